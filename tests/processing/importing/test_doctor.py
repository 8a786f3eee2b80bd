"""The import doctor: every fault it knows, put into a sound log, is told, placed, counted, and mended or masked.

Longer than 400 lines because each of the some 45 findings has its test here, and one test checks that none lacks it.
"""

import ast
from pathlib import Path

import numpy as np
import pytest

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.importing.folder import ImportOptions, import_folder
from processing.survey import Channel, Severity

DEG = np.pi / 180
G = 9.80665


def imported(folder, rows, options=None, **columns):
    rows.write(folder / "imu.csv", **columns)
    return import_folder(folder, options)


def found(recording, code):
    matching = [f for f in recording.findings if f.code == code]
    assert matching, f"{code} not among {[f.code for f in recording.findings]}"
    for language in messages.LANGUAGES:
        assert messages.finding_sentence(matching[0], language)
    return matching[0]


def only(recording, *codes):
    """Nothing but these was found (besides the missing magnetometer and sound)."""
    assert {f.code for f in recording.findings} - {"mag_absent", "sound_missing"} == set(codes)


def drop(rows, keep):
    for name in ("time", "acc", "gyr", "mag", "quat"):
        setattr(rows, name, getattr(rows, name)[keep])


def spans(recording, reason):
    return [(s.start_s, s.end_s) for s in recording.not_assessed if s.reason == reason]


# --- time -------------------------------------------------------------------------------------------------------------


def test_a_sound_log_has_nothing_to_tell(tmp_path, rows):
    recording = imported(tmp_path, rows)
    only(recording)
    assert recording.not_assessed == ()


def test_gaps_are_left_as_gaps_told_and_masked(tmp_path, rows):
    drop(rows, np.r_[0:500, 530:1000, 1003:1006, 1200:2000])
    recording = imported(tmp_path, rows)
    finding = found(recording, "gaps")
    assert finding.severity is Severity.MASKED
    assert (finding.params["count"], finding.params["first_s"]) == (2, pytest.approx(4.99))
    assert finding.params["longest_s"] == pytest.approx(1.95)
    assert spans(recording, "imu_gap") == [pytest.approx((4.99, 5.3)), pytest.approx((10.05, 12.0))]
    assert recording.not_assessed[0].channel is Channel.PATH
    assert len(recording.imu.time_s) == len(rows.time)


def test_a_short_gap_is_bridged_and_not_masked(tmp_path, make):
    rows = make(rate_hz=400.0)
    drop(rows, np.r_[0:500, 515:8000])
    recording = imported(tmp_path, rows)
    assert found(recording, "gaps_short").params["longest_s"] == pytest.approx(0.04)
    assert recording.not_assessed == ()


def test_rows_that_stand_twice_are_dropped(tmp_path, rows):
    drop(rows, np.r_[0:300, 299:700, 699:2000])
    recording = imported(tmp_path, rows)
    assert found(recording, "duplicate_rows").params["count"] == 2
    np.testing.assert_allclose(np.diff(recording.imu.time_s), 0.01, atol=1e-9)


def test_a_block_that_stands_twice_is_dropped(tmp_path, rows):
    drop(rows, np.r_[0:1200, 900:2000])
    recording = imported(tmp_path, rows)
    assert found(recording, "duplicate_rows").params["count"] == 300
    assert len(recording.imu.time_s) == 2000
    assert not [f for f in recording.findings if f.code == "time_restart"]


def test_other_rows_with_the_time_of_the_row_before_are_dropped(tmp_path, rows):
    rows.time[[400, 900]] = rows.time[[399, 899]]
    recording = imported(tmp_path, rows)
    finding = found(recording, "duplicate_times")
    assert (finding.params["count"], finding.params["first_s"]) == (2, pytest.approx(3.99))
    assert len(recording.imu.time_s) == 1998


@pytest.mark.parametrize("order", [np.r_[0:500, 510:520, 500:510, 520:2000], np.r_[0:500, 501, 500, 502:2000]])
def test_rows_out_of_order_are_sorted(tmp_path, rows, order):
    sound = rows.acc.copy()
    drop(rows, order)
    recording = imported(tmp_path, rows)
    found(recording, "rows_out_of_order")
    np.testing.assert_allclose(recording.imu.acc_s_mps2, sound, atol=1e-6)
    assert recording.not_assessed == ()


