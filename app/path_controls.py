"""What the tools of the path page do: tie points, the comparison of methods and the quality plots, wired together."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.comparison_control import ComparisonControl
from app.jobs import Jobs
from app.quality_control import QualityControl
from app.survey_session import SurveySession
from app.tie_control import TieControl

if TYPE_CHECKING:
    from app.review_page import ReviewPage


class PathControls(QObject):
    """Holds one control a tool; what they ask of the window comes out as signals of this one."""

    reprocess_asked = Signal()
    failed = Signal(object)  # LeaklineError that may come again with every move

    def __init__(
        self, session: SurveySession, jobs: Jobs, page: "ReviewPage", language: str, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self.comparison = ComparisonControl(session, jobs, page.methods, page.path, language, self)
        self.quality = QualityControl(session, page.quality, language, self)
        self.ties = TieControl(session, page, page.markers, self)
        page.tools.chosen.connect(lambda _name: self.quality.set_shown(page.tools.is_in_front("quality")))
        for control in (self.comparison, self.ties):
            control.reprocess_asked.connect(self.reprocess_asked)
        self.ties.failed.connect(self.failed)
