"""What is remembered between starts survives damage and never costs the program its start."""

import json
import math
from pathlib import Path

import pytest

from app.settings import MAX_RECENT, Preferences, PreferencesStore
from app.survey_cards import is_there


def test_what_was_changed_is_there_after_a_new_start(tmp_path):
    file = tmp_path / "sub" / "preferences.json"
    PreferencesStore(file).change(theme="sun", volume=0.25, splitters={"a": "AAAA"})
    again = PreferencesStore(file).values
    assert (again.theme, again.volume, again.splitters) == ("sun", 0.25, {"a": "AAAA"})


@pytest.mark.parametrize("content", ["", "{", "[1, 2]", '{"theme": 5, "recent": "no", "unknown": 1}', "\x00\xff"])
def test_a_damaged_file_means_the_defaults(tmp_path, content):
    file = tmp_path / "preferences.json"
    file.write_text(content, encoding="latin-1")
    assert PreferencesStore(file).values == Preferences()


def test_values_of_wrong_kind_are_dropped_and_the_others_kept(tmp_path):
    file = tmp_path / "preferences.json"
    file.write_text(json.dumps({"theme": "dark", "recent": ["/a", 7, None], "volume": "loud"}), encoding="utf-8")
    values = PreferencesStore(file).values
    assert (values.theme, values.recent, values.volume) == ("dark", ["/a"], Preferences().volume)


def test_recent_surveys_are_unique_newest_first_and_not_too_many(tmp_path):
    store = PreferencesStore(tmp_path / "preferences.json")
    for number in range(MAX_RECENT + 5):
        store.remember_recent(Path(f"/survey-{number}"))
    store.remember_recent(Path("/survey-10"))
    assert store.values.recent[0] == str(Path("/survey-10"))
    assert len(store.values.recent) == len(set(store.values.recent)) == MAX_RECENT
    store.forget_recent(Path("/survey-10"))
    assert str(Path("/survey-10")) not in PreferencesStore(store.file).values.recent


def test_a_folder_that_cannot_be_written_costs_nothing_but_the_memory(tmp_path):
    (tmp_path / "file").write_text("not a folder", encoding="utf-8")
    store = PreferencesStore(tmp_path / "file" / "preferences.json")
    store.change(theme="dark")
    assert store.values.theme == "dark"


@pytest.mark.parametrize(
    "absurd",
    [
        {"theme": "pink"},
        {"language": "../xx"},
        {"report_language": "de"},
        {"units": "parsec", "places": "nowhere"},
        {"text_scale": 5000},
        {"text_scale": True},
        {"text_scale": -3},
        {"volume": math.nan},
        {"volume": 1e308},
        {"volume": -4.0},
        {"play_slow": 0},
        {"company": {"logo": "\0"}},
        {"recent": ["", "\0"], "pinned": ["\0"], "recent_crs": [""]},
    ],
)
def test_values_that_make_no_sense_are_as_if_they_had_not_been_written(tmp_path, absurd):
    file = tmp_path / "preferences.json"
    file.write_text(json.dumps(absurd), encoding="utf-8")
    assert PreferencesStore(file).values == Preferences()


def test_the_recent_survey_in_a_place_that_may_not_be_looked_at_is_not_there(tmp_path):
    too_long = "x" * 5000  # the system refuses to look, as it does for a share that is away
    with pytest.raises(OSError, match="survey"):
        (tmp_path / too_long / "survey.db").is_file()
    assert not is_there(tmp_path / too_long)
    (tmp_path / "survey.db").touch()
    assert is_there(tmp_path)
