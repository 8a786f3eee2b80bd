"""Connects the tool of the bands with the selection of the spectrogram and with the detector's band."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.survey_session import SurveySession
from processing import messages
from processing.errors import LeaklineError
from widgets.band_panel import BandPanel
from widgets.latest_loader import LatestLoader
from widgets.spectrogram_view import SpectrogramView
from widgets.vocabulary import frequency_text, number

if TYPE_CHECKING:
    from processing.results import Results
    from processing.sound.band_methods import BandMap

METHODS = ("energy", "kurtogram", "kurtosis", "entropy")  # processing.sound.band_methods.BAND_METHODS, not loading it
_LEAST_BAND_HZ = 20.0


class BandControl(QObject):
    """Measures in a worker when asked to; what is measured belongs to the present results only."""

    band_taken = Signal(float, float)  # Hz, settled: to be looked for from now on

    def __init__(
        self,
        session: SurveySession,
        spectrogram: SpectrogramView,
        panel: BandPanel,
        language: str,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._spectrogram, self._panel, self._language = session, spectrogram, panel, language
        titles, words = messages.table("band_titles", language), messages.table("band_words", language)
        panel.set_methods([(name, titles[name], words[name]) for name in METHODS])
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._take)
        self._loader.failed.connect(self._on_failure)
        panel.measure_asked.connect(self.measure)
        panel.band_taken.connect(self._settle)
        spectrogram.selection_changed.connect(lambda *_four: self._show_able())
        spectrogram.selection_cleared.connect(self._show_able)
        session.results_changed.connect(self.forget)
        session.opened.connect(self.forget)
        self.forget()

    def stop(self) -> None:
        """Wait for the work in progress and drop it."""
        self._loader.stop()

    def forget(self) -> None:
        """Drop what belongs to another run."""
        self._loader.stop()
        text = messages.table("bands", self._language)["hint"]
        self._panel.view.set_hint(text)
        self._panel.tell("")
        self._panel.show_band(None)
        self._show_able()

    def measure(self) -> None:
        """Measure the selection against what lies before and after it."""
        of, results = self._spectrogram.selection, self._session.results
        if of is None or results is None or results.recording.audio is None:
            return
        method, beside = self._panel.method, self._spectrogram.beside_s(of)
        self._panel.tell(messages.table("bands", self._language)["measuring"])
        self._loader.request(lambda: (method, _measured(results, method, (of.start_s, of.end_s), beside)))

    def _take(self, found: "tuple[str, BandMap]") -> None:
        method, result = found
        panel, choice = self._panel, result.choice
        band = choice.band_hz if choice is not None else None
        unit = "dB" if method == "energy" else ""
        panel.view.set_map(result.bands_hz, result.row, result.value, band, unit)
        panel.show_band(band)
        panel.tell(self._sentence(method, result))

    def _sentence(self, method: str, result: "BandMap") -> str:
        texts = messages.table("bands", self._language)
        if result.choice is None:
            return texts["nothing"]
        low, high = (frequency_text(hz) for hz in result.choice.band_hz)
        digits = 3 if method == "entropy" else 1
        excess = number(result.choice.excess, digits)
        sentence = texts[f"found_{method}"].format(low=low, high=high, excess=excess)
        return f"{sentence} {texts['spans'].format(a=number(result.seconds, 1), b=number(result.background_s, 1))}"

    def _settle(self, low_hz: float, high_hz: float) -> None:
        self.band_taken.emit(max(low_hz, _LEAST_BAND_HZ), high_hz)

    def _on_failure(self, error: Exception) -> None:
        self._panel.tell(
            messages.error_sentence(error, self._language) if isinstance(error, LeaklineError) else str(error)
        )

    def _show_able(self) -> None:
        results = self._session.results
        able = results is not None and results.recording.audio is not None and self._spectrogram.selection is not None
        self._panel.set_able(selection=able)


def _measured(
    results: "Results", method: str, span_s: tuple[float, float], beside: tuple[tuple[float, float], ...]
) -> "BandMap":
    """Runs in a worker."""
    from processing.sound.band_methods import band_map

    audio, clock = results.recording.audio, results.clock
    assert audio is not None  # it was there when the worker was asked
    stretch, *others = (
        (float(clock.to_audio(start)), float(clock.to_audio(end))) for start, end in (span_s, *beside) if end > start
    )
    return band_map(method, audio, stretch, others)
