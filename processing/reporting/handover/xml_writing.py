"""XML as text: escaped, without characters that XML cannot hold."""

import re
from xml.sax.saxutils import escape

_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML 1.0, clause 2.2


def plain(text: str) -> str:
    """Return the text without what XML 1.0 has no form for: control characters and lone surrogates."""
    return _FORBIDDEN.sub("", text)


def escaped(text: str) -> str:
    """Return the text for the content of an element."""
    return escape(plain(text))


def element(name: str, text: str) -> str:
    """Return ``<name>text</name>``."""
    return f"<{name}>{escaped(text)}</{name}>"


def attribute(text: str) -> str:
    """Return the text for an attribute in double quotes, without them."""
    return escape(plain(text), {'"': "&quot;", "\n": "&#10;", "\t": "&#9;", "\r": "&#13;"})
