"""The correlator's page: two recordings in, a place out; bands, peaks, taps, listening and files by hand."""

import json

import numpy as np
import pytest
from answering import CountingSink
from correlator_runs import source_of
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QFileDialog, QStackedWidget, QWidget

from app.correlator_control import CorrelatorControl
from app.correlator_entry import CorrelatorEntry
from app.correlator_listening import Ears, PairReader
from app.correlator_page import CorrelatorPage
from app.devices.audio_output import SoundUnavailableError
from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.correlation.pipe import Pipe, PipeSection
from processing.correlation.recordings import Pair, Sync, SyncKind
from processing.correlation.simulation import SimulatedPair, simulate, write_wave
from processing.correlation.weighting import Weighting
from widgets.plot_theme import DARK, LIGHT, SUN

RATE = 2000
LEAK_M, DRAW_OFF_M = 37.4, 80.0
PVC = Pipe((PipeSection(100.0, "pvc", 0.16, speed_mps=400.0, speed_sigma_mps=2.0),))


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """Two recordings of a leak at 37.4 m and a quieter draw-off at 80 m, as files."""
    folder = tmp_path_factory.mktemp("pair")
    what = SimulatedPair(
        leak_m=LEAK_M, snr_db=0.0, other_m=DRAW_OFF_M, other_db=-1.0, other_share=0.4, duration_s=24.0,
        rate_hz=RATE, noise_top_hz=900.0, loss=0.01,
    )  # fmt: skip
    sounds = simulate(what)
    for name, sound in zip(("hydrant.wav", "valve.wav"), sounds, strict=True):
        write_wave(folder / name, sound, RATE)
    write_wave(folder / "both.wav", np.column_stack(sounds), RATE)
    write_wave(folder / "silent.wav", 0.0 * sounds[0], RATE)
    return folder


class Bench:
    """The page with everything behind it, and what it told."""

    def __init__(self, qtbot, folder, language="en"):
        self.qtbot = qtbot
        self.window = QWidget()
        self.jobs = Jobs(self.window)
        self.preferences = PreferencesStore(folder / "preferences.json")
        self.page = CorrelatorPage(LIGHT, language)
        self.page.resize(1250, 700)
        self.sinks = []
        self.control = CorrelatorControl(self.jobs, self.preferences, self.page, language, self.window, self.make_sink)
        self.page.pipe.set_pipe(PVC)
        self.told = []
        self.control.told.connect(self.told.append)
        qtbot.addWidget(self.window)
        qtbot.addWidget(self.page)
        self.page.show()

    def make_sink(self, rate_hz, channels):
        sink = CountingSink()
        sink.made_for = (rate_hz, channels)
        self.sinks.append(sink)
        return sink

    def wait(self):
        self.qtbot.waitUntil(lambda: not self.control.busy and not self.jobs.running, timeout=30_000)
        return self.control.result

    def load(self, *paths):
        self.control.files.take("a", list(paths))
        return self.wait()

    @property
    def words(self):
        return f"{self.page.place.text()}\n{self.page.notes.text()}"


@pytest.fixture
def bench(qtbot, tmp_path):
    made = Bench(qtbot, tmp_path)
    yield made
    made.control.stop()
    made.jobs.stop_all()


@pytest.fixture
def loaded(bench, recordings):
    assert bench.load(recordings / "hydrant.wav", recordings / "valve.wav") is not None
    return bench


def drop(widget, *paths):
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    event = QDropEvent(
        QPointF(5, 5), Qt.DropAction.CopyAction, mime, Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier
    )
    widget.dropEvent(event)


def test_two_recordings_give_the_place_in_words_and_in_the_pictures(loaded):
    position = loaded.control.result.position
    assert position.from_a_m == pytest.approx(LEAK_M, abs=0.3)
    assert f"Leak {position.from_a_m:.2f} m from A" in loaded.words
    assert "95 % interval" in loaded.words
    plot = loaded.page.correlation
    peak = plot.pixel_of_peak(plot.shown.chosen)
    assert plot.x_value(peak.x()) == pytest.approx(LEAK_M, abs=0.5)
    assert plot.plot_rect().contains(peak)
    for theme in (DARK, SUN, LIGHT):
        loaded.page.apply_theme(theme)
        assert not loaded.page.grab().isNull()


