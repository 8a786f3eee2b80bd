"""Every logger format, from files shaped like the real ones, against the motion that they were written from."""

import numpy as np
import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.importing.folder import ImportOptions, import_folder
from processing.importing.registry import FORMATS, sniff

DEG = np.pi / 180
G = 9.80665


def codes(recording):
    return [finding.code for finding in recording.findings]


def same_motion(imu, rows, start=0, acc=0.02, gyr=0.005):
    np.testing.assert_allclose(imu.acc_s_mps2, rows.acc[start : start + len(imu.time_s)], atol=acc)
    np.testing.assert_allclose(imu.gyr_s_radps, rows.gyr[start : start + len(imu.time_s)], atol=gyr)


def best(path):
    return sniff(path)[0].format.name


def test_names_of_formats_are_unique_and_each_has_a_title():
    assert len({f.name for f in FORMATS}) == len(FORMATS)
    assert all(f.title for f in FORMATS)


# --- the printed log of P0 and P3 -------------------------------------------------------------------------------------


def printed(rows, before=lambda _i: "", garbage=False):
    lines = []
    for i, (a, w, m) in enumerate(zip(rows.acc / G, rows.gyr / DEG, rows.mag, strict=True)):
        triple = [",".join(f"{x:.4f}" for x in v) for v in (a, w, m)]
        lines.append(
            f"{before(i)}Accelerometer(xyz)={triple[0]}, Gyroscope(xyz)={triple[1]}, Magnetometer(xyz)={triple[2]}---"
        )
        if garbage and i % 97 == 5:
            lines.append("battery 3.71 V")
            lines.append("Accelerometer(xyz)=0.06")
    return "\r\n".join(lines) + "\r\n"


def test_printed_lines_are_read_at_a_hundred_a_second(tmp_path, rows):
    (tmp_path / "run.log").write_text(printed(rows, garbage=True))
    recording = import_folder(tmp_path)
    assert best(tmp_path / "run.log") == "printed"
    same_motion(recording.imu, rows)
    np.testing.assert_allclose(recording.imu.mag_s_ut, rows.mag, atol=1e-3)
    np.testing.assert_allclose(recording.imu.time_s, rows.time, atol=1e-9)
    assert {"rate_assumed", "lines_unreadable"} <= set(codes(recording))
    unreadable = next(f for f in recording.findings if f.code == "lines_unreadable")
    assert (unreadable.params["count"], unreadable.params["first_line"]) == (21, 8)


def test_the_line_in_the_papers_is_read_as_it_stands(tmp_path):
    line = (
        "Accelerometer(xyz)=0.0620,0.8824,0.5342, Gyroscope(xyz)=5.9206,-4.2116,2.3194, "
        "Magnetometer(xyz)=-149.3362,-101.5259,-94.9980---\n"
    )
    (tmp_path / "run.txt").write_text(line * 40)
    imu = import_folder(tmp_path).imu
    np.testing.assert_allclose(imu.acc_s_mps2[0], np.array([0.0620, 0.8824, 0.5342]) * G)
    np.testing.assert_allclose(imu.gyr_s_radps[0], np.radians([5.9206, -4.2116, 2.3194]))


def test_another_rate_can_be_told(tmp_path, rows):
    (tmp_path / "run.log").write_text(printed(rows))
    recording = import_folder(tmp_path, ImportOptions(sample_rate_hz=50.0))
    assert recording.imu.sample_rate_hz == pytest.approx(50.0)
    assert "rate_assumed" not in codes(recording)


@pytest.mark.parametrize(
    "before",
    [
        lambda i: (
            f"[23:59:{55 + i // 100 % 60:02d}.{i % 100 * 10:03d}] "
            if i < 500
            else f"[00:00:{(i - 500) // 100:02d}.{i % 100 * 10:03d}] "
        ),
        lambda i: f"{i * 10} ms: ",
        lambda i: f"{i / 100:.2f} ",
        lambda i: f"{12000000 + i * 10000}; ",
    ],
    ids=["clock over midnight", "ms", "s", "bare µs"],
)
def test_times_before_printed_lines_are_used(tmp_path, rows, before):
    (tmp_path / "run.log").write_text(printed(rows, before))
    recording = import_folder(tmp_path)
    np.testing.assert_allclose(np.diff(recording.imu.time_s), 0.01, atol=1e-6)
    assert len(recording.imu.time_s) == len(rows.time)
    assert "rate_assumed" not in codes(recording)


