"""Ask which rule for outlying fixes wins where, and whether a moving horizon earns its place.

    python -m experiments.outliers [FOLDER]

FOLDER (default: results/outliers) gets outliers.csv and the figure, as PNG and SVG. A truth is
white noise with outliers (single or in bursts), with outages, or with red noise. A way is a scheme
with a rule for fixes far from their prediction; "gate 5" refuses up to five fixes in a row instead
of one. Every way runs on the same records at natural period 4 s, with the bias of
sensors=strong_bias and tuning=matched. Criterion: settled MSE of the position, x + y.
"""

from functools import partial
from itertools import product

import numpy as np
import pandas as pd
from scipy.stats import t as student

from experiments.command import read_data, read_words, write
from owtsweep.evaluation.loop import run_estimator
from owtsweep.figures import style
from owtsweep.studies import compose
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.sensors import observe

PERIOD = 4.0  # s
RECORDS = 10
AMPLITUDES = (0.05, 0.2, 1.0, 3.0)  # m
#: The truths, and the ways: name -> overrides.
TRUTHS, WAYS = read_data(__file__).values()
BASE = [
    "tuning=matched", "sensors=strong_bias", "record.duration=240", "measures.settling_time=60",
    f"grid.natural_period=[{PERIOD}]",
]  # fmt: skip


def run_ways(truth, faults):
    """Return the settled MSE of every way, amplitude and record under one truth, as rows."""
    faults = [f"sensors.gnss.{fault}" for fault in faults]
    configs = {way: compose([*BASE, *faults, *keys]) for way, keys in WAYS.items()}
    first = next(iter(configs.values()))
    records = make_records(first, PERIOD, list(range(RECORDS)))
    known, settled = records.sensors, round(first.measures.settling_time / records.sensors.step)
    rows = []
    for record, amplitude in product(range(RECORDS), AMPLITUDES):
        motion, noise = records.motion[record], records.noise[record]
        data = observe(motion, records.direction, known).add_noise(amplitude, noise)
        position = amplitude * np.outer(motion.position, records.direction)
        for way in WAYS:
            estimator = resolve(way.split()[0]).stream(Known(known, configs[way]))
            state = run_estimator(estimator, *data, known.fix_interval).state
            squares = np.sum((state[settled:, :2] - position[settled:]) ** 2, axis=1)
            rows.append((truth, amplitude, way, record, float(np.mean(squares))))
    return pd.DataFrame(rows, columns=["truth", "amplitude", "way", "record", "mse"])


def summarise(rows):
    """Return mean MSE and mean of log2 of the ratio to HME1 plain, per truth, amplitude and way.

    The ratio has the half-width of a 95 % interval over the records, in log2.
    """
    wide = rows.pivot(index=["truth", "amplitude", "record"], columns="way", values="mse")
    ratio = np.log2(wide.div(wide["HME1 plain"], axis=0))
    grouped = ratio.groupby(level=["truth", "amplitude"])
    half = student.ppf(0.975, RECORDS - 1) * grouped.std(ddof=1) / np.sqrt(RECORDS)
    parts = {
        "mse": wide.groupby(level=["truth", "amplitude"]).mean(),
        "log2_ratio": grouped.mean(),
        "half_width": half,
    }
    table = pd.concat({name: part.stack() for name, part in parts.items()}, axis=1).reset_index()
    order = {name: number for number, name in enumerate([*TRUTHS, *WAYS])}
    keys = ["truth", "amplitude", "way"]
    return table.sort_values(keys, key=lambda column: column.map(order).fillna(column))


def draw(table):
    """Return a figure with one panel per truth: ways over amplitudes, MSE as a colour and number.

    The best way of a column, and every way whose MSE is at most 5 % above, is printed bold.
    """
    figure = style.new_figure(11.0, 9.0)
    axes = figure.subplots(2, 4, sharex=True, sharey=True)
    for unused in axes.ravel()[len(TRUTHS) :]:
        unused.set_axis_off()
    for axis, truth in zip(axes.ravel(), TRUTHS, strict=False):
        part = table[table.truth == truth].pivot(index="way", columns="amplitude", values="mse")
        values = part.loc[list(WAYS)].to_numpy()
        best = values.min(axis=0)
        axis.imshow(np.log2(values / best), aspect="auto", vmin=0.0, vmax=4.0, cmap="Blues")
        for row, column in np.ndindex(values.shape):
            near = values[row, column] <= 1.05 * best[column]
            axis.text(
                column, row, f"{values[row, column]:.2g}", ha="center", va="center", fontsize=7,
                weight="bold" if near else "normal",
                color="white" if values[row, column] > 6.0 * best[column] else "black",
            )  # fmt: skip
        axis.set_title(truth, fontsize=9)
        axis.grid(False)
        axis.set_xticks(range(len(AMPLITUDES)), [f"{value:g}" for value in AMPLITUDES])
        axis.set_yticks(range(len(WAYS)), list(WAYS))
    figure.supxlabel("amplitude in m")
    figure.suptitle(
        "Settled MSE of the position in m² (x + y); bold: the best of its column, and within 5 %\n"
        f"Natural period 4 s, {RECORDS} records of 240 s, seed 2019, tuning matched, outliers of "
        "10 sigma; the bluer, the farther from the best (darkest: 16 times or more)",
        fontsize=10,
    )
    return figure


def main():
    """Run all ways under all truths; write the table and the figure."""
    folder, _, _ = read_words("results/outliers")
    rows = []
    for truth, faults in TRUTHS.items():
        rows.append(run_ways(truth, faults))
        print(truth, flush=True)
    table = summarise(pd.concat(rows, ignore_index=True))
    write(folder, {"outliers": table}, {"outliers": partial(draw, table)})


if __name__ == "__main__":
    main()