def test_taking_the_leaks_peak_out_shows_the_draw_off_and_putting_it_back_the_leak(loaded):
    loaded.page.peak_name.setText("draw-off")
    loaded.qtbot.mouseClick(loaded.page.suppress, Qt.MouseButton.LeftButton)
    result = loaded.wait()
    assert result.position.from_a_m == pytest.approx(DRAW_OFF_M, abs=1.0)
    assert "draw-off does not" in loaded.words
    assert [gone.name for gone in loaded.page.correlation.shown.suppressed] == ["draw-off"]
    assert loaded.page.peak_name.text() == ""
    loaded.page.grab()
    loaded.qtbot.mouseClick(loaded.page.restore, Qt.MouseButton.LeftButton)
    assert loaded.wait().position.from_a_m == pytest.approx(LEAK_M, abs=0.3)
    assert not loaded.page.restore.isEnabled()


def test_a_click_on_another_peak_or_an_arrow_chooses_it(loaded):
    plot = loaded.page.correlation
    other = min(plot.shown.peaks, key=lambda peak: abs(peak.delay_s + 0.15))
    loaded.qtbot.mouseClick(plot, Qt.MouseButton.LeftButton, pos=plot.pixel_of_peak(other).toPoint())
    assert loaded.wait().position.from_a_m == pytest.approx(DRAW_OFF_M, abs=1.0)
    for _ in range(6):  # past peaks that chance made, which give no place
        loaded.qtbot.keyClick(plot, Qt.Key.Key_Left)
        position = loaded.wait().position
        if position is not None and abs(position.from_a_m - LEAK_M) < 0.5:
            break
    assert loaded.control.result.position.from_a_m == pytest.approx(LEAK_M, abs=0.5)


def test_the_band_follows_hand_key_and_field_and_auto_finds_it_again(loaded):
    plot = loaded.page.coherence
    found = loaded.control.result.band
    start = QPoint(round(plot.x_pixel(plot.band.high_hz)), round(plot.plot_rect().center().y()))
    end = QPoint(round(plot.x_pixel(70.0)), start.y())
    loaded.qtbot.mousePress(plot, Qt.MouseButton.LeftButton, pos=start)
    for part in (0.5, 0.9, 1.0):
        loaded.qtbot.mouseMove(plot, start + (end - start) * part)
    loaded.qtbot.mouseRelease(plot, Qt.MouseButton.LeftButton, pos=end)
    assert loaded.wait().band.high_hz == pytest.approx(70.0, rel=0.05)
    loaded.qtbot.keyClick(plot, Qt.Key.Key_Up)
    assert loaded.wait().band.high_hz > 71.0
    loaded.page.band_low.setText("33")
    loaded.page.band_low.editingFinished.emit()
    assert loaded.wait().band.low_hz == pytest.approx(33.0)
    loaded.qtbot.mouseClick(loaded.page.auto_band, Qt.MouseButton.LeftButton)
    assert loaded.wait().band == found


def test_weighting_and_checks_reach_the_result(loaded):
    weighting = loaded.page.weighting
    weighting.setCurrentIndex(weighting.findData(Weighting.PHAT.value))
    weighting.activated.emit(weighting.currentIndex())
    loaded.page.hum.setChecked(False)
    loaded.page.bend.setChecked(False)
    loaded.page.resonances.setChecked(True)
    result = loaded.wait()
    session = loaded.control.session()
    assert session.choice.weighting is Weighting.PHAT
    assert session.choice.dispersion.sigma == 0.0
    assert session.choice.divide_resonances
    assert result.band.without_hum is False


def test_another_speed_moves_the_leak_without_reading_again(loaded):
    delay_s = loaded.control.result.delay_s
    row = loaded.page.pipe.rows[0]
    row.speed.setText("360")
    row.speed.editingFinished.emit()
    result = loaded.wait()
    assert result.position.from_a_m == pytest.approx((100.0 - 360.0 * result.delay_s) / 2.0)
    assert result.delay_s == pytest.approx(delay_s, abs=2e-3)


