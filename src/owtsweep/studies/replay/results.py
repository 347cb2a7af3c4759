"""Make the tables of a replay from its rows of results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial

import numpy as np
import pandas as pd

from owtsweep.errors import InputError
from owtsweep.statistics.inference import mean_and_error, t_quantile
from owtsweep.studies.hub.public import SCHEMES, resolve_all
from owtsweep.studies.replay import advice, measures
from owtsweep.studies.replay.blocks import RECORD
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import pick_facts
from owtsweep.studies.replay.files import label_files
from owtsweep.studies.replay.identification.of_record import UNITS
from owtsweep.studies.replay.place import expect_at_record, find_measure
from owtsweep.studies.replay.seastates import read_sea_states
from owtsweep.sweep.study import FAILED, OK


def aggregate(config: ReplayConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Make the tables of a replay from its rows; docs/replay.md describes the columns."""
    done = rows[rows["status"] == OK]
    schemes = rank_schemes(config)
    labels = list(label_files(config.grid.files))
    shown = [*schemes, *measures.BASELINE_ROWS]
    errors = _average_errors(done[done["scheme"].isin(shown)], labels, shown)
    kept = ["scheme", "measure", "window", "mean"]
    values = errors[kept if len(labels) == 1 else ["file", *kept]]
    records = _list_records(config, done[done["scheme"] == RECORD], labels)
    advised = [*_advise(config, done, schemes, labels, records)]
    tables = {
        "replay": values.rename(columns={"mean": "value"}),
        "errors": errors,
        "records": records,
        "noise": _tabulate_noise(done, labels),
        "advice": pd.DataFrame(advised, columns=list(advice.COLUMNS)),
    }
    if len(labels) > 1:  # a single record that cannot be used is refused before it is run
        failed = rows[(rows["status"] == FAILED) & (rows["scheme"] == RECORD)]
        failed = failed.drop_duplicates("file", keep="last")
        tables["refused"] = _sort(failed[["file", "reason"]].astype(str), file=labels)
    return tables


def rank_schemes(config: ReplayConfig) -> dict[str, int]:
    """Return scheme -> how simple it is, in the order of the key `schemes`."""
    ranks = SCHEMES.rank(config)
    return {scheme.name: ranks[scheme.name] for scheme in resolve_all(config.schemes, config)}


def _average_errors(
    rows: pd.DataFrame, files: Sequence[str], schemes: Sequence[str]
) -> pd.DataFrame:
    kept = rows[rows["window"].isin(measures.WINDOWS)]
    keys = ["file", "scheme", "measure", "window"]
    lines = []
    for key, group in kept.groupby(keys, sort=False):
        samples = group.sort_values("replicate")["value"].to_numpy(dtype=float)
        mean, error, n = mean_and_error(samples)
        half = float(t_quantile(n - 1) * error)
        lines.append((*key, float(mean), float(mean) - half, float(mean) + half, int(n)))
    table = pd.DataFrame(lines, columns=[*keys, "mean", "ci_low", "ci_high", "n"])
    named = dict.fromkeys(table["measure"])
    return _sort(table, file=files, scheme=schemes, measure=[*named], window=measures.WINDOWS)


def _sort(table: pd.DataFrame, **order: Sequence[str]) -> pd.DataFrame:
    """Sort a table by some columns, the first one first, each in the order of its values given."""
    return table.sort_values(
        [*order], key=lambda column: column.map(order[str(column.name)].index), kind="stable",
        ignore_index=True,
    )  # fmt: skip


def _list_records(config: ReplayConfig, rows: pd.DataFrame, files: Sequence[str]) -> pd.DataFrame:
    wide = rows.pivot_table(index="file", columns="measure", values="value", sort=False)
    there = [file for file in files if file in wide.index]
    table = wide.reindex(there).rename_axis(columns=None).reset_index()
    states = read_sea_states(config)
    return table if states is None else states.merge(table, on="file", how="right")


def _tabulate_noise(rows: pd.DataFrame, files: Sequence[str]) -> pd.DataFrame:
    numbers = ["stated", "estimate", "low", "high"]
    kept = rows[rows["scheme"] == measures.NOISE]
    wide = kept.pivot_table(index=["file", "measure"], columns="window", values="value")
    table = wide.reindex(columns=numbers).reset_index()
    table[["source", "parameter"]] = (
        table["measure"].str.split(": ", expand=True).reindex(columns=[0, 1])
    )
    table["unit"] = table["parameter"].map(UNITS).fillna("")
    table["inside"] = ~((table["stated"] < table["low"]) | (table["stated"] > table["high"]))
    table = _sort(table, file=files, parameter=[*UNITS, measures.TAILS])
    return table[["file", "parameter", "unit", "source", *numbers, "inside"]]


def _advise(
    config: ReplayConfig,
    rows: pd.DataFrame,
    schemes: Mapping[str, int],
    files: Sequence[str],
    records: pd.DataFrame,
) -> Iterator[dict[str, object]]:
    again = {
        measures.name_second_run(scheme): scheme for scheme in [*schemes, *measures.BASELINE_ROWS]
    }
    judge = partial(
        advice.advise,
        schemes=schemes,
        criterion=config.measures.criterion,
        window=config.measures.window,
    )
    for file in files:
        of_file = rows[rows["file"] == file]
        stated = judge(of_file[of_file["scheme"].isin([*schemes, *measures.BASELINE_ROWS])])
        second = of_file[of_file["scheme"].isin([*again])]
        estimated = judge(second.assign(scheme=second["scheme"].map(again)))
        if stated and estimated:
            advice.prefer_better(stated, estimated)
        by_map = None
        record = records[records["file"] == file]
        if not record.empty:
            with suppress(InputError):  # a scheme has no expectation; the report says so
                by_map = _advise_from_map(config, schemes, pick_facts(record), stated)
        noises = (
            (stated, measures.STATED),
            (by_map, measures.STATED),
            (estimated, measures.ESTIMATED),
        )
        yield from ({"file": file, **row, "noise": noise} for row, noise in noises if row)


def _advise_from_map(
    config: ReplayConfig,
    schemes: Mapping[str, int],
    record: Mapping[str, float],
    by_record: Mapping[str, object] | None,
) -> dict[str, object] | None:
    errors = expect_at_record(config, record)  # not of SKFA and others without a chain
    if errors is None:
        return None
    samples = np.array([[error] for error in errors.values()])
    judged = advice.judge(samples, list(errors), schemes)
    return judged and {
        "source": "map",
        "criterion": find_measure(config),
        "window": "settled",
        **judged,
        "counts": False,
        **advice.relate_to_record(errors, by_record, record["fit_share"]),
    }
