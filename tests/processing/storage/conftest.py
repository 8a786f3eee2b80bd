"""A small device folder and the survey folder made from it."""

import pytest

from processing.storage.folder import SurveyFolder
from processing.survey import (
    Candidate,
    LeakClass,
    PipeInfo,
    Route,
    Run,
    Survey,
    SurveyInfo,
    TiePoint,
)


@pytest.fixture(scope="session")
def candidate():
    """Return a function that makes a candidate; the ball rolls at 1 m/s, unless told otherwise."""

    def make(time_s, chainage_m=None, half_m=1.0, **more):
        chainage_m = time_s if chainage_m is None else chainage_m
        facts = {
            "id": 0,
            "time_s": float(time_s),
            "chainage_m": float(chainage_m),
            "chainage_low95_m": chainage_m - half_m,
            "chainage_high95_m": chainage_m + half_m,
            "position_w_m": (float(chainage_m), 0.0, -1.0),
            "score": 0.5,
            "level_db": 6.0,
            "leak_class": LeakClass.LEAK,
            "band_hz": (800.0, 1600.0),
            "width_m": 2.0,
            "evidence": {"peak_db": 7.5},
        }
        return Candidate(**(facts | more))

    return make


@pytest.fixture
def survey():
    return Survey(
        info=SurveyInfo("İstasyon Caddesi", "Ayşe Ğül", "2026-05-04", "Şişli Su"),
        pipe=PipeInfo("ductile iron", 0.3, 1204.0),
        tie_points=(TiePoint("çıkış", 2411.5, chainage_m=1204.0), TiePoint("vana", 20.0, east_m=1.0, north_m=2.0)),
        route=Route(((0.0, 0.0, 0.0), (120.0, 4.0, -0.5)), "EPSG:5254"),
    )


@pytest.fixture
def device(tmp_path):
    """What came off the ball."""
    folder = tmp_path / "Aygıt klasörü"
    folder.mkdir()
    (folder / "imu.csv").write_bytes(b"time_s,acc_x_mps2\n0,9.81\n")
    (folder / "audio.wav").write_bytes(bytes(range(256)) * 40)
    return folder


@pytest.fixture
def folder(tmp_path, device, survey):
    with SurveyFolder.create(tmp_path / "Ölçümler", survey, sorted(device.iterdir()), operator="Ayşe") as opened:
        yield opened


@pytest.fixture
def stored(folder, candidate):
    """A stored run of four candidates 100 m apart."""
    return folder.review.add_run(Run(0, "", "hash-1"), [candidate(100 * i) for i in range(1, 5)])
