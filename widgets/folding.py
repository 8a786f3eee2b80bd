"""Folds text for searching: case, accents and the Turkish letters i and ı make no difference to who types in gloves."""

import unicodedata

_LETTERS = str.maketrans({"ı": "i", "İ": "i", "I": "i", "ß": "ss"})


def folded(text: str) -> str:
    """Return text that two spellings of the same words share: ``Şişli`` and ``SISLI`` are both ``sisli``."""
    plain = unicodedata.normalize("NFD", text.translate(_LETTERS).lower())
    return "".join(letter for letter in plain if not unicodedata.combining(letter))


def has_all_words(query: str, text: str) -> bool:
    """Tell whether every word of ``query`` stands somewhere in ``text``; an empty query is everywhere."""
    found = folded(text)
    return all(word in found for word in folded(query).split())
