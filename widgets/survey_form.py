"""The form for everything of ``survey.toml`` except tie points: edits come out as whole, new :class:`Survey` values."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QFormLayout,
    QGridLayout,
    QGroupBox,
    QLabel,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from processing.survey import AudioInfo, Motion, Route, Survey
from widgets import units
from widgets.method_panel import MethodRow
from widgets.optional_number import OptionalNumber
from widgets.quiet_combo import QuietCombo
from widgets.vocabulary import motion_text


class SurveyForm(QWidget):
    """``methods`` gives the choices of each processing step, ``auto`` first: ``{"orientation": (row, …), …}``."""

    survey_changed = Signal(object)  # Survey
    route_import_asked = Signal()
    route_removed = Signal()
    presets_asked = Signal()

    def __init__(self, methods: dict[str, tuple[MethodRow, ...]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._survey = Survey()
        self._quiet = False
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for box in (
            self._run_box(),
            self._pipe_box(),
            self._launch_box(),
            self._route_box(),
            self._sound_box(),
            self._method_box(methods),
        ):
            layout.addWidget(box)
        layout.addStretch(1)

    # --- building ---

    def _run_box(self) -> QGroupBox:
        self._name, self._operator = self._line("name"), self._line("operator")
        self._date, self._client = self._line("date"), self._line("client")
        self._date.setPlaceholderText("2026-05-04")
        self._date.setInputMask("")
        return self._box(
            self.tr("Survey"),
            (self.tr("Name"), self._name),
            (self.tr("Operator"), self._operator),
            (self.tr("Date"), self._date),
            (self.tr("Client"), self._client),
        )

    def _pipe_box(self) -> QGroupBox:
        self._motion = self._combo("motion")
        for motion in Motion:
            self._motion.addItem(motion_text(motion), motion)
        small, length, pressure = units.small_unit(), units.length_unit(), units.pressure_unit()
        self._radius = self._number("radius", 0.005, 2.0, factor=small.factor)
        self._material = self._combo("material")
        self._material.setEditable(True)
        self._material.addItems(["", *self._materials()])
        line = self._material.lineEdit()
        if line is not None:
            line.editingFinished.connect(self._changed)
        self._diameter = self._number("diameter", 0.01, 10.0, factor=small.factor)
        self._length = self._number("length", 0.1, 1e6, factor=length.factor, hint=self.tr("unknown"))
        self._joints = self._number("joint_spacing", 0.5, 100.0, factor=length.factor, hint=self.tr("found by itself"))
        self._joints.setToolTip(self.tr("Length of one pipe from joint to joint: the bumps then count the way"))
        self._pressure = self._number("pressure", 0.01, 100.0, factor=pressure.factor, hint=self.tr("unknown"))
        self._pressure.setToolTip(self.tr("In the pipe during the run: the size of leaks is told with it"))
        self._preset = self._combo("preset")
        self._preset.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._preset.setMinimumContentsLength(18)
        self.set_presets(())
        self._presets = self._button("presets", self.tr("Table of presets…"))
        self._presets.clicked.connect(self.presets_asked)
        return self._box(
            self.tr("Device and pipe"),
            (self.tr("The device is"), self._motion),
            (self.tr("Rolling radius ({unit})").format(unit=small.sign), self._radius),
            (self.tr("Pipe material"), self._material),
            (self.tr("Inner diameter ({unit})").format(unit=small.sign), self._diameter),
            (self.tr("Surveyed length ({unit})").format(unit=length.sign), self._length),
            (self.tr("Joint to joint ({unit})").format(unit=length.sign), self._joints),
            (self.tr("Pressure ({unit})").format(unit=pressure.sign), self._pressure),
            (self.tr("Sound preset"), self._preset),
            ("", self._presets),
        )

    def set_presets(self, rows: Sequence[tuple[str, str, str]], automatic: str = "") -> None:
        """Offer these presets (key, title, tip); ``automatic`` is the title of the one that fits the pipe."""
        quiet, self._quiet = self._quiet, True
        wanted = self._survey.processing.preset
        self._preset.clear()
        text = self.tr("automatic: {preset}").format(preset=automatic) if automatic else self.tr("automatic")
        self._preset.addItem(text, "auto")
        self._preset.addItem(self.tr("none"), "none")
        for key, title, tip in rows:
            self._preset.addItem(title, key)
            self._preset.setItemData(self._preset.count() - 1, tip, Qt.ItemDataRole.ToolTipRole)
        self._show_preset(wanted)
        self._quiet = quiet

    def _show_preset(self, key: str) -> None:
        if self._preset.findData(key) < 0:
            self._preset.addItem(key, key)
        self._preset.setCurrentIndex(self._preset.findData(key))

    def _materials(self) -> tuple[str, ...]:
        iron = self.tr("ductile iron"), self.tr("cast iron"), self.tr("steel")
        return *iron, self.tr("asbestos cement"), "PVC", "PE100", "PE80", self.tr("concrete"), self.tr("GRP")

    def _launch_box(self) -> QGroupBox:
        unknown = self.tr("unknown")
        self._latitude = self._number("latitude", -90.0, 90.0, hint=unknown)
        self._longitude = self._number("longitude", -180.0, 180.0, hint=unknown)
        self._east = self._number("east", -1e8, 1e8, hint=unknown)
        self._north = self._number("north", -1e8, 1e8, hint=unknown)
        self._crs = self._line("crs")
        self._crs.setPlaceholderText("EPSG:5254")
        height = units.length_unit()
        self._elevation = self._number("elevation", -500.0, 9000.0, factor=height.factor, hint=unknown)
        self._heading = self._number("heading", -360.0, 360.0, hint=unknown)
        return self._box(
            self.tr("Launch point"),
            (self.tr("Latitude (°)"), self._latitude),
            (self.tr("Longitude (°)"), self._longitude),
            (self.tr("or East (m)"), self._east),
            (self.tr("and North (m)"), self._north),
            (self.tr("in the system"), self._crs),
            (self.tr("Elevation ({unit})").format(unit=height.sign), self._elevation),
            (self.tr("First heading (° from north)"), self._heading),
        )

    def _route_box(self) -> QGroupBox:
        self._route = QLabel()
        self._route.setTextFormat(Qt.TextFormat.PlainText)
        self._route.setWordWrap(True)
        self._remove_route = self._button("remove_route", self.tr("Remove route"))
        self._remove_route.clicked.connect(self.route_removed)
        ask = self._button("import_route", self.tr("Import route…"))
        ask.clicked.connect(self.route_import_asked)
        box = QGroupBox(self.tr("Mapped route"))
        grid = QGridLayout(box)
        grid.addWidget(self._route, 0, 0, 1, 2)
        grid.addWidget(ask, 1, 0)
        grid.addWidget(self._remove_route, 1, 1)
        return box

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(44)
        return button

    def _show_route(self, route: Route | None) -> None:
        self._remove_route.setEnabled(route is not None)
        if route is None:
            self._route.setText(self.tr("None. With the pipe's line from the map the path cannot leave it."))
            return
        length_m = sum(math.dist(a, b) for a, b in pairwise(route.points))
        system = self.tr("local metres") if route.crs == "local" else route.crs
        text = self.tr("{length}, {count} points, {system}, ± {sigma} (1σ)")
        self._route.setText(
            text.format(
                length=units.quantities().length(length_m),
                count=len(route.points),
                system=system,
                sigma=units.quantities().length(route.sigma_m),
            )
        )

    def _sound_box(self) -> QGroupBox:
        estimated = self.tr("found by itself")
        self._channel = self._number("channel", 0, 63)
        self._start = self._number("audio_start", -86400.0, 86400.0, hint=estimated)
        self._drift = self._number("drift", -1000.0, 1000.0, hint=estimated)
        return self._box(
            self.tr("Sound"),
            (self.tr("Channel (from 0)"), self._channel),
            (self.tr("Sound begins at (s)"), self._start),
            (self.tr("Clock drift (ppm)"), self._drift),
        )

    def _method_box(self, methods: dict[str, tuple[MethodRow, ...]]) -> QGroupBox:
        self._orientation, self._position = self._combo("orientation"), self._combo("position")
        self._detector = self._combo("detector")
        self._methods = {"orientation": self._orientation, "position": self._position, "detector": self._detector}
        for step, combo in self._methods.items():
            for method in methods[step]:
                combo.addItem(self.tr("automatic") if method.name == "auto" else method.title, method.name)
                combo.setItemData(combo.count() - 1, method.words, Qt.ItemDataRole.ToolTipRole)
            # a long title must not widen the whole form
            combo.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            combo.setMinimumContentsLength(18)
        return self._box(
            self.tr("Method"),
            (self.tr("Orientation"), self._orientation),
            (self.tr("Position"), self._position),
            (self.tr("Leak finder"), self._detector),
        )

    def _box(self, title: str, *rows: tuple[str, QWidget]) -> QGroupBox:
        box = QGroupBox(title)
        form = QFormLayout(box)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.ExpandingFieldsGrow)
        form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        for text, widget in rows:
            label = QLabel(text)
            label.setMinimumHeight(widget.minimumHeight())
            label.setBuddy(widget)
            widget.setAccessibleName(text)
            form.addRow(label, widget)
        return box

    def _line(self, name: str) -> QLineEdit:
        line = QLineEdit()
        line.setObjectName(name)
        line.setMinimumHeight(40)
        line.editingFinished.connect(self._changed)
        return line

    def _number(self, name: str, low: float, high: float, *, factor: float = 1.0, hint: str = "") -> OptionalNumber:
        field = OptionalNumber(low, high, factor=factor, hint=hint)
        field.setObjectName(name)
        field.value_changed.connect(self._changed)
        return field

    def _combo(self, name: str) -> QComboBox:
        combo = QuietCombo()
        combo.setObjectName(name)
        combo.setMinimumHeight(40)
        combo.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        combo.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        combo.activated.connect(self._changed)
        return combo

    # --- values ---

    def set_survey(self, survey: Survey) -> None:
        """Show a survey without a signal."""
        self._survey = survey
        self._quiet = True
        for line, text in (
            (self._name, survey.info.name),
            (self._operator, survey.info.operator),
            (self._date, survey.info.date),
            (self._client, survey.info.client),
            (self._crs, survey.launch.crs or ""),
        ):
            line.setText(text)
        self._motion.setCurrentIndex(self._motion.findData(survey.device.motion))
        self._material.setCurrentText(survey.pipe.material)
        self._show_preset(survey.processing.preset)
        for field, value in self._numbers(survey):
            field.set_value(value)
        for step, combo in self._methods.items():
            method = getattr(survey.processing, step)
            if combo.findData(method) < 0:
                combo.addItem(method, method)
            combo.setCurrentIndex(combo.findData(method))
        self._show_needs(survey.device.motion)
        self._show_route(survey.route)
        self._quiet = False

    def _numbers(self, survey: Survey) -> tuple[tuple[OptionalNumber, float | None], ...]:
        launch, audio = survey.launch, survey.audio
        return (
            (self._radius, survey.device.radius_m),
            (self._diameter, survey.pipe.diameter_m),
            (self._length, survey.pipe.length_m),
            (self._joints, survey.pipe.joint_spacing_m),
            (self._pressure, survey.pipe.pressure_bar),
            (self._latitude, launch.latitude),
            (self._longitude, launch.longitude),
            (self._east, launch.east_m),
            (self._north, launch.north_m),
            (self._elevation, launch.elevation_m),
            (self._heading, launch.heading_deg),
            (self._channel, float(audio.channel)),
            (self._start, audio.start_time_s),
            (self._drift, audio.drift_ppm),
        )

    def _audio(self) -> AudioInfo:
        """Return what the form says of the sound; a clock that was typed is no measurement any more."""
        audio = replace(
            self._survey.audio,
            channel=int(self._channel.value or 0),
            start_time_s=self._start.value,
            drift_ppm=self._drift.value,
        )
        before = self._survey.audio
        if (audio.start_time_s, audio.drift_ppm) == (before.start_time_s, before.drift_ppm):
            return audio
        return replace(audio, start_sigma_s=None, drift_sigma_ppm=None)

    def survey(self) -> Survey:
        """Return what the form says; tie points and route are those of the survey that was set."""
        return replace(
            self._survey,
            info=replace(
                self._survey.info,
                name=self._name.text().strip(),
                operator=self._operator.text().strip(),
                date=self._date.text().strip(),
                client=self._client.text().strip(),
            ),
            pipe=replace(
                self._survey.pipe,
                material=self._material.currentText().strip(),
                diameter_m=self._diameter.value,
                length_m=self._length.value,
                joint_spacing_m=self._joints.value,
                pressure_bar=self._pressure.value,
            ),
            device=replace(self._survey.device, motion=Motion(self._motion.currentData()), radius_m=self._radius.value),
            audio=self._audio(),
            launch=replace(
                self._survey.launch,
                latitude=self._latitude.value,
                longitude=self._longitude.value,
                east_m=self._east.value,
                north_m=self._north.value,
                crs=self._crs.text().strip() or None,
                elevation_m=self._elevation.value,
                heading_deg=self._heading.value,
            ),
            processing=replace(
                self._survey.processing,
                orientation=str(self._orientation.currentData()),
                position=str(self._position.currentData()),
                detector=str(self._detector.currentData()),
                preset=str(self._preset.currentData()),
            ),
        )

    def _show_needs(self, motion: Any) -> None:  # noqa: ANN401  # combo data
        self._radius.setEnabled(motion == Motion.ROLLING)
        self._radius.setPlaceholderText(self.tr("needed") if motion == Motion.ROLLING else "")

    def _changed(self) -> None:
        if self._quiet:
            return
        survey = self.survey()
        if survey != self._survey:
            self._survey = survey
            self._show_needs(survey.device.motion)
            self.survey_changed.emit(survey)
