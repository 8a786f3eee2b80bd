"""What each step from data to report still lacks: facts in, a light and the reasons for it out.

A light is not a grade: green means that nothing is missing, yellow that the result is usable but weaker than it could
be, red that it cannot be relied on, grey that an earlier step must come first. Each reason is a code of the table
``[readiness]`` in ``resources/messages``, whose sentence says what is missing and what to do, and names the place in
the window that leads there.
"""

from dataclasses import dataclass, field
from enum import StrEnum

from processing import messages
from processing.quantities import Quantities
from processing.survey import Params

DIG_HALF_M = 2.3  # a bell-hole lays open at most 4.6 m of pipe: what is known better than this needs one dig
RED_HALF_M = 10.0  # beyond this nobody digs by the place alone
UNHEARD_SHARE = 0.5  # when more of the sound is useless, the run is no leak survey
FEW_SECONDS = 1.0  # of trouble at the ends that nobody needs to be told about


class Step(StrEnum):
    """The steps, in order; ``ties`` are the markers that hold the path."""

    DATA = "data"
    TIES = "ties"
    PATH = "path"
    SOUND = "sound"
    LEAKS = "leaks"
    REPORT = "report"


class Light(StrEnum):
    """The lights, the gravest first."""

    RED = "red"
    YELLOW = "yellow"
    GREEN = "green"
    GREY = "grey"


class Lead(StrEnum):
    """Where to go to mend it."""

    OPEN = "open"
    DATA = "data"
    FORM = "form"
    TIES = "ties"
    PROCESS = "process"
    PATH = "path"
    SOUND = "sound"
    LEAKS = "leaks"
    UNDECIDED = "undecided"
    REPORT = "report"
    EXPORT = "export"


@dataclass(frozen=True)
class Facts:
    """What is known of the open survey; lengths in metres, shares 0..1.

    ``widest_m`` is half of the widest 95 % interval along the path, at chainage ``widest_at_m``; ``worst_miss_m`` is
    how far the path would have been off at a tie point had that one not been known. ``exported`` is None while
    nothing was written; ``changed_since`` tells whether a verdict came after the newest export.
    """

    is_open: bool = False
    previewing: bool = False  # a device's folder is looked at that has not been processed
    readable: bool = True  # of the preview: all that was found can be read
    processed: bool = False
    stale: bool = False  # form, tie points or settings have changed since
    writable: bool = True
    has_motion: bool = True
    has_sound: bool = True
    warnings: int = 0
    ties: int = 0  # those switched on
    ties_doubted: tuple[str, ...] = ()  # names of those that all else contradicts
    worst_miss_m: float | None = None
    has_length: bool = False
    has_path: bool = False
    length_m: float = 0.0
    widest_m: float = 0.0
    widest_at_m: float = 0.0
    path_lost_m: float = 0.0  # stretches of the path that cannot be assessed
    direction_known: bool = True
    clock_assumed: bool = False
    sound_lost_s: float = 0.0
    sound_s: float = 0.0
    candidates: int = 0
    undecided: int = 0
    unsure: int = 0
    confirmed: int = 0
    exported: str | None = None  # ISO day of the newest export
    changed_since: bool = False


@dataclass(frozen=True)
class Note:
    """One thing to know about a step: ``code`` is a key of ``[readiness]``, ``params`` fill its sentence."""

    code: str
    light: Light
    lead: Lead | None = None
    params: Params = field(default_factory=dict)


@dataclass(frozen=True)
class StepState:
    """A step with its notes, the gravest first; its light is that of the first."""

    step: Step
    notes: tuple[Note, ...]

    @property
    def light(self) -> Light:
        """The gravest of the notes' lights."""
        return self.notes[0].light


_GRAVITY = {light: rank for rank, light in enumerate(Light)}


def readiness(facts: Facts) -> tuple[StepState, ...]:
    """Return the state of every step in order; each has at least one note."""
    rules = {
        Step.DATA: _data,
        Step.TIES: _ties,
        Step.PATH: _path,
        Step.SOUND: _sound,
        Step.LEAKS: _leaks,
        Step.REPORT: _report,
    }
    states = []
    for step, rule in rules.items():
        notes = rule(facts) if facts.processed or step in (Step.DATA, Step.TIES) else [_waiting(step, facts)]
        states.append(StepState(step, tuple(sorted(notes, key=lambda note: _GRAVITY[note.light]))))
    return tuple(states)


def next_thing(states: tuple[StepState, ...]) -> Note | None:
    """Return what to do first: the gravest note, of equally grave ones that of the earliest step; None: all is done."""
    wanting = [note for state in states for note in state.notes if note.light in (Light.RED, Light.YELLOW)]
    return min(wanting, key=lambda note: _GRAVITY[note.light], default=None)


def sentence(note: Note, quantities: Quantities) -> str:
    """Return what a note says, in the language and units of ``quantities``."""
    told: dict[str, str | float] = dict(note.params)
    if "metres" in note.params:
        told["metres"] = quantities.length(float(note.params["metres"]), 1)
    if "at" in note.params:
        told["at"] = quantities.place(float(note.params["at"]), 0)
    if "day" in note.params:
        told["day"] = quantities.day(str(note.params["day"]))
    return messages.text("readiness", note.code, quantities.language, **told)


