"""Photos of the leaks: attached by dialog, drop or paste, read small in a worker, their place held to the leak's."""

import math
import tempfile
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QMimeData, QObject, Signal
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QGuiApplication, QImage
from PySide6.QtWidgets import QFileDialog

from app.photo_commands import AttachPhotos, CaptionPhoto, PhotoDesk, RemovePhoto
from app.services import Services
from processing.errors import LeaklineError
from processing.photo_facts import PhotoFacts, photo_facts, small_photo
from processing.progress import Progress
from processing.review_facts import Photo
from processing.storage.photos import CopiedPhoto, copy_photo
from widgets.candidate_row import CandidateRow
from widgets.latest_loader import LatestLoader
from widgets.photo_panel import PhotoPanel, ShownPhoto
from widgets.units import quantities

if TYPE_CHECKING:
    from app.main_window import MainWindow

NAME = "photos"
SUFFIXES = frozenset({".jpg", ".jpeg", ".png", ".heic", ".heif"})
SHOWN_PX = 1280
KEPT = 12  # pictures in memory: 5 MB each at most
CROWDED_PX = 640  # where one leak has more than that: all of them are kept, 1.3 MB each at most
FAR_M = 50.0  # a photo taken farther away than this is perhaps of another leak


@dataclass(frozen=True)
class ReadPhoto:
    """What a worker read of a photo; ``error`` is why it could not."""

    sha256: str
    image: QImage | None
    facts: PhotoFacts | None
    error: LeaklineError | None = None


