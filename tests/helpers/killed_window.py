"""A child process that reviews in the real window by key, for ever, and says each verdict once it is shown.

Started by the tests of killing: ``python killed_window.py SURVEY_FOLDER SEED``.
"""

import os
import random
import sys
from pathlib import Path

os.environ["QT_QPA_PLATFORM"] = "offscreen"


def main(path: Path, seed: int) -> None:
    """Press verdicts, undo, redo, notes and marks at random until killed."""
    from PySide6.QtCore import Qt
    from PySide6.QtTest import QTest
    from PySide6.QtWidgets import QApplication
    from small_survey import make_results

    from app.application import Application
    from app.settings import PreferencesStore
    from processing.storage.folder import SurveyFolder

    qt = QApplication([])
    application = Application(qt, PreferencesStore(path.parent / "p.json"), None, why_silent=lambda: "no card")
    window, session = application.window, application.services.session
    session.open(SurveyFolder.open(path))
    session.set_results(make_results(session.folder, tuple(range(4, 96, 4))))
    window.show_page("leaks")
    window.show()
    QTest.qWaitForWindowActive(window)
    window.review_page.focus_views()
    control = Qt.KeyboardModifier.ControlModifier
    keys = [(k, Qt.KeyboardModifier.NoModifier) for k in (Qt.Key.Key_1, Qt.Key.Key_2, Qt.Key.Key_3, Qt.Key.Key_0)] * 3
    keys += [(Qt.Key.Key_Z, control), (Qt.Key.Key_Y, control), (Qt.Key.Key_Down, Qt.KeyboardModifier.NoModifier)]
    keys += [(Qt.Key.Key_M, Qt.KeyboardModifier.NoModifier), (Qt.Key.Key_Return, Qt.KeyboardModifier.NoModifier)]
    choose = random.Random(seed)
    before = dict(session.decisions)
    while True:
        key, modifier = choose.choice(keys)
        QTest.keyClick(QApplication.focusWidget() or window, key, modifier)
        if key is Qt.Key.Key_Return:
            QTest.keyClicks(QApplication.focusWidget(), str(choose.random()))
            QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Return)
        now = dict(session.decisions)
        for candidate_id in sorted(before.keys() | now.keys()):
            if before.get(candidate_id) != now.get(candidate_id):
                decision = session.decision(candidate_id)
                print(candidate_id, decision.verdict.value, decision.note or "-", flush=True)
        before = now


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
