"""Which part of the window hears of which other: the signals among the controls, in one place."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.main_window import MainWindow


def connect(window: "MainWindow") -> None:
    """Connect the window's parts with each other; what they ask of the window itself, it connects itself."""
    files, start, recording, tell = window.files, window.start_page, window.recording, window.notices.tell
    recording.told.connect(tell)
    recording.page_asked.connect(window.show_page)
    recording.process_asked.connect(files.open_path)
    recording.recorded.connect(window.work.start.refresh)
    recording.close_asked.connect(window.close)
    start.record_asked.connect(recording.show)
    start.open_asked.connect(files.ask_open)
    start.demo_asked.connect(files.open_demo)
    start.correlator_asked.connect(window.correlator.show)
    start.settings_asked.connect(window.work.settings.show)
    start.manual_asked.connect(window.help.show_guide)
    start.tour_asked.connect(window.work.tour.show)
    start.recent_chosen.connect(lambda text: files.open_path(Path(text)))
    files.page_asked.connect(window.show_page)
    files.told.connect(tell)
    files.sound_met.connect(window.first_sound.look_at)
    for told in (window.report.told, window.spectrum.told, window.correlator.told, window.work.told):
        told.connect(tell)
    window.correlator.page_asked.connect(window.show_page)
    for failed in (window.spectrum.failed, window.path.failed, window.player.failed):
        failed.connect(window.notices.tell_error)
    page = window.review_page
    page.spectrogram.read_failed.connect(window.notices.tell_error)
    page.band_changed.connect(files.change_band)
    window.bands.band_taken.connect(files.change_band)
    files.band_settled.connect(page.spectrogram.set_band)
