"""Keys that mean one thing in the review and another while recording: which of them, the page in front decides."""

from app.recording_entry import RecordingEntry
from app.review_control import ReviewControl


class SharedKeys:
    """Handlers of the actions that both share."""

    def __init__(self, recording: RecordingEntry, review: ReviewControl) -> None:
        self._recording, self._review = recording, review

    def mark(self) -> None:
        """Mark what is passed now, or on a review page a leak at the cursor."""
        (self._recording if self._recording.in_front else self._review).mark_here()

    def undo(self) -> None:
        """Take back the last marker of the recording, or elsewhere the last change of the survey."""
        (self._recording if self._recording.in_front else self._review).undo()
