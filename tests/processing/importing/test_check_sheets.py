"""The sheets of checks are found in the journal beside the recording, whatever else stands there."""

from bench_ball import Bench

from processing.importing.check_sheets import check_sheets
from processing.importing.folder import import_folder
from processing.importing.options import ImportOptions
from processing.live.check_sheet import CheckItem, CheckSheet, Light
from processing.pipeline import read_recording
from processing.settings import ImportSettings
from processing.storage.cache import Cache
from processing.storage.journal import JOURNAL_NAME, JournalEvent, journal_line, line_bytes

SHEET = CheckSheet("launch", "2026-05-04T09:00:00+00:00", (CheckItem("field", Light.OPEN, "field_none", {}),))
END = CheckSheet("end", "2026-05-04T10:00:00+00:00", (CheckItem("knocks", Light.RED, "knocks_few", {"both": 1.0}),))


def write_log(folder):
    ball = Bench()
    header = "time_s,acc_x_mps2,acc_y_mps2,acc_z_mps2,gyr_x_radps,gyr_y_radps,gyr_z_radps\n"
    rows = zip(ball.imu_s, ball.acc, ball.gyr, strict=True)
    lines = (f"{time:.4f}," + ",".join(f"{value:.5f}" for value in (*acc, *gyr)) for time, acc, gyr in rows)
    (folder / "imu.csv").write_text(header + "\n".join(lines) + "\n", encoding="utf-8")


def write_journal(folder):
    with (folder / JOURNAL_NAME).open("wb") as file:
        for event, values in (
            (JournalEvent.STARTED, {}),
            (JournalEvent.CHECK, SHEET.to_json()),
            (JournalEvent.CHECK, {"items": "nonsense"}),
            (JournalEvent.CHECK, END.to_json()),
        ):
            file.write(line_bytes(journal_line(event, values)))
        file.write(b'{"event": "check", "utc"')


def test_the_sheets_come_with_the_recording_and_from_the_cache_too(tmp_path):
    folder = tmp_path / "device"
    folder.mkdir()
    write_log(folder)
    assert import_folder(folder).sheets == ()
    write_journal(folder)
    assert import_folder(folder).sheets == (SHEET, END)
    cache = Cache(tmp_path / "cache")
    for _ in range(2):
        assert read_recording(folder, ImportOptions(), ImportSettings(), cache).sheets == (SHEET, END)


def test_no_journal_or_a_broken_one_has_no_sheets(tmp_path):
    assert check_sheets(tmp_path) == ()
    (tmp_path / JOURNAL_NAME).write_bytes(b"\xff\x00" * 500)
    assert check_sheets(tmp_path) == ()
