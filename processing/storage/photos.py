"""Pictures of the leaks' places: copied untouched into ``attachments/``, told in the table ``photos``.

A picture is never deleted: :meth:`PhotoStore.withdraw` hides it, :meth:`PhotoStore.reinstate` shows it again.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.photo_facts import photo_facts
from processing.review_facts import Photo
from processing.storage.database import Database, Row
from processing.storage.files import copy_hashed, safe_name, sync_folder, writing
from processing.storage.plain import from_json, storable, to_json
from processing.storage.times import now_utc

ATTACHMENTS = "attachments"
LONGEST_CAPTION = 1000  # characters
_HASH_IN_NAME = 12


@dataclass(frozen=True)
class CopiedPhoto:
    """A picture that lies in ``attachments`` already, not yet told in the database."""

    file: str
    sha256: str
    size: int


def copy_photo(folder: Path, number: int, source: Path) -> CopiedPhoto:
    """Check ``source`` and copy it into ``folder/attachments``, synced; any thread may do it.

    The same picture is not stored twice. The source is not touched, and neither is the copy: EXIF stays in it.

    Raises:
        LeaklineError: what :func:`processing.photo_facts.photo_facts` says of the file; DISC_FULL, CANNOT_WRITE.
    """
    kind = photo_facts(source).kind
    attachments = folder / ATTACHMENTS
    with writing(attachments):
        attachments.mkdir(exist_ok=True)
        aside = attachments / f".{number}-{safe_name(source.stem, 'photo')[:40]}.part"
        aside.unlink(missing_ok=True)  # of a program that was killed while it copied
    try:
        size, sha256 = copy_hashed(source, aside, lambda _count: None)
        photo_facts(aside)  # what is kept is what was checked, even if the source changed in between
        name = f"leak-{number}-{safe_name(source.stem, 'photo')[:40]}-{sha256[:_HASH_IN_NAME]}.{kind}"
        with writing(attachments):
            aside.replace(attachments / name)
            sync_folder(attachments)
    finally:
        with writing(attachments):
            aside.unlink(missing_ok=True)
    return CopiedPhoto(name, sha256, size)


class PhotoStore:
    """The pictures of a survey; each write is on disc when the call returns.

    Every write raises SURVEY_READ_ONLY, DISC_FULL or CANNOT_WRITE where it cannot be done; then nothing has changed.
    """

    def __init__(self, database: Database, folder: Path) -> None:
        self._db = database
        self._folder = folder

    def add(self, number: int, source: Path, caption: str = "", operator: str = "") -> Photo:
        """Copy a picture of leak ``number`` into the survey; see :func:`copy_photo` for what else it raises."""
        if self._db.read_only:
            raise LeaklineError(ErrorCode.SURVEY_READ_ONLY, Place(self._db.path))
        return self.add_copied(number, copy_photo(self._folder, number, source), caption, operator)

    def add_copied(self, number: int, copied: CopiedPhoto, caption: str = "", operator: str = "") -> Photo:
        """Tell of a picture that :func:`copy_photo` has brought."""
        at_utc, operator = now_utc(), storable(operator)
        photo = Photo(0, number, copied.file, copied.sha256, copied.size, _caption(caption), at_utc, operator)
        with self._db.transaction() as db:
            sql = "INSERT INTO photos (number, at_utc, operator, value) VALUES (?, ?, ?, ?)"
            row_id = db.execute(sql, (number, at_utc, operator, to_json(photo))).lastrowid
        assert row_id is not None  # it is set by every INSERT
        return replace(photo, id=row_id)

    def photos(self, number: int | None = None) -> tuple[Photo, ...]:
        """Return the pictures of one leak, or of all, oldest first, without those withdrawn."""
        sql = "SELECT id, number, at_utc, operator, value FROM photos WHERE NOT withdrawn"
        if number is None:
            rows = self._db.rows(f"{sql} ORDER BY number, id")
        else:
            rows = self._db.rows(f"{sql} AND number = ? ORDER BY id", (number,))
        return tuple(self._photo(row) for row in rows)

    def path(self, photo: Photo) -> Path:
        """Return where the picture's file lies; raises SURVEY_DAMAGED if its name leads out of ``attachments``."""
        name = photo.file
        if not name or safe_name(name) != name:
            raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(self._db.path), reason=storable(name))
        return self._folder / ATTACHMENTS / name

    def set_caption(self, photo_id: int, text: str) -> Photo:
        """Write what stands below a picture; raises KeyError for an unknown one."""
        with self._db.transaction() as db:
            sql = "SELECT id, number, at_utc, operator, value FROM photos WHERE id = ?"
            row = db.execute(sql, (photo_id,)).fetchone()
            if row is None:
                raise KeyError(photo_id)
            photo = replace(self._photo(row), caption=_caption(text))
            db.execute("UPDATE photos SET value = ? WHERE id = ?", (to_json(replace(photo, id=0)), photo_id))
        return photo

    def withdraw(self, photo_id: int) -> None:
        """Hide a picture; its file and its row stay. Raises KeyError for an unknown one."""
        self._set_withdrawn(photo_id, withdrawn=True)

    def reinstate(self, photo_id: int) -> None:
        """Undo :meth:`withdraw`."""
        self._set_withdrawn(photo_id, withdrawn=False)

    def _set_withdrawn(self, photo_id: int, *, withdrawn: bool) -> None:
        with self._db.transaction() as db:
            sql = "UPDATE photos SET withdrawn = ? WHERE id = ?"
            if db.execute(sql, (int(withdrawn), photo_id)).rowcount != 1:
                raise KeyError(photo_id)

    def _photo(self, row: Row) -> Photo:
        try:
            photo = from_json(Photo, row[4])
        except ValueError as error:
            raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(self._db.path), reason=str(error)) from error
        return replace(photo, id=row[0], number=row[1], at_utc=row[2], operator=row[3])


def _caption(text: str) -> str:
    return storable(text.strip())[:LONGEST_CAPTION]
