"""Presets: the formula against published speeds, the table against its own promises, choice and filling in."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.errors import ErrorCode, LeaklineError
from processing.settings import DetectorSettings, Settings, SoundSettings, with_value
from processing.sound.presets import (
    AUTO,
    BASES,
    KINDS,
    NONE,
    Preset,
    PresetValue,
    chosen,
    effective,
    filled_in,
    save_user_rows,
    shipped,
    sound_speed_mps,
    table,
)
from processing.survey import PipeInfo, ProcessingChoice, Survey


def surveyed(material="", diameter_m=None, preset=AUTO):
    return Survey(pipe=PipeInfo(material, diameter_m), processing=ProcessingChoice(preset=preset))


def test_sound_is_slower_in_soft_pipes_and_free_water_is_the_limit():
    assert sound_speed_mps(1e6, 20) == pytest.approx((2.2e9 / 1000) ** 0.5, rel=1e-3)
    # D/e = 20: 1 + 0.91 · 2.2/3 · 20 = 14.35 and √(2.2e6) = 1483
    assert sound_speed_mps(3.0, 20) == pytest.approx(1483.24 / 14.3467**0.5, rel=1e-4)


@given(modulus=st.floats(0.1, 300), wall=st.floats(3, 200))
def test_a_stiffer_or_thicker_pipe_is_never_slower(modulus, wall):
    assert sound_speed_mps(modulus * 1.1, wall) > sound_speed_mps(modulus, wall)
    assert sound_speed_mps(modulus, wall * 1.1) < sound_speed_mps(modulus, wall)


def test_the_shipped_speeds_lie_where_the_correlators_handbooks_have_them():
    speed = {row.key: row.sound_speed_mps for row in shipped()}
    assert 1000 < speed["ductile_iron"] < 1400
    assert 1000 < speed["cast_iron"] < 1400
    assert 300 < speed["pvc"] < 600
    assert 200 < speed["pe"] < speed["pe_small"] < 400


def test_every_shipped_value_has_range_basis_and_source():
    rows = shipped()
    assert len({row.key for row in rows}) == len(rows)
    for row in rows:
        for name, told in row.told.items():
            assert KINDS[name].low <= told.value <= KINDS[name].high
            assert told.basis in BASES[:-1]
            assert len(told.source) > 5


def test_every_setting_that_a_preset_fills_in_exists_and_takes_any_value_of_its_range():
    for name, kind in KINDS.items():
        if kind.setting:
            step, key = kind.setting.split(".")
            for value in (kind.low, kind.high):
                assert getattr(getattr(with_value(Settings(), step, key, str(value)), step), key) == value, name


@pytest.mark.parametrize(
    ("material", "diameter", "key"),
    [
        ("ductile iron", 0.3, "ductile_iron"), ("DÜKTİL DEMİR", 0.3, "ductile_iron"), ("Çelik", 0.5, "steel"),
        ("PE100", 0.063, "pe_small"), ("PE 100", 0.2, "pe"), ("HDPE", None, "pe"), ("PVC-U", 0.15, "pvc"),
        ("ASBEST", 0.2, "asbestos_cement"), ("clay", 0.2, None), ("", 0.2, None), ("PVC", 15.0, None),
    ],
)  # fmt: skip
def test_material_and_diameter_choose_the_row(material, diameter, key):
    found = chosen(shipped(), surveyed(material, diameter))
    assert (found.key if found is not None else None) == key


def test_none_takes_none_a_key_takes_its_row_and_an_unknown_key_is_told():
    assert chosen(shipped(), surveyed("PVC", 0.15, NONE)) is None
    assert chosen(shipped(), surveyed("PVC", 0.15, "steel")).key == "steel"
    with pytest.raises(LeaklineError) as caught:
        chosen(shipped(), surveyed(preset="copper"))
    assert caught.value.code is ErrorCode.SETTING_INVALID
    assert "steel" in str(caught.value.params["allowed"])


def test_what_was_set_by_hand_stays_and_the_rest_is_filled_in():
    told = {"band_low_hz": PresetValue(800.0), "background_m": PresetValue(30.0), "modulus_gpa": PresetValue(3.0)}
    by_hand = replace(Settings(), sound=SoundSettings(band_low_hz=650.0))
    filled = filled_in(by_hand, Preset("x", "X", values=told))
    assert filled.sound.band_low_hz == 650.0
    assert filled.detector == replace(DetectorSettings(), background_m=30.0)
    assert filled_in(by_hand, None) is by_hand
    assert effective(Settings(), surveyed("clay"), shipped()) == Settings()


def test_the_users_rows_stand_in_the_place_of_shipped_ones_and_survive_the_disc(tmp_path):
    file = tmp_path / "settings" / "presets.toml"
    changed = replace(
        next(row for row in shipped() if row.key == "pvc"),
        values={"background_m": PresetValue(40.0, "own", "three digs")}, own=True,
    )  # fmt: skip
    added = Preset(
        "lead", "Lead", "Kurşun", ("lead", "kurşun"), (10.0, 50.0), {"band_low_hz": PresetValue(700.0)}, True
    )
    save_user_rows(file, [*shipped(), changed, added])
    rows = table(file)
    assert [row.key for row in rows] == [*(row.key for row in shipped()), "lead"]
    assert next(row for row in rows if row.key == "pvc") == changed
    assert rows[-1] == added
    assert chosen(rows, surveyed("kurşun", 0.02)) == added
    save_user_rows(file, shipped())
    assert not file.exists()
    assert table(file) == shipped()


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("[[preset]]\nkey = ", ErrorCode.TOML_INVALID),
        ("[[preset]]\nkey = 'x'", ErrorCode.KEY_MISSING),
        ("preset = 3", ErrorCode.SETTING_INVALID),
        ("[[preset]]\nkey = 'auto'\nname = 'x'", ErrorCode.SETTING_INVALID),
        ("[[preset]]\nkey = 'x'\nname = 'x'\nvalues.speed = 3", ErrorCode.SETTING_UNKNOWN),
        ("[[preset]]\nkey = 'x'\nname = 'x'\nvalues.background_m = 3000", ErrorCode.SETTING_INVALID),
        ("[[preset]]\nkey = 'x'\nname = 'x'\nvalues.background_m = nan", ErrorCode.SETTING_INVALID),
        ("[[preset]]\nkey = 'x'\nname = 'x'\nvalues.background_m = {value = 9, basis = 'guess'}",
         ErrorCode.SETTING_INVALID),
        ("[[preset]]\nkey = 'x'\nname = 'x'\nvalues.band_low_hz = 900\nvalues.band_high_hz = 800",
         ErrorCode.SETTING_INVALID),
        ("[[preset]]\nkey = 'x'\nname = 'x'\ndiameter_mm = [9, 3]", ErrorCode.SETTING_INVALID),
    ],
)  # fmt: skip
def test_a_wrong_table_is_told_with_its_file(tmp_path, text, code):
    file = tmp_path / "presets.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(LeaklineError) as caught:
        table(file)
    assert caught.value.code is code
    assert caught.value.place.path == file
