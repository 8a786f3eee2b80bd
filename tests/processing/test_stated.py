"""The report's intervals are widened where the operator chose so, and only there."""

from dataclasses import replace

import numpy as np
import pytest
from small_survey import candidate, make_folder, make_results

from processing.reporting.content import make_content
from processing.stated import as_stated, widened
from processing.storage.folder import SurveyFolder
from processing.survey import StatedIntervals


@pytest.fixture
def results(tmp_path):
    with make_folder(tmp_path) as folder:
        yield make_results(folder)


def test_an_interval_grows_about_its_own_place_and_ends_at_the_launch():
    leak = replace(candidate(1, 20.0, 0.9), chainage_low95_m=19.0, chainage_high95_m=23.0)
    wide = widened(leak, 2.0)
    assert (wide.chainage_low95_m, wide.chainage_m, wide.chainage_high95_m) == (18.0, 20.0, 26.0)
    assert widened(replace(leak, chainage_m=1.0, chainage_low95_m=0.2), 3.0).chainage_low95_m == 0.0
    assert widened(leak, 0.5) is leak
    nowhere = replace(leak, chainage_m=float("nan"), chainage_low95_m=float("nan"), chainage_high95_m=float("nan"))
    assert np.isnan(widened(nowhere, 2.0).chainage_low95_m)


def test_without_a_choice_the_results_are_the_machines_own(results):
    assert as_stated(results) is results


def test_the_report_widens_leaks_and_path_alike(results):
    survey = replace(results.survey, stated=StatedIntervals(1.5, 12, "rolling/*/*/*"))
    content = make_content(replace(results, survey=survey), {})
    assert [row.interval_m for row in content.rows] == pytest.approx([1.2] * 4)
    assert content.results.track.sigma_along_m == pytest.approx(1.5 * results.track.sigma_along_m)
    assert [row.candidate.chainage_m for row in content.rows] == [c.chainage_m for c in results.candidates]


def test_the_choice_is_kept_and_logged_with_the_survey(tmp_path):
    with make_folder(tmp_path) as folder:
        chosen = replace(folder.read_survey(), stated=StatedIntervals(1.5, 12, "rolling/*/*/*"))
        folder.write_survey(chosen, "Ayşe")
        path = folder.path
    with SurveyFolder.open(path) as again:
        assert again.read_survey() == chosen
        rows = again._db.rows("SELECT operator, after FROM survey_log WHERE part = 'stated' ORDER BY id")
    assert rows[-1] == ("Ayşe", '{"widen":1.5,"digs":12,"kind":"rolling/*/*/*"}')
