"""Buttons for listening: play, loop the candidate, volume; or a hint why this machine cannot play."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QSlider, QStyle, QWidget


class PlaybackBar(QWidget):
    """Signals out; it plays nothing itself."""

    play_asked = Signal()
    loop_asked = Signal()
    volume_changed = Signal(float)  # 0..1
    band_changed = Signal(bool)  # hear only the leak band

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
        self._band = QCheckBox(self.tr("Leak band only"))
        self._band.setMinimumHeight(40)
        self._band.setToolTip(self.tr("Hear only the band in which leaks are looked for"))
        self._band.toggled.connect(self.band_changed)
        self._hint = QLabel()
        self._hint.setObjectName("playback_hint")
        self._hint.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for widget in (self._play, self._loop, self._band, self._volume):
            layout.addWidget(widget)
        layout.addWidget(self._hint, 1)
        self.set_playing(playing=False, looping=False)

    def _button(self, name: str, tip: str) -> QPushButton:
        button = QPushButton()
        button.setObjectName(name)
        button.setToolTip(tip)
        button.setMinimumSize(64, 44)
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # its key is Space, everywhere on the page
        return button

    def set_available(self, hint: str, reason: str = "") -> None:
        """Switch everything on, or off with ``hint`` saying why; ``reason`` is the long story, as a tool tip."""
        for widget in (self._play, self._loop, self._volume, self._band):
            widget.setEnabled(not hint)
        self._hint.setText(hint)
        self._hint.setToolTip(reason)

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

    def set_band_only(self, *, on: bool) -> None:
        """Show the band choice without a signal."""
        self._band.blockSignals(True)
        self._band.setChecked(on)
        self._band.blockSignals(False)

    def _on_loop(self) -> None:
        self._loop.setChecked(not self._loop.isChecked())  # set_playing says what is true
        self.loop_asked.emit()