def _waiting(step: Step, facts: Facts) -> Note:
    lead = Lead.PROCESS if facts.is_open or facts.previewing else Lead.OPEN
    return Note(f"{step.value}_waiting", Light.GREY, lead)


def _data(facts: Facts) -> list[Note]:
    if not facts.is_open and not facts.previewing:
        return [Note("data_nothing_open", Light.GREY, Lead.OPEN)]
    if not facts.processed:
        if not facts.readable:
            return [Note("data_unreadable", Light.RED, Lead.DATA)]
        return [Note("data_not_processed", Light.YELLOW, Lead.PROCESS)]
    notes = []
    if not facts.has_motion:
        notes.append(Note("data_no_motion", Light.RED, Lead.DATA))
    if not facts.has_sound:
        notes.append(Note("data_no_sound", Light.RED, Lead.DATA))
    if facts.stale:
        notes.append(Note("data_stale", Light.YELLOW, Lead.PROCESS))
    if facts.warnings:
        notes.append(Note("data_warnings", Light.YELLOW, Lead.DATA, {"count": facts.warnings}))
    return notes or [Note("data_good", Light.GREEN)]


def _ties(facts: Facts) -> list[Note]:
    if not facts.processed and not facts.is_open and not facts.previewing:
        return [_waiting(Step.TIES, facts)]
    if facts.ties_doubted:
        params: Params = {"count": len(facts.ties_doubted), "names": ", ".join(facts.ties_doubted)}
        return [Note("ties_doubted", Light.RED, Lead.TIES, params)]
    known = facts.ties + (1 if facts.has_length else 0)
    if known == 0:
        if facts.processed and facts.has_path:
            return [Note("ties_none", Light.RED, Lead.TIES, {"metres": facts.widest_m})]
        return [Note("ties_none_yet", Light.RED, Lead.TIES)]
    if known == 1:
        code = "ties_one" if facts.ties else "ties_only_length"
        return [Note(code, Light.YELLOW, Lead.TIES)]
    if facts.worst_miss_m is None:
        return [Note("ties_good", Light.GREEN, Lead.TIES, {"count": known})]
    return [Note("ties_checked", Light.GREEN, Lead.TIES, {"count": known, "metres": facts.worst_miss_m})]


def _path(facts: Facts) -> list[Note]:
    if not facts.has_path:
        return [Note("path_none", Light.RED, Lead.DATA)]
    notes = []
    where: Params = {"metres": facts.widest_m, "at": facts.widest_at_m}
    if facts.widest_m > RED_HALF_M:
        notes.append(Note("path_too_wide", Light.RED, Lead.TIES, where))
    elif facts.widest_m > DIG_HALF_M:
        notes.append(Note("path_wide", Light.YELLOW, Lead.TIES, where))
    if facts.path_lost_m >= 1.0:
        notes.append(Note("path_gaps", Light.YELLOW, Lead.PATH, {"metres": facts.path_lost_m}))
    if not facts.direction_known:
        notes.append(Note("path_direction", Light.YELLOW, Lead.FORM))
    return notes or [Note("path_good", Light.GREEN, Lead.PATH, where)]


def _sound(facts: Facts) -> list[Note]:
    if not facts.has_sound:
        return [Note("sound_none", Light.RED, Lead.DATA)]
    notes = []
    share = facts.sound_lost_s / facts.sound_s if facts.sound_s > 0.0 else 0.0
    lost: Params = {"percent": 100.0 * share, "seconds": facts.sound_lost_s}
    if share > UNHEARD_SHARE:
        notes.append(Note("sound_mostly_lost", Light.RED, Lead.SOUND, lost))
    elif facts.sound_lost_s >= FEW_SECONDS:
        notes.append(Note("sound_gaps", Light.YELLOW, Lead.SOUND, lost))
    if facts.clock_assumed:
        notes.append(Note("sound_clock", Light.YELLOW, Lead.SOUND))
    return notes or [Note("sound_good", Light.GREEN, Lead.SOUND)]


def _leaks(facts: Facts) -> list[Note]:
    if not facts.has_sound:
        return [Note("leaks_no_sound", Light.GREY, Lead.DATA)]
    if facts.candidates == 0:
        return [Note("leaks_none", Light.GREEN, Lead.SOUND)]
    notes = []
    if facts.undecided:
        params: Params = {"left": facts.undecided, "count": facts.candidates}
        notes.append(Note("leaks_undecided", Light.YELLOW, Lead.UNDECIDED, params))
    if facts.unsure:
        notes.append(Note("leaks_unsure", Light.YELLOW, Lead.LEAKS, {"count": facts.unsure}))
    done: Params = {"count": facts.candidates, "confirmed": facts.confirmed}
    return notes or [Note("leaks_good", Light.GREEN, Lead.LEAKS, done)]


def _report(facts: Facts) -> list[Note]:
    notes = []
    if facts.undecided or facts.unsure:
        left: Params = {"left": facts.undecided + facts.unsure}
        notes.append(Note("report_draft", Light.YELLOW, Lead.UNDECIDED, left))
    if facts.exported is None:
        notes.append(Note("report_not_written", Light.YELLOW, Lead.EXPORT))
    elif facts.changed_since:
        notes.append(Note("report_old", Light.YELLOW, Lead.EXPORT, {"day": facts.exported}))
    return notes or [Note("report_good", Light.GREEN, Lead.REPORT, {"day": facts.exported or ""})]
