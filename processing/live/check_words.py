"""The sentences of a check's lights; a stored sheet of another version, or an edited one, is shown as it is."""

from processing import messages
from processing.live.check_sheet import CheckItem, Light


def item_title(item: CheckItem, language: str) -> str:
    """Return what was checked."""
    return messages.table("check_items", language).get(item.key, item.key)


def item_sentence(item: CheckItem, language: str) -> str:
    """Return what was found."""
    try:
        return messages.text("check_verdicts", item.verdict, language, **item.params)
    except (KeyError, ValueError, TypeError, IndexError):
        return " ".join([item.verdict, *(f"{name}={value}" for name, value in item.params.items())])


def light_word(light: Light, language: str) -> str:
    """Return the light in a word."""
    return messages.text("check_lights", light.value, language)
