"""Measures the spectra of chosen stretches away from the window's thread, and says what may be concluded from them."""

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.survey_session import SurveySession
from processing import messages
from processing.errors import LeaklineError
from widgets.latest_loader import LatestLoader
from widgets.plot_scale import hertz_name, hertz_span, number_text
from widgets.sound_selection import SoundSelection
from widgets.spectrogram_view import SpectrogramView
from widgets.spectrum_panel import SpectrumPanel
from widgets.spectrum_view import SpectrumCurve, SpectrumMark
from widgets.units import quantities, speed_text
from widgets.vocabulary import clock_text

if TYPE_CHECKING:
    from processing.results import Results
    from processing.sound.harmonics import Harmonics
    from processing.sound.spectrum import Comparison, PowerSpectrum

DENSITY_UNIT = "dBFS/Hz"  # 0 dB: a full-scale sine
LONGEST_S = 3600.0  # of a stretch: an hour takes a few seconds
HARMONICS_S = 60.0
MOST_MARKS = 12


@dataclass(frozen=True)
class Stretch:
    """Survey seconds, in one piece or around another stretch, and what they are called."""

    spans_s: tuple[tuple[float, float], ...]
    name: str
    place: str
    speed_mps: float  # NaN where it is not known


@dataclass(frozen=True)
class _Found:
    """What a worker brought."""

    a: "PowerSpectrum | None"
    b: "PowerSpectrum | None"
    comparison: "Comparison | None"
    harmonics: "Harmonics | None"


