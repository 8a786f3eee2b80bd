"""A tree of an XML file that a stranger wrote: no document type, so no entities, no other files, and not too deep."""

import xml.etree.ElementTree as ET  # only its plain tree: the text goes through expat below
from pathlib import Path
from xml.parsers import expat

from processing.errors import LeaklineError
from processing.importing.route_files.lines import damaged

MAX_DEPTH = 100
MAX_ELEMENTS = 8_000_000


def xml_tree(path: Path, data: bytes) -> ET.Element:
    """Return the root of an XML text; tags are without their namespaces.

    Raises:
        LeaklineError: ROUTE_DAMAGED with the line, also for a document type definition: neither KML nor GPX has one,
            and its entities can grow a small file to gigabytes or pull in others.
    """
    return _Tree(path).parse(data)


class _Tree:
    def __init__(self, path: Path) -> None:
        self._path = path
        self._builder = ET.TreeBuilder()
        self._depth = self._count = 0
        self._parser = expat.ParserCreate(namespace_separator=" ")
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._builder.data
        self._parser.StartDoctypeDeclHandler = self._doctype

    def parse(self, data: bytes) -> ET.Element:
        try:
            self._parser.Parse(data, True)  # its C signature
            return self._builder.close()
        except expat.ExpatError as fault:
            raise damaged(self._path, expat.ErrorString(fault.code), line=fault.lineno) from None
        except LeaklineError:
            raise
        except (ValueError, LookupError, AssertionError) as fault:  # an encoding nobody knows, an empty document
            raise damaged(self._path, fault) from None

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._depth += 1
        self._count += 1
        if self._depth > MAX_DEPTH or self._count > MAX_ELEMENTS:
            raise damaged(self._path, "XML: too deep or too large", line=self._parser.CurrentLineNumber)
        self._builder.start(_local(tag), {_local(key): value for key, value in attributes.items()})

    def _end(self, tag: str) -> None:
        self._depth -= 1
        self._builder.end(_local(tag))

    def _doctype(self, *_: object) -> None:
        raise damaged(self._path, "XML: <!DOCTYPE>", line=self._parser.CurrentLineNumber)


def _local(tag: str) -> str:
    return tag.rpartition(" ")[2]
