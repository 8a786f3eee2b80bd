"""Words, numbers and marks that several widgets share: verdicts as shape + letter + colour, classes, figures with ±."""

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, QLocale, QPointF, Qt
from PySide6.QtGui import QColor, QGuiApplication, QIcon, QPainter, QPixmap

from processing.quantities import Places
from processing.sound.sizes import LeakSize, SizeClass
from processing.survey import Candidate, LeakClass, Motion, Severity, Verdict
from widgets.plot_theme import Theme, paint_verdict
from widgets.units import quantities

DARK_BELOW = 128  # of 255

_VERDICTS: dict[Verdict, str] = {
    Verdict.NONE: str(QT_TRANSLATE_NOOP("Vocabulary", "undecided")),
    Verdict.CONFIRMED: str(QT_TRANSLATE_NOOP("Vocabulary", "confirmed")),
    Verdict.REJECTED: str(QT_TRANSLATE_NOOP("Vocabulary", "rejected")),
    Verdict.UNSURE: str(QT_TRANSLATE_NOOP("Vocabulary", "unsure")),
}
_CLASSES: dict[LeakClass, str] = {
    LeakClass.LEAK: str(QT_TRANSLATE_NOOP("Vocabulary", "leak")),
    LeakClass.VALVE: str(QT_TRANSLATE_NOOP("Vocabulary", "valve")),
    LeakClass.BEND: str(QT_TRANSLATE_NOOP("Vocabulary", "bend")),
    LeakClass.PUMP: str(QT_TRANSLATE_NOOP("Vocabulary", "pump")),
    LeakClass.BUMP: str(QT_TRANSLATE_NOOP("Vocabulary", "bump")),
    LeakClass.AIR: str(QT_TRANSLATE_NOOP("Vocabulary", "air pocket")),
    LeakClass.TRAFFIC: str(QT_TRANSLATE_NOOP("Vocabulary", "traffic")),
    LeakClass.UNKNOWN: str(QT_TRANSLATE_NOOP("Vocabulary", "unknown")),
}
_SIZES: dict[SizeClass, str] = {
    SizeClass.SMALL: str(QT_TRANSLATE_NOOP("Vocabulary", "small")),
    SizeClass.MEDIUM: str(QT_TRANSLATE_NOOP("Vocabulary", "medium")),
    SizeClass.LARGE: str(QT_TRANSLATE_NOOP("Vocabulary", "large")),
}
_MOTIONS: dict[Motion, str] = {
    Motion.ROLLING: str(QT_TRANSLATE_NOOP("Vocabulary", "rolling ball")),
    Motion.CARRIED: str(QT_TRANSLATE_NOOP("Vocabulary", "carried or pulled")),
    Motion.FOOT: str(QT_TRANSLATE_NOOP("Vocabulary", "on a foot")),
}
_AT_UNIT = str(QT_TRANSLATE_NOOP("Vocabulary", "At ({unit})"))
_AT = str(QT_TRANSLATE_NOOP("Vocabulary", "At"))
_SEVERITIES: dict[Severity, str] = {
    Severity.INFO: str(QT_TRANSLATE_NOOP("Vocabulary", "good to know")),
    Severity.REPAIRED: str(QT_TRANSLATE_NOOP("Vocabulary", "repaired")),
    Severity.MASKED: str(QT_TRANSLATE_NOOP("Vocabulary", "not assessed")),
    Severity.WARNING: str(QT_TRANSLATE_NOOP("Vocabulary", "please look")),
}


def _words(text: str) -> str:
    return QCoreApplication.translate("Vocabulary", text)


def verdict_text(verdict: Verdict) -> str:
    """Return the verdict as a word in the window's language."""
    return _words(_VERDICTS[verdict])


def class_text(leak_class: LeakClass) -> str:
    """Return the class as a word in the window's language."""
    return _words(_CLASSES[leak_class])


def size_text(size: LeakSize | None) -> str:
    """Return a leak's size in the window's language, ``small–medium`` where it may be either; empty if unknown."""
    if size is None or size.size is SizeClass.UNKNOWN:
        return ""
    return "–".join(_words(_SIZES[SizeClass(part)]) for part in size.name.split("-"))


