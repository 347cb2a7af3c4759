"""Says what a reader of a run must know: where its numbers come from, and who wins in its cells.

Sensors, truth, tuning, seed and number of records; in each cell the best scheme, or a baseline; and
who regrets least if the world is another one, from a stored sweep.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from owtsweep.config import as_mapping
from owtsweep.config.stored import read
from owtsweep.io.tables import read_table
from owtsweep.results.answer import count_names
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.cube import Cube
from owtsweep.results.regret import SUMMARY
from owtsweep.results.verdicts import Asked, count_cells
from owtsweep.studies.hub.config import HubConfig, SensorConfig
from owtsweep.studies.hub.contract import INSTEAD, SCHEMES, list_baselines, scheme_names
from owtsweep.studies.hub.measures import CRITERIA, JUDGED, MEASURES
from owtsweep.studies.hub.tuning_rules import take_facts
from owtsweep.studies.hub.worlds import find_world, list_departing

#: Value of the configuration key `normalise` -> what the amplitude of a motion measures.
MEANING = {"peak": "largest displacement", "rms": "standard deviation"}


def list_sensors(sensors: SensorConfig) -> dict[str, str]:
    """Return name -> value, in words, of each property of the sensors.

    What the paper's sensors do not have, e.g. a tilt, is listed only if it is there.
    """
    known, imu = take_facts(sensors), sensors.imu
    return {
        "GNSS noise": f"{known.gnss_sigma:g} m",
        "GNSS rate": f"{known.gnss_rate:g} Hz",
        "GNSS delay": f"{known.delay:g} s",
        "IMU noise": f"{known.imu_sigma:g} m/s²",
        "IMU rate": f"{known.imu_rate:g} Hz",
        "IMU bias": f"{imu.bias_initial:g} m/s²",
        "bias walk": f"{imu.bias_walk:g} m/s²/√s",
        **_list_faults(sensors),
    }


def _list_faults(sensors: SensorConfig) -> dict[str, str]:
    """Return name -> value, in words, of what the paper's sensors do not have."""
    gnss, imu = sensors.gnss, sensors.imu
    outliers, red = gnss.outliers, gnss.correlation
    burst = f" in bursts of {outliers.length}" if outliers.length > 1 else ""
    lean = "that of the structure" if isinstance(imu.tilt, str) else f"{imu.tilt:g} rad/m"
    listed = {
        "accuracies read as": (sensors.accuracy, sensors.accuracy != "sigma"),
        "IMU tilt": (lean, imu.tilt != 0.0),
        "IMU high-pass": (f"{imu.high_pass or 0.0:g} Hz", imu.high_pass is not None),
        "GNSS scale": (f"{gnss.scale:g}", gnss.scale != 1.0),
        "GNSS outliers": (f"{outliers.rate:.3g} of {outliers.size:g} sigma{burst}",
                          outliers.rate > 0.0),
        "GNSS outages": (f"of {gnss.loss.length} with {gnss.loss.probability:.3g} per fix",
                         gnss.loses),
        "GNSS red noise": (f"{red.sigma:g} m of {red.time:g} s", red.sigma > 0.0),
    }  # fmt: skip
    return {name: value for name, (value, there) in listed.items() if there}


def describe_truth(config: HubConfig) -> str:
    """Return the truth of a run in one line: the length of a record, and the sensors' faults."""
    faults = [f"{name} {value}" for name, value in _list_faults(config.sensors).items()]
    return ", ".join([_describe_records(config), *faults])


def list_origin_lines(config: HubConfig) -> list[str]:
    """Return lines on tuning, a motion without spectrum, truth, sensors, and records."""
    world, known = find_world(config), take_facts(config.sensors)
    return [
        f"Tuning {config.tuning_name}",
        *([] if world.has_spectrum else [world.describe(config)]),
        describe_truth(config),
        f"Sensors: GNSS {known.gnss_sigma:g} m, {known.gnss_rate:g} Hz, {known.delay:g} s late; "
        f"IMU {known.imu_sigma:g} m/s², {known.imu_rate:g} Hz",
        describe_draws(config),
    ]


def describe_draws(config: HubConfig) -> str:
    """Return in words how many records a cell has, and their seed."""
    if config.engine == "expected":
        return "mean over all records"
    return f"{config.grid.describe_records()}, seed {config.seed}"