def test_sections_are_added_and_removed_and_must_add_up(loaded):
    table = loaded.page.pipe
    loaded.qtbot.mouseClick(table._add, Qt.MouseButton.LeftButton)
    assert "Section 2 cannot be 0.00 m long" in loaded.words
    second = table.rows[1]
    second.length.setText("50")
    second.length.editingFinished.emit()
    table.rows[0].length.setText("50,0")
    table.rows[0].length.editingFinished.emit()
    second.speed.setText("400")
    second.speed.editingFinished.emit()
    assert loaded.wait().position.from_a_m == pytest.approx(LEAK_M, abs=0.5)
    table.distance.setText("112")
    table.distance.editingFinished.emit()
    assert "add up to 100.00 m" in loaded.words
    assert loaded.control.result is None
    assert not loaded.page.export.isEnabled()
    table.distance.setText("")
    table.distance.editingFinished.emit()
    loaded.qtbot.mouseClick(table._remove, Qt.MouseButton.LeftButton)
    assert len(table.rows) == 1


def test_an_empty_speed_says_what_follows_from_material_and_size(bench):
    row = bench.page.pipe.rows[0]
    row.set_section(PipeSection(10.0, "ductile_iron", 0.15, 0.006))
    assert row.speed.placeholderText() == "1292"


def test_a_recording_of_two_channels_is_both_sensors_and_channels_can_be_exchanged(bench, recordings):
    result = bench.load(recordings / "both.wav")
    assert result.position.from_a_m == pytest.approx(LEAK_M, abs=0.3)
    assert bench.page.box_b.channel.currentIndex() == 1
    bench.qtbot.mouseClick(bench.page.swap, Qt.MouseButton.LeftButton)
    assert bench.wait().position.from_a_m == pytest.approx(100.0 - LEAK_M, abs=0.3)
    bench.control.files.choose_channel("a", 0)
    assert "delay is 0" in (bench.wait() and bench.words)


def test_recordings_may_be_dropped_on_a_sensor_or_anywhere(bench, recordings):
    drop(bench.page.box_b, recordings / "valve.wav")
    assert bench.wait() is None
    drop(bench.page, recordings / "hydrant.wav")
    bench.wait()
    assert bench.control.files.recording("a").paths[0].name == "hydrant.wav"
    assert bench.control.result.position.from_a_m == pytest.approx(LEAK_M, abs=0.3)


def test_silence_noise_and_no_sound_at_all_are_told_in_a_sentence(bench, recordings, tmp_path):
    bench.load(recordings / "hydrant.wav", recordings / "silent.wav")
    assert "every sample is the same" in bench.words
    bench.control.files.take("b", [tmp_path / "gone.wav"])
    assert "gone.wav" in bench.words
    (tmp_path / "text.wav").write_text("hello")
    bench.control.files.take("b", [tmp_path / "text.wav"])
    bench.wait()
    assert "text.wav" in bench.words
    assert not bench.page.suppress.isEnabled()


def test_unknown_clocks_give_a_delay_but_no_place(loaded):
    loaded.page.clock.set_sync(Sync(SyncKind.UNKNOWN))
    loaded.page.clock.changed.emit()
    result = loaded.wait()
    assert result.position is None
    assert "No place" in loaded.words
    assert "It is not known whether the recordings began together" in loaded.words
    assert loaded.page.listen_a.isEnabled()


def test_the_stretch_is_the_part_that_is_read(loaded):
    loaded.page.stretch.set_stretch(4.0, 14.0)
    loaded.page.stretch.changed.emit()
    assert loaded.wait().spectra.used_s == pytest.approx(10.0, abs=1.2)


def test_taps_beyond_both_ends_measure_speed_and_clock(bench, tmp_path):
    """Taps beyond A and then beyond B, in recordings of which B began half a second late."""
    rng = np.random.default_rng(2)
    travel = round(RATE * 100.0 / 380.0)
    sounds = []
    for nearer in (True, False):
        tap = rng.standard_normal(20 * RATE)
        early, late = tap, np.roll(tap, travel)
        sounds.append((early, late) if nearer else (late, early))
    a = np.concatenate([sounds[0][0], sounds[1][0]])
    b = np.concatenate([sounds[0][1], sounds[1][1]])[round(0.5 * RATE) :]
    for name, sound in (("a.wav", a), ("b.wav", b)):
        write_wave(tmp_path / name, 0.1 * sound, RATE)
    bench.page.clock.set_sync(Sync(SyncKind.TYPED, 0.497, 0.01))
    bench.page.stretch.set_stretch(1.0, 18.0)
    bench.load(tmp_path / "a.wav", tmp_path / "b.wav")
    bench.control.measuring.measure_speed("a")
    bench.wait()
    bench.page.stretch.set_stretch(21.0, 38.0)
    bench.page.stretch.changed.emit()
    bench.wait()
    bench.control.measuring.measure_speed("b")
    bench.wait()
    assert bench.page.pipe.rows[0].speed.value == pytest.approx(380.0, abs=0.6)
    sync = bench.page.clock.sync()
    assert sync.kind is SyncKind.TAPS
    assert sync.offset_s == pytest.approx(0.5, abs=2e-4)