def test_late_packets_of_seconds_are_sorted_too(tmp_path, rows):
    sound = rows.acc.copy()
    drop(rows, np.r_[0:500, 800:1100, 500:800, 1100:2000])
    recording = imported(tmp_path, rows)
    assert found(recording, "rows_out_of_order").params["count"] == 300
    np.testing.assert_allclose(recording.imu.acc_s_mps2, sound, atol=1e-6)


@pytest.mark.parametrize(("factor", "mend"), [(1e3, 1e-3), (1e6, 1e-6), (1e9, 1e-9), (1e-3, 1e3)])
def test_times_that_are_not_in_seconds_are_brought_to_seconds(tmp_path, rows, factor, mend):
    recording = imported(tmp_path, rows, time_s=rows.time * factor)
    assert found(recording, "time_rescaled").params["factor"] == mend
    np.testing.assert_allclose(recording.imu.time_s, rows.time, atol=1e-3)


@pytest.mark.parametrize("factor", [10.0, 0.1])
def test_times_ten_times_wrong_are_found_by_gravity(tmp_path, make, factor):
    rows = make(seconds=30.0)
    recording = imported(tmp_path, rows, time_s=rows.time * factor)
    assert found(recording, "time_ten_times").params["factor"] == pytest.approx(1 / factor)
    assert recording.imu.duration_s == pytest.approx(rows.time[-1], rel=1e-6)


def test_integer_nanoseconds_of_another_logger_are_understood(tmp_path, rows, table):
    columns = {"time": (rows.time * 1e9).astype(np.int64) + 1_700_000_000_000_000_000}
    columns |= {f"a{a}": rows.acc[:, i] for i, a in enumerate("xyz")}
    columns |= {f"g{a}": rows.gyr[:, i] for i, a in enumerate("xyz")}
    table(tmp_path / "log.csv", columns)
    recording = import_folder(tmp_path)
    assert found(recording, "time_unit_found").params["unit"] == "ns"
    found(recording, "time_from_first")
    np.testing.assert_allclose(recording.imu.time_s, rows.time, atol=1e-6)


def test_a_counter_needs_a_rate(tmp_path, rows, table):
    columns = {"sample": np.arange(len(rows.time))}
    columns |= {f"acc_{a}": rows.acc[:, i] for i, a in enumerate("xyz")}
    columns |= {f"gyr_{a}": rows.gyr[:, i] for i, a in enumerate("xyz")}
    table(tmp_path / "log.csv", columns)
    with pytest.raises(LeaklineError) as caught:
        import_folder(tmp_path)
    assert caught.value.code is ErrorCode.SAMPLE_RATE_MISSING
    recording = import_folder(tmp_path, ImportOptions(sample_rate_hz=100.0))
    assert found(recording, "time_from_counter").params["rate_hz"] == 100.0
    np.testing.assert_allclose(recording.imu.time_s, rows.time, atol=1e-9)


def test_a_restart_of_the_device_is_counted_on_and_masked(tmp_path, rows):
    rows.time[1200:] -= rows.time[1200]
    recording = imported(tmp_path, rows)
    finding = found(recording, "time_restart")
    assert finding.severity is Severity.WARNING
    assert (finding.params["count"], finding.params["back_s"]) == (1, pytest.approx(11.99))
    assert spans(recording, "imu_restart") == [pytest.approx((11.99, 12.99))]
    assert np.all(np.diff(recording.imu.time_s) > 0)
    assert len(recording.imu.time_s) == 2000


def test_single_wild_times_are_dropped(tmp_path, rows):
    rows.time[[300, 1400]] = [7.3e4, -50.0]
    recording = imported(tmp_path, rows)
    assert found(recording, "time_wild").params["count"] == 2
    assert len(recording.imu.time_s) == 1998
    assert recording.not_assessed == ()


def test_rows_without_a_time_are_dropped(tmp_path, rows):
    rows.time[[300, 301]] = np.nan
    recording = imported(tmp_path, rows)
    assert found(recording, "rows_without_time").params == {"count": 2, "first_row": 301}
    assert len(recording.imu.time_s) == 1998


def bursty(rows, seed=0):
    """250 Hz in packets of 18, stamped by the host when they arrive: steps of 0.04 ms and one of 72 ms."""
    rng = np.random.default_rng(seed)
    count = len(rows.time)
    packet = np.arange(count) // 18
    arrival = (
        rows.time[np.minimum(packet * 18 + 17, count - 1)] + 0.02 + rng.exponential(0.002, packet.max() + 1)[packet]
    )
    return arrival + (np.arange(count) % 18) * 4e-5


