"""The story of a candidate in plain words, for the decision panel."""

import math

from PySide6.QtCore import QCoreApplication

from processing import messages
from processing.sound.size_words import size_sentence
from processing.survey import Params
from widgets.candidate_row import CandidateRow
from widgets.units import quantities
from widgets.vocabulary import chance_text, class_text, clock_text, frequency_text, number, size_text

# what is said of a candidate, and from which value on it is worth a line
WORTH_SAYING = {
    "stood_s": 3.0,
    "faded_db": 3.0,
    "impulsive_share": 0.1,
}
RARE = 0.02  # of the places along the pipe: what more of them show is worth no line


def evidence_text(row: CandidateRow, language: str) -> str:
    """Return what speaks for this candidate, one sentence a line."""
    candidate = row.candidate
    lines = []
    if row.manual:
        lines.append(QCoreApplication.translate("Evidence", "Marked by hand."))
    else:
        text = QCoreApplication.translate("Evidence", "Leak with {percent} probability; looks like: {kind}.")
        lines.append(text.format(percent=chance_text(candidate.score), kind=class_text(candidate.leak_class)))
        text = QCoreApplication.translate(
            "Evidence", "{level} dB above its surroundings from {low} to {high}, {width} wide."
        )
        low, high = candidate.band_hz
        lines.append(
            text.format(
                level=number(candidate.level_db, 1),
                low=frequency_text(low),
                high=frequency_text(high),
                width=quantities().length(candidate.width_m),
            )
        )
    if row.leak_size is not None and (sized := size_sentence(row.leak_size, language, quantities().units)):
        lines.append(sized)
    text = QCoreApplication.translate("Evidence", "95 % between {low} and {high}, passed at {time}.")
    low_m, high_m = (quantities().place(x) for x in (candidate.chainage_low95_m, candidate.chainage_high95_m))
    lines.append(text.format(low=low_m, high=high_m, time=clock_text(candidate.time_s)))
    for key, least in WORTH_SAYING.items():
        value = candidate.evidence.get(key)
        if isinstance(value, float | int) and math.isfinite(value) and value >= least:
            lines.append(messages.text_in(quantities().units, "evidence", key, language, value=value))
    lines += _pressure_lines(candidate.evidence, language)
    sigmas = [candidate.evidence.get(key) for key in ("sigma_path_m", "sigma_sound_m", "sigma_clock_m")]
    if all(isinstance(sigma, float) and math.isfinite(sigma) for sigma in sigmas):
        path, sound, clock = (quantities().length(float(sigma), 2) for sigma in sigmas if sigma is not None)
        lines.append(messages.text("evidence", "sigmas", language, path=path, sound=sound, clock=clock))
    return "\n".join(lines)


def evidence_brief(row: CandidateRow) -> str:
    """Return what the decision panel has room for, two short lines; :func:`evidence_text` has all of it."""
    candidate = row.candidate
    if row.manual:
        first = QCoreApplication.translate("Evidence", "Marked by hand.")
    else:
        text = QCoreApplication.translate("Evidence", "Leak {percent} · looks like: {kind}")
        first = text.format(percent=chance_text(candidate.score), kind=class_text(candidate.leak_class))
    parts = [f"{number(candidate.level_db, 1)} dB"] if math.isfinite(candidate.level_db) else []
    parts += [quantities().length(candidate.width_m), clock_text(candidate.time_s), size_text(row.leak_size)]
    return f"{first}\n{' · '.join(part for part in parts if part)}"


def _pressure_lines(evidence: Params, language: str) -> list[str]:
    """Return what the pressure says, where it does what it does at few other places only."""
    lines = []
    for key in ("pressure_dip", "pressure_step"):
        value, p = evidence.get(f"{key}_kpa"), evidence.get(f"{key}_p")
        if isinstance(value, float) and isinstance(p, float) and p <= RARE:
            lines.append(
                messages.text_in(
                    quantities().units,
                    "evidence",
                    key,
                    language,
                    value=abs(value) if key == "pressure_dip" else value,
                    p=p,
                )
            )
    near = evidence.get("pressure_transient_s")
    if isinstance(near, float):
        lines.append(messages.text("evidence", "pressure_transient_s", language, value=near))
    return lines
