"""Buttons for listening: play, loop, raw or cleaned, band, slow, volume; or a hint why this machine cannot play."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QFont, QFontMetrics
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSizePolicy, QSlider, QStyle, QWidget

from widgets.quiet_combo import QuietCombo


class PlaybackBar(QWidget):
    """Signals out; it plays nothing itself."""

    play_asked = Signal()
    loop_asked = Signal()
    volume_changed = Signal(float)  # 0..1
    cleaned_asked = Signal()  # the other of raw and cleaned
    band_chosen = Signal(str)  # whole, leaks, candidate
    slow_chosen = Signal(int)  # times as long

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._play = self._button("play", self.tr("Play or pause (Space)"))
        self._play.clicked.connect(self.play_asked)
        self._loop = self._button("loop", self.tr("Play the candidate again and again (Shift+Space)"))
        self._loop.setCheckable(True)
        self._loop.setText(self.tr("Loop candidate"))
        self._loop.clicked.connect(self._on_loop)
        self._volume = QSlider(Qt.Orientation.Horizontal)
        self._volume.setRange(0, 100)
        self._volume.setMinimumSize(90, 40)
        self._volume.setMaximumWidth(180)
        self._volume.setAccessibleName(self.tr("Volume"))
        self._volume.setToolTip(self.tr("Volume"))
        self._volume.valueChanged.connect(lambda value: self.volume_changed.emit(value / 100))
        self._cleaned = self._button("cleaned", "")
        self._cleaned.setCheckable(True)
        self._cleaned.setText(self.tr("Cleaned"))
        bold = QFont(self._cleaned.font())
        bold.setBold(True)  # as a checked button is drawn
        self._cleaned.setMinimumWidth(QFontMetrics(bold).horizontalAdvance(self._cleaned.text()) + 36)
        self._cleaned.clicked.connect(self._on_cleaned)
        self._band = self._choice("band", self.tr("What is heard (B)"))
        for name, text in (
            ("whole", self.tr("All of it")),
            ("leaks", self.tr("Leak band")),
            ("candidate", self.tr("Candidate's band")),
        ):
            self._band.addItem(text, name)
        self._band.activated.connect(lambda _row: self.band_chosen.emit(str(self._band.currentData())))
        self._slow = self._choice("slow", self.tr("How fast it is heard, at the same pitch (S)"))
        for times, text in ((1, "1×"), (2, "½×"), (4, "¼×")):
            self._slow.addItem(text, times)
        self._slow.activated.connect(lambda _row: self.slow_chosen.emit(int(self._slow.currentData())))
        self._unavailable, self._reason, self._note = "", "", ""
        self._hint = QLabel()
        self._hint.setObjectName("playback_hint")
        self._hint.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for widget in (self._play, self._loop, self._cleaned, self._band, self._slow, self._volume):
            layout.addWidget(widget)
        layout.addWidget(self._hint, 1)
        self.set_playing(playing=False, looping=False)
        self.set_cleaned(on=False)

    def _button(self, name: str, tip: str) -> QPushButton:
        button = QPushButton()
        button.setObjectName(name)
        button.setToolTip(tip)
        button.setMinimumHeight(44)  # not the width: that would let the word be cut
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # its key is Space, everywhere on the page
        return button

    def _choice(self, name: str, tip: str) -> QuietCombo:
        combo = QuietCombo()
        combo.setObjectName(name)
        combo.setToolTip(tip)
        combo.setAccessibleName(tip)
        combo.setMinimumHeight(40)
        combo.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        return combo

    def set_available(self, hint: str, reason: str = "") -> None:
        """Switch everything on, or off with ``hint`` saying why; ``reason`` is the long story, as a tool tip."""
        for widget in (self._play, self._loop, self._volume, self._band, self._slow):
            widget.setEnabled(not hint)
        self._volume.setVisible(not hint.strip())  # why nothing is heard needs the room, and is never cut
        bold = QFont(self._hint.font())
        bold.setBold(True)  # as some themes draw it
        self._hint.setMinimumWidth(QFontMetrics(bold).horizontalAdvance(hint.strip()))
        self._unavailable, self._reason = hint, reason
        self._tell()

    def set_note(self, note: str) -> None:
        """Say something about what is heard and seen, beside a hint where there is one."""
        self._note = note
        self._tell()

    def _tell(self) -> None:
        told = [text for text in (self._unavailable.strip(), self._note) if text]
        self._hint.setText("  ·  ".join(told))
        self._hint.setToolTip("\n".join(text for text in (self._reason, self._note) if text))

    def set_playing(self, *, playing: bool, looping: bool) -> None:
        """Show what is going on."""
        icons = QStyle.StandardPixmap
        self._play.setIcon(self.style().standardIcon(icons.SP_MediaPause if playing else icons.SP_MediaPlay))
        self._play.setText(self.tr("Pause") if playing else self.tr("Play"))
        self._loop.setChecked(looping)

    def set_volume(self, volume: float) -> None:
        """Show a volume (0..1) without a signal."""
        self._volume.blockSignals(True)
        self._volume.setValue(round(100 * volume))
        self._volume.blockSignals(False)

    def set_band(self, name: str) -> None:
        """Show the choice of band without a signal."""
        self._band.setCurrentIndex(max(0, self._band.findData(name)))

    def set_slow(self, times: int) -> None:
        """Show the slowness without a signal."""
        self._slow.setCurrentIndex(max(0, self._slow.findData(times)))

    def set_cleaned(self, *, on: bool, reason: str = "") -> None:
        """Show whether the sound is cleaned; a ``reason`` why it cannot be switches the button off."""
        self._cleaned.setChecked(on)
        self._cleaned.setEnabled(not reason)
        usual = self.tr("Raw sound, or without the noise of the ball's own rolling, in sound and picture (A)")
        self._cleaned.setToolTip(reason or usual)

    def _on_loop(self) -> None:
        self._loop.setChecked(not self._loop.isChecked())  # set_playing says what is true
        self.loop_asked.emit()

    def _on_cleaned(self) -> None:
        self._cleaned.setChecked(not self._cleaned.isChecked())  # set_cleaned says what is true
        self.cleaned_asked.emit()
