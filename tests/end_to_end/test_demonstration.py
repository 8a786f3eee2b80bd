"""The demonstration survey, whole: what a newcomer sees first must be right."""

import json

import pytest

from processing.importing.folder import ImportOptions, read_survey
from processing.pipeline import process, read_recording
from processing.settings import Settings
from processing.simulation.demo import demo_folder
from processing.storage.cache import Cache


@pytest.fixture(scope="module")
def demonstration(tmp_path_factory):
    root = tmp_path_factory.mktemp("demonstration")
    folder = demo_folder(root)
    cache = Cache(root / "cache")
    survey, settings = read_survey(folder), Settings()
    recording = read_recording(folder, ImportOptions(), settings.importing, cache)
    results = process(survey, recording, settings, cache)
    return folder, results, lambda: process(survey, recording, settings, cache)


def test_every_leak_heads_the_list_and_lies_in_its_interval(demonstration):
    folder, results, _ = demonstration
    truth = json.loads(next(folder.rglob("truth.json")).read_text(encoding="utf-8"))
    leaks = sorted(place["chainage_m"] for place in truth["places"] if place["kind"] == "leak")
    best = sorted(results.candidates, key=lambda c: -c.score)[: len(leaks)]
    assert all(candidate.score > 0.5 for candidate in best)
    for leak, candidate in zip(leaks, sorted(best, key=lambda c: c.chainage_m), strict=True):
        assert candidate.chainage_low95_m <= leak <= candidate.chainage_high95_m


def test_the_list_is_short(demonstration):
    _, results, _ = demonstration
    assert len(results.candidates) <= 8


def test_processing_again_takes_everything_from_the_cache(demonstration):
    _, first, again = demonstration
    second = again()
    assert set(second.timings.values()) == {0.0}
    assert second.run_hash == first.run_hash
    assert second.candidates == first.candidates
