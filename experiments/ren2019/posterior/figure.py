"""Draw the posterior's main results from its stored tables: which readings, and which numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from experiments.ren2019.evidence import SCHEMES
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.io.tables import read_table

#: Readings shown, the greatest evidence first.
SHOWN = 10


def draw(folder: Path) -> list[Path]:
    """Draw `posterior.png` and `.svg` into the folder that has the tables; return the files."""
    evidence, numbers = read_table(folder, "evidence"), read_table(folder, "numbers")
    with style.context():
        figure = style.new_figure(11.0, 7.2)
        left, right = figure.subplots(1, 2, width_ratios=[1.0, 1.5])
        readings, tried = read_table(folder, "readings"), len(read_table(folder, "first_look"))
        _draw_evidence(left, readings, evidence)
        _draw_numbers(right, numbers)
        figure.suptitle(
            f"What can Ren et al. (2019) have done? Closest of {tried} readings:\n"
            f"{describe(evidence.iloc[0])}",
            x=0.01,
            ha="left",
        )
        style.footnote(
            figure,
            "Left: natural logarithms, discrepancies inferred; scatter of single records at "
            "draws of each reading's own posterior (dotted: a factor of 10). Right, for the "
            "closest: each table of the print as the other three predict it for one record; dots "
            "are medians. Crosses: the print lies outside. Seed 1; 240 records.",
        )
        return style.save(figure, folder, "posterior", {})


def describe(row: pd.Series) -> str:
    """Return a reading in words, from a row of the table `evidence`."""
    start = "whole" if row["start"] else "without its start"
    force = {"level": "level IMU", "leaning": "IMU leaning", "against": "IMU leaning against",
             "coupled": "AC-coupled IMU",
             "coupled_high": "AC-coupled IMU (.05 Hz)"}[row["force"]]  # fmt: skip
    spectrum = "" if row["spectrum"] == "middle" else f"{row['spectrum']} spectrum, "
    accuracy = {"sigma": "σ", "uniform": "uniform ±", "three_sigma": "3 σ"}[row["accuracy"]]
    return f"{accuracy}, {row['length']:g} s {start}, {force}, {spectrum}{row['seeds']} seeds"


def _draw_evidence(axes: Axes, readings: pd.DataFrame, own: pd.DataFrame) -> None:
    """Draw the closest readings, and again those that were sampled closely."""
    readings = readings.assign(name=[describe(row) for _, row in readings.iterrows()])
    own = own.assign(name=[describe(row) for _, row in own.iterrows()])
    kept = (readings.index < SHOWN) | readings["name"].isin(own["name"])
    shown = readings[kept].iloc[::-1].reset_index(drop=True)
    place = {name: number for number, name in enumerate(shown["name"])}
    axes.errorbar(
        shown["below"], shown.index, xerr=shown["error"], fmt="o", color="black",
        label="80 live points",
    )  # fmt: skip
    axes.errorbar(
        own["below"], own["name"].map(place), xerr=own["error"], fmt="D", color="C1", mfc="none",
        label="250, one turn later",
    )  # fmt: skip
    axes.axvline(-np.log(10.0), color="black", linestyle=":", linewidth=1.0)
    axes.set_yticks(shown.index, shown["name"], fontsize=7)
    axes.set_xlabel("log evidence below the greatest")
    axes.set_title("the closest readings", loc="left")
    axes.legend(loc="center left", fontsize=7)


def _draw_numbers(axes: Axes, table: pd.DataFrame) -> None:
    places, labels = [], []
    for place, row in enumerate(table.to_dict("records")):
        line = -(place + place // 16)  # a gap between tables
        colour = style_of(str(row["scheme"]), SCHEMES).color
        low, middle, high = (
            row[f"out_{end}"] / row["published"] for end in ("low", "median", "high")
        )
        axes.plot([low, high], [line, line], color=colour, linewidth=2.0)
        marker = "o" if row["inside"] else "X"
        axes.plot(middle, line, marker, color=colour, markersize=4 if row["inside"] else 7)
        places.append(line)
        labels.append(f"{row['table']}  {row['scheme']} {row['measure']}")
    axes.axvline(1.0, color="black", linewidth=1.0)
    axes.set_xscale("log")
    axes.set_yticks(places, labels, fontsize=5)
    axes.set_xlabel("predicted / printed mean square error, 95 %")
    inside = int(table["inside"].sum())
    axes.set_title(f"tables 6 to 9: {inside} of {len(table)} numbers inside", loc="left")