class PhotoControl(QObject):
    """Public methods without arguments are actions' handlers."""

    told = Signal(str)

    def __init__(self, window: "MainWindow", services: Services, language: str) -> None:
        super().__init__(window)
        self._window, self._session, self._jobs, self._language = window, services.session, services.jobs, language
        self._page = window.review_page
        self._tools = self._page.tools
        self.panel = PhotoPanel()
        self.desk = PhotoDesk(self._session)
        self._kept: OrderedDict[str, ReadPhoto] = OrderedDict()
        self._asked: list[tuple[str, Path]] = []  # what the worker is reading
        self._most = KEPT
        self._title = self.tr("Photos")
        self._tools.add_tool(NAME, self._title, self.panel, pages=("leaks",))
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._take)
        session, panel = self._session, self.panel
        session.selection_changed.connect(self._show)
        session.candidates_changed.connect(self._show)
        session.results_changed.connect(self._forget)
        session.opened.connect(self._forget)
        session.closing.connect(self.panel.flush)
        session.annexes_changed.connect(self._show)
        self._tools.chosen.connect(lambda _name: self._show())
        panel.attach_asked.connect(self.attach)
        panel.paste_asked.connect(self.paste)
        panel.remove_asked.connect(self._remove)
        panel.caption_changed.connect(self._set_caption)
        panel.caption_left.connect(self._page.focus_views)
        self._page.setAcceptDrops(True)
        self._page.installEventFilter(self)

    # --- actions ------------------------------------------------------------------------------------------------

    def toggle(self) -> None:
        """Bring the photos to the front, or the list of leaks where they are there already."""
        if self._tools.is_in_front(NAME):
            self._tools.leave(NAME)
            self._page.focus_views()
            return
        if self._window.page != "leaks":
            self._window.show_page("leaks")
        self._tools.choose(NAME)

    def attach(self) -> None:
        """Ask for pictures and attach them to the selected leak."""
        if self._row() is None:
            return
        kinds = self.tr("Pictures") + " (*.jpg *.jpeg *.png *.JPG *.JPEG *.PNG)"
        paths, _kind = QFileDialog.getOpenFileNames(self._window, self.tr("Attach photos"), "", kinds)
        self.bring([Path(path) for path in paths])

    def paste(self) -> None:
        """Attach the picture, or the picture files, that the clipboard holds."""
        # an empty clipboard has no data at all, whatever its type says
        mime: QMimeData | None = QGuiApplication.clipboard().mimeData()
        paths = picture_paths(mime) if mime is not None else []
        image = QGuiApplication.clipboard().image()
        if paths:
            self.bring(paths)
        elif not image.isNull():
            self._bring_image(image)
        else:
            self.told.emit(self.tr("There is no picture in the clipboard. Copy one first."))

    def stop(self) -> None:
        """Read nothing more: the window closes."""
        self.panel.flush()
        self._loader.stop()

    # --- attaching ----------------------------------------------------------------------------------------------

    def bring(self, paths: Sequence[Path]) -> None:
        """Copy pictures into the survey in a worker, then attach them to the leak that is selected now."""
        row, folder = self._row(), self._session.folder
        if row is None or folder is None or not paths:
            return
        if not self._session.writable:
            self._session.write(lambda: None)  # which tells that nothing can be written
            return
        number, place, sources = row.candidate.label, folder.path, tuple(paths)
        self._jobs.start(
            lambda progress: copy_all(place, number, sources, progress),
            title=self.tr("Copying photos"),
            on_success=lambda result: self._attach(place, row.name, number, *result),
        )

    def _bring_image(self, image: QImage) -> None:
        row, folder = self._row(), self._session.folder
        if row is None or folder is None:
            return
        if not self._session.writable:
            self._session.write(lambda: None)
            return
        number, place = row.candidate.label, folder.path

        def step(progress: Progress) -> tuple[list[CopiedPhoto], list[LeaklineError]]:
            with tempfile.TemporaryDirectory(prefix="leakline-paste-") as aside:
                source = Path(aside) / "clipboard.png"
                image.save(str(source), "PNG")  # type: ignore[call-overload]
                return copy_all(place, number, (source,), progress)

        self._jobs.start(
            step,
            title=self.tr("Copying photos"),
            on_success=lambda result: self._attach(place, row.name, number, *result),
        )

    def _attach(
        self, place: Path, name: str, number: int, copied: list[CopiedPhoto], errors: list[LeaklineError]
    ) -> None:
        folder = self._session.folder
        if folder is None or folder.path != place:  # a leak of another survey may have the same number
            text = self.tr("Photos not attached: their survey was closed while they were copied. Attach them again.")
            self.told.emit(text)
            return
        known = {photo.sha256 for photo in self.desk.photos(number)}
        fresh = [one for one in copied if one.sha256 not in known]
        if fresh:
            self._session.push(AttachPhotos(self.desk, self.tr("photo of {name}").format(name=name), number, fresh))
            if self._window.page == "leaks":
                self._tools.choose(NAME)
        elif copied:
            self.told.emit(self.tr("This photo is attached to {name} already.").format(name=name))
        for error in errors[:1]:
            self._window.boxes.error(error)

    def _remove(self, photo_id: int) -> None:
        row, photo = self._row(), self._photo(photo_id)
        if row is not None and photo is not None:
            text = self.tr("remove photo of {name}").format(name=row.name)
            self._session.push(RemovePhoto(self.desk, text, photo))

    def _set_caption(self, photo_id: int, caption: str) -> None:
        """Write a caption, perhaps of a leak that was left while it was being typed."""
        folder = self._session.folder
        photos = () if folder is None else folder.photos.photos()
        photo = next((photo for photo in photos if photo.id == photo_id), None)
        if photo is not None and photo.caption != caption:
            names = {row.candidate.label: row.name for row in self._session.rows()}
            text = self.tr("caption of {name}").format(name=names.get(photo.number, photo.number))
            self._session.push(CaptionPhoto(self.desk, text, photo, caption))

    # --- showing ------------------------------------------------------------------------------------------------

    def _row(self) -> CandidateRow | None:
        return self._session.row(self._session.selected)

    def _photo(self, photo_id: int) -> Photo | None:
        row = self._row()
        photos = () if row is None else self.desk.photos(row.candidate.label)
        return next((photo for photo in photos if photo.id == photo_id), None)

    def _forget(self) -> None:
        self._loader.stop()
        self._asked = []
        self._kept.clear()
        self._show()

    def _show(self) -> None:
        row = self._row()
        photos = () if row is None else self.desk.photos(row.candidate.label)
        self._tools.set_title(NAME, f"{self._title} ({len(photos)})" if photos else self._title)
        if not self._tools.is_in_front(NAME):
            return  # the pictures are read when somebody looks
        shown = [self._shown(row, photo) for photo in photos] if row is not None else []
        self._most = max(KEPT, len(photos))  # else those in front would push each other out for ever
        self.panel.show_photos("" if row is None else row.name, shown, writable=self._session.writable)
        self._read([photo for photo in photos if photo.sha256 not in self._kept])

    def _shown(self, row: CandidateRow, photo: Photo) -> ShownPhoto:
        read = self._kept.get(photo.sha256)
        if read is None:
            return ShownPhoto(photo.id, photo.caption)
        self._kept.move_to_end(photo.sha256)
        if read.error is not None:
            from processing import messages

            return ShownPhoto(photo.id, photo.caption, QImage(), messages.error_sentence(read.error, self._language))
        return ShownPhoto(photo.id, photo.caption, read.image, self._told_by(row, read.facts))

    def _read(self, photos: Sequence[Photo]) -> None:
        folder = self._session.folder
        if folder is None or not photos:
            return
        wanted = [(photo.sha256, folder.photos.path(photo)) for photo in photos[:KEPT]]
        if wanted == self._asked:
            return
        self._asked = wanted
        size = SHOWN_PX if self._most <= KEPT else CROWDED_PX
        self._loader.request(lambda: [read_photo(sha256, path, size) for sha256, path in wanted])

    def _take(self, found: list[ReadPhoto]) -> None:
        self._asked = []
        for read in found:
            self._kept[read.sha256] = read
        while len(self._kept) > self._most:
            self._kept.popitem(last=False)
        self._show()

    def _told_by(self, row: CandidateRow, facts: PhotoFacts | None) -> str:
        """Return when and how far from the leak a photo was taken, by its own word."""
        if facts is None:
            return ""
        words = quantities()
        parts = []
        if facts.taken:
            parts.append(self.tr("Taken {day}, {time}.").format(day=words.day(facts.taken), time=facts.taken[11:16]))
        away = self._away_m(row, facts)
        if facts.latitude is None:
            parts.append(self.tr("The photo does not say where it was taken."))
        elif away is not None:
            parts.append(
                self.tr("This photo was taken {metres} from the stated place.").format(metres=words.length(away, 0))
            )
            if away > FAR_M:
                parts.append(self.tr("Is it a photo of this leak?"))
        else:
            place = f"{words.number(facts.latitude, 5)}  {words.number(facts.longitude, 5)}"
            parts.append(self.tr("Taken at {place}.").format(place=place))
        return " ".join(parts)

    def _away_m(self, row: CandidateRow, facts: PhotoFacts) -> float | None:
        """Return the level distance between a photo's place and the leak's; None where either is not known."""
        from processing.coordinates import frame_of

        if facts.latitude is None or facts.longitude is None:
            return None
        try:
            frame = frame_of(self._session.survey)
        except LeaklineError:  # told where the coordinates are typed
            return None
        if not frame.is_geographic:
            return None
        there = frame.from_geographic([[facts.latitude, facts.longitude, frame.height_m]])[0]
        away = float(np.hypot(*(there[:2] - np.asarray(row.candidate.position_w_m[:2]))))
        return away if math.isfinite(away) else None

    # --- dropping -----------------------------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Qt: pictures that are dropped on the leaks page are photos; all else is the window's."""
        if isinstance(event, QDragEnterEvent) and picture_paths(event.mimeData()) and self._row() is not None:
            event.acceptProposedAction()
            return True
        if isinstance(event, QDropEvent) and event.type() is QEvent.Type.Drop and self._row() is not None:
            paths = picture_paths(event.mimeData())
            if paths:
                event.acceptProposedAction()
                self.bring(paths)
                return True
        return super().eventFilter(watched, event)


def picture_paths(mime: QMimeData) -> list[Path]:
    """Return the files that are dropped or pasted if all of them are pictures by name; else none."""
    paths = [Path(url.toLocalFile()) for url in mime.urls() if url.isLocalFile()]
    pictures = [path for path in paths if path.suffix.lower() in SUFFIXES]
    return pictures if len(pictures) == len(paths) else []


def copy_all(
    folder: Path, number: int, sources: Sequence[Path], progress: Progress
) -> tuple[list[CopiedPhoto], list[LeaklineError]]:
    """Copy pictures into a survey's folder, for a worker; return those copied and why others were not."""
    copied, errors = [], []
    for place, source in enumerate(sources):
        progress.update(place / len(sources), "copying_photos")
        try:
            copied.append(copy_photo(folder, number, source))
        except LeaklineError as error:
            errors.append(error)
    return copied, errors


def read_photo(sha256: str, path: Path, size_px: int = SHOWN_PX) -> ReadPhoto:
    """Read a picture small, and what it tells of itself; for a worker."""
    try:
        return ReadPhoto(sha256, QImage.fromData(small_photo(path, size_px)), photo_facts(path))
    except LeaklineError as error:
        return ReadPhoto(sha256, None, None, error)
