"""The spectrum tool from a selection to its words and files, on a recording whose difference is known."""

import csv
from types import SimpleNamespace

import numpy as np
import pytest
import soundfile
from PySide6.QtCore import QObject, Signal
from scipy import signal

from app.spectrum_control import SpectrumControl
from processing.sound.source import open_audio
from processing.survey import ClockMap
from widgets.sound_selection import SoundSelection
from widgets.spectrogram_view import SpectrogramView
from widgets.spectrum_panel import SpectrumPanel
from widgets.time_cursor import TimeCursor

RATE = 8000


class Session(QObject):
    results_changed, opened = Signal(), Signal()

    def __init__(self, results):
        super().__init__()
        self.results, self.cursor, self.folder = results, TimeCursor(), None


@pytest.fixture
def bench(qtbot, tmp_path):
    """30 s: noise, with 9 dB more from 1 to 2 kHz and a motor of 50 Hz between 10 and 20 s; sound starts at 5 s."""
    rng = np.random.default_rng(4)
    noise = rng.normal(0.0, 0.02, 30 * RATE)
    band = signal.sosfilt(
        signal.butter(6, [1000, 2000], "bandpass", fs=RATE, output="sos"), rng.normal(0, 0.02, 10 * RATE)
    )
    time_s = np.arange(10 * RATE) / RATE
    motor = sum(0.004 * np.sin(2 * np.pi * 50.0 * k * time_s) for k in range(1, 9))
    noise[10 * RATE : 20 * RATE] += np.sqrt(10**0.9 - 1) * band + motor
    soundfile.write(tmp_path / "sound.wav", noise.astype(np.float32), RATE, subtype="FLOAT")
    audio = open_audio([tmp_path / "sound.wav"])[0]
    results = SimpleNamespace(recording=SimpleNamespace(audio=audio), clock=ClockMap(start_s=5.0))
    session = Session(results)
    session.cursor.set_extent(5.0, 35.0)
    spectrogram, panel = SpectrogramView(session.cursor), SpectrumPanel()
    qtbot.addWidget(spectrogram)
    qtbot.addWidget(panel)
    control = SpectrumControl(session, spectrogram, panel, "en")
    yield session, spectrogram, panel, control
    control.forget()
    spectrogram.set_source(None)


def words(panel):
    return panel._words.text()


def test_a_selection_against_what_lies_around_it_names_the_band_and_the_motor(bench, qtbot, tmp_path):
    _, spectrogram, panel, control = bench
    spectrogram.select(SoundSelection(16.0, 24.0, 1000.0, 2000.0))
    control.use_a()
    qtbot.waitUntil(lambda: len(panel.view.curves) == 2, timeout=10_000)
    assert "stands out in" in words(panel)
    assert "multiples of 50.0" in words(panel)
    comparison = control._found.comparison
    inner = [b.difference_db for b in comparison.bands if b.low_hz > 1050.0 and b.high_hz < 1900.0]
    assert inner
    # around it lie 1 s on either side with the leak and 7 s without: (2·7.94 + 14)/16 in power
    assert np.mean(inner) > 4.0

    control.export(tmp_path / "spectrum.csv")
    rows = list(csv.reader((tmp_path / "spectrum.csv").read_text(encoding="utf-8").splitlines()))
    assert ["a_frequency_hz", "a_dbfs_per_hz", "a_low95", "a_high95"] in rows
    assert any(row[0] == "band_low_hz" for row in rows)
    control.export(tmp_path / "spectrum.png")
    assert (tmp_path / "spectrum.png").stat().st_size > 1000


def test_two_selections_are_compared_in_survey_time_not_in_the_recorders(bench, qtbot):
    _, spectrogram, panel, control = bench
    spectrogram.select(SoundSelection(16.0, 24.0, 1000.0, 2000.0))
    control.use("a")
    spectrogram.select(SoundSelection(26.0, 34.0, 1000.0, 2000.0))
    control.use("b")
    qtbot.waitUntil(lambda: len(panel.view.curves) == 2, timeout=10_000)
    inner = next(b for b in control._found.comparison.bands if b.low_hz < 1400.0 < b.high_hz)
    assert inner.difference_db == pytest.approx(9.0, abs=0.7)
    panel._difference.setChecked(True)
    qtbot.waitUntil(lambda: len(panel.view.curves) == 1, timeout=10_000)


def test_another_run_takes_everything_away(bench, qtbot):
    session, spectrogram, panel, control = bench
    spectrogram.select(SoundSelection(16.0, 24.0, 1000.0, 2000.0))
    control.use("a")
    qtbot.waitUntil(lambda: len(panel.view.curves) == 1, timeout=10_000)
    session.results_changed.emit()
    assert panel.view.curves == ()
    assert words(panel) == ""


def test_a_selection_without_sound_is_told_in_a_sentence(bench, qtbot):
    _, spectrogram, panel, control = bench
    spectrogram.select(SoundSelection(5.0, 5.001, 1000.0, 2000.0))
    control.use("a")
    qtbot.waitUntil(lambda: "samples" in words(panel), timeout=10_000)
