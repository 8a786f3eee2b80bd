"""The correlator's files: choosing and dropping recordings, opening and saving sessions, exporting."""

import logging
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.correlator_page import CorrelatorPage
from app.jobs import Jobs
from app.settings import PreferencesStore
from processing.correlation.report import CorrelationReport
from processing.correlation.session import SUFFIX, CorrelatorSession, RecordingChoice, read_session, write_session
from processing.errors import LeaklineError
from processing.sound.source import AUDIO_SUFFIXES, open_audio
from processing.survey import AudioSource
from widgets.correlator_form import ShownRecording

log = logging.getLogger(__name__)


class CorrelatorFiles(QObject):
    """Holds the two opened recordings, named ``a`` and ``b``."""

    changed = Signal()
    failed = Signal(object)  # LeaklineError
    told = Signal(str)
    session_opened = Signal(object)  # CorrelatorSession
    save_asked = Signal()
    export_asked = Signal()

    def __init__(
        self, jobs: Jobs, preferences: PreferencesStore, page: CorrelatorPage, language: str, window: QWidget
    ) -> None:
        super().__init__(window)
        self._jobs, self._preferences, self._page, self._window = jobs, preferences, page, window
        self._language = language
        self._sources: dict[str, AudioSource] = {}
        self._boxes = {"a": page.box_a, "b": page.box_b}
        for name, box in self._boxes.items():
            box.choose_asked.connect(lambda n=name: self._ask(n))
            box.dropped.connect(lambda paths, n=name: self.take(n, paths))
            box.channel_chosen.connect(lambda channel, n=name: self.choose_channel(n, channel))
        page.swap.clicked.connect(self.swap)
        page.open.clicked.connect(self._ask_session)
        page.save.clicked.connect(self.save_asked)
        page.export.clicked.connect(self.export_asked)

    # --- recordings ---

    def source(self, name: str) -> AudioSource | None:
        """Return a recording."""
        return self._sources.get(name)

    def recording(self, name: str) -> RecordingChoice:
        """Return a recording's files and channel; no files where none are chosen."""
        source = self._sources.get(name)
        if source is None:
            return RecordingChoice(())
        return RecordingChoice(tuple(part.path for part in source.parts), source.channel)

    def take(self, name: str, paths: list[Path]) -> None:
        """Use these files: one session, the recordings of A and B, or one recording; two channels go to both."""
        sessions = [path for path in paths if path.suffix.lower() == SUFFIX]
        if sessions:
            self.open_session(sessions[0])
            return
        other = "b" if name == "a" else "a"
        if len(paths) == 2 and not self._sources:
            first, second = sorted(paths)
            if self._open("a", [first]) and self._open("b", [second]):
                self.changed.emit()
            return
        if not self._open(name, sorted(paths)):
            return
        source = self._sources[name]
        if source.channels > 1 and other not in self._sources:
            self._sources[other] = replace(source, channel=1 if source.channel == 0 else 0)
            self._show(other)
        self.changed.emit()

    def choose_channel(self, name: str, channel: int) -> None:
        """Use another channel of the same files."""
        source = self._sources.get(name)
        if source is not None and 0 <= channel < source.channels:
            self._sources[name] = replace(source, channel=channel)
            self.changed.emit()

    def swap(self) -> None:
        """Exchange A and B."""
        a, b = self._sources.get("a"), self._sources.get("b")
        self._sources = {name: source for name, source in (("a", b), ("b", a)) if source is not None}
        for name in self._boxes:
            self._show(name)
        self.changed.emit()

    def _open(self, name: str, paths: list[Path], channel: int = 0) -> bool:
        try:
            source, _findings = open_audio(paths, channel=channel)
        except LeaklineError as error:
            self.failed.emit(error)
            return False
        self._sources[name] = source
        self._show(name)
        self._remember(paths[0])
        return True

    def _show(self, name: str) -> None:
        source = self._sources.get(name)
        shown = None
        if source is not None:
            paths = tuple(part.path for part in source.parts)
            shown = ShownRecording(paths, source.duration_s, source.sample_rate_hz, source.channels, source.channel)
        self._boxes[name].show_recording(shown)

    def _ask(self, name: str) -> None:
        kinds = " ".join(f"*{suffix}" for suffix in sorted(AUDIO_SUFFIXES))
        text = self.tr("Recording of sensor A") if name == "a" else self.tr("Recording of sensor B")
        filters = f"{self.tr('Sound')} ({kinds});;{self.tr('All files')} (*)"
        chosen, _ = QFileDialog.getOpenFileNames(self._window, text, self._folder(), filters)
        if chosen:
            self.take(name, [Path(text) for text in chosen])

    # --- sessions ---

    def _ask_session(self) -> None:
        filters = f"{self.tr('Correlation')} (*{SUFFIX})"
        chosen, _ = QFileDialog.getOpenFileName(self._window, self.tr("Open a correlation"), self._folder(), filters)
        if chosen:
            self.open_session(Path(chosen))

    def open_session(self, path: Path) -> None:
        """Show what a session says, and open its recordings."""
        try:
            session = read_session(path)
        except LeaklineError as error:
            self.failed.emit(error)
            return
        self._remember(path)
        self._use(session)

    def _use(self, session: CorrelatorSession) -> None:
        self._sources.clear()
        self.session_opened.emit(session)
        good = True
        for name, wanted in (("a", session.a), ("b", session.b)):
            self._show(name)
            if wanted.paths:
                good = self._open(name, list(wanted.paths), wanted.channel) and good
        if good:
            self.changed.emit()

    def reopen(self, path: Path) -> None:
        """Show what was open last; recordings that are gone since then are simply not there."""
        try:
            session = read_session(path)
        except LeaklineError as error:
            log.warning("the last session was not read: %s", error)
            return
        wanted = (*session.a.paths, *session.b.paths)
        if wanted and all(file.is_file() for file in wanted):
            self._use(session)

    def save(self, session: CorrelatorSession) -> None:
        """Ask where, and write the session."""
        proposal = str(Path(self._folder()) / f"correlation{SUFFIX}")
        filters = f"{self.tr('Correlation')} (*{SUFFIX})"
        chosen, _ = QFileDialog.getSaveFileName(self._window, self.tr("Save the correlation"), proposal, filters)
        if not chosen:
            return
        path = Path(chosen)
        path = path if path.suffix.lower() == SUFFIX else path.with_name(path.name + SUFFIX)
        try:
            write_session(path, session)
        except LeaklineError as error:
            self.failed.emit(error)
            return
        self._remember(path)
        self.told.emit(self.tr("Written: {name}").format(name=path.name))

    def export(self, report: CorrelationReport) -> None:
        """Ask where, and write page, curve and numbers in a job."""
        proposal = str(Path(self._folder()) / "correlation.pdf")
        chosen, _ = QFileDialog.getSaveFileName(self._window, self.tr("Export"), proposal, "PDF (*.pdf)")
        if not chosen:
            return
        stem = Path(chosen).with_suffix("") if chosen.lower().endswith(".pdf") else Path(chosen)
        self._remember(stem)

        def write(_progress: object) -> tuple[Path, ...]:
            from processing.correlation.report import write_report

            return write_report(stem, report)

        def done(paths: tuple[Path, ...]) -> None:
            names = ", ".join(path.name for path in paths)
            self.told.emit(self.tr("Written: {name}").format(name=names))

        self._jobs.start(write, title=self.tr("Export"), on_success=done, on_failure=self.failed.emit)

    # --- the remembered folder ---

    def _folder(self) -> str:
        remembered = self._preferences.values.correlator_folder
        return remembered if remembered and Path(remembered).is_dir() else str(Path.home())

    def _remember(self, path: Path) -> None:
        folder = str(path.absolute().parent)
        if folder != self._preferences.values.correlator_folder:
            self._preferences.change(correlator_folder=folder)