class SpectrumControl(QObject):
    """Connects the selection of the spectrogram with the spectrum tool."""

    told = Signal(str)
    failed = Signal(object)  # Exception

    def __init__(
        self,
        session: SurveySession,
        spectrogram: SpectrogramView,
        panel: SpectrumPanel,
        language: str,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._spectrogram, self._panel = session, spectrogram, panel
        self._language = language
        self._stretches: dict[str, Stretch] = {}
        self._cache: dict[tuple[Stretch, str], PowerSpectrum] = {}
        self._found: _Found | None = None
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._take)
        self._loader.failed.connect(self._on_failure)
        panel.use_asked.connect(self.use)
        panel.options_changed.connect(self._measure)
        panel.export_asked.connect(self.ask_export)
        spectrogram.selection_changed.connect(lambda *_four: self._show_able())
        spectrogram.selection_cleared.connect(self._show_able)
        session.results_changed.connect(self.forget)
        session.opened.connect(self.forget)
        self.forget()

    # --- what the buttons do ------------------------------------------------------------------------------------

    def use(self, what: str) -> None:
        """Take the selection as ``a`` or ``b``, or what lies ``around`` A as B."""
        if what == "around":
            self._use_around()
        elif (of := self._spectrogram.selection) is not None:
            self._stretches[what] = self._stretch(of, what.upper())
        self._measure()

    def use_a(self) -> None:
        """Take the selection as A, with what lies around it as B where there is none yet."""
        self.use("a")
        if "b" not in self._stretches:
            self.use("around")

    def use_b(self) -> None:
        """Take the selection as B."""
        self.use("b")

    def forget(self) -> None:
        """Drop what belongs to another run; waits for the work in progress."""
        self._loader.stop()
        self._stretches.clear()
        self._cache.clear()
        self._found = None
        self._panel.view.set_curves(())
        self._panel.view.set_marks(())
        self._panel.view.set_hint(self.tr("Select a stretch in the spectrogram (Shift and drag), then make it A."))
        self._panel.set_words("")
        self._show_able()

    def _stretch(self, of: SoundSelection, name: str) -> Stretch:
        cursor = self._session.cursor
        end_s = min(of.end_s, of.start_s + LONGEST_S)
        place = f"{clock_text(of.start_s)}–{clock_text(end_s)}"
        ends = [cursor.chainage_at(t) for t in (of.start_s, end_s)]
        if ends[0] is not None and ends[1] is not None:
            told = quantities()
            place = f"{told.place(ends[0])}–{told.place(ends[1])}, {place}"
        return Stretch(((of.start_s, end_s),), name, place, self._speed(of.start_s, end_s))

    def _use_around(self) -> None:
        a = self._stretches.get("a")
        if a is None:
            return
        cursor, (start_s, end_s) = self._session.cursor, a.spans_s[0]
        whole = self._spectrogram.whole_frequency()
        spans = self._spectrogram.beside_s(SoundSelection(start_s, end_s, whole.low, whole.high))
        kept = tuple((max(low, high - LONGEST_S / 2), high) for low, high in spans[:1] if high > low)
        kept += tuple((low, min(high, low + LONGEST_S / 2)) for low, high in spans[1:] if high > low)
        speeds = [self._speed(*span) for span in kept]
        known = [speed for speed in speeds if np.isfinite(speed)]
        del cursor
        name = self.tr("around A")
        self._stretches["b"] = Stretch(kept, name, name, float(np.mean(known)) if known else float("nan"))

    def _speed(self, start_s: float, end_s: float) -> float:
        """Return metres over seconds; NaN without a path."""
        ends = [self._session.cursor.chainage_at(t) for t in (start_s, end_s)]
        if ends[0] is None or ends[1] is None or not end_s > start_s:
            return float("nan")
        return abs(ends[1] - ends[0]) / (end_s - start_s)

    # --- measuring ----------------------------------------------------------------------------------------------

    def _measure(self) -> None:
        results = self._session.results
        self._show_able()
        if results is None or results.recording.audio is None or not self._stretches:
            return
        stretches, average, cache = dict(self._stretches), self._panel.average, self._cache
        same = self._panel.same_loudness
        if not self._panel.view.curves:
            self._panel.view.set_hint(self.tr("Measuring …"))
        self._loader.request(lambda: _measured(results, stretches, average, same, cache))

    def _take(self, found: _Found) -> None:
        self._found = found
        self._show()

    def _on_failure(self, error: Exception) -> None:
        if isinstance(error, LeaklineError):
            self._panel.set_words(messages.error_sentence(error, self._language))
        else:
            self.failed.emit(error)

    # --- showing ------------------------------------------------------------------------------------------------

    def _show_able(self) -> None:
        results = self._session.results
        sound = results is not None and results.recording.audio is not None
        chosen = "".join(self._stretches)
        self._panel.set_able(selection=sound and self._spectrogram.selection is not None, stretches=chosen)

    def _show(self) -> None:
        found = self._found
        if found is None:
            return
        comparison = found.comparison
        view, unit = self._panel.view, DENSITY_UNIT
        standing = [(b.low_hz, b.high_hz) for b in comparison.bands if b.stands_out] if comparison is not None else []
        if comparison is not None and self._panel.wants_difference:
            name = self.tr("A − B")
            curve = SpectrumCurve(
                name, comparison.frequency_hz, comparison.difference_db, comparison.low95_db, comparison.high95_db
            )
            view.set_curves((curve,), self.tr("dB"), zero=True, bands_hz=standing)
        else:
            pairs = ((spectrum, self._stretches.get(key)) for key, spectrum in (("a", found.a), ("b", found.b)))
            curves = [
                SpectrumCurve(stretch.name, spectrum.frequency_hz, spectrum.level_db, *spectrum.interval_db)
                for spectrum, stretch in pairs
                if spectrum is not None and stretch is not None
            ]
            view.set_curves(curves, unit, bands_hz=standing)
        view.set_marks(_marks(found.harmonics))
        self._panel.set_words("\n".join(self._sentences(found)))

    def _sentences(self, found: _Found) -> list[str]:
        lines = []
        for key, spectrum in (("a", found.a), ("b", found.b)):
            stretch = self._stretches.get(key)
            if spectrum is not None and stretch is not None:
                text = self.tr("{name}: {place}; {seconds} s, {windows} windows")
                seconds = number_text(spectrum.duration_s, 1)
                label = key.upper()
                lines.append(text.format(name=label, place=stretch.place, seconds=seconds, windows=spectrum.windows))
        if found.comparison is not None:
            lines += self._compared(found.comparison)
        if found.harmonics is not None and found.harmonics.families:
            first = found.harmonics.families[0]
            text = self.tr("{count} multiples of {hertz} Hz in A: a machine, not a leak.")
            lines.append(text.format(count=len(first.harmonics), hertz=number_text(first.fundamental_hz, 2)))
        return lines

    def _compared(self, comparison: "Comparison") -> list[str]:
        from processing.sound.spectrum import speed_note

        sign = "+" if comparison.louder_db >= 0.0 else ""
        text = self.tr("A against B over the whole: {level} dB.")
        lines = [text.format(level=sign + number_text(comparison.louder_db, 1))]
        out = [band for band in comparison.bands if band.stands_out]
        if out:
            most = max(out, key=lambda band: band.difference_db)
            text = self.tr("A stands out in {spans}; most, by {level} ± {half} dB, at {hertz}.")
            half = 0.5 * (most.high95_db - most.low95_db)
            lines.append(
                text.format(
                    spans=_spans_text([(band.low_hz, band.high_hz) for band in out]),
                    level=number_text(most.difference_db, 1),
                    half=number_text(half, 1),
                    hertz=hertz_name(round((most.low_hz * most.high_hz) ** 0.5)),
                )
            )
        else:
            lines.append(self.tr("In no band does A stand out of B by more than chance and a decibel."))
        note = speed_note(*(self._stretches[key].speed_mps for key in ("a", "b")))
        if note is not None:
            text = self.tr("A was passed at {a}, B at {b}: rolling alone may explain about {level} dB.")
            level = number_text(note.explained_db, 0)
            lines.append(text.format(a=speed_text(note.a_mps), b=speed_text(note.b_mps), level=level))
        return lines

    # --- writing ------------------------------------------------------------------------------------------------

    def ask_export(self, kind: str) -> None:
        """Ask for a file, and write numbers or picture into it."""
        if self._found is None:
            return
        folder = self._session.folder.path.parent if self._session.folder is not None else Path.home()
        caption = self.tr("Save spectrum")
        name, _ = QFileDialog.getSaveFileName(None, caption, str(folder / f"spectrum.{kind}"), f"*.{kind}")
        if name:
            try:
                self.export(Path(name))
            except OSError as error:
                self.failed.emit(error)
            else:
                self.told.emit(self.tr("Written: {file}").format(file=name))

    def export(self, path: Path) -> None:
        """Write the numbers (``.csv``) or the picture (``.png``)."""
        if path.suffix.lower() == ".png":
            if not self._panel.view.image().save(str(path)):
                raise OSError(f"{path} could not be written")
            return
        found = self._found
        assert found is not None
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            spectra = [(key, s) for key, s in (("a", found.a), ("b", found.b)) if s is not None]
            for key, spectrum in spectra:
                stretch = self._stretches[key]
                writer.writerow([f"# {key.upper()}", stretch.place, f"{spectrum.duration_s:.2f} s", spectrum.average])
            for key, spectrum in spectra:
                head = ("frequency_hz", "dbfs_per_hz", "low95", "high95")
                writer.writerow([f"{key}_{column}" for column in head])
                rows = zip(spectrum.frequency_hz, spectrum.level_db, *spectrum.interval_db, strict=True)
                writer.writerows([f"{value:.4f}" for value in row] for row in rows)
            if found.comparison is not None:
                writer.writerow(["band_low_hz", "band_high_hz", "a_over_b_db", "low95", "high95", "stands_out"])
                for band in found.comparison.bands:
                    ends = (band.low_hz, band.high_hz, band.difference_db, band.low95_db, band.high95_db)
                    writer.writerow([*(f"{v:.3f}" for v in ends), int(band.stands_out)])


