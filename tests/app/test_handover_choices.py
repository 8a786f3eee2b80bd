"""Which files are handed over, by the preferences and by the command line."""

import pytest

from app.cli import BAD_INPUT, HANDOVER_FILES, run
from app.handover_choices import handover_options, options_of_words, remember_handover
from app.settings import Preferences, PreferencesStore
from processing.quantities import Units
from processing.reporting.options import ColumnScheme, FileKind, HandoverOptions


def test_who_chose_nothing_gets_all_files_in_the_units_of_the_window():
    assert handover_options(Preferences()) == HandoverOptions()
    assert handover_options(Preferences(units="us")).units is Units.US


@pytest.mark.parametrize(
    "options",
    [
        HandoverOptions(),
        HandoverOptions(frozenset(), as_zip=False),
        HandoverOptions(frozenset({FileKind.DXF}), "EPSG:2263", Units.US, ColumnScheme.ASSET, "Çınar; H-12"),
    ],
)
def test_what_was_chosen_comes_back_in_the_next_start(tmp_path, options):
    remember_handover(PreferencesStore(tmp_path / "preferences.json"), options)
    again = PreferencesStore(tmp_path / "preferences.json").values
    assert handover_options(again) == options
    assert again.recent_crs == ([options.crs] if options.crs else [])


def test_a_damaged_choice_is_the_default():
    options = handover_options(Preferences(handover={"files": "dxf,what", "units": "ells", "columns": "x"}))
    assert options == HandoverOptions(frozenset({FileKind.DXF}))


def test_the_command_lines_names_are_those_of_all_kinds():
    assert options_of_words(None, None) is None
    assert options_of_words(frozenset(HANDOVER_FILES), None) == HandoverOptions()
    assert options_of_words(None, "5254") == HandoverOptions(crs="EPSG:5254")
    some = options_of_words(frozenset({"excel", "raven"}), None)
    assert some == HandoverOptions(frozenset({FileKind.EXCEL_CSV, FileKind.RAVEN}), as_zip=False)


def test_a_file_or_a_system_that_does_not_exist_is_refused_before_any_work(tmp_path, capsys):
    (tmp_path / "ball").mkdir()
    words = ["process", str(tmp_path / "ball"), "--out", str(tmp_path / "out")]
    with pytest.raises(SystemExit) as left:
        run([*words, "--files", "kml,floppy"])
    assert left.value.code == BAD_INPUT
    assert "'floppy' is none of all, decisions" in capsys.readouterr().err
    assert run([*words, "--crs", "EPSG:999999"]) == BAD_INPUT
    assert "EPSG:999999" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
