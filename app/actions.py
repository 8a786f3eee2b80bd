"""Every user action is one row here: menus, toolbar, key sheet, manual and tests come from this table.

A row's ``handler`` is a path below the main window: ``review.confirm`` is ``window.review.confirm``. Keys are chosen
for a Turkish Q keyboard without AltGr: no punctuation, no letter I. Keys without Ctrl or F rest while a text field has
the focus.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, QObject
from PySide6.QtGui import QAction, QKeySequence


class Page(StrEnum):
    """Where an action belongs: the menu it stands in, and when its keys are alive."""

    FILE = "file"
    EDIT = "edit"
    REVIEW = "review"
    PLAY = "play"
    VIEW = "view"
    HELP = "help"


class Needs(StrEnum):
    """What must be there before an action makes sense."""

    NOTHING = "nothing"
    SURVEY = "survey"  # a survey folder is open
    RESULTS = "results"  # it has been processed, and a review page is in front
    CANDIDATE = "candidate"  # and a candidate is selected
    WRITABLE = "writable"  # and the survey may be changed
    RECORDING = "recording"  # the recording page is in front


@dataclass(frozen=True)
class ActionRow:
    """One thing the user can do; ``keys`` are portable key texts, the first one is shown."""

    id: str
    text: str
    keys: tuple[str, ...]
    page: Page
    handler: str
    tip: str
    needs: Needs = Needs.NOTHING
    short: str = ""  # for a tool button, where the text is too long for it


PAGE_TITLES: dict[Page, str] = {
    Page.FILE: str(QT_TRANSLATE_NOOP("Actions", "&File")),
    Page.EDIT: str(QT_TRANSLATE_NOOP("Actions", "&Edit")),
    Page.REVIEW: str(QT_TRANSLATE_NOOP("Actions", "&Review")),
    Page.PLAY: str(QT_TRANSLATE_NOOP("Actions", "&Playback")),
    Page.VIEW: str(QT_TRANSLATE_NOOP("Actions", "&View")),
    Page.HELP: str(QT_TRANSLATE_NOOP("Actions", "&Help")),
}


def _row(
    row_id: str,
    text: object,
    keys: str,
    page: Page,
    handler: str,
    tip: object,
    needs: Needs = Needs.NOTHING,
    *,
    short: object = "",
) -> ActionRow:
    return ActionRow(row_id, str(text), tuple(keys.split()), page, handler, str(tip), needs, str(short))


N = QT_TRANSLATE_NOOP
ACTIONS: tuple[ActionRow, ...] = (
    # file
    _row("record", N("Actions", "Record…"), "Ctrl+N", Page.FILE, "recording.show",
         N("Actions", "Show the recording page: devices, levels, live path"), short=N("Actions", "Record")),
    _row("record_press", N("Actions", "Record or stop"), "F5", Page.FILE, "recording.press",
         N("Actions", "Begin the recording; to stop it, press twice within three seconds"), Needs.RECORDING),
    _row("clear_clip", N("Actions", "Clip light out"), "Q", Page.FILE, "recording.clear_clip",
         N("Actions", "Put out the light that says the sound was too loud"), Needs.RECORDING),
    _row("open", N("Actions", "Open folder…"), "Ctrl+O", Page.FILE, "files.ask_open",
         N("Actions", "Open a device folder or a saved survey"), short=N("Actions", "Open")),
    _row("demo", N("Actions", "Demonstration survey"), "Ctrl+D", Page.FILE, "files.open_demo",
         N("Actions", "Open the simulated survey that comes with Leakline")),
    _row("route", N("Actions", "Import route…"), "Ctrl+M", Page.FILE, "route.ask_import",
         N("Actions", "Take the pipe's line from a map: GeoJSON, Shapefile, GeoPackage, KML, GPX, DXF or CSV")),
    _row("route_remove", N("Actions", "Remove route"), "", Page.FILE, "route.remove",
         N("Actions", "Go on without the mapped route; the path is computed again")),
    _row("process", N("Actions", "Process again"), "Ctrl+R", Page.FILE, "files.reprocess",
         N("Actions", "Compute path and leaks again with the present form and tie points; decisions are carried over"),
         Needs.WRITABLE),
    _row("export", N("Actions", "Export report and files"), "Ctrl+E", Page.FILE, "report.export",
         N("Actions", "Write the PDF, the tables and the map files that are chosen on the report page"), Needs.SURVEY,
         short=N("Actions", "Export")),
    _row("preview_report", N("Actions", "See the report's pages"), "Ctrl+Shift+E", Page.FILE, "report.preview",
         N("Actions", "Show each page of the report as it will be, before anything is written"), Needs.SURVEY),
    _row("close", N("Actions", "Close survey"), "Ctrl+W", Page.FILE, "files.close_survey",
         N("Actions", "Close this survey; everything is saved already"), Needs.SURVEY),
    _row("quit", N("Actions", "Quit"), "Ctrl+Q", Page.FILE, "close", N("Actions", "Close Leakline; nothing is lost")),
    # edit
    _row("undo", N("Actions", "Undo"), "Ctrl+Z", Page.EDIT, "shared.undo",
         N("Actions", "Take the last change back; while recording, the last marker"), Needs.SURVEY),
    _row("redo", N("Actions", "Redo"), "Ctrl+Y", Page.EDIT, "review.redo",
         N("Actions", "Do the change again that was taken back"), Needs.SURVEY),
    # review
    _row("confirm", N("Actions", "Confirm"), "1", Page.REVIEW, "review.confirm",
         N("Actions", "It is a leak; go to the next undecided"), Needs.CANDIDATE),
    _row("reject", N("Actions", "Reject"), "2", Page.REVIEW, "review.reject",
         N("Actions", "It is no leak; go to the next undecided"), Needs.CANDIDATE),
    _row("unsure", N("Actions", "Unsure"), "3", Page.REVIEW, "review.unsure",
         N("Actions", "Leave it open for a second look; go to the next undecided"), Needs.CANDIDATE),
    _row("clear", N("Actions", "Clear verdict"), "0", Page.REVIEW, "review.clear",
         N("Actions", "Take the verdict away and stay here"), Needs.CANDIDATE),
    _row("class", N("Actions", "Class"), "C", Page.REVIEW, "review.choose_class",
         N("Actions", "Say what it is: leak, valve, bend, pump …"), Needs.CANDIDATE),
    _row("note", N("Actions", "Note"), "Return Enter", Page.REVIEW, "review.edit_note",
         N("Actions", "Write a note; it is saved as you type. Enter ends it"), Needs.CANDIDATE),
    _row("phrase", N("Actions", "Note used before"), "Shift+Return Shift+Enter", Page.REVIEW, "review.choose_phrase",
         N("Actions", "Choose a note that was written in this survey already"), Needs.CANDIDATE),
    _row("next", N("Actions", "Next candidate"), "Down", Page.REVIEW, "review.next_candidate",
         N("Actions", "Go one candidate down the list"), Needs.RESULTS),
    _row("previous", N("Actions", "Previous candidate"), "Up", Page.REVIEW, "review.previous_candidate",
         N("Actions", "Go one candidate up the list"), Needs.RESULTS),
    _row("undecided", N("Actions", "Next undecided"), "U", Page.REVIEW, "review.next_undecided",
         N("Actions", "Go to the next candidate without a verdict"), Needs.RESULTS),
    _row("undecided_up", N("Actions", "Previous undecided"), "Shift+U", Page.REVIEW, "review.previous_undecided",
         N("Actions", "Go to the candidate above without a verdict"), Needs.RESULTS),
    _row("filter", N("Actions", "Next filter of the list"), "N", Page.REVIEW, "work.list.next_filter",
         N("Actions", "Show all candidates, or only the undecided, unsure, confirmed or rejected ones"), Needs.RESULTS),
    _row("filter_more", N("Actions", "Filter by class and score…"), "Shift+N", Page.REVIEW, "work.list.open_filter",
         N("Actions", "Choose class and least score of the candidates that the list shows"), Needs.RESULTS),
    _row("filter_clear", N("Actions", "Clear filter"), "Ctrl+Shift+N", Page.REVIEW, "work.list.clear_filter",
         N("Actions", "Show all candidates in the list again"), Needs.RESULTS),
    _row("batch", N("Actions", "Reject below a score…"), "Ctrl+B", Page.REVIEW, "work.list.open_batch",
         N("Actions", "Reject all undecided candidates of the list below a score, in one step"), Needs.RESULTS),
    _row("why", N("Actions", "Why a leak"), "W", Page.REVIEW, "evidence.toggle",
         N("Actions", "Show what speaks for and against a leak here, or the list again"), Needs.CANDIDATE),
    _row("gallery", N("Actions", "Gallery"), "O", Page.REVIEW, "work.gallery.show",
         N("Actions", "Show all candidates as pictures in metres, or go back; arrows choose, Enter opens, Z and X "
           "change the size"), Needs.RESULTS, short=N("Actions", "Gallery")),
    _row("photos", N("Actions", "Photos"), "P", Page.REVIEW, "work.photos.toggle",
         N("Actions", "Show the photos of the selected leak, or the list again"), Needs.CANDIDATE),
    _row("photo_attach", N("Actions", "Attach photos…"), "Shift+P", Page.REVIEW, "work.photos.attach",
         N("Actions", "Attach pictures of the place to the selected leak; they can also be dropped on the page"),
         Needs.CANDIDATE),
    _row("photo_paste", N("Actions", "Paste a photo"), "Ctrl+V", Page.REVIEW, "work.photos.paste",
         N("Actions", "Attach the picture in the clipboard to the selected leak"), Needs.CANDIDATE),
    _row("dig", N("Actions", "Found at the dig"), "Ctrl+F", Page.REVIEW, "work.digs.toggle",
         N("Actions", "Enter what a dig showed beside what was stated, see all digs and what they say of the "
           "intervals; pressed again, go back"), Needs.SURVEY, short=N("Actions", "Digs")),
    _row("second_review", N("Actions", "Second review, blind"), "Ctrl+J", Page.REVIEW, "work.second.toggle",
         N("Actions", "Let a second person judge without seeing the first verdicts; again: end it and compare"),
         Needs.WRITABLE),
    _row("differences", N("Actions", "Differences between reviewers"), "Ctrl+Shift+J", Page.REVIEW,
         "work.second.show_differences",
         N("Actions", "Show where the second reviewer differs, side by side; arrows keep the first or take the second"),
         Needs.SURVEY),
    _row("opinions_import", N("Actions", "Opinions of a colleague…"), "", Page.FILE, "work.second.ask_import",
         N("Actions", "Take the second opinions from a colleague's copy of this survey"), Needs.WRITABLE),
    _row("goto", N("Actions", "Go to candidate"), "G", Page.REVIEW, "review.go_to_candidate",
         N("Actions", "Bring the cursor and all views to the selected candidate"), Needs.CANDIDATE),
    _row("mark", N("Actions", "Mark a leak here"), "M F6", Page.REVIEW, "shared.mark",
         N("Actions", "Add a candidate at the cursor that the machine missed; while recording, what is passed now"),
         Needs.RESULTS,
         short=N("Actions", "Mark")),
    _row("mark_back", N("Actions", "Move mark back"), "Ctrl+Shift+Left", Page.REVIEW, "work.marks.nudge_back",
         N("Actions", "Move the selected mark a fiftieth of what is shown towards the launch"), Needs.CANDIDATE),
    _row("mark_forward", N("Actions", "Move mark forward"), "Ctrl+Shift+Right", Page.REVIEW,
         "work.marks.nudge_forward",
         N("Actions", "Move the selected mark a fiftieth of what is shown away from the launch"), Needs.CANDIDATE),
    _row("mark_cursor", N("Actions", "Move mark to the cursor"), "Shift+M", Page.REVIEW, "work.marks.place_at_cursor",
         N("Actions", "Put the selected mark where the cursor is"), Needs.CANDIDATE),
    _row("tie", N("Actions", "Tie point here"), "T", Page.REVIEW, "path.ties.add_here",
         N("Actions", "Add a tie point at the cursor: a place the device is known to have passed then"), Needs.RESULTS),
    # playback
    _row("play", N("Actions", "Play or pause"), "Space", Page.PLAY, "player.toggle",
         N("Actions", "Play the sound from the cursor, or pause"), Needs.RESULTS),
    _row("loop", N("Actions", "Play candidate in a loop"), "Shift+Space", Page.PLAY, "player.toggle_loop",
         N("Actions", "Play the selected candidate again and again, with two seconds of lead-in"), Needs.CANDIDATE),
    _row("autoplay", N("Actions", "Listen on arrival"), "Shift+A", Page.PLAY, "work.list.toggle_autoplay",
         N("Actions", "Play each candidate in a loop as soon as it is selected, or only by key"), Needs.RESULTS),
    _row("loop_selection", N("Actions", "Play selection in a loop"), "Ctrl+Space", Page.PLAY,
         "player.toggle_selection_loop",
         N("Actions", "Play what is selected in the sound again and again; without a selection, the candidate"),
         Needs.RESULTS),
    _row("cleaned", N("Actions", "Raw or cleaned"), "A", Page.PLAY, "cleaning.toggle",
         N("Actions", "Hear and see the sound without the noise of the ball's own rolling, or as it was recorded"),
         Needs.RESULTS),
    _row("band", N("Actions", "Which band is heard"), "B", Page.PLAY, "player.next_band",
         N("Actions", "All of the sound, the leak band, or the band of the selected candidate"), Needs.RESULTS),
    _row("slow", N("Actions", "Slower"), "S", Page.PLAY, "player.next_slow",
         N("Actions", "Half and quarter speed at the same pitch, then full speed again"), Needs.RESULTS),
    # view
    _row("page_start", N("Actions", "Start page"), "Ctrl+0", Page.VIEW, "work.start.show",
         N("Actions", "Recent surveys, recording, demonstration; what is open stays open")),
    _row("page_data", N("Actions", "Data page"), "Ctrl+1", Page.VIEW, "show_data",
         N("Actions", "Files, findings, form and tie points")),
    _row("page_path", N("Actions", "Path page"), "Ctrl+2", Page.VIEW, "show_path",
         N("Actions", "Plan and profile large"), Needs.SURVEY),
    _row("page_sound", N("Actions", "Sound page"), "Ctrl+3", Page.VIEW, "show_sound",
         N("Actions", "Spectrogram, level and motion large"), Needs.SURVEY),
    _row("page_leaks", N("Actions", "Leaks page"), "Ctrl+4", Page.VIEW, "show_leaks",
         N("Actions", "Everything needed for the verdicts"), Needs.SURVEY),
    _row("page_report", N("Actions", "Report page"), "Ctrl+5", Page.VIEW, "show_report",
         N("Actions", "What will be written, and where"), Needs.SURVEY),
    _row("correlator", N("Actions", "Correlator"), "Ctrl+K", Page.VIEW, "correlator.show",
         N("Actions", "Find a leak between two fixed sensors from their recordings"), short=N("Actions", "Correlator")),
    _row("repeat", N("Actions", "Compare runs"), "Ctrl+L", Page.VIEW, "work.repeat.toggle",
         N("Actions", "Put another run of the same pipe beside this one in metres: new, gone, grown; A hears one and "
           "the other, G goes to the leak; pressed again, go back"), Needs.SURVEY, short=N("Actions", "Compare")),
    _row("left", N("Actions", "Cursor back"), "Left", Page.VIEW, "review.step_back",
         N("Actions", "Move the cursor one step back: a fiftieth of what is shown"), Needs.RESULTS),
    _row("right", N("Actions", "Cursor forward"), "Right", Page.VIEW, "review.step_forward",
         N("Actions", "Move the cursor one step forward: a fiftieth of what is shown"), Needs.RESULTS),
    _row("left_1", N("Actions", "Cursor back 1 s"), "Shift+Left", Page.VIEW, "review.step_back_1s",
         N("Actions", "Move the cursor one second back"), Needs.RESULTS),
    _row("right_1", N("Actions", "Cursor forward 1 s"), "Shift+Right", Page.VIEW, "review.step_forward_1s",
         N("Actions", "Move the cursor one second forward"), Needs.RESULTS),
    _row("left_10", N("Actions", "Cursor back 10 s"), "Ctrl+Left", Page.VIEW, "review.step_back_10s",
         N("Actions", "Move the cursor ten seconds back"), Needs.RESULTS),
    _row("right_10", N("Actions", "Cursor forward 10 s"), "Ctrl+Right", Page.VIEW, "review.step_forward_10s",
         N("Actions", "Move the cursor ten seconds forward"), Needs.RESULTS),
    _row("zoom_in", N("Actions", "Zoom in"), "Z PgUp", Page.VIEW, "work.views.zoom.zoom_in",
         N("Actions", "Show half of it, or of the plan if that is in front (wheel, two fingers)"), Needs.RESULTS),
    _row("zoom_out", N("Actions", "Zoom out"), "X PgDown", Page.VIEW, "work.views.zoom.zoom_out",
         N("Actions", "Show twice as much, or of the plan if that is in front (wheel, two fingers)"), Needs.RESULTS),
    _row("zoom_up_in", N("Actions", "Zoom in up and down"), "Shift+Z", Page.VIEW, "work.views.zoom.zoom_in_upright",
         N("Actions", "Show half of the frequencies, or of the values of the plot in front (Ctrl and wheel)"),
         Needs.RESULTS),
    _row("zoom_up_out", N("Actions", "Zoom out up and down"), "Shift+X", Page.VIEW,
         "work.views.zoom.zoom_out_upright",
         N("Actions", "Show twice as many frequencies, or values of the plot in front (Ctrl and wheel)"),
         Needs.RESULTS),
    _row("pan_back", N("Actions", "Pan back"), "Shift+PgUp", Page.VIEW, "work.views.zoom.pan_back",
         N("Actions", "Show half a view of what lies before, or west on the plan; the cursor stays (Shift and wheel)"),
         Needs.RESULTS),
    _row("pan_forward", N("Actions", "Pan forward"), "Shift+PgDown", Page.VIEW, "work.views.zoom.pan_forward",
         N("Actions", "Show half a view of what lies after, or east on the plan; the cursor stays (Shift and wheel)"),
         Needs.RESULTS),
    _row("pan_up", N("Actions", "Pan plan north"), "Shift+Up", Page.VIEW, "work.views.zoom.pan_up",
         N("Actions", "With the plan in front, show what lies to the north"), Needs.RESULTS),
    _row("pan_down", N("Actions", "Pan plan south"), "Shift+Down", Page.VIEW, "work.views.zoom.pan_down",
         N("Actions", "With the plan in front, show what lies to the south"), Needs.RESULTS),
    _row("fit", N("Actions", "Show all"), "F Home", Page.VIEW, "review.fit",
         N("Actions", "Show the whole run (double click; on a leak it goes there)"), Needs.RESULTS),
    _row("axis", N("Actions", "Metres or seconds"), "D", Page.VIEW, "sound_view.toggle_axis",
         N("Actions", "Show sound and motion along the pipe in metres, or in time"), Needs.RESULTS),
    _row("plane", N("Actions", "Short events, steady sounds, excess"), "E", Page.VIEW, "sound_view.next_plane",
         N("Actions", "Show short events, steady sounds, or what is over the local background"), Needs.RESULTS),
    _row("scale", N("Actions", "Scale of frequencies"), "L", Page.VIEW, "sound_view.next_scale",
         N("Actions", "Spread frequencies by octaves, evenly, or as the ear hears them"), Needs.RESULTS),
    _row("contrast", N("Actions", "Contrast"), "K", Page.VIEW, "sound_view.contrast",
         N("Actions", "Let the colours fit what is visible now; they stay so, and the bar says auto"), Needs.RESULTS),
    _row("contrast_fixed", N("Actions", "Fixed contrast"), "Shift+K", Page.VIEW, "sound_view.fixed_contrast",
         N("Actions", "Let the colours span the fixed decibels again, the same for every recording"), Needs.RESULTS),
    _row("quiet_up", N("Actions", "Hide more of what is quiet"), "Ctrl+Up", Page.VIEW, "sound_view.quiet_end_up",
         N("Actions", "Let the colours begin 3 dB louder; that is kept"), Needs.RESULTS),
    _row("quiet_down", N("Actions", "Show more of what is quiet"), "Ctrl+Down", Page.VIEW,
         "sound_view.quiet_end_down", N("Actions", "Let the colours begin 3 dB quieter; that is kept"), Needs.RESULTS),
    _row("loud_up", N("Actions", "Tell loud sounds apart"), "Ctrl+PgUp", Page.VIEW, "sound_view.loud_end_up",
         N("Actions", "Let the colours end 3 dB louder; that is kept"), Needs.RESULTS),
    _row("loud_down", N("Actions", "Brighter"), "Ctrl+PgDown", Page.VIEW, "sound_view.loud_end_down",
         N("Actions", "Let the colours end 3 dB quieter; that is kept"), Needs.RESULTS),
    _row("colours", N("Actions", "Next colours"), "J", Page.VIEW, "sound_view.next_colours",
         N("Actions", "Change the colours of the spectrogram"), Needs.RESULTS),
    _row("select_here", N("Actions", "Selection from here"), "V", Page.VIEW, "sound_view.select_here",
         N("Actions", "Begin a selection at the cursor; the second time, end it there"), Needs.RESULTS),
    _row("select", N("Actions", "Select by dragging"), "Shift+V", Page.VIEW, "sound_view.toggle_select",
         N("Actions", "Let a drag in the spectrogram select instead of pan"), Needs.RESULTS),
    _row("spectrum", N("Actions", "Spectrum of the selection"), "Y", Page.VIEW, "spectrum_of_selection",
         N("Actions", "Measure the selection as A, against what lies around it"), Needs.RESULTS),
    _row("spectrum_b", N("Actions", "Compare with the selection"), "Shift+Y", Page.VIEW, "spectrum.use_b",
         N("Actions", "Measure the selection as B"), Needs.RESULTS),
    _row("settings", N("Actions", "Settings…"), "F7", Page.VIEW, "work.settings.show",
         N("Actions", "Language, colours, size of letters, units, and your company on the report")),
    _row("measure", N("Actions", "Measure from here"), "R", Page.VIEW, "work.views.measure.press",
         N("Actions", "Begin measuring at the cursor; the second time, end there; the third time, remove it"),
         Needs.RESULTS, short=N("Actions", "Measure")),
    _row("measure_end", N("Actions", "Move the other end"), "Shift+R", Page.VIEW, "work.views.measure.other_end",
         N("Actions", "Let the cursor move the other end of what is measured"), Needs.RESULTS),
    _row("measure_tool", N("Actions", "Measure by dragging"), "Ctrl+Shift+R", Page.VIEW,
         "work.views.measure.toggle_tool",
         N("Actions", "Let a drag in any view measure instead of pan"), Needs.RESULTS),
    _row("follow", N("Actions", "Follow the playback"), "H", Page.VIEW, "work.views.follow.next_mode",
         N("Actions", "While it plays, turn pages, keep the cursor in the middle, or leave the view as it is"),
         Needs.RESULTS),
    _row("language", N("Actions", "Türkçe / English"), "F8", Page.VIEW, "toggle_language",
         N("Actions", "Switch the language")),
    _row("theme", N("Actions", "Sun, light or dark"), "F9", Page.VIEW, "next_theme",
         N("Actions", "Next theme: sun for outdoors, light, dark")),
    _row("full", N("Actions", "Full screen"), "F11", Page.VIEW, "work.views.screen.toggle",
         N("Actions", "Use the whole screen without menus and steps; Escape goes back")),
    _row("full_sound", N("Actions", "Spectrogram alone"), "Shift+F11", Page.VIEW,
         "work.views.screen.toggle_spectrogram",
         N("Actions", "Give the whole screen to the spectrogram; Escape goes back"), Needs.RESULTS),
    _row("panels", N("Actions", "Panels…"), "Ctrl+H", Page.VIEW, "work.views.panels.open_menu",
         N("Actions", "Choose which panels this page shows"), Needs.RESULTS),
    _row("reset_layout", N("Actions", "Reset layout"), "", Page.VIEW, "work.views.reset_layout",
         N("Actions", "Arrange panels, tabs and dividers as they were the first time"), Needs.RESULTS),
    # help
    _row("missing", N("Actions", "What is missing"), "Ctrl+G", Page.HELP, "work.guide.show_all",
         N("Actions", "Say what each step still lacks, and lead there")),
    _row("help", N("Actions", "Manual"), "F1", Page.HELP, "help.show_guide",
         N("Actions", "The manual's page for what is in front; it needs no network")),
    _row("tour", N("Actions", "Five hints"), "Shift+F1", Page.HELP, "work.tour.show",
         N("Actions", "Show the hints of the first start again; pressed again, the next one")),
    _row("keys", N("Actions", "Keys"), "F2", Page.HELP, "help.show_keys", N("Actions", "All keys on one sheet")),
    _row("diagnostics", N("Actions", "Save diagnostics…"), "", Page.HELP, "save_diagnostics",
         N("Actions", "Write the log and version numbers into a zip file for support; no survey data")),
)  # fmt: skip


# a key that is held down neither ends a run nor marks again
ONCE_A_PRESS = frozenset({"record_press", "mark", "mark_back", "mark_forward", "mark_cursor"})


def translated(text: str) -> str:
    """Return a text of the table in the window's language."""
    return QCoreApplication.translate("Actions", text)


