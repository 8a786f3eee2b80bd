"""Which devices are recorded: the sound input by name, rate and channels; the IMU by its wire or network address."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QComboBox, QFormLayout, QHBoxLayout, QLineEdit, QPushButton, QSpinBox, QWidget

from widgets.quiet_combo import QuietCombo
from widgets.recording_words import rate_text

DEFAULT, NONE, AUTO = "default", "none", "auto"
RATES_HZ = (16_000, 22_050, 32_000, 44_100, 48_000, 88_200, 96_000, 176_400, 192_000)
BAUDS = (9600, 57_600, 115_200, 230_400, 460_800, 921_600, 1_000_000, 2_000_000)
PROTOCOLS = ("auto", "frames", "csv", "printed", "ximu3")
_HEIGHT = 40


@dataclass(frozen=True)
class SoundWish:
    """A sound input by name, ``default`` or ``none``; a rate of None is one that suits the device."""

    name: str = DEFAULT
    rate_hz: int | None = None
    channels: int = 1


@dataclass(frozen=True)
class MotionWish:
    """An IMU: ``kind`` is ``none``, ``serial``, ``tcp`` or ``udp``; ``address`` a serial port or a host."""

    kind: str = NONE
    address: str = ""
    port: int = 0
    baud: int = 115_200
    protocol: str = AUTO


@dataclass(frozen=True)
class FoundSound:
    """A sound input that is there."""

    name: str
    channels: int


@dataclass(frozen=True)
class FoundPort:
    """A serial port that is there; ``label`` says what hangs on it."""

    address: str
    label: str


class DeviceForm(QWidget):
    """Two boxes of choices; every change comes out as ``changed``, once."""

    changed = Signal()
    search_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._quiet = True
        self._sounds: tuple[FoundSound, ...] = ()
        self._build_sound()
        self._build_motion()
        self.search = QPushButton(self.tr("Search again"))
        self.search.setObjectName("search_devices")
        self.search.setMinimumHeight(_HEIGHT)
        self.search.setToolTip(self.tr("Look for devices that were plugged in since"))
        self.search.clicked.connect(self.search_asked)
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 0, 0)
        form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        form.addRow(self.tr("Sound"), self._sound)
        form.addRow("", _row(self._rate, self._channels))
        form.addRow(self.tr("IMU"), _row(self._kind, self._protocol))
        form.addRow("", self._address_row)
        form.addRow("", self.search)
        self.set_found((), ())
        self.set_wishes(SoundWish(), MotionWish())

    # --- building ---

    def _build_sound(self) -> None:
        self._sound = self._combo("sound_device", self.tr("Sound device"))
        self._sound.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._sound.setMinimumContentsLength(14)
        self._rate = self._combo("sound_rate", self.tr("Sample rate"))
        self._rate.addItem(self.tr("rate: auto"), None)
        for rate in RATES_HZ:
            self._rate.addItem(rate_text(rate), rate)
        self._channels = self._combo("sound_channels", self.tr("Channels"))

    def _build_motion(self) -> None:
        self._kind = self._combo("imu_kind", self.tr("Connection of the IMU"))
        for kind, text in (
            (NONE, self.tr("none")),
            ("serial", self.tr("serial (USB)")),
            ("tcp", self.tr("network TCP")),
            ("udp", self.tr("network UDP")),
        ):
            self._kind.addItem(text, kind)
        self._protocol = self._combo("imu_protocol", self.tr("Protocol of the IMU"))
        for name in PROTOCOLS:
            self._protocol.addItem(self._protocol_text(name), name)
        self._serial = self._combo("imu_port", self.tr("Serial port"))
        self._serial.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._serial.setMinimumContentsLength(10)
        self._baud = self._combo("imu_baud", self.tr("Baud rate"))
        for baud in BAUDS:
            self._baud.addItem(str(baud), baud)
        self._host = QLineEdit()
        self._host.setObjectName("imu_host")
        self._host.setMinimumHeight(_HEIGHT)
        self._host.editingFinished.connect(self._on_edited)
        self._port = QSpinBox()
        self._port.setObjectName("imu_network_port")
        self._port.setRange(1, 65_535)
        self._port.setMinimumHeight(_HEIGHT)
        self._port.setAccessibleName(self.tr("Port"))
        self._port.setKeyboardTracking(False)
        self._port.valueChanged.connect(self._on_edited)
        self._address_row = _row(self._serial, self._baud, self._host, self._port)

    def _protocol_text(self, name: str) -> str:
        return {
            "auto": self.tr("protocol: auto"),
            "frames": self.tr("binary frames"),
            "csv": self.tr("CSV lines"),
            "printed": self.tr("printed lines"),
            "ximu3": "x-IMU3",
        }[name]

    def _combo(self, name: str, title: str) -> QuietCombo:
        combo = QuietCombo()
        combo.setObjectName(name)
        combo.setAccessibleName(title)
        combo.setToolTip(title)
        combo.setMinimumHeight(_HEIGHT)
        combo.currentIndexChanged.connect(self._on_edited)
        return combo

    # --- what is there ---

    def set_found(self, sounds: Sequence[FoundSound], ports: Sequence[FoundPort]) -> None:
        """Offer these devices; a chosen one that is not among them stays chosen, and is said to be away."""
        sound, motion = self.sound, self.motion
        self._quiet, quiet = True, self._quiet
        self._sounds = tuple(sounds)
        self._sound.clear()
        self._sound.addItem(self.tr("the system's input"), DEFAULT)
        for found in sounds:
            self._sound.addItem(found.name, found.name)
        self._sound.addItem(self.tr("none"), NONE)
        self._serial.clear()
        self._serial.addItem(self.tr("found by itself"), AUTO)
        for port in ports:
            self._serial.addItem(port.label, port.address)
        self._quiet = quiet
        self.set_wishes(sound, motion)

    def set_wishes(self, sound: SoundWish, motion: MotionWish) -> None:
        """Show these choices without a signal."""
        self._quiet = True
        _choose(self._sound, sound.name, self.tr("{name} (not there now)").format(name=sound.name))
        _choose(self._rate, sound.rate_hz, rate_text(sound.rate_hz or 0))
        self._show_channels(sound.channels)
        _choose(self._kind, motion.kind, motion.kind)
        _choose(self._protocol, motion.protocol, motion.protocol)
        if motion.kind == "serial":
            wanted = motion.address or AUTO
            _choose(self._serial, wanted, self.tr("{name} (not there now)").format(name=wanted))
        elif motion.kind in ("tcp", "udp"):
            self._host.setText(motion.address)
            self._port.setValue(motion.port or 1)
        _choose(self._baud, motion.baud, str(motion.baud))
        self._show_kind()
        self._quiet = False

    @property
    def sound(self) -> SoundWish:
        """The sound that is chosen."""
        return SoundWish(
            self._sound.currentData() or DEFAULT, self._rate.currentData(), self._channels.currentData() or 1
        )

    @property
    def motion(self) -> MotionWish:
        """The IMU that is chosen."""
        kind = self._kind.currentData() or NONE
        protocol, baud = self._protocol.currentData() or AUTO, self._baud.currentData() or 115_200
        if kind == "serial":
            return MotionWish(kind, self._serial.currentData() or AUTO, 0, baud, protocol)
        if kind in ("tcp", "udp"):
            return MotionWish(kind, self._host.text().strip(), self._port.value(), baud, protocol)
        return MotionWish(NONE, "", 0, baud, protocol)

    def set_locked(self, *, locked: bool) -> None:
        """Let nothing be changed while it is recorded."""
        self.setEnabled(not locked)

    def _show_channels(self, wanted: int) -> None:
        name = self._sound.currentData()
        most = next((found.channels for found in self._sounds if found.name == name), 2)
        self._channels.clear()
        for count in range(1, max(most, wanted, 1) + 1):
            self._channels.addItem(self.tr("channels: {count}").format(count=count), count)
        _choose(self._channels, wanted, "")
        for widget in (self._rate, self._channels):
            widget.setEnabled(name != NONE)

    def _show_kind(self) -> None:
        kind = self._kind.currentData()
        for widget in (self._serial, self._baud):
            widget.setVisible(kind == "serial")
        for field in (self._host, self._port):
            field.setVisible(kind in ("tcp", "udp"))
        self._protocol.setEnabled(kind != NONE)
        self._host.setPlaceholderText("192.168.1.1" if kind == "tcp" else self.tr("any sender"))
        self._host.setAccessibleName(self.tr("Address of the IMU"))

    def _on_edited(self) -> None:
        if self._quiet:
            return
        if self.sender() is self._sound:
            self._quiet = True
            self._show_channels(self._channels.currentData() or 1)
            self._quiet = False
        if self.sender() is self._kind:
            self._show_kind()
        self.changed.emit()


def _choose(combo: QComboBox, data: object, text_if_missing: str) -> None:
    at = combo.findData(data)
    if at < 0:
        combo.addItem(text_if_missing, data)
        at = combo.count() - 1
    combo.setCurrentIndex(at)


def _row(*widgets: QWidget) -> QHBoxLayout:
    layout = QHBoxLayout()
    layout.setSpacing(4)
    for widget in widgets:
        layout.addWidget(widget, 1)
    return layout