def motion_text(motion: Motion) -> str:
    """Return the motion as words in the window's language."""
    return _words(_MOTIONS[motion])


def severity_text(severity: Severity) -> str:
    """Return what a severity means to the operator."""
    return _words(_SEVERITIES[severity])


def number(value: float | None, digits: int) -> str:
    """Return a number by the window's locale with a true minus, never a minus zero; a dash where there is none."""
    if value is None or value != value:  # NaN
        return "–"
    rounded = round(float(value), digits) + 0.0
    return QLocale().toString(rounded, "f", digits).replace("-", "−")


def chance_text(probability: float) -> str:
    """Return a probability in per cent as words may claim it: never 0 and never 100, nothing here is certain."""
    percent = round(100.0 * probability)
    text = _words(str(QT_TRANSLATE_NOOP("Vocabulary", "{percent} %"))).format(percent=min(max(percent, 1), 99))
    return f"< {text}" if percent < 1 else f"> {text}" if percent > 99 else text


def frequency_text(hz: float) -> str:
    """Return a frequency to two digits or so: ``430 Hz``, ``3.9 kHz``."""
    return f"{number(round(hz, -1), 0)} Hz" if hz < 999.5 else f"{number(hz / 1000.0, 1)} kHz"


def clock_text(time_s: float) -> str:
    """Return survey seconds as ``h:mm:ss.t`` (``m:ss.t`` under an hour)."""
    sign = "−" if time_s < 0 else ""
    tenths = round(abs(time_s) * 10)
    seconds, tenth = divmod(tenths, 10)
    minutes, second = divmod(seconds, 60)
    hours, minute = divmod(minutes, 60)
    point = QLocale().decimalPoint()
    head = f"{hours}:{minute:02d}" if hours else f"{minute}"
    return f"{sign}{head}:{second:02d}{point}{tenth}"


def half_width_m(candidate: Candidate) -> float:
    """Return the ± of the candidate's chainage: half of its 95 % interval, metres."""
    return (candidate.chainage_high95_m - candidate.chainage_low95_m) / 2.0


def warning_colour() -> QColor:
    """Return the red of a warning that is legible on a list's ground, dark or light."""
    dark = QGuiApplication.palette().base().color().lightness() < DARK_BELOW
    return QColor("#ff8fa3" if dark else "#c3124b")


def place_text(candidate: Candidate) -> str:
    """Return a candidate's place with its ±, each with its unit: never one without the other."""
    return place_and_width(candidate.chainage_m, half_width_m(candidate))


def place_and_width(chainage_m: float | None, half_m: float | None) -> str:
    """Return a place and its 95 % ±: ``123.4 m ± 1.2 m``, ``0+123.4 ± 1.2 m``, ``404.9 ft ± 3.9 ft``."""
    told = quantities()
    return f"{told.place(chainage_m)} ± {told.length(half_m)}"


def place_title() -> str:
    """Return the title of a column of places: with the unit, except where the figures are stations."""
    told = quantities()
    if told.places is Places.STATIONING:
        return _words(_AT)
    return _words(_AT_UNIT).format(unit=told.length_unit)


def width_title() -> str:
    """Return the title of a column of 95 % half-widths."""
    return f"± {quantities().length_unit}"


def place_cell(chainage_m: float | None) -> str:
    """Return a place for a column that :func:`place_title` stands over."""
    told = quantities()
    return told.place(chainage_m) if told.places is Places.STATIONING else length_cell(chainage_m)


def length_cell(metres: float | None, digits: int = 1) -> str:
    """Return a length for a column whose title has the unit."""
    told = quantities()
    return told.number(None if metres is None else metres * told.length_factor, digits)


def verdict_icon(theme: Theme, verdict: Verdict, size: int = 24) -> QIcon:
    """Return the mark of a verdict as the views draw it: a shape and a sign of its own, readable without colour."""
    scale = 2  # crisp on displays with two pixels a point
    pixmap = QPixmap(size * scale, size * scale)
    pixmap.setDevicePixelRatio(scale)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    paint_verdict(painter, theme, verdict, QPointF(size / 2, size / 2), size * 0.34)
    painter.end()
    icon = QIcon(pixmap)
    icon.addPixmap(pixmap, QIcon.Mode.Selected)  # a selected row must not tint the colour away
    return icon