def test_knocks_before_and_after_tell_offset_and_drift(bench, tmp_path):
    """B began 1.5 s late and runs 200 ppm fast."""
    rng = np.random.default_rng(6)
    times = (2.0, 2.7, 4.4, 5.1, 7.3, 61.0, 62.3, 62.9, 64.8, 66.0)
    sounds = []
    for start, fast in ((0.0, 0.0), (1.5, 200e-6)):
        moments = start + np.arange(70 * RATE) / RATE / (1.0 + fast)
        sound = 0.002 * rng.standard_normal(len(moments))
        for at in times:
            after = np.clip(moments - at, 0.0, None)
            sound += np.where(moments >= at, 0.4 * np.exp(-150.0 * after) * np.sin(2 * np.pi * 500.0 * after), 0.0)
        sounds.append(sound)
    for name, sound in zip(("a.wav", "b.wav"), sounds, strict=True):
        write_wave(tmp_path / name, sound, RATE)
    bench.load(tmp_path / "a.wav", tmp_path / "b.wav")
    for first, last in ((1.0, 9.0), (60.0, 68.0)):
        bench.page.stretch.set_stretch(first, last)
        bench.control.measuring.find_event()
        bench.wait()
    sync = bench.page.clock.sync()
    assert sync.kind is SyncKind.EVENT
    assert sync.offset_s == pytest.approx(1.5, abs=1e-3)
    assert sync.drift_ppm == pytest.approx(200.0, abs=15.0)


# --- listening ---


def test_both_sensors_are_heard_left_and_right_until_they_are_stopped(loaded):
    loaded.qtbot.mouseClick(loaded.page.listen_both, Qt.MouseButton.LeftButton)
    (sink,) = loaded.sinks
    assert sink.made_for == (RATE, 2)
    loaded.qtbot.waitUntil(lambda: sink.frames > 0)
    assert loaded.page.listen_both.isChecked()
    loaded.qtbot.mouseClick(loaded.page.listen_a, Qt.MouseButton.LeftButton)
    assert sink.closed
    assert loaded.control.listening.ears is Ears.A
    assert loaded.sinks[1].made_for == (RATE, 1)
    loaded.control.leave()
    assert not loaded.control.listening.playing
    assert not loaded.page.listen_a.isChecked()


def test_without_a_sound_card_nothing_breaks(loaded):
    def refuse(_rate, _channels):
        raise SoundUnavailableError("no card")

    loaded.control.listening._make_sink = refuse
    loaded.qtbot.mouseClick(loaded.page.listen_b, Qt.MouseButton.LeftButton)
    assert loaded.told == ["Nothing can be played: no card"]
    assert not loaded.page.listen_b.isChecked()


def test_what_is_heard_is_the_band_with_b_moved_by_its_offset(tmp_path):
    time_s = np.arange(8 * RATE) / RATE
    low, high = np.sin(2 * np.pi * 40 * time_s), np.sin(2 * np.pi * 400 * time_s)
    a = source_of(tmp_path / "a.wav", 0.1 * (low + high), RATE)
    b = source_of(tmp_path / "b.wav", 0.1 * (low + high)[RATE:], RATE)
    reader = PairReader(Pair(a, b, Sync(SyncKind.TYPED, 1.0)), Ears.BOTH, (300.0, 500.0))
    heard = reader(2 * 2 * RATE, 2 * RATE).reshape(-1, 2)[RATE // 2 :]
    reader.close()
    spectrum = np.abs(np.fft.rfft(heard[:, 0] * np.hanning(len(heard))))
    hertz = np.fft.rfftfreq(len(heard), 1 / RATE)
    assert spectrum[np.argmin(np.abs(hertz - 400))] > 100 * spectrum[np.argmin(np.abs(hertz - 40))]
    np.testing.assert_allclose(heard[:, 0], heard[:, 1], atol=0.01)
    assert np.sqrt(np.mean(heard[:, 0] ** 2)) == pytest.approx(0.12, rel=0.1)


# --- files ---


def test_a_saved_session_opens_to_the_same_place(loaded, monkeypatch, tmp_path, qtbot):
    loaded.page.band_low.setText("25")
    loaded.page.band_low.editingFinished.emit()
    place = loaded.wait().position.from_a_m
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "street"), ""))
    loaded.qtbot.mouseClick(loaded.page.save, Qt.MouseButton.LeftButton)
    assert loaded.told == ["Written: street.leakcorr"]
    assert loaded.preferences.values.correlator_folder == str(tmp_path)
    other = Bench(qtbot, tmp_path)
    drop(other.page.box_a, tmp_path / "street.leakcorr")
    result = other.wait()
    assert result.position.from_a_m == pytest.approx(place, abs=1e-6)
    assert result.band.low_hz == pytest.approx(25.0)
    other.control.stop()
    (tmp_path / "street.leakcorr").write_text("{}")
    loaded.control.files.open_session(tmp_path / "street.leakcorr")
    assert "cannot be used: what stands under format" in loaded.words


