"""Write what a replay found: the terminal's output and report.md, from its tables."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from owtsweep.errors import InputError, printable
from owtsweep.io import markdown
from owtsweep.io.files import write_atomically
from owtsweep.studies.replay import describe
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import pick_facts
from owtsweep.studies.replay.files import label_files
from owtsweep.studies.replay.loading import load_record, tell_lean
from owtsweep.studies.replay.measures import BASELINE_ROWS
from owtsweep.studies.replay.record import ReplayRecord

if TYPE_CHECKING:
    from rich.console import RenderableType

KINDS = {
    "simulated": "Recorded motion; GNSS and IMU are simulated, {n} draws of their noise.",
    "from_reference": "Recorded specific force; fixes made from the reference, {n} draws of their "
    "noise.",
    "recorded": "Recorded specific force and recorded fixes.",
}
CAPTIONS = {
    "position_zoom": "Position about the largest motion",
    "position": "Position",
    "velocity_zoom": "Velocity about the largest motion",
    "velocity": "Velocity",
    "acceleration_zoom": "Acceleration",
    "bias": "Accelerometer bias",
    "spectrum": "Spectrum and the fit of Eq. (1)",
    "place_in_map": "Place in the expected map",
    "best_scheme_by_record": "Best scheme by record",
}
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
BASELINES_NOTE = (
    "NONE, HOLD, DELTA: no IMU, but zero, the last fix, or the line through the last two fixes."
)
ABOUT_ERRORS = (
    "Mean squared errors of x + y; ± is the 95 % interval over the draws. *In ±1.96 σ*: how much "
    "of the position error lies within what the scheme states (95 % if it knows its noise). *To "
    "later fix*: squared distance of the estimate from the fix that tells of the same moment "
    "later, noise of the fix included. *NIS* is 2 and *white p* not small where the filter's "
    f"innovations are as it expects them to be. {BASELINES_NOTE}"
)
ABOUT_NOISE = (
    "Maximum likelihood, from the positions minus the double integral of the specific force; "
    "nothing is assumed of the motion. The delay of recorded fixes contains the offset between the "
    "clocks of GNSS and IMU. *clock_offset* is how much later the reference's clock shows a moment "
    "than the IMU's. A slow disturbance, such as gravity in a tilting IMU, counts as noise."
)
#: With more records than this the terminal prints counts of the advice, not each advice.
MOST_RECORDS = 8


def render_answer(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
    """Make the terminal's output: the advice, and with a single record the table of errors."""
    from rich.console import Group
    from rich.text import Text

    from owtsweep.io.terminal import PartedTable

    parts: list[RenderableType] = []
    lines: list[str] = []
    records, advised, files = tables["records"], tables["advice"], config.grid.files
    if len(files) == 1:
        title = f"errors, {config.measures.window} record, tuning {config.tuning}"
        headings, rows = _make_error_cells(config, tables["errors"])
        parts.append(PartedTable(headings, rows, title=title, caption=BASELINES_NOTE))
        if len(records):
            record = pick_facts(records)
            lines.append(f"motion: {describe.describe_modes(config, record)}")
            if tilt := describe.describe_tilt(config, record):
                lines.append(f"tilt: {tilt}")
        if lean := tell_lean(config, files[0]):
            lines.append(f"lean: {lean}")
    if len(files) <= MOST_RECORDS:
        lines += describe.warn_of_noise(config, tables) + describe.tell_others(advised)
    else:
        lines += [*describe.count_doubted(tables["noise"]), describe.count_advice(advised)]
    lines += describe.tell_scope(config, tables)
    if len(files) > 1:
        lines += list_left_out(tables["refused"])
    lines += ["", *tell_answer(config, tables)]
    return Group(*parts, *map(Text, lines))


