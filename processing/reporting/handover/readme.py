"""Writes ``README.txt``, in both languages: files, columns, units, system, what ± means, what was not assessed.

With the mark and the line ends that Windows' own editor needs for Turkish letters.
"""

import textwrap
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

from processing import messages
from processing.coordinates import is_local
from processing.reporting.content import ReportContent
from processing.reporting.files import whole_path
from processing.reporting.handover.layers import Layers, has_elevation
from processing.reporting.handover.words import HandoverWords
from processing.reporting.references import is_heading_known
from processing.reporting.stretches import StretchStatus, pipe_stretches
from processing.survey import Finding

FILE_NAME = "README.txt"
WIDTH = 100


def write_readme(
    path: Path,
    content: ReportContent,
    layers: Layers | None,
    files: Sequence[tuple[str, str]],
    findings: Sequence[Finding],
    language: str,
) -> None:
    """Write the text, ``language`` first; ``files`` are names with the key of what they are. Raises OSError.

    ``layers`` is None where there is no path: then there are no map files to explain.
    """
    languages = (language, *(other for other in messages.LANGUAGES if other != language))
    parts = ["\n".join(_text(content, layers, files, findings, one)) for one in languages]
    text = ("\n\n" + "=" * WIDTH + "\n\n").join(parts) + "\n"
    with whole_path(path) as aside:
        aside.write_bytes(text.replace("\n", "\r\n").encode("utf-8-sig", "backslashreplace"))


def _text(
    content: ReportContent,
    layers: Layers | None,
    files: Sequence[tuple[str, str]],
    findings: Sequence[Finding],
    language: str,
) -> list[str]:
    simulated = content.results.survey.info.simulated
    words = HandoverWords(language, simulated=simulated)
    lines = [words("readme_title").upper() if language == "en" else words("readme_title"), ""]
    if simulated:
        lines += [words("simulated"), ""]
    if content.undecided:
        lines += [words("draft", count=content.undecided), ""]
    lines += _facts(content, words)
    lines += _section(words("readme_files"), [f"{name}: {words(f'file_{key}')}" for name, key in files])
    lines += _section(words("readme_interval"), [words("readme_interval_text")])
    lines += _section(words("readme_status"), [words("readme_status_text")])
    lines += _section(words("readme_unassessed"), _unassessed(content, words))
    left_out = [messages.finding_sentence(finding, language) for finding in findings]
    lines += _section(words("readme_findings"), left_out or [words("readme_findings_none")])
    if layers is not None:
        lines += _section(words("readme_system"), _system(content, layers, words))
        unit = "ftus" if layers.options.units == "us" else "m"
        lines += _section(words("readme_units"), [words(f"readme_units_{unit}"), words("readme_units_plain")])
        lines += _columns(layers, words)
    return lines


def _facts(content: ReportContent, words: HandoverWords) -> list[str]:
    results = content.results
    info, pipe = results.survey.info, results.survey.pipe
    size = "" if pipe.diameter_m is None else f"{1000 * pipe.diameter_m:.0f} mm"
    facts = (
        ("readme_survey", info.name),
        ("readme_date", info.date),
        ("readme_operator", info.operator),
        ("readme_client", info.client),
        ("readme_pipe", ", ".join(part for part in (pipe.material, size) if part)),
        ("readme_run", results.run_hash[:12]),
        ("readme_made", f"Leakline {metadata.version('leakline')}"),
    )
    return [f"{words(key)}: {' '.join(value.split())}" for key, value in facts if value]


def _section(heading: str, paragraphs: Sequence[str]) -> list[str]:
    lines = ["", heading, "-" * len(heading)]
    for paragraph in paragraphs:
        lines += textwrap.wrap(paragraph, WIDTH, subsequent_indent="  ", break_long_words=False) or [""]
    return lines


def _unassessed(content: ReportContent, words: HandoverWords) -> list[str]:
    told = []
    for stretch in pipe_stretches(content):
        if stretch.status is StretchStatus.NOT_ASSESSED:
            reasons = "; ".join(messages.text("reasons", key, words.language) for key in stretch.reasons)
            told.append(f"{stretch.start_m:.1f} – {stretch.end_m:.1f} m: {reasons}")
    return told or [words("readme_unassessed_none" if content.results.track is not None else "readme_no_path")]


def _system(content: ReportContent, layers: Layers, words: HandoverWords) -> list[str]:
    system = layers.system
    unit = words(f"unit_{system.unit}")
    heights = words("readme_heights_known" if has_elevation(content) else "readme_heights_local")
    if system.is_local:
        local = "readme_system_local" if is_heading_known(content.results) else "readme_system_turned"
        return [words(local, unit=unit), heights]
    own = content.frame.grid
    key = "readme_system_contract_local" if is_local(own) else "readme_system_contract"
    return [words("readme_system_told", crs=system.label, unit=unit), words(key, crs=own), heights]


def _columns(layers: Layers, words: HandoverWords) -> list[str]:
    lines = _section(words("readme_columns"), [words("readme_columns_about")])
    for layer in layers.all:
        lines += ["", f"{words.layer(layer.name)} ({layer.name})"]
        for column in layer.columns:
            short = f" ({column.short})" if column.short != column.name else ""
            lines.append(f"  {column.name}{short}: {words.heading(column)}")
    return lines
