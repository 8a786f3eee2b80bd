"""What is remembered of each survey for the start page, so that showing the list opens none of them.

A card is a small JSON file in the user's configuration folder, written while the survey is open. It is a memory, not
the truth: a damaged or missing one is as if nothing were known.
"""

import hashlib
import json
import logging
import os
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from processing.errors import LeaklineError
from processing.survey import Survey, Verdict

if TYPE_CHECKING:
    from app.survey_session import SurveySession
    from processing.survey import Track

log = logging.getLogger(__name__)

OUTLINE_POINTS = 48
MAX_BYTES = 65_536


@dataclass(frozen=True)
class SurveyCard:
    """What was known of a survey when it was last open; ``outline`` is (n, 2), east and north in metres."""

    name: str = ""
    date: str = ""
    client: str = ""
    material: str = ""
    diameter_m: float | None = None
    length_m: float | None = None
    candidates: int | None = None
    decided: int = 0
    confirmed: int = 0
    exported: str | None = None
    simulated: bool = False
    outline: tuple[tuple[float, float], ...] = ()


class CardStore:
    """One file a survey in ``folder``, named by the survey's path."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def read(self, path: str) -> SurveyCard | None:
        """Return the card of the survey at ``path``; None where there is none that can be understood."""
        try:
            file = self._file(path)
            if file.stat().st_size > MAX_BYTES:
                return None
            found = json.loads(file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            log.warning("a card of the start page was not read: %s", error)
            return None
        return _understood(found)

    def write(self, path: str, card: SurveyCard) -> None:
        """Keep a card; a disc that refuses costs a line of the start page, not the work."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            aside = self._file(path).with_suffix(".new")
            values = {field.name: getattr(card, field.name) for field in fields(card)}
            aside.write_text(json.dumps(values, ensure_ascii=False), encoding="utf-8")
            os.replace(aside, self._file(path))  # noqa: PTH105  # atomic on every platform
        except OSError as error:
            log.warning("a card of the start page was not written: %s", error)

    def forget(self, path: str) -> None:
        """Throw a card away."""
        try:
            self._file(path).unlink(missing_ok=True)
        except OSError as error:
            log.warning("a card of the start page was not removed: %s", error)

    def _file(self, path: str) -> Path:
        return self._folder / f"{hashlib.sha256(path.encode('utf-8', 'surrogateescape')).hexdigest()[:24]}.json"


def card_of(session: "SurveySession", exported: str | None) -> SurveyCard | None:
    """Return the card of the open survey; None where none is open."""
    folder, results = session.folder, session.results
    if folder is None:
        return None
    card = _told(session.survey, folder.path)
    if results is None:
        return card
    verdicts = [session.decision(row).verdict for row in session.ordered_ids()]
    return _decided(card, verdicts, exported, results.track)


def is_there(path: Path) -> bool:
    """Tell whether a survey lies there; a share that is away or a folder that may not be read holds none."""
    return os.path.isfile(path / "survey.db")  # noqa: PTH113  # Path.is_file raises for what it may not look at


def peeked(path: Path) -> SurveyCard | None:
    """Return what a survey's database says of it, without opening its recording; None where it cannot be read."""
    from app.readiness_facts import newest_export_day
    from processing.storage.folder import SurveyFolder

    try:
        with SurveyFolder.open(path, read_only=True) as folder:
            card = _told(folder.read_survey(), path)
            run = folder.review.latest_run()
            if run is None:
                return card
            decisions = folder.review.decisions(run)
            verdicts = [decisions[c.id].verdict if c.id in decisions else Verdict.NONE
                        for c in folder.review.candidates(run)]  # fmt: skip
            return _decided(card, verdicts, newest_export_day(folder.exports_dir), None)
    except LeaklineError as error:
        log.info("nothing is known of %s: %s", path, error)
        return None


def _told(survey: Survey, path: Path) -> SurveyCard:
    info, pipe = survey.info, survey.pipe
    return SurveyCard(
        name=info.name or path.stem,
        date=info.date,
        client=info.client,
        material=pipe.material,
        diameter_m=pipe.diameter_m,
        length_m=pipe.length_m,
        simulated=info.simulated,
    )


def _decided(card: SurveyCard, verdicts: list[Verdict], exported: str | None, track: "Track | None") -> SurveyCard:
    return replace(
        card,
        candidates=len(verdicts),
        decided=len(verdicts) - verdicts.count(Verdict.NONE),
        confirmed=verdicts.count(Verdict.CONFIRMED),
        exported=exported,
        length_m=card.length_m if track is None or not len(track.chainage_m) else float(track.chainage_m[-1]),
        outline=() if track is None else outline(track),
    )


def outline(track: "Track") -> tuple[tuple[float, float], ...]:
    """Return the path from above in a few points, evenly along the pipe, to a decimetre."""
    chainage = np.maximum.accumulate(track.chainage_m)
    wanted = np.linspace(chainage[0], chainage[-1], OUTLINE_POINTS)
    rows = np.searchsorted(chainage, wanted).clip(0, len(chainage) - 1)
    return tuple((round(float(e), 1), round(float(n), 1)) for e, n in track.position_w_m[rows, :2])


_KINDS: dict[str, tuple[type, ...]] = {
    "name": (str,), "date": (str,), "client": (str,), "material": (str,), "exported": (str, type(None)),
    "diameter_m": (int, float, type(None)), "length_m": (int, float, type(None)), "candidates": (int, type(None)),
    "decided": (int,), "confirmed": (int,), "simulated": (bool,),
}  # fmt: skip


def _understood(found: Any) -> SurveyCard | None:  # noqa: ANN401  # whatever a JSON file may hold
    if not isinstance(found, dict):
        return None
    values = {key: found[key] for key, kinds in _KINDS.items() if isinstance(found.get(key), kinds) and key in found}
    points = found.get("outline")
    drawn = tuple(
        (float(point[0]), float(point[1]))
        for point in (points if isinstance(points, list) else [])
        if isinstance(point, list) and len(point) == 2 and all(isinstance(v, int | float) for v in point)
    )
    return SurveyCard(**values, outline=drawn[:OUTLINE_POINTS])
