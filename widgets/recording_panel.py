"""The heart of the recording page: the one big button, the time, what is left of disc and battery, what went wrong."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from processing.live.stream import RecordingState, RecordingStatus
from widgets.plot_scale import number_text
from widgets.plot_theme import LIGHT, Theme
from widgets.recording_words import clock_text, count_text

BUTTON_HEIGHT = 84
SYNC_LATE_S = 3.0  # the disc is synced each second; later than this is worth a word
BATTERY_LOW = 0.2
SPACE_LOW_S = 15 * 60.0
_MESSAGES = 200


class RecordingPanel(QWidget):
    """Shows statuses; the button only tells that it was pressed."""

    pressed = Signal()

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.button = QPushButton()
        self.button.setObjectName("record_button")
        self.button.setMinimumHeight(BUTTON_HEIGHT)
        self.button.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # a space bar must not end a run
        self.button.clicked.connect(self.pressed)
        self.elapsed = QLabel(clock_text(0))
        self.elapsed.setObjectName("recording_elapsed")
        self.elapsed.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.synced, self.disc = self._figure("recording_synced"), self._figure("recording_disc")
        self.battery, self.counts = self._figure("recording_battery"), self._figure("recording_counts")
        self._shown: dict[QLabel, str] = {}
        self._state: tuple[RecordingState | None, bool, bool] | None = None
        top = QHBoxLayout()
        top.addWidget(self.button, 3)
        top.addWidget(self.elapsed, 2)
        figures = QGridLayout()
        figures.setContentsMargins(0, 0, 0, 0)
        figures.setVerticalSpacing(2)
        for number, (label, share) in enumerate(((self.synced, 4), (self.disc, 6), (self.battery, 5))):
            figures.addWidget(label, 0, number)
            figures.setColumnStretch(number, share)
        figures.addWidget(self.counts, 1, 0, 1, 3)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addLayout(top)
        column.addLayout(figures)
        self.apply_theme(theme)
        self.show_state(None, armed=False, ready=False)

    def _figure(self, name: str) -> QLabel:
        label = QLabel()
        label.setObjectName(name)
        label.setTextFormat(Qt.TextFormat.PlainText)
        label.setWordWrap(True)
        label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        return label

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.elapsed.setStyleSheet("font-size: 30pt; font-weight: bold")
        self._state = None
        for label in tuple(self._shown):
            self._shown.pop(label)

    # --- the button ---

    def show_state(self, state: RecordingState | None, *, armed: bool, ready: bool) -> None:
        """Say on the button what a press does now; ``armed``: the next press stops. None: no devices are open."""
        if self._state == (state, armed, ready):
            return
        self._state = (state, armed, ready)
        recording = state is RecordingState.RECORDING
        texts = {
            RecordingState.RECORDING: self.tr("■  Stop\n(press twice)"),
            RecordingState.STOPPING: self.tr("Closing\nthe files …"),
        }
        text = texts[state] if state in texts else self.tr("●  Record")
        if recording and armed:
            text = self.tr("■  Once more\nto stop")
        self.button.setText(text)
        self.button.setEnabled(recording or (ready and state is not RecordingState.STOPPING))
        self.button.setAccessibleName(text.replace("\n", " "))
        self.button.setToolTip(self.tr("F5; to stop, press twice within three seconds"))
        ground, letters = self._theme.cursor, self._theme.canvas
        if recording and armed:
            ground, letters = self._theme.text, self._theme.canvas
        size = 16 if "\n" in text else 20
        style = f"font-size: {size}pt; font-weight: bold; border-radius: 10px; "
        if self.button.isEnabled() and not recording:
            style += f"color: {self._theme.cursor}; border: 4px solid {self._theme.cursor}; "
        elif recording:
            style += f"color: {letters}; background: {ground}; border: 4px solid {ground}; "
        self.button.setStyleSheet(f"QPushButton {{ {style} }}")

    # --- figures ---

    def show_status(self, status: RecordingStatus, now_host_s: float) -> None:
        """Show time, disc and counters."""
        self._say(self.elapsed, clock_text(status.elapsed_s))
        self._show_synced(status, now_host_s)
        self._show_disc(status)
        self._say(self.counts, self.counts_text(status), warn=self.has_trouble(status))

    def show_battery(self, part: float | None, *, plugged: bool) -> None:
        """Show what is left of the laptop's battery, 0..1; None where it has none."""
        if part is None:
            self._say(self.battery, "")
            return
        low = part < BATTERY_LOW and not plugged
        text = self.tr("⚡ mains, {part} %") if plugged else self.tr("battery {part} %")
        if low:
            text = self.tr("⚠ battery {part} %: plug in")
        self._say(self.battery, text.format(part=round(100 * part)), warn=low)

    def has_trouble(self, status: RecordingStatus) -> bool:
        """Tell whether a counter is not at zero that ought to be."""
        sound, motion = status.sound, status.motion
        return any((sound.lost_frames, sound.gaps, motion.lost, motion.gaps, motion.restarts))

    def counts_text(self, status: RecordingStatus) -> str:
        """Return the counters in words, those at zero left out but for the ones that matter."""
        sound, motion = status.sound, status.motion
        lost_s = sound.lost_frames / sound.sample_rate_hz if sound.sample_rate_hz else 0.0
        parts = [
            self.tr("IMU lost: {count}").format(count=count_text(motion.lost)),
            self.tr("sound lost: {seconds} s").format(seconds=number_text(lost_s, 3 if lost_s else 0, self.locale())),
            self.tr("gaps: {count}").format(count=count_text(sound.gaps + motion.gaps)),
        ]
        for count, text in (
            (motion.repeated, self.tr("repeated: {count}")),
            (motion.garbage_bytes, self.tr("garbage: {count} B")),
            (motion.bad_sums, self.tr("bad sums: {count}")),
            (motion.restarts, self.tr("restarts: {count}")),
            (status.feed_dropped, self.tr("not drawn: {count}")),
        ):
            if count:
                parts.append(text.format(count=count_text(count)))
        return " · ".join(parts)

    def _show_synced(self, status: RecordingStatus, now_host_s: float) -> None:
        if status.state not in (RecordingState.RECORDING, RecordingState.STOPPING):
            self._say(self.synced, self.tr("○ not recording"))
            return
        synced = status.disc.synced_host_s
        age = None if synced is None else max(0.0, now_host_s - synced)
        if age is None or age > SYNC_LATE_S:
            if age is None and status.elapsed_s < SYNC_LATE_S:
                self._say(self.synced, self.tr("○ on disc: …"))
                return
            late = number_text(status.elapsed_s if age is None else age, 0, self.locale())
            self._say(self.synced, self.tr("⚠ on disc: {age} s late").format(age=late), warn=True)
            return
        self._say(self.synced, self.tr("✓ on disc"))

    def _show_disc(self, status: RecordingStatus) -> None:
        disc = status.disc
        if not disc.free_bytes and disc.seconds_left is None:
            self._say(self.disc, "")
            return
        size = number_text(disc.free_bytes / 1e9, 0 if disc.free_bytes > 10e9 else 1, self.locale())
        free = self.tr("disc: {size} GB free").format(size=size)
        self.disc.setToolTip(free)
        if disc.seconds_left is None:
            self._say(self.disc, free)
            return
        low = disc.seconds_left < SPACE_LOW_S
        hours = clock_text(disc.seconds_left).rpartition(":")[0]
        if disc.seconds_left > 20 * 3600:
            hours = count_text(min(int(disc.seconds_left / 3600), 999))
        text = self.tr("⚠ disc: {hours} h left") if low else self.tr("disc: {hours} h left")
        self._say(self.disc, text.format(hours=hours), warn=low)

    def _say(self, label: QLabel, text: str, *, warn: bool = False) -> None:
        key = f"{warn}{text}"
        if self._shown.get(label) == key:
            return
        self._shown[label] = key
        label.setText(text)
        if label is not self.elapsed:
            label.setStyleSheet(f"color: {self._theme.cursor}; font-weight: bold" if warn else "")


class MessageList(QWidget):
    """What happened, with times: the newest as a banner, all of it in a list, the newest on top."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.banner = QLabel()
        self.banner.setObjectName("warning")
        self.banner.setTextFormat(Qt.TextFormat.PlainText)
        self.banner.setWordWrap(True)
        self.banner.hide()
        self.list = QListWidget()
        self.list.setObjectName("recording_messages")
        self.list.setAccessibleName(self.tr("Messages"))
        self.list.setWordWrap(True)
        self.list.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.list.setMinimumHeight(60)
        self._lines: tuple[str, ...] = ()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.list, 1)

    def sizeHint(self) -> QSize:
        """Prefer a few lines."""
        return QSize(300, 120)

    def show_lines(self, lines: Sequence[str], banner: str) -> None:
        """List these, oldest first; ``banner`` is said large, empty hides it."""
        if tuple(lines) != self._lines:
            self._lines = tuple(lines)
            self.list.clear()
            for line in reversed(self._lines[-_MESSAGES:]):
                self.list.addItem(QListWidgetItem(line))
            self.list.scrollToTop()
        if banner != self.banner.text():
            self.banner.setText(banner)
        self.banner.setVisible(bool(banner))
