"""Make the text that the command `replay` prints at its end: every scheme's errors, and advice."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from owtsweep.motion.recorded import tell_alone
from owtsweep.studies.hub.public import OTHER_WINDOW
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import pick_facts, summarise_motion
from owtsweep.studies.replay.identification.words import ESTIMATED, count_doubted, warn_of_noise
from owtsweep.studies.replay.loading import tell_lean
from owtsweep.studies.replay.measures import BASELINE_ROWS
from owtsweep.studies.replay.sentences import describe_modes, describe_tilt, write_sentence

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

#: Measure -> heading, in the order of the columns. A measure without a value has no column.
SHOWN = {
    "position": "position MSE (m²)",
    "velocity": "velocity MSE (m²/s²)",
    "coverage_position": "in ±1.96 σ",
    "fix_residual": "to later fix (m²)",
    "nis": "NIS (2)",
    "innovation_lag_1": "innov. lag 1",
    "innovation_white_p": "white p",
}
#: What the table of errors says below it.
BASELINES_NOTE = (
    "NONE, HOLD, DELTA: no IMU, but zero, the last fix, or the line through the last two fixes"
)

#: With more records than this the terminal prints counts of the advice, not each advice.
MOST_RECORDS = 8


def render_answer(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
    """Make the terminal's output: the advice, and with a single record the table of errors."""
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = []
    if len(config.grid.files) == 1:
        parts.append(_make_table(config, tables["errors"]))
        if len(tables["records"]):
            record = pick_facts(tables["records"])
            parts.append(Text(f"motion: {describe_modes(config, record)}"))
            if tilt := describe_tilt(config, record):
                parts.append(Text(f"tilt: {tilt}"))
        if lean := tell_lean(config, config.grid.files[0]):
            parts.append(Text(f"lean: {lean}"))
    if len(config.grid.files) <= MOST_RECORDS:
        parts += [Text(line) for line in warn_of_noise(config, tables)]
        parts += [Text(line) for line in make_sentences(tables["advice"])]
    else:
        parts += [Text(line) for line in count_doubted(tables)]
        parts.append(Text(_count_advice(tables["advice"])))
    parts += [Text(line) for line in tell_scope(config, tables)]
    if len(config.grid.files) > 1:
        parts += [Text(line) for line in list_left_out(tables["refused"])]
    return Group(*parts)


def list_left_out(refused: pd.DataFrame) -> list[str]:
    """Return a line with the reason per record left out; the last counts those not listed."""
    lines = [f"left out: {row.reason}" for row in refused.head(MOST_RECORDS).itertuples()]
    more = len(refused) - len(lines)
    return [*lines, f"left out: {more} more (refused.csv)"] if more else lines


def _count_advice(advised: pd.DataFrame) -> str:
    by_record = advised[(advised["source"] != "map") & (advised["noise"] != ESTIMATED)]
    counts = by_record["recommended"].value_counts()
    best = ", ".join(f"{name} in {count}" for name, count in counts.items())
    alike = int((~by_record["matters"].astype(bool)).sum())
    return (
        f"{len(by_record)} records; recommended: {best}; in {alike} no difference between schemes "
        "that matters (report.md)"
    )


def make_sentences(advised: pd.DataFrame) -> list[str]:
    """Write a sentence per row of the table of advice; it names the record if there are several."""
    many = advised["file"].nunique() > 1
    return [
        (f"{row['file']}: " if many else "") + write_sentence(row)
        for row in advised.to_dict("records")
    ]


def tell_scope(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return sentences on what the advice holds for: the motion, and the part of a record."""
    drawn = (tables["errors"]["n"] > 1).any()  # recorded sensors have the noise that they had
    motion = [f"The advice is for {tell_alone(*config.grid.files)}."] if drawn else []
    return [*motion, *_tell_windows(tables["advice"])]


def _tell_windows(advised: pd.DataFrame) -> list[str]:
    """Return sentences on the part of a record that the advice judges, and on the other part."""
    of_map = advised["source"] == "map"
    windows = list(dict.fromkeys(advised.loc[~of_map, "window"]))
    lines = [OTHER_WINDOW[window] for window in windows or dict.fromkeys(advised["window"])]
    if of_map.any() and "full" in windows:
        lines.append("The expected map judges the settled part.")
    return lines


def list_spectrum_notes(config: ReplayConfig) -> list[str]:
    """List the warnings about the spectrum fitted to the single record of a run; [] for several."""
    if len(config.grid.files) > 1:
        return []
    return [f"spectrum: {warning}" for warning in list_fit_warnings(config, config.grid.files[0])]


def list_fit_warnings(config: ReplayConfig, file: str) -> tuple[str, ...]:
    """List the warnings about the spectrum fitted to a record, or why none could be fitted."""
    fit = summarise_motion(config, file).fit
    return (fit,) if isinstance(fit, str) else fit.warnings


def make_error_cells(
    config: ReplayConfig, errors: pd.DataFrame
) -> tuple[list[str], list[list[str]]]:
    """Return headings and texts of a record's errors by scheme, in the part `measures.window`."""
    shown = errors[errors["window"] == config.measures.window]
    names = [name for name in SHOWN if name in set(shown["measure"])]
    rows = []
    for scheme, group in shown.groupby("scheme", sort=False):
        by_measure = group.set_index("measure")
        if (baseline := BASELINE_ROWS.get(str(scheme))) in config.schemes:
            continue  # the baseline has a row among the schemes
        row = [baseline or str(scheme)]
        for name in names:
            row.append(_format(name, by_measure) if name in by_measure.index else "")
        rows.append(row)
    return ["scheme", *(SHOWN[name] for name in names)], rows


def _format(name: str, by_measure: pd.DataFrame) -> str:
    line = by_measure.loc[name]
    if name.startswith("coverage"):
        return f"{100.0 * line['mean']:.1f} %"
    text = f"{line['mean']:.3g}"
    if line["n"] > 1 and name in ("position", "velocity", "fix_residual"):
        text += f" ± {line['ci_high'] - line['mean']:.1g}"
    return text


def _make_table(config: ReplayConfig, errors: pd.DataFrame) -> RenderableType:
    from owtsweep.io.parted_table import PartedTable

    headings, rows = make_error_cells(config, errors)
    title = f"errors, {config.measures.window} record, tuning {config.tuning}"
    return PartedTable(headings, rows, title=title, caption=f"{BASELINES_NOTE}.")