def describe_origin(config: HubConfig, draws: str | None = None) -> str:
    """Return in a line the truth, and the number of records per cell with their seed, or `draws`.

    A line about the motion comes before it with motion=plant or motion.envelope, and one about the
    sensors if they have what the paper's have not. So lines fit the width of a figure.
    """
    faults = [f"{name} {value}" for name, value in _list_faults(config.sensors).items()]
    lines = [motion] if (motion := find_world(config).describe(config)) else []
    lines += [", ".join(faults)] if faults else []
    last = f"{_describe_records(config)}; {draws or describe_draws(config)}"
    return "Truth: " + ";\n".join([*lines, last])


def describe_in_a_line(config: HubConfig) -> str:
    """Return in one line the tuning, the truth, and the number of records with their seed."""
    return f"Tuning {config.tuning_name}. {' '.join(describe_origin(config).split())}"


def list_origin(config: HubConfig) -> dict[str, str]:
    """Return name -> value, in words, of a run's tuning, sensors, truth, records and seed."""
    facts = {
        "tuning": config.tuning_name,
        **list_sensors(config.sensors),
        "record length": f"{config.record.duration:g} s",
    }
    if motion := find_world(config).describe(config):
        facts["motion"] = motion
    if config.engine == "expected":
        return facts | {"records per cell": "infinitely many (expected value)"}
    return facts | {"records per cell": config.grid.count_records(), "seed": str(config.seed)}


def _describe_records(config: HubConfig) -> str:
    imu = config.sensors.imu
    return (
        f"records of {config.record.duration:g} s, IMU bias {imu.bias_initial:g} m/s² and walk "
        f"{imu.bias_walk:g} m/s²/√s"
    )


#: Baseline -> what it is, in the note on a map.
ESTIMATES = {
    "NONE": "an estimate of zero",
    "HOLD": "the last fix",
    "DELTA": "a straight line through the last two fixes",
}

#: What a map says of a baseline that has the least error in some cells, but beats no scheme there.
UNDECIDED = (
    "has the least error in some cells, but the data do not tell it and the best scheme apart there"
)


def tell_window(window: str, settling: float | None = None) -> str:
    """Return what an answer that judges a window says of it, and of the other one.

    settling: what the window "settled" leaves out, s; None where no record is judged.
    """
    if window == "full":
        return (
            "Judged: the full record, with its start. Over the settled part alone, as is the "
            "default (measures.window=settled), another may be best."
        )
    part = "the settled part of a record"
    if settling is not None:
        part = f"a record without its first {settling:g} s"
    return (
        f"Judged: {part}. Over the full record, with its start (measures.window=full), another may "
        "be best."
    )


def tell_not_asked(config: HubConfig) -> list[str]:
    """Return a sentence on SKFA, which may be better, if it could take part and does not.

    It is not in the default list, because it costs some 25 s of a processor per record of the
    default map.
    """
    if "SKFA" in scheme_names(config) or not find_world(config).has_spectrum:
        return []
    return [
        "Not asked: SKFA, which tracks the sea. Where that keeps its spectrum for minutes, its "
        "error is at most that of these (docs/better.md); sweep schemes=[HME1,SKFA] compares it."
    ]


class Winners(NamedTuple):
    """What a map of best schemes shows.

    table: rows of the table best_scheme, one per cell. Where a baseline has less error than every
        scheme, it is in the place of the best scheme, and the best scheme in that of the runner-up;
        `distinguishable` then says whether the baseline beats that scheme.
    names: the schemes, and those baselines that have the least error in some cell.
    notes: a sentence on each baseline that beats every scheme in some cell, and one on each that
        has the least error in some cell where the data do not show that.
    """

    table: pd.DataFrame
    names: list[str]
    notes: list[str]


