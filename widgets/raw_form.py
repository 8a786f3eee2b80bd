"""The small form for sound without a header: sample rate, format of a sample, channels and where the samples begin."""

from dataclasses import dataclass

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFormLayout, QLabel, QPushButton, QWidget

from widgets.optional_number import OptionalNumber
from widgets.quiet_combo import QuietCombo


@dataclass(frozen=True)
class RawAnswer:
    """What the operator said of the headerless sound."""

    sample_rate_hz: float
    bits: int
    encoding: str  # signed | float
    endian: str  # little | big
    channels: int


class RawForm(QWidget):
    """Announces a complete answer when its button is pressed."""

    answered = Signal(object)  # RawAnswer

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        hint = QLabel(self.tr("This sound has no header. The device's manual says how it was recorded."))
        hint.setWordWrap(True)
        self._rate = OptionalNumber(1000.0, 1e6)
        self._rate.setObjectName("raw_rate")
        self._rate.set_value(48000.0)
        self._kind = QuietCombo()
        self._kind.setMinimumHeight(40)
        for text, bits, encoding in (
            (self.tr("16 bit"), 16, "signed"),
            (self.tr("24 bit"), 24, "signed"),
            (self.tr("32 bit"), 32, "signed"),
            (self.tr("32 bit floating point"), 32, "float"),
        ):
            self._kind.addItem(text, (bits, encoding))
        self._order = QuietCombo()
        self._order.setMinimumHeight(40)
        self._order.addItem(self.tr("low byte first (usual)"), "little")
        self._order.addItem(self.tr("high byte first"), "big")
        self._channels = OptionalNumber(1.0, 64.0)
        self._channels.set_value(1.0)
        apply = QPushButton(self.tr("Read it so"))
        apply.setObjectName("raw_apply")
        apply.setMinimumHeight(44)
        apply.clicked.connect(self._on_apply)
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 0, 0)
        form.addRow(hint)
        form.addRow(self.tr("Samples a second"), self._rate)
        form.addRow(self.tr("A sample is"), self._kind)
        form.addRow(self.tr("Byte order"), self._order)
        form.addRow(self.tr("Channels"), self._channels)
        form.addRow(apply)

    def answer(self) -> RawAnswer | None:
        """Return what is filled in; None while a number is missing."""
        rate, channels = self._rate.value, self._channels.value
        if rate is None or channels is None:
            return None
        bits, encoding = self._kind.currentData()
        return RawAnswer(rate, int(bits), str(encoding), str(self._order.currentData()), int(channels))

    def _on_apply(self) -> None:
        answer = self.answer()
        if answer is not None:
            self.answered.emit(answer)