def test_bursts_of_host_stamps_become_an_even_clock(tmp_path, make):
    rows = make(seconds=40.0, rate_hz=250.0)
    recording = imported(tmp_path, rows, time_s=bursty(rows))
    finding = found(recording, "time_bursty")
    assert finding.params["rate_hz"] == pytest.approx(250.0, rel=1e-3)
    assert finding.params["median_step_ms"] == pytest.approx(0.04, rel=0.01)
    assert np.diff(recording.imu.time_s) == pytest.approx(0.004, rel=0.05)
    late = recording.imu.time_s - rows.time
    assert np.ptp(late) < 0.02  # against 72 ms before
    assert recording.not_assessed == ()
    assert len(recording.imu.time_s) == len(rows.time)


def test_a_real_gap_survives_the_rebuilding_of_bursts(tmp_path, make):
    rows = make(seconds=40.0, rate_hz=250.0)
    stamps = bursty(rows)
    keep = np.r_[0:4500, 5256:10000]  # 756 samples = 42 packets = 3.02 s
    drop(rows, keep)
    recording = imported(tmp_path, rows, time_s=stamps[keep])
    found(recording, "time_bursty")
    (start, end), *others = spans(recording, "imu_gap")
    assert not others
    assert start == pytest.approx(18.0, abs=0.08)
    assert end - start == pytest.approx(3.02, abs=0.02)
    assert np.abs(recording.imu.time_s - rows.time - 0.055).max() < 0.02


def test_a_counter_beside_bursty_stamps_keeps_every_gap(tmp_path, make, table):
    rows = make(seconds=40.0, rate_hz=250.0)
    stamps, counter = bursty(rows), np.arange(10000) % 65536
    keep = np.r_[0:4500, 4550:10000]
    drop(rows, keep)
    columns = {"Time (s)": stamps[keep], "Counter": counter[keep]}
    columns |= {f"Acc {a} (m/s^2)": rows.acc[:, i] for i, a in enumerate("XYZ")}
    columns |= {f"Gyro {a} (rad/s)": rows.gyr[:, i] for i, a in enumerate("XYZ")}
    table(tmp_path / "log.csv", columns)
    recording = import_folder(tmp_path)
    (start, end), *others = spans(recording, "imu_gap")
    assert not others
    assert end - start == pytest.approx(51 * 0.004, abs=0.003)


def test_two_rates_in_one_log_are_told(tmp_path, rows):
    drop(rows, np.r_[0:1000, 1000:2000:2])
    finding = found(imported(tmp_path, rows), "two_rates")
    assert (finding.params["first_hz"], finding.params["other_hz"]) == (pytest.approx(100.0), pytest.approx(50.0))
    assert finding.params["at_s"] == pytest.approx(10.0, abs=1.5)


def test_a_rate_that_no_imu_has_is_told(tmp_path, make):
    rows = make()
    rows.write(tmp_path / "imu.csv", time_s=[f"{t:.6e}" for t in rows.time * 1e-13])
    assert found(import_folder(tmp_path / "imu.csv"), "rate_odd").params["rate_hz"] == pytest.approx(1e15)


# --- rows and lines ---------------------------------------------------------------------------------------------------


def test_a_first_row_of_zeros_is_dropped(tmp_path, rows):
    rows.acc[0] = rows.gyr[0] = rows.mag[0] = 0.0
    recording = imported(tmp_path, rows)
    assert found(recording, "first_rows_zero").params["count"] == 1
    assert len(recording.imu.time_s) == 1999


def test_rows_of_nan_are_masked_and_stay_in_place(tmp_path, rows):
    rows.acc[700:800] = np.nan
    rows.gyr[1500, 2] = np.nan
    recording = imported(tmp_path, rows)
    finding = found(recording, "rows_unreadable")
    assert (finding.params["count"], finding.params["first_s"]) == (101, pytest.approx(7.0))
    assert spans(recording, "imu_unreadable") == [pytest.approx((6.99, 8.0))]
    assert len(recording.imu.time_s) == 2000
    assert np.isfinite(recording.imu.acc_s_mps2).all()
    assert np.isfinite(recording.imu.gyr_s_radps).all()
    assert list(np.nonzero(~recording.imu.valid)[0]) == [*range(700, 800), 1500]
    between = recording.imu.acc_s_mps2[700:800]
    edges = recording.imu.acc_s_mps2[[699, 800]]
    assert np.all(between >= edges.min(axis=0) - 1e-9)
    assert np.all(between <= edges.max(axis=0) + 1e-9)