def find_winners(config: HubConfig, best: pd.DataFrame, criterion: str, window: str) -> Winners:
    """Find what a map shows in each cell: the best scheme, or a baseline that has less error."""
    names = scheme_names(config)
    table = best[(best["criterion"] == criterion) & (best["window"] == window)].copy()
    if "baseline_wins" not in table:  # baselines are contenders, or there are none
        leading = [name for name in list_baselines(config) if (table["best"] == name).any()]
        return Winners(table, names + leading, explain(leading))
    leads = table["mse_baseline"] < table["mse_best"]
    led = table[leads]
    wins = led["baseline_wins"].to_numpy(dtype=bool)
    for end, own in (("best", "baseline"), ("runner_up", "best")):
        table.loc[leads, end] = led[own]
        for kind in ("mse", "error"):
            table.loc[leads, f"{kind}_{end}"] = led[f"{kind}_{own}"]
    table.loc[leads, "difference"] = led["mse_best"] - led["mse_baseline"]
    table.loc[leads, ["ci_low", "ci_high", "error_low", "error_high"]] = np.nan
    table.loc[leads, "distinguishable"] = wins
    table.loc[leads, "verdict"] = np.where(wins, "won", "open")
    winning, undecided, leading = (
        [name for name in list_baselines(config) if (cells["baseline"] == name).any()]
        for cells in (led[wins], led[~wins], led)
    )
    doubtful = [f"{name}: {ESTIMATES[name]} {UNDECIDED}." for name in undecided]
    return Winners(table, names + leading, explain(winning) + doubtful)


def explain(baselines: list[str]) -> list[str]:
    """Return a sentence on each baseline that beats every scheme somewhere on a map."""
    return [f"{name}: {ESTIMATES[name]} beats every scheme: {INSTEAD[name]}." for name in baselines]


def make_cube(config: HubConfig, rows: pd.DataFrame, *, baselines: bool = False) -> Cube:
    """Arrange a run's rows as a cube, with `baselines` after the schemes."""
    names = scheme_names(config) + (list_baselines(config) if baselines else [])
    world = find_world(config)
    return Cube.of_rows(rows, names, world.conditions, world.get_grid(config), measures=MEASURES)


def judge_efficiency(summary: pd.DataFrame, config: HubConfig) -> pd.DataFrame:
    """Return a table summary with its columns of efficiency, if the configuration asks for them."""
    if not config.measures.efficiency:
        return summary
    from owtsweep.studies.hub.bounds.cells import add_efficiency

    return add_efficiency(summary, config)


def find_alike(config: HubConfig, rows: pd.DataFrame) -> list[tuple[str, ...]]:
    """Find groups of schemes with equal results; the last of a group stands for it on a map."""
    contenders = [*SCHEMES.rank(config)] if config.grid.decides else ()
    return find_coinciding(make_cube(config, rows), CRITERIA, contenders)


def ask(config: HubConfig) -> Asked:
    """Return what a configuration asks of its map, with the criterion that decides first."""
    first, grid = config.measures.criterion, config.grid
    return Asked(
        {name: JUDGED[name] for name in (first, *CRITERIA)},
        config.measures.window,
        [*SCHEMES.rank(config)],
        list_baselines(config),
        count_cells(find_world(config).get_grid(config)),
        grid.margin,
        grid.most,
    )


def _find_reference() -> Path | None:
    """Return the folder of the stored tables, installed or in a checkout; None without one."""
    package = Path(__file__).resolve().parents[2]
    folders = (package / "worlds", package.parents[1] / "results" / "reference" / "worlds")
    return next((folder for folder in folders if (folder / "origin.yaml").is_file()), None)


def quote_worlds(config: HubConfig) -> list[str]:
    """Return a sentence on who regrets least if the world is another one, as it was computed once.

    There is none for other sensors, another tuning or another motion than those of that sweep, or
    if the run is itself over worlds.
    """
    folder = _find_reference()
    steady = config.motion.kind == "spectrum" and not list_departing(config)
    if folder is None or config.over is not None or not steady:
        return []
    origin = read(folder / "origin.yaml")
    if (config.tuning, as_mapping(config.sensors)) != (origin["tuning"], origin["sensors"]):
        return []
    summary = read_table(folder, SUMMARY)
    cells = int(summary["least_mean"].sum())
    periods = " ".join(f"{period:g}" for period in summary["natural_period"].unique())
    worst = summary.loc[summary.loc[summary["least_worst"], "worst"].idxmax()]
    far = f"{worst['scheme']} has up to {worst['worst']:.2f} times the least error"
    return [
        f"If the world is another one, by a stored sweep of {cells} cells of its own ({periods} s; "
        f"{origin['worlds']} worlds, `{origin['command']}`, {origin['date']}): least mean regret "
        f"{_count(summary, 'mean')} cells, least worst {_count(summary, 'worst')}; "
        f"{far}, in {worst['worst_world']} (docs/regret.md)."
    ]


def _count(summary: pd.DataFrame, kind: str) -> str:
    return count_names(summary.loc[summary[f"least_{kind}"], "scheme"])