# --- xio --------------------------------------------------------------------------------------------------------------


def xio_inertial(rows):
    table = {"Timestamp (us)": np.round(rows.time * 1e6 + 19150794).astype(int)}
    table |= {f"Gyroscope {a} (deg/s)": rows.gyr[:, i] / DEG for i, a in enumerate("XYZ")}
    return table | {f"Accelerometer {a} (g)": rows.acc[:, i] / G for i, a in enumerate("XYZ")}


def test_an_x_imu3_folder_is_read_with_the_files_beside(tmp_path, rows, table):
    device = tmp_path / "x-IMU3 673B204B (UDP)"
    device.mkdir()
    table(device / "Inertial.csv", xio_inertial(rows))
    slow = rows.time[::5]
    stamps = {"Timestamp (us)": np.round(slow * 1e6 + 19150794).astype(int)}
    magnetometer = {f"Magnetometer {a} (a.u.)": rows.mag[::5, i] / 50 for i, a in enumerate("XYZ")}
    table(device / "Magnetometer.csv", stamps | magnetometer)
    table(device / "Quaternion.csv", stamps | {a: rows.quat[::5, i] for i, a in enumerate("WXYZ")})
    (device / "Command.json").write_text('{"ping": null}')
    recording = import_folder(tmp_path)
    assert best(device / "Inertial.csv") == "xio"
    same_motion(recording.imu, rows)
    assert recording.imu.time_s[0] == pytest.approx(19.150794)
    np.testing.assert_allclose(recording.imu.mag_s_ut[:-5], rows.mag[:-5], atol=3.0)
    np.testing.assert_allclose(np.abs(np.sum(recording.imu.quat_ws * rows.quat, axis=1))[:-5], 1.0, atol=1e-3)
    assert "mag_arbitrary" in codes(recording)
    assert {f.path.name for f in recording.files} == {"Inertial.csv", "Magnetometer.csv", "Quaternion.csv"}


def test_a_damaged_file_beside_costs_only_itself(tmp_path, rows, table):
    table(tmp_path / "Inertial.csv", xio_inertial(rows))
    (tmp_path / "Magnetometer.csv").write_text("")
    (tmp_path / "Quaternion.csv").write_text("Timestamp (us),W\n1,2\n")
    recording = import_folder(tmp_path)
    same_motion(recording.imu, rows)
    assert recording.imu.quat_ws is None


@pytest.mark.data
@pytest.mark.parametrize(("name", "count", "rate"), [("short_walk.csv", 16539, 398.4), ("long_walk.csv", 28132, 398.4)])
def test_gait_tracking_walks_are_read_and_their_double_rows_dropped(shared_data, name, count, rate):
    recording = import_folder(shared_data / "gait_tracking" / name)
    doubles = next(f for f in recording.findings if f.code == "duplicate_rows").params["count"]
    assert len(recording.imu.time_s) == count - doubles
    assert recording.imu.sample_rate_hz == pytest.approx(rate, abs=0.2)
    rest = np.linalg.norm(recording.imu.acc_s_mps2[:400], axis=1)
    assert np.median(rest) == pytest.approx(9.8, abs=0.2)
    assert best(shared_data / "gait_tracking" / name) == "xio"


@pytest.mark.data
def test_the_fusion_example_is_read_with_its_magnetometer(shared_data):
    imu = import_folder(shared_data / "fusion_example").imu
    assert len(imu.time_s) == 13514
    np.testing.assert_allclose(imu.mag_s_ut[0], [15.3017, 0.4328527, -41.06483])
    np.testing.assert_allclose(imu.gyr_s_radps[0], np.radians([0.01644619, -0.1517251, 0.1080897]))


# --- Xsens ------------------------------------------------------------------------------------------------------------

MT_MANAGER = """// General information:
//  MT Manager version: 2022.2.0
// Device information:
//  DeviceId: 00B4D6D1
//  Firmware Version: 4.6.0
// Device settings:
//  Filter Profile: human(46.1)
//  Update Rate: 100.0Hz
// Coordinate system: ENU
"""


