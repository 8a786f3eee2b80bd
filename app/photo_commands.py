"""Photos as undoable commands: attaching is undone by withdrawing, removing by reinstating; no file is ever deleted."""

from collections.abc import Sequence

from PySide6.QtGui import QUndoCommand

from app.survey_session import SurveySession
from processing.review_facts import Photo
from processing.storage.photos import CopiedPhoto


class PhotoDesk:
    """Writes photos of the open survey; the session tells of each change, and of a refusal.

    It knows no window: the undo stack, whose commands hold it, outlives the window when the language changes.
    """

    def __init__(self, session: SurveySession) -> None:
        self.session = session

    def photos(self, number: int) -> tuple[Photo, ...]:
        """Return the photos of a leak."""
        folder = self.session.folder
        return () if folder is None else folder.photos.photos(number)

    def add(self, number: int, copied: CopiedPhoto, caption: str) -> Photo | None:
        """Tell of a picture that was copied already; None where that was refused."""
        added: list[Photo] = []
        folder, operator = self.session.folder, self.session.operator
        if folder is None:
            return None
        store = folder.photos
        if not self.session.write(lambda: added.append(store.add_copied(number, copied, caption, operator))):
            return None
        self.session.annexes_changed.emit(number)
        return added[0]

    def set_withdrawn(self, photo: Photo, *, withdrawn: bool) -> bool:
        """Hide a photo, or show it again."""
        folder = self.session.folder
        if folder is None:
            return False
        call = folder.photos.withdraw if withdrawn else folder.photos.reinstate
        if not self.session.write(lambda: call(photo.id)):
            return False
        self.session.annexes_changed.emit(photo.number)
        return True

    def set_caption(self, photo: Photo, text: str) -> bool:
        """Write what stands below a photo."""
        folder = self.session.folder
        if folder is None or not self.session.write(lambda: folder.photos.set_caption(photo.id, text)):
            return False
        self.session.annexes_changed.emit(photo.number)
        return True


class AttachPhotos(QUndoCommand):
    """Attaches pictures that were copied into the survey to one leak, in one step."""

    def __init__(self, desk: PhotoDesk, text: str, number: int, copied: Sequence[CopiedPhoto]) -> None:
        super().__init__(text)
        self._desk, self._number, self._copied = desk, number, tuple(copied)
        self._photos: list[Photo] = []

    def redo(self) -> None:
        """Qt: attach, or show them again."""
        if self._photos:
            done = self._set_all(withdrawn=False)
        else:
            added = [self._desk.add(self._number, copied, "") for copied in self._copied]
            self._photos = [photo for photo in added if photo is not None]
            done = bool(self._photos)
        if not done:
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: withdraw them."""
        if not self._set_all(withdrawn=True):
            self.setObsolete(True)

    def _set_all(self, *, withdrawn: bool) -> bool:
        return all(self._desk.set_withdrawn(photo, withdrawn=withdrawn) for photo in self._photos)


class RemovePhoto(QUndoCommand):
    """Takes a photo away from a leak."""

    def __init__(self, desk: PhotoDesk, text: str, photo: Photo) -> None:
        super().__init__(text)
        self._desk, self._photo = desk, photo

    def redo(self) -> None:
        """Qt: withdraw it."""
        if not self._desk.set_withdrawn(self._photo, withdrawn=True):
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: put it back."""
        if not self._desk.set_withdrawn(self._photo, withdrawn=False):
            self.setObsolete(True)


class CaptionPhoto(QUndoCommand):
    """Writes a caption."""

    def __init__(self, desk: PhotoDesk, text: str, photo: Photo, caption: str) -> None:
        super().__init__(text)
        self._desk, self._photo, self._caption = desk, photo, caption

    def redo(self) -> None:
        """Qt: write it."""
        if not self._desk.set_caption(self._photo, self._caption):
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: write the one before."""
        if not self._desk.set_caption(self._photo, self._photo.caption):
            self.setObsolete(True)
