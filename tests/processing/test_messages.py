"""Every code has a sentence in every language, with the same placeholders."""

import string

import pytest

from processing import messages
from processing.errors import ErrorCode, LeaklineError, Place


def placeholders(text: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(text) if name}


@pytest.mark.parametrize("language", messages.LANGUAGES)
def test_every_error_code_has_a_sentence(language):
    assert set(messages.table("errors", language)) == {code.value for code in ErrorCode}


def test_the_languages_have_the_same_keys_and_placeholders():
    english, turkish = messages._tables("en"), messages._tables("tr")
    assert english.keys() == turkish.keys()
    for name, texts in english.items():
        assert texts.keys() == turkish[name].keys(), name
        for key, text in texts.items():
            assert placeholders(text) == placeholders(turkish[name][key]), f"{name}.{key}"


def test_an_error_names_the_file_and_the_place_and_what_to_do(tmp_path):
    error = LeaklineError(ErrorCode.VALUE_NOT_A_NUMBER, Place(tmp_path / "imu.csv", line=7, column=3), value="abc")
    sentence = messages.error_sentence(error)
    assert sentence.startswith(f"{tmp_path / 'imu.csv'}, line 7, column 3: 'abc' is not a number")
    assert "\n" not in sentence


def test_turkish_sentences_have_a_decimal_comma_and_the_percent_sign_first():
    assert messages.text("evidence", "impulsive_share", "tr", value=0.123).startswith("Sesin yaklaşık %12 ")
    assert messages.text("evidence", "impulsive_share", "en", value=0.123).startswith("12% ")
    params = {"name": "A", "metres": 20.2, "sigma_m": 0.4}
    assert "20,2 m uzakta (beklenen ±0,4 m" in messages.text("findings", "tie_disagrees", "tr", **params)
