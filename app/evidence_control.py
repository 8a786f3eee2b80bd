"""Feeds the evidence panel: measures the selected candidate beside the rest of the pipe, in a worker thread."""

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject

from app.review_commands import EditSurvey
from app.survey_session import SurveySession
from processing import messages
from processing.survey import CalibrationLeak, LeakClass
from widgets.candidate_row import CandidateRow
from widgets.evidence_panel import EvidencePanel, EvidenceRow, ShownEvidence
from widgets.evidence_plots import SmallPlot, Weighed
from widgets.known_leak_dialog import KnownFlow, KnownLeakDialog
from widgets.latest_loader import LatestLoader
from widgets.units import quantities
from widgets.vocabulary import chance_text, class_text

if TYPE_CHECKING:
    from app.page_tools import PageTools
    from processing.results import Results
    from processing.sound.feature_background import CandidateEvidence, ShownFeature
    from processing.sound.ground import Ground

NAME = "why"
SAME_M = 5.0  # a candidate this close to the known leak is it
WORTH_SAYING = 0.08  # nats; less changes no opinion
# figures that are logarithms of what the sentence tells
_RATIOS = ("flutter", "place_not_moment", "lopsided", "speed_ratio")


class EvidenceControl(QObject):
    """Works only while the panel is shown; what lies along the run is gathered once for each run."""

    def __init__(
        self,
        session: SurveySession,
        tools: "PageTools",
        panel: EvidencePanel,
        language: str,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._tools, self._panel, self._language = session, tools, panel, language
        self._ground: tuple[Results, Ground | None] | None = None
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._loaded)
        self._loader.failed.connect(lambda _error: self._panel.show_evidence(None, self._words("nothing")))
        tools.chosen.connect(lambda _name: self._show())
        session.selection_changed.connect(self._show)
        session.results_changed.connect(self._show)
        session.opened.connect(self._forget)
        session.survey_changed.connect(self._show)
        panel.known_leak_asked.connect(self.mark_known)

    def toggle(self) -> None:
        """Bring the panel to the front, or the list of leaks where it is there already."""
        if self._tools.is_in_front(NAME):
            self._tools.leave(NAME)
        else:
            self._tools.choose(NAME)

    def mark_known(self) -> None:
        """Ask for the flow of the selected candidate, a leak that is known; others are sized beside it from then on."""
        session, row = self._session, self._session.row(self._session.selected)
        if row is None or not session.writable or not math.isfinite(row.candidate.chainage_m):
            return
        before = session.survey.calibration_leak
        is_this = before is not None and abs(before.chainage_m - row.candidate.chainage_m) <= SAME_M
        known = KnownFlow(before.flow_lpm, before.pressure_bar) if before is not None and is_this else None
        dialog = KnownLeakDialog(row.name, known, self._panel)
        if dialog.exec() != KnownLeakDialog.DialogCode.Accepted:
            return
        answer = dialog.answer
        after = None
        if answer is not None:
            after = CalibrationLeak(row.candidate.chainage_m, answer.flow_lpm, answer.pressure_bar, row.name)
        if after != before:
            text = self.tr("known leak")
            session.push(EditSurvey(session, text, replace(session.survey, calibration_leak=after)))

    def stop(self) -> None:
        """Wait for what is being measured: call before the survey's files are closed."""
        self._loader.stop()

    def _words(self, key: str, **params: object) -> str:
        return messages.text("why", key, self._language, **params)

    def _forget(self) -> None:
        self._loader.stop()
        self._ground = None
        self._show()

    def _show(self) -> None:
        results, row = self._session.results, self._session.row(self._session.selected)
        if not self._tools.is_in_front(NAME):
            self._loader.cancel()
        elif results is None or results.scan is None:
            self._loader.cancel()
            self._panel.show_evidence(None, self._words("no_sound"))
        elif row is None:
            self._loader.cancel()
            self._panel.show_evidence(None, self._words("no_candidate"))
        else:
            self._panel.show_evidence(None, self._words("waiting"))
            known = self._ground[1] if self._ground is not None and self._ground[0].scan is results.scan else None
            self._loader.request(partial(_measure, results, row, known, self._language))

    def _loaded(self, found: "_Measured") -> None:
        self._ground = (found.results, found.ground)
        self._panel.show_evidence(found.shown, "" if found.shown is not None else self._words("nothing"))


@dataclass(frozen=True)
class _Measured:
    results: "Results"
    ground: "Ground | None"
    shown: ShownEvidence | None


def _measure(results: "Results", row: CandidateRow, ground: "Ground | None", language: str) -> _Measured:
    from processing.sound.classes import load_model
    from processing.sound.feature_background import evidence_of, ground_of_results
    from processing.sound.size_words import size_sentence

    ground = ground if ground is not None else ground_of_results(results)
    evidence = evidence_of(row.candidate, ground, results.candidates, load_model()) if ground is not None else None
    if evidence is None:
        return _Measured(results, ground, None)
    size = size_sentence(row.leak_size, language, quantities().units) if row.leak_size is not None else ""
    return _Measured(results, ground, _shown(row, evidence, size, language))


def _shown(row: CandidateRow, evidence: "CandidateEvidence", size: str, language: str) -> ShownEvidence:
    chances = sorted(evidence.probability.items(), key=lambda item: -item[1])
    percent = chance_text(evidence.probability[LeakClass.LEAK])
    kind = class_text(row.kind)
    telling = [f for f in evidence.features if abs(f.for_leak) >= WORTH_SAYING]
    rows = [EvidenceRow(_sentence(f, language), Weighed(f.value, f.quantiles, f.for_leak)) for f in telling]
    faded, seconds = row.candidate.evidence.get("faded_db"), row.candidate.evidence.get("stood_s")
    if isinstance(faded, float) and isinstance(seconds, float) and row.candidate.leak_class is LeakClass.TRAFFIC:
        told = messages.text("why", "faded", language, seconds=seconds, faded=faded)
        rows.insert(0, EvidenceRow(told, Weighed(math.nan, (math.nan,) * 5, -4.0)))
    return ShownEvidence(
        title=messages.text("why", "title", language, name=row.name, kind=kind, percent=percent),
        size=size,
        chances=tuple((class_text(c), p) for c, p in chances[:3]),
        rows=tuple(rows),
        spectrum=SmallPlot(evidence.band_hz, evidence.excess_db, evidence.usual_db, logarithmic=True),
        rise=SmallPlot(evidence.away, evidence.rise_db, None, evidence.fit_away, evidence.fit_db, dots=True),
        places=evidence.places,
        may_be_known=row.leak_size is not None and evidence.in_metres,
    )


def _sentence(feature: "ShownFeature", language: str) -> str:
    """Return the figure in plain words: is it more, or less, than elsewhere in this pipe."""
    middle = feature.quantiles[2]
    high = feature.value > middle if math.isfinite(middle) else feature.value > 0
    if feature.name == "flutter":
        high = feature.value > 0.3  # less than a third more is no gurgle, whatever the rest does
    elif feature.name == "place_not_moment":
        high = feature.value >= -0.02
    value = float(np.exp(feature.value)) if feature.name in _RATIOS else feature.value
    return messages.text_in(
        quantities().units, "why", f"{feature.name}_{'high' if high else 'low'}", language, value=value
    )