def test_lines_of_other_kind_are_left_out_with_their_number(tmp_path, rows):
    rows.write(tmp_path / "imu.csv")
    lines = (tmp_path / "imu.csv").read_text().splitlines()
    lines[300] = "logger restarted"
    lines[900] = "12.0,1,2"
    (tmp_path / "imu.csv").write_text("\n".join(lines))
    recording = import_folder(tmp_path)
    assert found(recording, "lines_unreadable").params == {"count": 2, "first_line": 301}


def test_empty_bytes_of_a_power_cut_are_left_out(tmp_path, rows):
    rows.write(tmp_path / "imu.csv")
    with (tmp_path / "imu.csv").open("ab") as file:
        file.write(b"20.0,1.0,2" + bytes(4096))
    recording = import_folder(tmp_path)
    assert found(recording, "nul_bytes").params["count"] == 4096
    assert len(recording.imu.time_s) == 2000


def test_a_line_without_end_is_left_out(tmp_path, rows):
    rows.write(tmp_path / "imu.csv")
    with (tmp_path / "imu.csv").open("ab") as file:
        file.write(b"x" * 30_000_000 + b"\n")
    recording = import_folder(tmp_path)
    assert found(recording, "lines_too_long").params["count"] >= 1
    assert len(recording.imu.time_s) == 2000


def test_too_few_rows_are_an_error_with_the_count(tmp_path, rows):
    drop(rows, slice(0, 9))
    with pytest.raises(LeaklineError) as caught:
        imported(tmp_path, rows)
    assert (caught.value.code, caught.value.params["count"]) == (ErrorCode.TOO_FEW_SAMPLES, 9)


# --- units ------------------------------------------------------------------------------------------------------------


def test_g_written_as_metres_per_second_squared_is_converted(tmp_path, rows):
    sound = rows.acc.copy()
    rows.acc = rows.acc / G
    recording = imported(tmp_path, rows)
    finding = found(recording, "acc_unit_mended")
    assert (finding.params["declared"], finding.params["found"]) == ("m/s²", "g")
    np.testing.assert_allclose(recording.imu.acc_s_mps2, sound, atol=1e-5)


def test_degrees_written_as_radians_are_converted(tmp_path, rows):
    sound = rows.gyr.copy()
    rows.gyr = rows.gyr / DEG
    recording = imported(tmp_path, rows)
    finding = found(recording, "gyr_unit_mended")
    assert (finding.params["declared"], finding.params["found"]) == ("rad/s", "°/s")
    np.testing.assert_allclose(recording.imu.gyr_s_radps, sound, atol=1e-6)


def test_a_header_that_says_g_and_degrees_over_si_data_is_overruled(tmp_path, rows, table):
    columns = {"Time (s)": rows.time}
    columns |= {f"Gyroscope {a} (deg/s)": rows.gyr[:, i] for i, a in enumerate("XYZ")}
    columns |= {f"Accelerometer {a} (g)": rows.acc[:, i] for i, a in enumerate("XYZ")}
    table(tmp_path / "log.csv", columns)
    recording = import_folder(tmp_path)
    assert found(recording, "acc_unit_mended").params["found"] == "m/s²"
    assert found(recording, "gyr_unit_mended").params["found"] == "rad/s"
    np.testing.assert_allclose(recording.imu.acc_s_mps2, rows.acc, atol=1e-5)
    np.testing.assert_allclose(recording.imu.gyr_s_radps, rows.gyr, atol=1e-6)


def test_a_ball_that_rolls_fast_in_true_units_is_left_alone(tmp_path, make):
    only(imported(tmp_path, make(seconds=30.0, rate_hz=200.0, spin=20.0)))


def test_a_log_without_units_that_hardly_turned_is_assumed_and_told(tmp_path, make, table):
    rows = make(spin=0.0)
    columns = {"t": rows.time} | {f"a{a}": rows.acc[:, i] for i, a in enumerate("xyz")}
    columns |= {f"g{a}": rows.gyr[:, i] / DEG for i, a in enumerate("xyz")}
    table(tmp_path / "log.csv", columns)
    recording = import_folder(tmp_path)
    assert found(recording, "gyr_unit_assumed").params["found"] == "°/s"
    np.testing.assert_allclose(recording.imu.gyr_s_radps, rows.gyr, atol=1e-6)


def test_axes_that_contradict_gravity_are_told(tmp_path, rows):
    rows.gyr = -rows.gyr
    assert found(imported(tmp_path, rows), "gyr_disagrees").severity is Severity.WARNING


