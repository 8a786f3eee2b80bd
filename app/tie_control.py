"""Tie points on the path page: dragged, edited, switched off, with the path fitted anew while the hand moves.

The reckoned path is kept from the results, so only the fit is repeated, by a worker that always takes the newest wish.
What is drawn after a change is that fit; leaks and report follow when the survey is processed again.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.review_commands import EditSurvey
from app.survey_session import SurveySession
from processing.errors import LeaklineError
from processing.survey import FloatArray, Survey, TiePoint, Track
from widgets.latest_loader import LatestLoader
from widgets.marker_panel import MarkerCheck, MarkerPanel
from widgets.tie_point_panel import closed_loop

if TYPE_CHECKING:
    from app.review_page import ReviewPage
    from processing.position.fit_results import FitPreview
    from processing.position.fitting import FitProblem
    from processing.position.tie_checks import TieCheck
    from processing.results import Results

NORMAL_95 = 1.959964


class TieControl(QObject):
    """Connects tie points in the views and in the table with the session; the session's survey alone is the truth."""

    reprocess_asked = Signal()
    failed = Signal(object)  # LeaklineError

    def __init__(
        self, session: SurveySession, page: "ReviewPage", panel: MarkerPanel, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._session, self._page, self._panel = session, page, panel
        self._fit = _LiveFit()
        self._shown: Track | None = None  # the path that is drawn: of the results, or of the newest fit
        self._dragging: tuple[TiePoint, ...] | None = None
        self._doubted: frozenset[int] = frozenset()
        self._loader = LatestLoader(self, overtaken=True)
        self._loader.loaded.connect(self._take)
        self._loader.failed.connect(self.failed)
        panel.tie_points_changed.connect(self._edit)
        panel.chosen.connect(self._choose)
        panel.add_asked.connect(self.add_here)
        panel.loop_asked.connect(self._add_loop)
        panel.process_asked.connect(self.reprocess_asked)
        page.table.process_asked.connect(self.reprocess_asked)
        plan = page.path
        plan.tie_clicked.connect(self._choose)
        plan.tie_dragged.connect(lambda n, east, north: self._drag(n, self._moved_on_plan(n, east, north)))
        plan.tie_dropped.connect(lambda n, east, north: self._drop(n, self._moved_on_plan(n, east, north)))
        plan.tie_drag_ended.connect(self._end_drag)
        for strip in page.strips:
            strip.tie_clicked.connect(self._choose)
            strip.tie_dragged.connect(lambda n, time_s: self._drag(n, self._moved_in_time(n, time_s)))
            strip.tie_dropped.connect(lambda n, time_s: self._drop(n, self._moved_in_time(n, time_s)))
            strip.tie_drag_ended.connect(self._end_drag)
        session.results_changed.connect(self._on_results)
        session.survey_changed.connect(self._on_survey)
        self._on_results()

    # --- what the operator does ---

    def add_here(self) -> None:
        """Add a tie point where the cursor is, named by its number; its chainage is what the path says there."""
        session, track = self._session, self._shown
        if session.results is None or track is None:
            return
        time_s = round(session.cursor.time_s, 3)
        chainage = round(float(np.interp(time_s, track.time_s, track.chainage_m)), 2)
        points = session.survey.tie_points
        name = self.tr("mark {number}").format(number=len(points) + 1)
        self._edit((*points, TiePoint(name, time_s, chainage_m=chainage)))
        self._panel.select(len(points))

    def _add_loop(self) -> None:
        results = self._session.results
        if results is not None and results.track is not None:
            end_s = float(results.track.time_s[-1])
            survey = self._session.survey
            point = closed_loop(survey.launch, end_s, self.tr("back at the launch"))
            self._edit((*survey.tie_points, point))

    def _edit(self, points: tuple[TiePoint, ...]) -> None:
        session = self._session
        if points != session.survey.tie_points:
            after = replace(session.survey, tie_points=points)
            session.push(EditSurvey(session, self.tr("tie points"), after))
        self._on_survey()  # also where it could not be written: the table goes back to what is true

    def _choose(self, number: int) -> None:
        points = self._session.survey.tie_points
        if 0 <= number < len(points):
            self._panel.select(number)
            self._session.cursor.set_time(points[number].time_s)
            self._show_pins()

    # --- dragging ---

    def _moved_on_plan(self, number: int, east_m: float, north_m: float) -> TiePoint | None:
        from processing.coordinates import frame_of
        from processing.position.tie_moving import moved_on_plan

        results = self._session.results
        points = self._session.survey.tie_points
        if results is None or results.track is None or number >= len(points):
            return None
        # along the path as it was before the drag: it must not run away under the hand
        track = self._fit.before_drag or results.track
        try:
            frame = frame_of(self._session.survey)
        except LeaklineError as error:
            self.failed.emit(error)
            return None
        return moved_on_plan(points[number], (east_m, north_m), frame, track.position_w_m, track.chainage_m)

    def _moved_in_time(self, number: int, time_s: float) -> TiePoint | None:
        from processing.position.tie_moving import moved_in_time

        track, points = self._shown, self._session.survey.tie_points
        if track is None or number >= len(points):
            return None
        return moved_in_time(points[number], time_s, float(track.time_s[0]), float(track.time_s[-1]))

    def _with(self, number: int, tie: TiePoint) -> tuple[TiePoint, ...]:
        return tuple(tie if k == number else p for k, p in enumerate(self._session.survey.tie_points))

    def _drag(self, number: int, tie: TiePoint | None) -> None:
        if tie is None or not self._session.writable:
            return
        if self._dragging is None:
            self._fit.before_drag = self._shown
            self._panel.select(number)
        self._dragging = self._with(number, tie)
        self._page.show_tie_points(self._dragging)
        self._panel.set_tie_points(self._dragging, writable=self._session.writable)
        self._request(replace(self._session.survey, tie_points=self._dragging))

    def _drop(self, number: int, tie: TiePoint | None) -> None:
        self._dragging = None
        if tie is not None and self._session.writable:
            self._edit(self._with(number, tie))

    def _end_drag(self) -> None:
        self._dragging = self._fit.before_drag = None
        self._on_survey()

    # --- the live fit ---

    def _on_results(self) -> None:
        results = self._session.results
        self._loader.cancel()
        self._fit = _LiveFit()
        self._dragging = None
        self._shown = results.track if results is not None else None
        movable = self._session.writable and results is not None and results.track is not None
        for view in self._page.views:
            view.ties_movable = movable
        self._on_survey()

    def _on_survey(self) -> None:
        """Show what the session's survey says; where the results are of other tie points, fit anew."""
        session, results = self._session, self._session.results
        self._panel.set_tie_points(session.survey.tie_points, writable=session.writable)
        self._page.show_tie_points(session.survey.tie_points)
        if results is None or results.track is None:
            self._panel.set_checks({})
            self._show_state("", stale=False)
            return
        if _told(results.survey) == _told(session.survey):
            self._loader.cancel()
            self._show_track(results.track)
            self._show_checks(results.tie_checks, session.survey)
            self._show_state("", stale=False)
        else:
            self._request(session.survey)

    def _request(self, survey: Survey) -> None:
        results = self._session.results
        if results is None or results.reckoned is None:
            return
        self._loader.request(partial(self._fit.refit, results, survey))

    def _take(self, found: "tuple[Survey, FitPreview]") -> None:
        survey, preview = found
        results = self._session.results
        if results is None or results.track is None:
            return
        self._show_track(preview_track(preview, results.track))
        self._show_checks(preview.checks, survey)
        state = self.tr("The path follows the tie points. The leaks in the list still stand where they were.")
        self._show_state(state, stale=self._dragging is None and self._session.writable)

    def _show_state(self, text: str, *, stale: bool) -> None:
        self._panel.set_state(text, stale=stale)
        self._page.table.set_stale(stale)

    def _show_track(self, track: Track) -> None:
        if track is self._shown:
            return
        self._shown = track
        self._page.show_track(track, whole=self._dragging is None)

    def _show_checks(self, checks: "Sequence[TieCheck]", survey: Survey) -> None:
        numbered = numbered_checks(checks, survey.tie_points)
        self._panel.set_checks(numbered)
        self._doubted = frozenset(n for n, check in numbered.items() if check.doubted)
        self._show_pins()

    def _show_pins(self) -> None:
        self._page.path.set_tie_state(self._doubted, self._panel.selected)


class _LiveFit:
    """The fit that a worker repeats; the problem is prepared once for what no tie point changes."""

    def __init__(self) -> None:
        self._key: object = None
        self._problem: FitProblem | None = None
        self.before_drag: Track | None = None

    def refit(self, results: "Results", survey: Survey) -> "tuple[Survey, FitPreview]":
        """Return the fitted keyframes, with the survey that they are of; called by one worker at a time."""
        from processing.position.fitting import prepare, refit

        assert results.reckoned is not None
        key = replace(survey, tie_points=())
        if self._problem is None or key != self._key:
            # the evidence is that of the last processing: a bend is not looked for while a hand moves
            reckoned, settings = results.reckoned, results.settings.position
            self._problem, self._key = prepare(reckoned.odometry, survey, reckoned.evidence, settings), key
        return survey, refit(self._problem, survey, results.settings.position)


def _told(survey: Survey) -> tuple[object, ...]:
    """What of a survey the fit of the path rests on."""
    return survey.tie_points, survey.launch, survey.route, survey.pipe.length_m


def preview_track(preview: "FitPreview", base: Track) -> Track:
    """Return a track at the keyframes of a fit, for the views: height, attitude and method as in ``base``."""
    rows = np.clip(np.searchsorted(base.time_s, preview.time_s), 0, len(base.time_s) - 1)

    def at_keyframes(values: FloatArray) -> FloatArray:
        return np.asarray(np.interp(preview.time_s, base.time_s, values))

    return replace(
        base,
        time_s=preview.time_s,
        chainage_m=preview.chainage_m,
        position_w_m=preview.position_w_m,
        sigma_along_m=preview.sigma_along_m,
        sigma_cross_m=preview.sigma_cross_m,
        cov_level_m2=preview.cov_level_m2,
        sigma_up_m=at_keyframes(base.sigma_up_m),
        quat_ws=base.quat_ws[rows],
        speed_mps=at_keyframes(base.speed_mps),
    )


def numbered_checks(checks: "Sequence[TieCheck]", points: Sequence[TiePoint]) -> dict[int, MarkerCheck]:
    """Return the checks by the number of their tie point: matched by name and moment, each used once."""
    left = list(checks)
    out: dict[int, MarkerCheck] = {}
    for number, tie in enumerate(points):
        found = next((c for c in left if c.name == tie.name and abs(c.time_s - tie.time_s) < 1e-6), None)
        if found is not None and tie.enabled:
            left.remove(found)
            spread = NORMAL_95 * found.left_out_sigma_m
            out[number] = MarkerCheck(found.residual_m, found.left_out_m, spread, found.held_down)
    return out