def resolve(root: object, handler: str) -> Callable[[], Any]:
    """Return the callable that ``handler`` names below ``root``; raises AttributeError if it does not exist."""
    thing: Any = root
    for name in handler.split("."):
        thing = getattr(thing, name)
    if not callable(thing):
        raise TypeError(f"{handler} is not callable")
    return thing  # type: ignore[no-any-return]


def is_plain_key(key: str) -> bool:
    """Tell whether ``key`` could be meant for a text field: no Ctrl in it, and not a function key."""
    return not key.startswith("Ctrl+") and not (key.startswith("F") and key[1:].isdigit())


def shown_keys(row: ActionRow) -> str:
    """Return the keys of a row as the platform writes them."""
    native = QKeySequence.SequenceFormat.NativeText
    return " / ".join(QKeySequence(key).toString(native) for key in row.keys)


def build(owner: QObject, root: object, rows: Iterable[ActionRow] = ACTIONS) -> dict[str, QAction]:
    """Return one QAction a row, owned by ``owner``, wired to its handler below ``root``, without shortcuts yet."""
    actions: dict[str, QAction] = {}
    for row in rows:
        action = QAction(translated(row.text), owner)
        action.setObjectName(row.id)
        action.setToolTip(translated(row.tip))
        action.setStatusTip(translated(row.tip))
        if row.short:
            action.setIconText(translated(row.short))
        action.setAutoRepeat(row.id not in ONCE_A_PRESS)
        handler = resolve(root, row.handler)
        action.triggered.connect(lambda _checked=False, call=handler: call())
        actions[row.id] = action
    return actions


def arm_keys(actions: dict[str, QAction], *, typing: bool, rows: Iterable[ActionRow] = ACTIONS) -> None:
    """Give each action its keys; while ``typing`` those that a text field could want are taken away."""
    for row in rows:
        keys = [key for key in row.keys if not (typing and is_plain_key(key))]
        if [s.toString() for s in actions[row.id].shortcuts()] != keys:
            actions[row.id].setShortcuts([QKeySequence(key) for key in keys])
