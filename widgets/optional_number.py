"""A field for a number that may be left empty; takes comma and point alike, and says at once when it is no number."""

import math

from PySide6.QtCore import QLocale, Signal
from PySide6.QtWidgets import QLineEdit, QWidget


def parse_number(text: str) -> float | None:
    """Return the number in ``text`` (``1,5`` and ``1.5`` alike), None for an empty one; raises ValueError otherwise."""
    bare = "".join(text.split()).replace("−", "-").replace(",", ".")
    if not bare:
        return None
    value = float(bare)
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def number_text(value: float | None) -> str:
    """Return a number as the window's locale writes it, without needless digits; empty for None."""
    if value is None:
        return ""
    return f"{value:.10g}".replace(".", QLocale().decimalPoint()).replace("-", "−")


def converted_text(value: float | None, factor: float) -> str:
    """Return ``value / factor`` as text; of a unit that is no power of ten (feet, inches) four decimals are enough."""
    if value is None:
        return ""
    decimal = abs(math.log10(factor) - round(math.log10(factor))) < 1e-9
    return number_text(value / factor if decimal else round(value / factor, 4) + 0.0)


class OptionalNumber(QLineEdit):
    """Holds ``value / factor``: a radius kept in metres is typed in millimetres with ``factor`` 0.001."""

    value_changed = Signal()

    def __init__(
        self,
        low: float = -math.inf,
        high: float = math.inf,
        *,
        factor: float = 1.0,
        hint: str = "",
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._low, self._high, self._factor = low, high, factor
        self._value: float | None = None
        self.setMinimumHeight(40)
        self.setPlaceholderText(hint)
        self.textEdited.connect(self._on_text)
        self.editingFinished.connect(self._on_finished)

    @property
    def value(self) -> float | None:
        """The last valid number, in the unit of the survey; None where empty."""
        return self._value

    def set_value(self, value: float | None) -> None:
        """Show a number without a signal."""
        self._value = value
        self.setText(self._text())
        self._mark(good=True)

    def _text(self) -> str:
        return converted_text(self._value, self._factor)

    def _parsed(self) -> tuple[bool, float | None]:
        try:
            shown = parse_number(self.text())
        except ValueError:
            return False, None
        if shown is None:
            return True, None
        value = shown * self._factor
        return self._low <= value <= self._high, value

    def _on_text(self) -> None:
        self._mark(good=self._parsed()[0])

    def _on_finished(self) -> None:
        if self.text() == self._text():  # in feet it may stand there rounded: who typed nothing changes nothing
            self._mark(good=True)
            return
        good, value = self._parsed()
        if not good:
            self.set_value(self._value)  # back to what was there
        elif value != self._value:
            self._value = value
            self.value_changed.emit()

    def _mark(self, *, good: bool) -> None:
        self.setStyleSheet("" if good else "QLineEdit { border: 2px solid #c62828; }")
        text = self.tr("Allowed: {low} … {high}").format(
            low=converted_text(self._low, self._factor) if math.isfinite(self._low) else "−∞",
            high=converted_text(self._high, self._factor) if math.isfinite(self._high) else "∞",
        )
        self.setToolTip("" if good else text)