def test_an_accelerometer_without_gravity_is_told(tmp_path, rows):
    rows.acc = np.random.default_rng(0).normal(0, 0.2, rows.acc.shape)
    found(imported(tmp_path, rows), "acc_without_gravity")


def test_an_accelerometer_in_no_known_unit_is_told(tmp_path, rows):
    rows.acc = rows.acc * 5.0
    found(imported(tmp_path, rows), "acc_magnitude_odd")


def test_gravity_far_off_at_rest_is_told(tmp_path, rows):
    rows.acc = rows.acc * 1.06
    finding = found(imported(tmp_path, rows), "rest_gravity_off")
    assert finding.params["rest_mps2"] == pytest.approx(1.06 * G, rel=0.01)
    assert finding.params["off_pct"] == pytest.approx(6.0, abs=0.5)


# --- values -----------------------------------------------------------------------------------------------------------


def test_impossible_values_are_masked_not_believed(tmp_path, rows):
    rows.gyr[1000, 1] = 1e5 * DEG
    rows.gyr[1200:1220, 0] = 1e5 * DEG
    recording = imported(tmp_path, rows)
    finding = found(recording, "values_impossible")
    assert (finding.params["count"], finding.params["worst_dps"]) == (21, pytest.approx(1e5))
    assert spans(recording, "imu_impossible") == [pytest.approx((11.99, 12.2))]
    assert np.abs(recording.imu.gyr_s_radps).max() < 10
    assert (~recording.imu.valid).sum() == 21


def test_a_saturated_gyroscope_is_masked_where_it_is_flat(tmp_path, make):
    rows = make(seconds=40.0, rate_hz=200.0, spin=45.0)
    limit = 2000 * DEG
    clipped = np.abs(rows.gyr) > limit
    rows.gyr = np.clip(rows.gyr, -limit, limit)
    recording = imported(tmp_path, rows)
    finding = found(recording, "gyr_saturated")
    assert finding.params["limit"] == pytest.approx(2000.0, rel=1e-4)
    assert finding.severity is Severity.MASKED
    assert np.array_equal(~recording.imu.valid, clipped.any(axis=1))
    assert spans(recording, "imu_gyr_saturated")


def test_a_saturated_accelerometer_is_told(tmp_path, make):
    rows = make(seconds=40.0, rate_hz=200.0)
    rng = np.random.default_rng(0)
    for start in range(2500, 5500, 300):
        rows.acc[start : start + 8, 0] += 200 * np.hanning(8) * rng.choice([-1, 1])
    limit = 4 * G
    rows.acc = np.clip(rows.acc, -limit, limit)
    assert found(imported(tmp_path, rows), "acc_saturated").params["limit"] == pytest.approx(limit, abs=1.0)


def test_a_peak_that_is_merely_coarse_is_not_called_saturated(tmp_path, make):
    rows = make(seconds=30.0, rate_hz=200.0, spin=8.0)
    rows.gyr = np.round(rows.gyr / (0.0609 * DEG)) * 0.0609 * DEG
    rows.acc = np.round(rows.acc / 0.005) * 0.005
    only(imported(tmp_path, rows))


@pytest.mark.parametrize(("sensor", "code"), [("gyr", "gyr_dead"), ("acc", "acc_dead")])
def test_a_dead_axis_masks_the_whole_path(tmp_path, rows, sensor, code):
    getattr(rows, sensor)[:, 1] = 0.0
    recording = imported(tmp_path, rows)
    assert found(recording, code).params["axes"] == "y"
    assert spans(recording, "imu_dead") == [pytest.approx((rows.time[0], rows.time[-1]))]
    assert not recording.imu.valid.any()


def test_a_noise_free_simulation_has_no_dead_axis(tmp_path, make):
    rows = make(noise=False)
    rows.gyr[:, 0] = rows.gyr[:, 2] = 0.0
    angle = np.cumsum(rows.gyr[:, 1]) * 0.01
    rows.acc = G * np.column_stack([-np.sin(angle), 0 * angle, np.cos(angle)])
    only(imported(tmp_path, rows))


def test_a_log_that_stands_still_while_it_turns_is_masked(tmp_path, rows):
    rows.acc[900:1100], rows.gyr[900:1100] = rows.acc[900], rows.gyr[900]
    recording = imported(tmp_path, rows)
    assert found(recording, "imu_frozen").params["count"] == 199
    assert spans(recording, "imu_frozen") == [pytest.approx((9.0, 11.0))]


# --- magnetometer and quaternion --------------------------------------------------------------------------------------


