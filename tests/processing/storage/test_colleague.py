"""Opinions of a colleague's copy come in only where the survey and the place are the same."""

import shutil

import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.storage.colleague import matched, read_colleague, sums_of
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, Run, Survey, SurveyInfo, Verdict

YES, NO = Decision(Verdict.CONFIRMED), Decision(Verdict.REJECTED, note="vana")


@pytest.fixture
def copy(folder, stored, tmp_path):
    """The colleague's copy, in which the first leak was confirmed and the third rejected."""
    path = tmp_path / "from-colleague" / folder.path.name
    shutil.copytree(folder.path, path, ignore=shutil.ignore_patterns("survey.lock"))
    labels = [c.label for c in stored.candidates]
    with SurveyFolder.open(path) as opened:
        opened.opinions.give_all({labels[0]: YES, labels[2]: NO}, "Bülent")
    return path


def test_opinions_of_a_copy_are_those_of_this_surveys_leaks(folder, stored, copy):
    before = (copy / "survey.db").read_bytes()
    found = matched(read_colleague(copy), sums_of(folder), stored.candidates)
    labels = [c.label for c in stored.candidates]
    assert found.opinions == {"Bülent": {labels[0]: YES, labels[2]: NO}}
    assert found.left_out == 0
    assert (copy / "survey.db").read_bytes() == before


def test_a_leak_that_lies_elsewhere_by_now_is_left_out(folder, stored, candidate, copy):
    again = folder.review.add_run(Run(0, "", "moved"), [candidate(100), candidate(300, chainage_m=340)])
    found = matched(read_colleague(copy), sums_of(folder), again.candidates)
    assert found.opinions == {"Bülent": {stored.candidates[0].label: YES}}
    assert found.left_out == 1


def test_another_survey_is_refused_though_its_numbers_are_the_same(folder, stored, candidate, tmp_path):
    (tmp_path / "other.csv").write_bytes(b"another run")
    with SurveyFolder.create(tmp_path / "x", Survey(SurveyInfo("Other")), [tmp_path / "other.csv"]) as other:
        run = other.review.add_run(Run(0, "", "h"), [candidate(100 * i) for i in range(1, 5)])
        other.opinions.give(run.candidates[0].label, "Bülent", YES)
        path = other.path
    with pytest.raises(LeaklineError) as caught:
        matched(read_colleague(path), sums_of(folder), stored.candidates)
    assert caught.value.code is ErrorCode.OPINIONS_OTHER_SURVEY


def test_a_copy_in_which_nobody_gave_a_second_opinion_is_told(folder, stored):
    with pytest.raises(LeaklineError) as caught:
        read_colleague(folder.path)
    assert caught.value.code is ErrorCode.OPINIONS_NONE