def _measured(
    results: "Results",
    stretches: dict[str, Stretch],
    average: str,
    same: bool,
    cache: "dict[tuple[Stretch, str], PowerSpectrum]",
) -> _Found:
    """Measure what is not known yet; called in a worker."""
    from processing.sound.spectrum import compare, power_spectrum

    audio = results.recording.audio
    assert audio is not None
    for stretch in stretches.values():
        if (stretch, average) not in cache:
            spans = [(float(results.clock.to_audio(a)), float(results.clock.to_audio(b))) for a, b in stretch.spans_s]
            cache[stretch, average] = power_spectrum(audio, spans, average=average)
    a, b = (cache.get((stretches[key], average)) if key in stretches else None for key in ("a", "b"))
    comparison = compare(a, b, same_loudness=same) if a is not None and b is not None else None
    return _Found(a, b, comparison, _harmonics_of(results, stretches.get("a"), stretches.get("b")))


def _harmonics_of(results: "Results", a: Stretch | None, b: Stretch | None) -> "Harmonics | None":
    """Return the families of lines in A, against B; at most a minute of each is looked at."""
    from processing.sound.harmonics import find_harmonics
    from processing.sound.source import read_frames

    audio = results.recording.audio
    if a is None or audio is None:
        return None
    samples = []
    for stretch in (a, b):
        pieces = [np.zeros(0, np.float32)]
        for start_s, end_s in stretch.spans_s if stretch is not None else ():
            first, last = (round(float(results.clock.to_audio(t)) * audio.sample_rate_hz) for t in (start_s, end_s))
            first = min(max(first, 0), audio.frames)
            most = round(HARMONICS_S * audio.sample_rate_hz)
            pieces.append(read_frames(audio, first, min(max(last - first, 0), most)))
        samples.append(max(pieces, key=len))
    if len(samples[0]) < audio.sample_rate_hz:
        return None
    background = samples[1] if len(samples[1]) >= audio.sample_rate_hz else None
    return find_harmonics(samples[0], audio.sample_rate_hz, background)


def _marks(harmonics: "Harmonics | None") -> list[SpectrumMark]:
    if harmonics is None:
        return []
    lines = [
        SpectrumMark(h.frequency_hz, f"{h.number} × {number_text(family.fundamental_hz, 1)}")
        for family in harmonics.families[:2]
        for h in family.harmonics
    ]
    return lines[:MOST_MARKS]


def _spans_text(bands: list[tuple[float, float]]) -> str:
    """Return bands as few spans of frequency: neighbours are joined."""
    joined: list[list[float]] = []
    for low, high in bands:
        if joined and low <= joined[-1][1] * 1.001:
            joined[-1][1] = high
        else:
            joined.append([low, high])
    return ", ".join(hertz_span(low, high) for low, high in joined)