def magnetic(rows, mag):
    return {f"mag_{a}_uT": mag[:, i] for i, a in enumerate("xyz")}


def quaternion(quat):
    return {f"quat_{a}": quat[:, i] for i, a in enumerate("wxyz")}


def test_a_good_magnetometer_is_kept(tmp_path, rows):
    recording = imported(tmp_path, rows, **magnetic(rows, rows.mag))
    assert {f.code for f in recording.findings} == {"sound_missing"}
    np.testing.assert_allclose(recording.imu.mag_s_ut, rows.mag, atol=1e-6)


@pytest.mark.parametrize(
    ("change", "code", "kept"),
    [
        (lambda mag: mag * 0 + 3.0, "mag_dead", False),
        (lambda mag: mag * [1, 0, 1], "mag_axis_dead", False),
        (lambda mag: mag * 1e-3, "mag_odd", True),
        (lambda mag: mag * np.nan, "mag_absent", False),
    ],
)
def test_a_bad_magnetometer_is_told(tmp_path, rows, change, code, kept):
    recording = imported(tmp_path, rows, **magnetic(rows, change(rows.mag)))
    found(recording, code)
    assert (recording.imu.mag_s_ut is not None) == kept


def test_a_magnetometer_in_gauss_without_a_unit_is_scaled(tmp_path, rows, table):
    columns = {"t": rows.time} | {f"a{a}": rows.acc[:, i] for i, a in enumerate("xyz")}
    columns |= {f"g{a}": rows.gyr[:, i] for i, a in enumerate("xyz")}
    columns |= {f"m{a}": rows.mag[:, i] / 100 for i, a in enumerate("xyz")}
    table(tmp_path / "log.csv", columns)
    recording = import_folder(tmp_path)
    found(recording, "mag_scaled")
    np.testing.assert_allclose(recording.imu.mag_s_ut, rows.mag, atol=1e-4)


def test_quaternions_are_brought_to_unit_length_and_bad_ones_held(tmp_path, rows):
    quat = rows.quat * 1.02
    quat[500:510] = 0.0
    recording = imported(tmp_path, rows, **quaternion(quat))
    finding = found(recording, "quat_invalid")
    assert (finding.params["count"], finding.params["first_s"]) == (10, pytest.approx(5.0))
    np.testing.assert_allclose(np.linalg.norm(recording.imu.quat_ws, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(recording.imu.quat_ws[505], rows.quat[499], atol=1e-6)


@pytest.mark.parametrize("change", [lambda q: q * 0, lambda q: q * 57.3, lambda q: q * 0 + [1, 0, 0, 0]])
def test_quaternions_that_are_none_are_left_out(tmp_path, rows, change):
    recording = imported(tmp_path, rows, **quaternion(change(rows.quat)))
    found(recording, "quat_unusable")
    assert recording.imu.quat_ws is None


# --- all of them ------------------------------------------------------------------------------------------------------


def spoken_codes():
    """Every code that import's modules put into a Finding or a Mask."""
    folder = Path(__file__).parents[3] / "processing" / "importing"
    table = set(messages.table("findings")) | set(messages.table("reasons"))
    for path in folder.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("Finding", "Mask"):
                for argument in node.args[:3]:
                    if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                        yield argument.value, table


def test_every_code_has_its_sentence():
    spoken = list(spoken_codes())
    assert len(spoken) > 30
    for code, table in spoken:
        assert code in table, code


@pytest.mark.data
def test_a_foot_log_of_sample_numbers_in_si_is_read_with_its_rate(shared_data):
    log = shared_data / "constrained_zupt_fgo" / "imuMeasLeft.csv"
    recording = import_folder(log, ImportOptions(sample_rate_hz=60.0))
    assert found(recording, "acc_unit_found").params["found"] == "m/s²"
    assert found(recording, "gyr_unit_found").params["found"] == "rad/s"
    assert len(recording.imu.time_s) == 7201


@pytest.mark.data
def test_a_table_with_two_header_rows_and_two_feet_gives_the_first_foot(shared_data):
    recording = import_folder(shared_data / "gaitmap" / "imu_sample.csv", ImportOptions(sample_rate_hz=204.8))
    assert found(recording, "gyr_unit_found").params["found"] == "°/s"
    assert recording.imu.acc_s_mps2[0] == pytest.approx([0.8808107, 2.7622081, 9.4086502])
    assert recording.imu.gyr_s_radps[0] == pytest.approx(np.radians([-0.1124017, -0.0321572, -0.0622611]), abs=1e-8)