def xsens_table(rows, fine, quaternions=True, gyr=1.0):
    table = {"PacketCounter": (np.arange(len(rows.time)) + 65000) % 65536, "SampleTimeFine": fine}
    table |= {f"Acc_{a}": rows.acc[:, i] for i, a in enumerate("XYZ")}
    table |= {f"FreeAcc_{a}": rows.acc[:, i] * 0 + 0.1 for i, a in enumerate("XYZ")}
    table |= {f"Gyr_{a}": rows.gyr[:, i] / gyr for i, a in enumerate("XYZ")}
    table |= {f"Mag_{a}": rows.mag[:, i] / 47 for i, a in enumerate("XYZ")}
    return table | ({f"Quat_q{i}": rows.quat[:, i] for i in range(4)} if quaternions else {})


def write_xsens(path, table, contents, preamble, separator="\t", tail=""):
    table(path, contents, separator)
    lines = path.read_text().splitlines()
    path.write_text(preamble + "\n".join(line + tail for line in lines) + "\n")


@pytest.mark.parametrize("quaternions", [True, False])
def test_mt_manager_without_times_is_read_by_counter_and_update_rate(tmp_path, rows, table, quaternions):
    empty = np.full(len(rows.time), "")
    write_xsens(tmp_path / "MT_00B4D6D1-000.txt", table, xsens_table(rows, empty, quaternions), MT_MANAGER)
    recording = import_folder(tmp_path)
    assert best(tmp_path / "MT_00B4D6D1-000.txt") == "xsens"
    same_motion(recording.imu, rows)
    np.testing.assert_allclose(recording.imu.time_s, rows.time, atol=1e-9)
    assert (recording.imu.quat_ws is not None) == quaternions
    if quaternions:
        np.testing.assert_allclose(recording.imu.quat_ws, rows.quat, atol=1e-5)


@pytest.mark.parametrize("first", [1000, 2**32 - 90_000])
def test_ticks_of_an_mti_are_tenths_of_milliseconds_and_wrap(tmp_path, rows, table, first):
    fine = (np.round(rows.time * 1e4).astype(np.int64) + first) % 2**32
    write_xsens(tmp_path / "mti.txt", table, xsens_table(rows, fine), "// Start Time: Unknown\n")
    imu = import_folder(tmp_path).imu
    np.testing.assert_allclose(imu.time_s - imu.time_s[0], rows.time, atol=1e-4)


def test_a_dot_export_with_sep_and_trailing_comma_is_in_microseconds_and_degrees(tmp_path, rows, table):
    fine = np.round(rows.time * 1e6).astype(np.int64) + 2268972329
    preamble = (
        "sep=,\nDeviceTag:,1\nFirmwareVersion:,3.0.0\nAppVersion:,2023.6.0\nSyncStatus:,Synced\nOutputRate:,100Hz\n"
        "FilterProfile:,General\nMeasurement Mode:,Custom Mode 4\nStartTime: ,2025-07-11_20:06:00_086 WEST\n"
        "© Movella Technologies B. V. 2005-2025\n\n"
    )
    write_xsens(tmp_path / "dot.csv", table, xsens_table(rows, fine, gyr=DEG), preamble, ",", ",")
    recording = import_folder(tmp_path)
    same_motion(recording.imu, rows)
    np.testing.assert_allclose(recording.imu.time_s - recording.imu.time_s[0], rows.time, atol=1e-5)
    assert not {"lines_unreadable", "gyr_unit_mended", "time_rescaled"} & set(codes(recording))


def test_an_export_without_the_gyroscope_says_which_column_is_missing(tmp_path, rows, table):
    contents = xsens_table(rows, np.full(len(rows.time), ""))
    write_xsens(tmp_path / "x.txt", table, {k: v for k, v in contents.items() if k != "Gyr_Z"}, MT_MANAGER)
    with pytest.raises(LeaklineError) as caught:
        import_folder(tmp_path / "x.txt")
    assert caught.value.code is ErrorCode.COLUMN_MISSING


# --- phones -----------------------------------------------------------------------------------------------------------


def phyphox(rows, table, folder, separator=",", comma=False):
    """The accelerometer runs at 80 Hz on times of its own."""
    acc_time = np.arange(0.003, rows.time[-1], 1 / 80)
    acc = np.column_stack([np.interp(acc_time, rows.time, c) for c in rows.acc.T])
    for name, time, values, unit in (
        ("Accelerometer", acc_time, acc, "m/s^2"),
        ("Gyroscope", rows.time, rows.gyr, "rad/s"),
        ("Magnetometer", rows.time, rows.mag, "µT"),
    ):
        columns = {'"Time (s)"': time} | {f'"{a} ({unit})"': values[:, i] for i, a in enumerate("XYZ")}
        table(folder / f"{name}.csv", columns, separator, "%.9E")
        if comma:
            text = (folder / f"{name}.csv").read_text()
            head, body = text.split("\n", 1)
            (folder / f"{name}.csv").write_text(head + "\n" + body.replace(".", ","))


