"""What became of a format: the files that it wrote, and what its reader should know."""

from dataclasses import dataclass
from pathlib import Path

from processing.survey import Finding


@dataclass(frozen=True)
class Written:
    """The files of a format, whole on disk, and findings on them."""

    files: tuple[Path, ...]
    findings: tuple[Finding, ...] = ()

    def __add__(self, other: "Written") -> "Written":
        return Written(self.files + other.files, self.findings + other.findings)
