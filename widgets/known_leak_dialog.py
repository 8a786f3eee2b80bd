"""Asks how much a known leak loses: an opened tap that the ball passed, beside which other leaks are sized."""

from dataclasses import dataclass

from PySide6.QtWidgets import QDialog, QDialogButtonBox, QFormLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from widgets import units
from widgets.optional_number import OptionalNumber

HEIGHT = 44


@dataclass(frozen=True)
class KnownFlow:
    """What was measured at a known leak: litres a minute, and the pressure in the pipe there (None: not known)."""

    flow_lpm: float
    pressure_bar: float | None


class KnownLeakDialog(QDialog):
    """``answer`` is what was typed; ``removed`` says that this is no known leak any more."""

    def __init__(self, name: str, known: KnownFlow | None, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.removed = False
        self.setWindowTitle(self.tr("Known leak"))
        about = QLabel(
            self.tr(
                "{name}: how much water came out here while the device passed? A tap opened near the launch and "
                "measured with a bucket will do. Other leaks of this run are then sized beside it."
            ).format(name=name)
        )
        about.setWordWrap(True)
        flow, pressure = units.flow_unit(), units.pressure_unit()
        titles = (
            self.tr("Flow ({unit})").format(unit=flow.sign),
            self.tr("Pressure ({unit})").format(unit=pressure.sign),
        )
        self._flow = OptionalNumber(0.001, 1e6, factor=flow.factor, hint=self.tr("needed"))
        self._flow.setObjectName("known_flow")
        self._pressure = OptionalNumber(0.01, 100.0, factor=pressure.factor, hint=self.tr("not known"))
        self._pressure.setObjectName("known_pressure")
        for field, title in zip((self._flow, self._pressure), titles, strict=True):
            field.setMinimumHeight(HEIGHT)
            field.setAccessibleName(title)
        if known is not None:
            self._flow.set_value(known.flow_lpm)
            self._pressure.set_value(known.pressure_bar)
        form = QFormLayout()
        form.addRow(titles[0], self._flow)
        form.addRow(titles[1], self._pressure)
        self._buttons = QDialogButtonBox()
        self._keep = self._button(self.tr("Size others beside it"), QDialogButtonBox.ButtonRole.AcceptRole)
        self._button(self.tr("Cancel"), QDialogButtonBox.ButtonRole.RejectRole)
        if known is not None:
            remove = self._button(self.tr("No known leak"), QDialogButtonBox.ButtonRole.DestructiveRole)
            remove.clicked.connect(self._remove)
        self._buttons.accepted.connect(self.accept)
        self._buttons.rejected.connect(self.reject)
        self._flow.value_changed.connect(self._check)
        self._pressure.value_changed.connect(self._check)
        layout = QVBoxLayout(self)
        layout.addWidget(about)
        layout.addLayout(form)
        layout.addWidget(self._buttons)
        self.setMinimumWidth(420)
        self._check()

    @property
    def answer(self) -> KnownFlow | None:
        """What was typed; None while the flow is missing or no number, or after "No known leak"."""
        flow = self._flow.value
        return None if self.removed or flow is None else KnownFlow(flow, self._pressure.value)

    def _button(self, text: str, role: QDialogButtonBox.ButtonRole) -> QPushButton:
        button = self._buttons.addButton(text, role)
        button.setMinimumHeight(HEIGHT)
        return button

    def _check(self) -> None:
        self._keep.setEnabled(self._flow.value is not None)

    def _remove(self) -> None:
        self.removed = True
        self.accept()