def test_an_export_is_a_page_a_curve_and_numbers(loaded, monkeypatch, tmp_path):
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "out" / "leak.pdf"), ""))
    loaded.qtbot.mouseClick(loaded.page.export, Qt.MouseButton.LeftButton)
    loaded.wait()
    assert "leak.csv" in loaded.words  # the folder does not exist: told in a sentence
    loaded.control._read_again()
    loaded.wait()
    (tmp_path / "out").mkdir()
    loaded.qtbot.mouseClick(loaded.page.export, Qt.MouseButton.LeftButton)
    loaded.wait()
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["leak.csv", "leak.json", "leak.pdf"]
    data = json.loads((tmp_path / "out" / "leak.json").read_text())
    assert data["leak"]["from_a_m"] == pytest.approx(LEAK_M, abs=0.3)
    assert loaded.told == ["Written: leak.csv, leak.json, leak.pdf"]


def test_reading_can_be_cancelled_and_started_again(bench, recordings):
    bench.control.files.take("a", [recordings / "hydrant.wav", recordings / "valve.wav"])
    for job in bench.jobs.running:
        job.cancel()
    bench.wait()
    bench.control._read_again()
    assert bench.wait() is not None


def test_the_page_is_built_when_it_is_asked_for_and_remembers_what_was_open(qtbot, tmp_path, recordings):
    places = []
    for _ in range(2):
        window, stack, pages = QWidget(), QStackedWidget(), {}
        qtbot.addWidget(window)
        qtbot.addWidget(stack)
        jobs = Jobs(window)
        entry = CorrelatorEntry(
            jobs, PreferencesStore(tmp_path / "p.json"), "en", pages, stack, window, lambda: (places or ["leaks"])[-1]
        )
        entry.page_asked.connect(places.append)
        assert entry.page is None
        entry.apply_theme(DARK)
        entry.show()
        assert pages["correlator"] is entry.page
        if len(places) == 1:
            entry.page.pipe.set_pipe(PVC)
            entry.control.files.take("a", [recordings / "hydrant.wav", recordings / "valve.wav"])
        qtbot.waitUntil(lambda e=entry, j=jobs: not e.control.busy and not j.running, timeout=30_000)
        assert entry.control.result.position.from_a_m == pytest.approx(LEAK_M, abs=0.3)
        entry.show()  # again: back to where it was asked for
        entry.stop()
        jobs.stop_all()
    assert places == ["correlator", "leaks", "correlator", "leaks"]


def test_every_button_is_large_enough_for_gloves(bench):
    page = bench.page
    for button in (page.open, page.save, page.export, page.swap, page.suppress, page.restore, page.listen_both):
        assert button.minimumHeight() >= 36
        assert button.toolTip()


def test_the_window_goes_there_and_back_by_its_action(qtbot, tmp_path):
    services = Services(SurveySession(), Jobs(), PreferencesStore(tmp_path / "p.json"), why_silent=lambda: None)
    window = MainWindow(services, "en")
    qtbot.addWidget(window)
    window.show()
    action = window.actions_by_id["correlator"]
    assert [key.toString() for key in action.shortcuts()] == ["Ctrl+K"]
    action.trigger()
    assert window.page == "correlator"
    assert window._stack.currentWidget() is window.correlator.page
    window.next_theme()
    assert window.correlator.page.correlation._theme.name == window._theme.name
    action.trigger()
    assert window.page == "start"
    qtbot.waitUntil(lambda: not services.jobs.running)
    window.close()
