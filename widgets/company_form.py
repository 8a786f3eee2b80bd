"""Who hands the report over: name, address, logo and further lines of its cover; edits come out as plain texts."""

from collections.abc import Mapping

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QImageReader, QPixmap
from PySide6.QtWidgets import (
    QFormLayout,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

PREVIEW = QSize(240, 90)
LINES_HEIGHT = 88
ONE_LINE = ("name", "contact", "licence", "footer")
MORE_LINES = ("address", "extra")


class CompanyForm(QGroupBox):
    """Signals out; it keeps no file and checks none."""

    changed = Signal(object)  # dict[str, str]: all fields, without the logo
    logo_asked = Signal()
    logo_removed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTitle(self.tr("Your company on the report"))
        self._fields: dict[str, QLineEdit | QPlainTextEdit] = {}
        form = QFormLayout(self)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.ExpandingFieldsGrow)
        form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        for name, title, hint in (
            ("name", self.tr("Company"), ""),
            ("address", self.tr("Address"), ""),
            ("contact", self.tr("Contact"), self.tr("telephone, e-mail")),
            ("licence", self.tr("Licence or project number"), ""),
            ("footer", self.tr("Foot of every page"), ""),
            ("extra", self.tr("More lines of the cover"), self.tr("one a line, for example:  Contract: 2026/17")),
        ):
            form.addRow(title, self._field(name, title, hint))
        form.addRow(self.tr("Logo"), self._logo_part())

    def _field(self, name: str, title: str, hint: str) -> QWidget:
        field: QLineEdit | QPlainTextEdit
        if name in ONE_LINE:
            field = QLineEdit()
            field.setMinimumHeight(44)
            field.editingFinished.connect(self._tell)
        else:
            field = QPlainTextEdit()
            field.setTabChangesFocus(True)
            field.setFixedHeight(LINES_HEIGHT)
            field.textChanged.connect(self._tell)
        field.setObjectName(f"company_{name}")
        field.setAccessibleName(title)
        field.setPlaceholderText(hint)
        self._fields[name] = field
        return field

    def _logo_part(self) -> QWidget:
        self._logo = QLabel()
        self._logo.setObjectName("company_logo")
        self._logo.setMinimumHeight(PREVIEW.height())
        self._logo.setAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        self._logo_words = QLabel()
        self._logo_words.setWordWrap(True)
        self._logo_words.setTextFormat(Qt.TextFormat.PlainText)
        choose = self._button("choose_logo", self.tr("Choose a logo…"))
        choose.clicked.connect(self.logo_asked)
        self._remove = self._button("remove_logo", self.tr("No logo"))
        self._remove.clicked.connect(self.logo_removed)
        buttons = QHBoxLayout()
        buttons.addWidget(choose)
        buttons.addWidget(self._remove)
        buttons.addStretch(1)
        part = QWidget()
        layout = QVBoxLayout(part)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._logo)
        layout.addWidget(self._logo_words)
        layout.addLayout(buttons)
        return part

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(44)
        return button

    def set_values(self, values: Mapping[str, str]) -> None:
        """Show these texts without a signal."""
        for name, field in self._fields.items():
            text = values.get(name, "")
            field.blockSignals(True)
            if isinstance(field, QLineEdit):
                field.setText(text)
            elif field.toPlainText() != text:
                field.setPlainText(text)
            field.blockSignals(False)

    def set_logo(self, path: str, words: str) -> None:
        """Show a logo that was looked at before, or none; ``words`` say what is good or bad about it."""
        self._logo.setPixmap(_scaled(path) if path else QPixmap())
        self._logo.setVisible(bool(path))
        self._logo_words.setText(words)
        self._remove.setEnabled(bool(path))

    def _tell(self) -> None:
        self.changed.emit(
            {
                name: field.text() if isinstance(field, QLineEdit) else field.toPlainText()
                for name, field in self._fields.items()
            }
        )


def _scaled(path: str) -> QPixmap:
    """Return the picture no larger than the preview, decoded at that size."""
    reader = QImageReader(path)
    size = reader.size()
    if size.isValid() and (size.width() > PREVIEW.width() or size.height() > PREVIEW.height()):
        reader.setScaledSize(size.scaled(PREVIEW, Qt.AspectRatioMode.KeepAspectRatio))
    return QPixmap.fromImage(reader.read())
