"""Write report.md of a replay: the advice, the records, the errors and the figures."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.errors import InputError, printable
from owtsweep.io import markdown
from owtsweep.io.files import write_atomically
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import pick_facts
from owtsweep.studies.replay.files import label_files
from owtsweep.studies.replay.identification.words import describe_table, warn_of_noise
from owtsweep.studies.replay.loading import load_record, tell_lean
from owtsweep.studies.replay.record import ReplayRecord
from owtsweep.studies.replay.sentences import describe_modes, describe_tilt
from owtsweep.studies.replay.terminal import (
    BASELINES_NOTE,
    list_fit_warnings,
    make_error_cells,
    make_sentences,
    tell_scope,
)

if TYPE_CHECKING:
    import pandas as pd

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


def write(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame], figures: Sequence[Path], folder: Path
) -> Path:
    """Write report.md into a run folder, in which the figures lie; return the path of the file."""
    parts = ["# Replay\n", "## Advice\n"]
    parts += [f"- {_escape(line)}" for line in warn_of_noise(config, tables)]
    parts += [f"- {_escape(line)}" for line in make_sentences(tables["advice"])] or [
        "- none: no scheme ran"
    ]
    parts += [f"- {_escape(line)}" for line in tell_scope(config, tables)]
    if len(config.grid.files) == 1:
        record = load_record(config, config.grid.files[0])
        parts += [f"- {_escape(record.lean)}"] if record.lean else []
        parts += ["", *_describe_one(config, tables, record)]
    else:
        parts += ["", f"## Records\n\n{_describe_many(tables['records'])}"]
        parts += _tell_leans(config)
        parts += _tell_refused(tables["refused"])
    parts.append("\n## Figures\n")
    drawn = {path.stem: path for path in figures if path.suffix == ".png"}
    parts += [
        f"**{caption}**\n\n![{caption}]({drawn[name].relative_to(folder).as_posix()})\n"
        for name, caption in CAPTIONS.items()
        if name in drawn
    ]
    path = folder / "report.md"
    write_atomically(path, "\n".join(parts) + "\n")
    return path


def _describe_one(
    config: ReplayConfig, tables: Mapping[str, pd.DataFrame], record: ReplayRecord
) -> list[str]:
    count = int(tables["errors"]["n"].max()) if len(tables["errors"]) else 0
    headings, rows = make_error_cells(config, tables["errors"])
    return [
        "## The record\n",
        f"- {_escape(Path(record.file).name)}: {KINDS[record.gnss].format(n=count)}",
        f"- {record.steps} IMU steps at {1.0 / record.step:g} Hz "
        f"({record.steps * record.step:.6g} s), fixes at {config.sensors.gnss.rate:g} Hz, "
        f"{config.sensors.gnss.delay:g} s late; tuning {config.tuning}",
        *(f"- {line}" for line in _state_facts(config, tables["records"])),
        *(f"- {_escape(note)}" for note in record.notes),
        "",
        f"## Errors, {config.measures.window} record\n",
        markdown.table(headings, rows),
        "",
        "Mean squared errors of x + y; ± is the 95 % interval over the draws. *In ±1.96 σ*: how "
        "much of the position error lies within what the scheme states (95 % if it knows its "
        "noise). *To later fix*: squared distance of the estimate from the fix that tells of the "
        "same moment later, noise of the fix included. *NIS* is 2 and *white p* not small where "
        f"the filter's innovations are as it expects them to be. {BASELINES_NOTE}.",
        *describe_table(tables),
    ]


def _state_facts(config: ReplayConfig, records: pd.DataFrame) -> list[str]:
    if records.empty:
        return []
    line = pick_facts(records)
    facts = [
        f"displacement: rms {line['rms']:.3g} m, largest {line['peak']:.3g} m along "
        f"{line['direction']:.0f} deg from x, which carries "
        f"{100 * line['direction_share']:.0f} % of the variance"
    ]
    facts.append(describe_modes(config, line))
    if tilt := describe_tilt(config, line):
        facts.append(tilt)
    if np.isfinite(line["natural_period"]):
        facts.append(
            f"Eq. (1): natural period {line['natural_period']:.4g} ± "
            f"{1.96 * line['natural_period_error']:.2g} s, half-bandwidth "
            f"{line['half_bandwidth']:.3g} ± {1.96 * line['half_bandwidth_error']:.2g} Hz, "
            + ", ".join(f"{name} = {line[name]:.4g}" for name in "abc")
            + f"; {100 * line['band_share']:.0f} % of the variance lies in the band "
            f"[{config.fit_band[0]:g}, {config.fit_band[1]:g}] Hz, and "
            f"{100 * line['fit_share']:.0f} % under the curve, which is what the expected "
            "map judges"
        )
        facts += [
            f"the fit of Eq. (1): {warning}"
            for warning in list_fit_warnings(config, config.grid.files[0])
        ]
        low, high = config.fit_band
        if not low <= 1.0 / line["natural_period"] <= high:
            facts.append("its peak lies outside band, so it has no place in the expected map")
    else:
        facts.append("Eq. (1) could not be fitted, so the record has no place in the expected map")
    return facts


def _describe_many(records: pd.DataFrame) -> str:
    kept = [name for name in records.columns if not name.startswith("spectrum_") or
            name == "spectrum_natural_period"]  # fmt: skip
    rows = [
        [f"{v:.4g}" if isinstance(v, float) else printable(str(v)) for v in line]
        for line in records[kept].itertuples(index=False)
    ]
    return markdown.table([printable(str(name)) for name in kept], rows)


def _tell_leans(config: ReplayConfig) -> list[str]:
    lines = []
    for label, file in label_files(config.grid.files).items():
        try:
            lean = tell_lean(config, file)
        except InputError:  # a record that was left out
            continue
        lines += [f"- {_escape(f'{label}: {lean}')}"] if lean else []
    return ["", *lines] if lines else []


def _tell_refused(refused: pd.DataFrame) -> list[str]:
    if refused.empty:
        return []
    both = zip(refused["file"], refused["reason"], strict=True)
    lines = [f"- {_escape(str(file))}: {_escape(str(reason))}" for file, reason in both]
    return ["\n## Records left out\n", *lines]


def _escape(text: str) -> str:
    """Escape a text of other people for Markdown: no link, picture, formula or HTML."""
    return re.sub(r"([\\`*\[\]<>$&])", r"\\\1", printable(text))
