"""A survey that is handed over: the small one of the reports, with what people added to it."""

from dataclasses import replace

import numpy as np
import pytest

from processing.progress import silent
from processing.reporting.content import make_content
from processing.reporting.handover.writing import write_handover
from processing.reporting.options import FileKind, HandoverOptions, ReportOptions
from processing.review_facts import DigFinding, DigResult, LoggedDecision, ReviewRecord
from processing.survey import Decision, LeakClass, Verdict


@pytest.fixture
def surveyed(results):
    """The small survey with a place that was marked by hand: no score, no level."""
    first = results.candidates[0]
    side = 25.0 / np.sqrt(2)
    marked = replace(
        first,
        id=4,
        number=17,
        time_s=50.0,
        chainage_m=25.0,
        chainage_low95_m=24.0,
        chainage_high95_m=26.0,
        position_w_m=(side, side, -0.25),
        score=float("nan"),
        level_db=float("nan"),
    )
    return replace(results, candidates=(*results.candidates, marked))


@pytest.fixture
def record():
    leak = Decision(Verdict.CONFIRMED, LeakClass.LEAK, "vana yanında; ıslak")
    log = (
        LoggedDecision("2026-05-04T10:00:00Z", "Ayşe", "decide", 1, Decision(), leak),
        LoggedDecision("2026-05-04T10:00:05Z", "Ayşe", "undo", 1, leak, Decision()),
    )
    return ReviewRecord(log=log, digs={2: DigResult(2, DigFinding.LEAK, "2026-05-11", off_along_m=-0.4)})


@pytest.fixture
def hand_over(surveyed, decisions, record, tmp_path):
    """Write chosen files into ``tmp_path / "out"``; returns the folder and what became of it."""

    def write(*kinds, language="en", changed=surveyed, decided=decisions, contract=(), progress=None, **options):
        folder = tmp_path / "out"
        folder.mkdir(exist_ok=True)
        content = make_content(changed, decided, record, ReportOptions(language=language))
        chosen = HandoverOptions(**{"files": frozenset(kinds or FileKind), "pipe_id": "H-12", **options})
        return folder, write_handover(content, chosen, folder, contract, progress or silent())

    return write
