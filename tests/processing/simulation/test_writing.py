"""What is written is what was simulated: log, sound, paperwork and truth; faults where they were asked for."""

import json
from dataclasses import replace

import numpy as np
import pytest
import soundfile as sf

from processing.errors import ErrorCode, LeaklineError
from processing.importing.survey_toml import read_survey_toml
from processing.simulation.run import simulate
from processing.simulation.scenario import (
    Clock,
    Drive,
    Faults,
    Gap,
    Imu,
    Local,
    Magnetics,
    Marker,
    Paperwork,
    PipeRoute,
    Scenario,
    Sound,
)
from processing.simulation.sound import sound_blocks
from processing.simulation.writing import write_run
from processing.survey import LeakClass

SHORT = Scenario(
    "short",
    route=PipeRoute(((0.0, 0, 0), (6.0, 0, 0), (6.0, 5.0, 0.1))),
    drive=Drive(0.7, rest_start_s=6.0, rest_end_s=4.0, ramp_s=1.0),
    imu=Imu(rate_hz=100.0, device_quaternion=True, magnetics=Magnetics(enabled=True)),
    sound=Sound(rate_hz=8000, file="audio.wav", local=(Local(LeakClass.LEAK, 4.0),)),
    clock=Clock(0.8, 25.0, told=True),
    markers=(Marker("half way", 5.0, 0.3), Marker("end", by="both", sigma_m=0.3)),
    paperwork=Paperwork(title="Kısa ölçüm (simulated)", latitude=40.9, longitude=29.1, tell_route=True),
)


def table(path):
    header = path.read_text().splitlines()[0].split(",")
    return header, np.genfromtxt(path, delimiter=",", skip_header=1)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "made"
    run = simulate(SHORT, 11)
    write_run(run, folder)
    return run, folder


def test_the_log_holds_the_samples_to_its_printed_digits(written):
    run, folder = written
    header, rows = table(folder / "imu.csv")
    imu = run.imu
    expected = [
        imu.time_s,
        imu.acc_s_mps2,
        imu.gyr_s_radps,
        imu.mag_s_ut,
        imu.quat_ws,
        imu.pressure_kpa,
        imu.temperature_c,
    ]
    assert header[:4] == ["time_s", "acc_x_mps2", "acc_y_mps2", "acc_z_mps2"]
    assert header[-2:] == ["pressure_kPa", "temperature_C"]
    np.testing.assert_allclose(rows, np.column_stack(expected), atol=5.1e-3)
    np.testing.assert_allclose(rows[:, :7], np.column_stack(expected[:3]), atol=5.1e-5)


def test_the_sound_file_holds_the_blocks_in_sixteen_bits(written):
    run, folder = written
    read, rate = sf.read(folder / "audio.wav", dtype="float64")
    assert rate == 8000
    np.testing.assert_allclose(read, np.concatenate(list(sound_blocks(run.sound))), atol=2.0 / 32768)


def test_the_paperwork_reads_back_and_says_that_it_is_simulated(written):
    run, folder = written
    survey = read_survey_toml(folder / "survey.toml")
    assert survey == run.survey
    assert survey.info.simulated
    assert survey.audio.drift_ppm == 25.0


def test_the_truth_beside_it_places_the_leak(written):
    _, folder = written
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    leak = truth["places"][0]
    assert (leak["kind"], leak["chainage_m"]) == ("leak", 4.0)
    header, track = table(folder / "truth_track.csv")
    at = [
        np.interp(leak["time_s"], track[:, 0], track[:, header.index(n)]) for n in ("chainage_m", "east_m", "north_m")
    ]
    np.testing.assert_allclose(at, [4.0, *leak["position_w_m"][:2]], atol=0.01)
    assert truth["clock"] == {"start_s": 0.8, "drift_ppm": 25.0}
    assert truth["simulated"] is True


def test_the_same_seed_writes_the_same_bytes_and_another_seed_does_not(written, tmp_path):
    _, folder = written
    names = ["imu.csv", "audio.wav", "survey.toml", "truth.json", "truth_track.csv"]
    write_run(simulate(SHORT, 11), tmp_path / "again")
    write_run(simulate(SHORT, 12), tmp_path / "other")
    for name in names:
        assert (tmp_path / "again" / name).read_bytes() == (folder / name).read_bytes(), name
        assert (tmp_path / "other" / name).read_bytes() != (folder / name).read_bytes(), name


def test_tie_points_err_as_they_confess():
    errors = []
    for seed in range(60):
        run = simulate(replace(SHORT, sound=replace(SHORT.sound, enabled=False), imu=Imu.perfect(20.0)), seed)
        half, end = run.survey.tie_points
        errors += [half.chainage_m - 5.0, end.chainage_m - run.route.length_m]
        assert half.time_s == pytest.approx(np.interp(5.0, run.motion.chainage_m, run.motion.time_s), abs=0.06)
        assert half.east_m is None
        assert end.north_m is not None
    assert np.std(errors) == pytest.approx(0.3, rel=0.25)


def test_faults_appear_in_the_log_and_only_there(tmp_path):
    faults = Faults(gaps=(Gap(7.0, 8.5),), nan_rows=5, duplicate_rows=4, swapped_rows=3)
    run = simulate(replace(SHORT, faults=faults, sound=replace(SHORT.sound, enabled=False)), 11)
    write_run(run, tmp_path)
    _, rows = table(tmp_path / "imu.csv")
    t = rows[:, 0]
    assert np.sum(np.isnan(rows[:, 1])) in (5, 6)  # a broken row may be one of those written twice
    assert np.diff(np.sort(t)).max() == pytest.approx(1.5, abs=0.03)
    assert len(t) - len(np.unique(t)) == 4
    assert 1 <= np.sum(np.diff(t) < 0) <= 3
    assert np.all(np.isfinite(run.imu.acc_s_mps2))


def test_a_folder_that_cannot_be_made_is_an_error_the_user_can_mend(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(LeaklineError) as caught:
        write_run(simulate(SHORT, 1), tmp_path / "file" / "inside")
    assert caught.value.code is ErrorCode.CANNOT_WRITE
