"""A reviewed project processed without a window: verdicts go into the files, whatever the settings."""

import csv

import pytest

from app.batch import process_folder
from app.opening import results_of, source_of
from processing.progress import silent
from processing.reporting.options import FileKind, HandoverOptions
from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.simulation.writing import write_run
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, Run, Verdict


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A small processed survey whose only candidate is confirmed with a note."""
    root = tmp_path_factory.mktemp("project")
    write_run(simulate(load_scenario("rolling"), 3), root / "ball")
    from processing.importing.folder import read_survey

    files = [root / "ball" / name for name in ("imu.csv", "audio.wav", "survey.toml")]
    with SurveyFolder.create(root, read_survey(root / "ball"), files) as folder:
        results = results_of(source_of(folder), silent())
        stored = folder.review.add_run(Run(0, "", results.run_hash), results.candidates)
        folder.review.decide(stored.candidates[0].id, Decision(Verdict.CONFIRMED, None, "ıslak zemin"), "Ayşe")
        return folder.path


def verdicts(out):
    with (out / "leaks.csv").open(encoding="utf-8") as file:
        return [(row["status"], row["note"]) for row in csv.DictReader(file)]


def test_the_verdict_and_the_note_are_in_the_table(project, tmp_path):
    process_folder(project, tmp_path, [], "en", silent())
    assert verdicts(tmp_path)[0] == ("confirmed", "ıslak zemin")


def test_a_verdict_is_carried_over_to_other_settings(project, tmp_path):
    process_folder(project, tmp_path, ["processing.orientation=madgwick"], "en", silent())
    assert verdicts(tmp_path)[0] == ("confirmed", "ıslak zemin")


def test_a_verdict_whose_candidate_is_not_found_again_is_still_told(project, tmp_path):
    """A band in which there is no leak to be heard finds nothing; the confirmed leak stays in the list."""
    process_folder(project, tmp_path, ["detector.min_score=1.0"], "en", silent())
    assert verdicts(tmp_path) == [("confirmed", "ıslak zemin")]


def test_processing_a_project_changes_nothing_in_it(project, tmp_path):
    before = (project / "survey.db").read_bytes()
    process_folder(project, tmp_path, [], "en", silent())
    assert (project / "survey.db").read_bytes() == before


def test_the_hand_over_goes_along_with_who_decided_what(project, tmp_path):
    options = HandoverOptions(frozenset({FileKind.DECISIONS_CSV, FileKind.KML}), as_zip=False)
    results = process_folder(project, tmp_path, [], "en", silent(), options)
    with (tmp_path / "decisions.csv").open(encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert (row["operator"], row["verdict_after"], row["note_after"]) == ("Ayşe", "confirmed", "ıslak zemin")
    told = "handover_no_place" in [finding.code for finding in results.findings]
    assert told != (tmp_path / "survey.kml").exists()
