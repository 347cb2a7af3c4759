"""Tell what a record shows of its sensors: rows of results, a table, and lines of the advice."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.io import markdown
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.identification.of_record import UNITS, Estimated, Noise

if TYPE_CHECKING:
    import pandas as pd

#: Values of the column `noise` of the advice.
STATED, ESTIMATED = "stated", "estimated"
#: Value in the column `scheme` of rows on a record's noise.
NOISE = "noise_of_record"
#: Row of the table for innovations that are not Gaussian; its estimate is their excess kurtosis.
TAILS = "excess_kurtosis"
COLUMNS = ("file", "parameter", "unit", "source", "stated", "estimate", "low", "high", "inside")
_NUMBERS = ("stated", "estimate", "low", "high")
#: NIS per degree of freedom outside of this range is said.
RIGHT_NIS = (0.5, 2.0)
#: Degrees of freedom of a fix.
FREEDOM = 2
#: Columns of the table of noise that tell an estimate.
BOUNDS = ("estimate", "low", "high", "unit")


def name_second_run(scheme: str) -> str:
    """Return the name, in rows of results, of a scheme that was run with the estimated noise."""
    return f"{scheme} (estimated noise)"


def list_values(noise: Noise) -> Iterator[tuple[str, str, float, int]]:
    """Yield the numbers of a record's noise as ("source: parameter", window, value, 1)."""
    for one in noise.parameters:
        numbers = asdict(one)
        for window in _NUMBERS:
            if np.isfinite(numbers[window]):
                yield (f"{one.source}: {one.parameter}", window, float(numbers[window]), 1)
    if noise.heavy_tails:
        yield (f"innovations: {TAILS}", "estimate", noise.heavy_tails, 1)


def tabulate_noise(rows: pd.DataFrame, files: Sequence[str]) -> pd.DataFrame:
    """Make the table of noise from a replay's rows of results, in the order of `files`."""
    import pandas as pd

    kept = rows[rows["scheme"] == NOISE]
    found = {(f, m, w): v for f, m, w, v in kept[["file", "measure", "window", "value"]].to_numpy()}
    lines = []
    for file in files:
        measures = {
            measure.partition(": ")[2]: measure for name, measure, _ in found if name == file
        }
        for parameter in [*UNITS, TAILS]:
            if parameter not in measures:
                continue
            measure = measures[parameter]
            source = measure.partition(": ")[0]
            numbers = [float(found.get((file, measure, w), np.nan)) for w in _NUMBERS]
            inside = Estimated(parameter, source, *numbers).inside
            unit = UNITS.get(parameter, "")
            lines.append((file, parameter, unit, source, *numbers, inside))
    return pd.DataFrame(lines, columns=list(COLUMNS))


def pick_second_run(rows: pd.DataFrame, schemes: Sequence[str]) -> pd.DataFrame:
    """Return the rows of the schemes' run with the estimated noise, under the schemes' names."""
    names = {name_second_run(scheme): scheme for scheme in schemes}
    kept = rows[rows["scheme"].isin(list(names))]
    return kept.assign(scheme=kept["scheme"].map(names))


def warn_of_noise(config: ReplayConfig, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Say where the stated noise does not fit the records: NIS first, then each parameter."""
    lines = []
    errors, advised, noise = tables["errors"], tables["advice"], tables.get("noise")
    for file in dict.fromkeys(advised["file"]):
        start = f"{file}: " if advised["file"].nunique() > 1 else ""
        lines += [start + line for line in _warn_of_nis(config, file, errors, advised)]
        if noise is not None and len(noise):
            lines += [start + line for line in _compare(noise[noise["file"] == file])]
    return lines


def count_doubted(tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Say on how many records the stated noise is not what the record shows; [] if on none."""
    noise = tables["noise"]
    doubted = noise[~noise["inside"].astype(bool)]["file"].nunique()
    return [f"on {doubted} records the stated noise is not the record's (noise.csv)"] * bool(
        doubted
    )


def _warn_of_nis(
    config: ReplayConfig, file: str, errors: pd.DataFrame, advised: pd.DataFrame
) -> list[str]:
    rows = advised[(advised["file"] == file) & (advised["source"] != "map")]
    rows = rows[rows["noise"] != ESTIMATED]
    lines = []
    for best in rows["best"]:
        chosen = (errors["file"] == file) & (errors["scheme"] == best)
        chosen &= (errors["measure"] == "nis") & (errors["window"] == config.measures.window)
        for nis in errors[chosen]["mean"]:
            if not RIGHT_NIS[0] <= nis / FREEDOM <= RIGHT_NIS[1]:
                size = "larger" if nis > FREEDOM else "smaller"
                lines.append(
                    f"the stated noise does not fit: {best}'s innovations are {size} than its "
                    f"noise explains (NIS {nis:.3g}, {FREEDOM} is right)"
                )
    return lines


def _compare(noise: pd.DataFrame) -> list[str]:
    lines = []
    rows = noise.to_dict("records")
    for row in rows:
        if row["parameter"] == TAILS:
            lines.append(
                f"the {TAILS.replace('_', ' ')} of the innovations is {row['estimate']:.2g} (0 for "
                "Gaussian noise): outliers or a changing quality of the positions, which no sigma "
                "describes"
            )
        elif not row["inside"]:
            found, also = _format_estimate(*(row[name] for name in BOUNDS)), ""
            if row["parameter"] == "sensors.gnss.delay":
                also = "; with the offset between the clocks of GNSS and IMU"
            lines.append(
                f"{row['parameter']}: {row['stated']:.4g} {row['unit']} stated, the record says "
                f"{found}{also}"
            )
    if rows and not lines:
        lines.append("the stated noise agrees with the record, so no second run with estimates")
    return lines


def _format_estimate(estimate: float, low: float, high: float, unit: str) -> str:
    open_below = np.isnan(low) or (low == 0.0 and unit != "s")
    if open_below and np.isnan(high):
        return "nothing about it"
    if open_below:
        return f"less than {high:.3g} {unit}"
    if np.isnan(high):
        return f"more than {low:.3g} {unit}"
    return f"{estimate:.3g} {unit} ({low:.3g} to {high:.3g})"


def describe_table(tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return the lines of the report's section on noise; [] if nothing was estimated."""
    noise = tables.get("noise")
    if noise is None or noise.empty:
        return []
    cells = []
    for row in noise.to_dict("records"):
        found = _format_estimate(*(row[name] for name in BOUNDS))
        if row["parameter"] == TAILS:
            found = f"{row['estimate']:.2g}"
        stated = "" if np.isnan(row["stated"]) else f"{row['stated']:.4g} {row['unit']}"
        inside = "yes" if row["inside"] else "no"
        cells.append([row["parameter"], row["source"], stated, found, inside])
    headings = ["parameter", "from", "stated", "from the record (95 %)", "inside"]
    return [
        "",
        "## Noise of the recorded sensors\n",
        markdown.table(headings, cells),
        "",
        "Maximum likelihood, from the positions minus the double integral of the specific force; "
        "nothing is assumed of the motion. The delay of recorded fixes contains the offset "
        "between the clocks of GNSS and IMU. *clock_offset* is how much later the reference's "
        "clock shows a moment than the IMU's. A slow disturbance, such as gravity in a tilting "
        "IMU, counts as noise.",
    ]