def tell_answer(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return the answer in sentences, with what it holds for if a platform turns."""
    sentences = describe.tell_answer(config, tables)
    if sentences and len(config.grid.files) == 1 and tell_lean(config, config.grid.files[0]):
        sentences.append("This holds for a levelled IMU only.")
    return sentences


def list_left_out(refused: pd.DataFrame) -> list[str]:
    """Return a line with the reason per record left out; the last counts those not listed."""
    lines = [f"left out: {row.reason}" for row in refused.head(MOST_RECORDS).itertuples()]
    more = len(refused) - len(lines)
    return [*lines, f"left out: {more} more (refused.csv)"] if more else lines


def _make_error_cells(
    config: ReplayConfig, errors: pd.DataFrame
) -> tuple[list[str], list[list[str]]]:
    shown = errors[errors["window"] == config.measures.window]
    names = [name for name in SHOWN if name in set(shown["measure"])]
    rows = []
    for scheme, group in shown.groupby("scheme", sort=False):
        by_measure = group.set_index("measure")
        if (baseline := BASELINE_ROWS.get(str(scheme))) in config.schemes:
            continue  # the baseline has a row among the schemes
        cells = (_format(name, by_measure) if name in by_measure.index else "" for name in names)
        rows.append([baseline or str(scheme), *cells])
    return ["scheme", *(SHOWN[name] for name in names)], rows


def _format(name: str, by_measure: pd.DataFrame) -> str:
    line = by_measure.loc[name]
    if name.startswith("coverage"):
        return f"{100.0 * line['mean']:.1f} %"
    text = f"{line['mean']:.3g}"
    if line["n"] > 1 and name in ("position", "velocity", "fix_residual"):
        text += f" ± {line['ci_high'] - line['mean']:.1g}"
    return text


def write(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame], figures: Sequence[Path], folder: Path
) -> Path:
    """Write report.md into a run folder, in which the figures lie; return the path of the file."""
    advised = tables["advice"]
    advice = [*tell_answer(config, tables), *describe.warn_of_noise(config, tables)]
    advice += describe.tell_others(advised)
    if advised.empty:
        advice.append("none: no scheme ran")
    advice += describe.tell_scope(config, tables)
    if len(config.grid.files) == 1:
        record = load_record(config, config.grid.files[0])
        advice += [record.lean] if record.lean else []
        sections = _describe_one(config, tables, record)
    else:
        sections = _describe_many(config, tables)
    drawn = {path.stem: path for path in figures if path.suffix == ".png"}
    pictures = [
        f"**{caption}**\n\n![{caption}]({drawn[name].relative_to(folder).as_posix()})\n"
        for name, caption in CAPTIONS.items()
        if name in drawn
    ]
    parts = ["# Replay\n", "## Advice\n", *_itemise(advice), *sections, "\n## Figures\n", *pictures]
    path = folder / "report.md"
    write_atomically(path, "\n".join(parts) + "\n")
    return path


def _describe_one(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame], record: ReplayRecord
) -> list[str]:
    errors, records, noise = tables["errors"], tables["records"], tables["noise"]
    kind = KINDS[record.gnss].format(n=int(errors["n"].max()) if len(errors) else 0)
    facts = [
        f"{Path(record.file).name}: {kind}",
        f"{record.steps} IMU steps at {1.0 / record.step:g} Hz "
        f"({record.steps * record.step:.6g} s), fixes at {config.sensors.gnss.rate:g} Hz, "
        f"{config.sensors.gnss.delay:g} s late; tuning {config.tuning}",
    ]
    if len(records):
        facts += describe.describe_motion(config, pick_facts(records))
    parts = ["\n## The record\n", *_itemise([*facts, *record.notes])]
    table = markdown.table(*_make_error_cells(config, errors))
    parts += [f"\n## Errors, {config.measures.window} record\n", table, "", ABOUT_ERRORS]
    if len(noise):
        cells = [
            [
                row["parameter"],
                row["source"],
                "" if row["stated"] != row["stated"] else f"{row['stated']:.4g} {row['unit']}",
                describe.format_estimate(row),
                "yes" if row["inside"] else "no",
            ]
            for row in noise.to_dict("records")
        ]
        headings = ["parameter", "from", "stated", "from the record (95 %)", "inside"]
        table = markdown.table(headings, cells)
        parts += ["\n## Noise of the recorded sensors\n", table, "", ABOUT_NOISE]
    return parts


def _describe_many(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    leans = []
    for label, file in label_files(config.grid.files).items():
        with suppress(InputError):  # a record that was left out
            leans += [f"{label}: {lean}"] if (lean := tell_lean(config, file)) else []
    parts = [f"\n## Records\n\n{tabulate_records(tables['records'])}"]
    parts += ["", *_itemise(leans)] if leans else []
    refused = tables["refused"]
    if len(refused):
        lines = map("{}: {}".format, refused["file"], refused["reason"])
        parts += ["\n## Records left out\n", *_itemise(lines)]
    return parts


def tabulate_records(records: pd.DataFrame) -> str:
    """Write the table of records in Markdown."""
    rows = [
        [f"{v:.4g}" if isinstance(v, float) else printable(str(v)) for v in line]
        for line in records.itertuples(index=False)
    ]
    return markdown.table([printable(str(name)) for name in records.columns], rows)


def _itemise(texts: Iterable[str]) -> list[str]:
    # file names, reasons and names of schemes are other people's: no link, picture, formula or HTML
    escaped = (re.sub(r"([\\`*\[\]<>$&])", r"\\\1", printable(text)) for text in texts)
    return [f"- {text}" for text in escaped]