@pytest.mark.parametrize(("separator", "comma"), [(",", False), (";", True), ("\t", False)])
def test_a_phyphox_folder_is_merged_onto_the_gyroscope(tmp_path, table, make, separator, comma):
    rows = make(noise=False)
    phyphox(rows, table, tmp_path, separator, comma)
    recording = import_folder(tmp_path)
    assert best(tmp_path / "Gyroscope.csv") == "phone"
    start = int(np.searchsorted(rows.time, 0.003))
    same_motion(recording.imu, rows, start, acc=0.02)
    np.testing.assert_allclose(recording.imu.time_s, rows.time[start : start + len(recording.imu.time_s)], atol=1e-6)
    merged = next(f for f in recording.findings if f.code == "streams_merged")
    assert merged.params["acc_hz"] == pytest.approx(80.0, rel=1e-3)
    assert "several_imu_logs" not in codes(recording)


def test_a_gap_of_the_accelerometer_is_masked_not_bridged(tmp_path, table, make):
    rows = make(noise=False)
    phyphox(rows, table, tmp_path)
    lines = (tmp_path / "Accelerometer.csv").read_text().splitlines()
    (tmp_path / "Accelerometer.csv").write_text("\n".join(lines[:400] + lines[640:]) + "\n")  # 3 s
    recording = import_folder(tmp_path)
    hole = next(s for s in recording.not_assessed if s.reason == "imu_unreadable")
    assert hole.end_s - hole.start_s == pytest.approx(3.0, abs=0.05)
    inside = (recording.imu.time_s > hole.start_s + 0.02) & (recording.imu.time_s < hole.end_s - 0.02)
    assert not recording.imu.valid[inside].any()
    assert np.isfinite(recording.imu.acc_s_mps2).all()


def test_a_phyphox_file_with_both_sensors_is_read(tmp_path, rows, table):
    columns = {'"Time (s)"': rows.time}
    columns |= {f'"Acceleration {a} (m/s^2)"': rows.acc[:, i] for i, a in enumerate("xyz")}
    columns |= {'"Absolute acceleration (m/s^2)"': np.linalg.norm(rows.acc, axis=1)}
    columns |= {f'"Gyroscope {a} (rad/s)"': rows.gyr[:, i] for i, a in enumerate("xyz")}
    table(tmp_path / "Raw Data.csv", columns)
    assert best(tmp_path / "Raw Data.csv") == "phone"
    same_motion(import_folder(tmp_path).imu, rows)


def sensor_logger(rows, table, folder, files):
    stamps = {"time": np.round(rows.time * 1e9).astype(np.int64) + 1767620467350470700, "seconds_elapsed": rows.time}
    for name, values in files.items():
        table(folder / f"{name}.csv", stamps | {a: values[:, "xyz".index(a)] for a in "zyx"})


def test_sensor_logger_with_total_acceleration_is_read_by_names_not_places(tmp_path, rows, table):
    linear = rows.acc - rows.acc.mean(axis=0)
    files = {"TotalAcceleration": rows.acc, "Accelerometer": linear, "Gyroscope": rows.gyr, "Magnetometer": rows.mag}
    sensor_logger(rows, table, tmp_path, files)
    recording = import_folder(tmp_path)
    same_motion(recording.imu, rows)
    np.testing.assert_allclose(recording.imu.time_s, rows.time, atol=1e-6)
    assert "acc_without_gravity" not in codes(recording)


def test_sensor_logger_s_gravity_is_added_again(tmp_path, rows, table):
    gravity = rows.acc * 0.7
    sensor_logger(
        rows, table, tmp_path, {"Accelerometer": rows.acc - gravity, "Gravity": gravity, "Gyroscope": rows.gyr}
    )
    recording = import_folder(tmp_path)
    same_motion(recording.imu, rows)
    assert "gravity_added" in codes(recording)


def test_a_phone_without_gravity_is_warned_of(tmp_path, rows, table):
    still = np.random.default_rng(0).normal(0, 0.1, rows.acc.shape)
    sensor_logger(rows, table, tmp_path, {"Accelerometer": still, "Gyroscope": rows.gyr})
    assert "acc_without_gravity" in codes(import_folder(tmp_path))
