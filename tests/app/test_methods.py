"""What the form offers is what the steps can do, in both languages."""

import pytest

from app.methods import methods
from processing import messages
from processing.orientation.registry import ESTIMATORS
from processing.position.registry import METHODS
from processing.sound.candidates import DETECTORS


def test_the_names_offered_are_those_of_the_steps_own_tables():
    offered = {step: [row.name for row in rows] for step, rows in methods("en").items()}
    assert offered["orientation"] == ["auto", *(row.name for row in ESTIMATORS)]
    assert offered["position"] == ["auto", *METHODS]
    assert set(offered["detector"]) == {"auto", *DETECTORS}


@pytest.mark.parametrize("language", messages.LANGUAGES)
def test_every_method_has_a_title_and_plain_words(language):
    for rows in methods(language).values():
        assert rows[0].name == "auto"
        for row in rows:
            assert row.words.endswith(".")
            assert row.title or row.name == "auto"
