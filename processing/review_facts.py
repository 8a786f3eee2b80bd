"""What people add to a leak besides the verdict: photos, a second reviewer's opinion, and what the dig showed.

Each belongs to a leak by the **number** that people call it by (:attr:`processing.survey.Candidate.label`): it is the
same from run to run, so nothing has to be carried over when the survey is processed again.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum

from processing.quantities import Quantities
from processing.survey import Decision


@dataclass(frozen=True)
class Photo:
    """A picture of a leak's place, kept in the survey's folder ``attachments`` under ``file``, untouched."""

    id: int
    number: int  # of the leak
    file: str  # its name in the folder ``attachments``
    sha256: str
    size: int
    caption: str = ""
    at_utc: str = ""
    operator: str = ""


# 1 sigma in metres of a found place by how it was measured, where nobody said how well: coordinates are a hand-held
# receiver's
MEASURED_SIGMA_M = {"tape": 0.2, "chainage": 0.3, "coordinates": 1.5}


class DigFinding(StrEnum):
    """What a dig showed at or near the stated place."""

    LEAK = "leak"  # a leak of the main
    OTHER = "other"  # something else made the sound: a service, a valve, a pump …
    NOTHING = "nothing"  # the pipe was laid open and is sound


@dataclass(frozen=True)
class DigResult:
    """What was found where, and what had been stated when the crew dug.

    ``off_along_m`` is found minus stated along the pipe (positive away from the launch), None where nothing was found
    or nobody measured, and ``sigma_m`` how well that was measured (1 sigma, None: by tape as usual). ``stated_*`` are
    frozen: a later run must not make an old statement look better. A ``missed`` leak was dug up where none was stated.
    """

    number: int
    finding: DigFinding
    date: str = ""  # ISO 8601 day of the dig
    off_along_m: float | None = None
    off_across_m: float | None = None
    depth_m: float | None = None
    flow_lpm: float | None = None
    cause: str = ""  # joint, crack, hole, corrosion, service …: free text
    note: str = ""
    stated_chainage_m: float | None = None
    stated_low95_m: float | None = None
    stated_high95_m: float | None = None
    at_utc: str = ""
    operator: str = ""  # who entered it
    dug_by: str = ""  # who was there
    measured: str = "tape"  # tape | chainage | coordinates: what ``off_along_m`` comes from
    sigma_m: float | None = None
    stated_score: float | None = None  # the machine's probability that it is a leak
    run_id: int = 0  # that stated it; 0 where that is not known
    missed: bool = False
    stated_widen: float = 1.0  # by what the statement had been widened already, after earlier digs


@dataclass(frozen=True)
class Opinion:
    """What a second reviewer, who did not see the first one's verdict, says of a leak."""

    number: int
    reviewer: str
    decision: Decision
    at_utc: str = ""


@dataclass(frozen=True)
class LoggedDecision:
    """One line of who decided what when, for the report's appendix and ``decisions.csv``."""

    at_utc: str
    operator: str
    reason: str  # decide | undo | redo | carry | add | withdraw | reinstate | opinion | dig
    number: int
    before: Decision
    after: Decision


@dataclass(frozen=True)
class ScoreBand:
    """How many digs at places with a score of ``low``..``high`` found a leak, with the 95 % interval of the share.

    For the report only: scores are never changed by it.
    """

    low: float
    high: float
    digs: int
    leaks: int
    share_low: float
    share_high: float


@dataclass(frozen=True)
class DigHistory:
    """The digs of all surveys of a kind of pipe and run, this computer's memory: what the intervals were worth.

    ``held`` of ``count`` measured digs lay inside of the stated 95 % interval; errors are along the pipe, absolute but
    for the bias (found minus stated, positive away from the launch). Its sentences: :mod:`processing.dig_words`.
    """

    kind: str  # which digs: ``rolling/ductile_iron/300/tied``, parts that are not told apart being ``*``
    count: int
    held: int
    median_error_m: float
    p95_error_m: float
    dry_holes: int  # digs at stated leaks that found nothing or something else
    widen: float = 1.0  # by which factor intervals should be multiplied to hold 95 %, 1 where nothing speaks against
    dug: int = 0  # digs at stated leaks, measured or not
    missed: int = 0  # leaks dug up where none had been stated
    held_low: float = 0.0  # 95 % intervals of the shares held and dry (Clopper and Pearson 1934)
    held_high: float = 1.0
    dry_low: float = 0.0
    dry_high: float = 1.0
    bias_m: float = 0.0
    bias_sigma_m: float = float("nan")  # of the mean error; NaN below two digs
    bands: tuple[ScoreBand, ...] = ()


@dataclass(frozen=True)
class ReviewRecord:
    """All that people added to a run, as the report and the hand-over need it."""

    log: tuple[LoggedDecision, ...] = ()
    photos: tuple[tuple[Photo, str], ...] = ()  # with the path of the file
    digs: dict[int, DigResult] = field(default_factory=dict)  # the newest of each number
    opinions: tuple[Opinion, ...] = ()
    history: DigHistory | None = None
    # what has changed since another run of the pipe, in sentences; None where the operator has put none beside this one
    changes: Callable[[Quantities], tuple[str, ...]] | None = None
