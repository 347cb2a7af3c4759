"""Run one scheme on a record, piece by piece; write the estimates of all schemes to files.

Pieces, because a whole day at 100 Hz would take several GB of memory.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.loop import Updating, run_steps
from owtsweep.evaluation.trajectory import Trajectory, spread_to_both_axes
from owtsweep.studies.hub import public as hub
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.record import LONG, ReplayRecord, Signals, cut_into_pieces, listen

STATES = ("x", "y", "vx", "vy")
DEVIATIONS = ("x_std", "y_std", "vx_std", "vy_std")
COLUMNS = ("time", "scheme", *STATES, *DEVIATIONS)
#: Rows written at once, and approximate bytes of a row in CSV and in Parquet.
WRITTEN, ROW = 500_000, (160, 60)


def estimate_pieces(
    config: hub.HubConfig,
    scheme: hub.Scheme,
    sensors: hub.Sensors,
    replicates: Sequence[Signals],
    edges: Sequence[int],
) -> Iterator[tuple[Trajectory, ...]]:
    """Run a scheme on some replicates of a record; yield a `Trajectory` of each, piece by piece.

    If every fix arrived, the batch engine runs all replicates at once. If fixes are missing, gains
    depend on which these are: the scheme's online form (`stream`) computes them step by step. With
    engine=reference, or without kernel and online form, `update` is called at every step. Estimates
    depend neither on the pieces nor on the number of replicates.

    edges: the steps at which the pieces begin, and the number of steps.
    Raises ValueError if an estimate lacks a quantity, has the wrong shape or is not finite.
    """
    known, start = hub.Known(sensors, config), scheme.start
    if config.engine == "batch":
        complete = all(bool(np.all(np.isfinite(signals.fixes))) for signals in replicates)
        if complete and scheme.batched == "chain":
            chain = scheme.kernel_for_runs(known, replicates[0].steps)
            return _run_kernel(chain, sensors, replicates, edges)
        start = scheme.stream
    runs = [_run_estimator(start(known), sensors, signals, edges) for signals in replicates]
    return zip(*runs, strict=True)


def rotate_force(signals: Signals, sensors: hub.Sensors) -> Iterator[Array]:
    """Yield the measured specific force in NED coordinates, in m/s^2, in pieces of shape (n, 2)."""
    return (piece @ sensors.rotation.T for piece in signals.force())


def make_lanes(
    replicates: Sequence[Signals], sensors: hub.Sensors
) -> tuple[hub.OnePassSeries, Array]:
    """Arrange the measurements of replicates side by side, for the batch engine.

    Returns the specific force in NED (m/s^2, one row per step) and the fixes (m, one row each),
        with the columns x and y of the first replicate, then of the second, and so on.
    """
    pieces = zip(*(rotate_force(signals, sensors) for signals in replicates), strict=True)
    side_by_side = (np.concatenate(parts, axis=1) for parts in pieces)
    fixes = np.concatenate([signals.fixes for signals in replicates], axis=1)
    return hub.OnePassSeries(side_by_side, (replicates[0].steps, 2 * len(replicates))), fixes


def _run_kernel(
    chain: hub.Chain, sensors: hub.Sensors, replicates: Sequence[Signals], edges: Sequence[int]
) -> Iterator[tuple[Trajectory, ...]]:
    estimates, count = hub.chunks(chain, *make_lanes(replicates, sensors)), len(replicates)
    covariances = spread_to_both_axes(chain.covariance)
    first, size, chunk = next(estimates)
    for begin, end in itertools.pairwise(edges):
        # x, y, vx, vy and innovations of each replicate
        numbers = np.empty((end - begin, count, 6))
        at = begin
        while at < end:
            if at == first + size:
                first, size, chunk = next(estimates)
            stop = min(first + size, end)
            pairs = [lanes[at - first : stop - first].reshape(-1, count, 2) for lanes in chunk]
            np.concatenate(pairs, axis=2, out=numbers[at - begin : stop - begin])
            at = stop
        row = chain.gains.row(np.arange(begin, end))
        fresh = chain.gains.fresh[row]
        numbers[~fresh, :, 4:] = np.nan
        variance = np.where(fresh, chain.gains.innovation_variance[row], np.nan)
        covariance = covariances[row]
        innovation_covariance = variance[:, None, None] * np.eye(2)
        piece = [
            Trajectory(each[:, :4], covariance, each[:, 4:], innovation_covariance)
            for each in numbers.swapaxes(0, 1)
        ]
        # Free this piece of a long record before the next one is made.
        del numbers, covariance, innovation_covariance, variance, row
        yield tuple(piece.pop(0) for _ in replicates)


def _run_estimator(
    estimator: Updating, sensors: hub.Sensors, signals: Signals, edges: Sequence[int]
) -> Iterator[Trajectory]:
    force = hub.OnePassSeries(signals.force(), (signals.steps, 2))
    M = sensors.fix_interval
    for begin, end in itertools.pairwise(edges):
        positions = np.full((end - begin, 2), np.nan)
        first_fix = -(-begin // M)
        positions[first_fix * M - begin :: M] = signals.fixes[first_fix : -(-end // M)]
        yield run_steps(estimator, np.ascontiguousarray(force[begin:end]), positions, first=begin)


def write_estimates(
    config: ReplayConfig,
    file: str,
    folder: Path,
    say: Callable[[str], None],
    failed: Collection[str] = (),
) -> None:
    """Write all schemes' estimates on a record (replicate 0) to Parquet, and to a CSV per scheme.

    The columns are `COLUMNS`: time in s and x, y in m as in the record's file, m/s, and standard
    deviations, NaN without a covariance; the CSV have no `scheme`.

    folder: is made if need be.
    say: shows the user a line, before slow work on a long record.
    failed: names of schemes that failed on the record; they are left out.
    """
    import pyarrow as pa
    import pyarrow.csv as pc
    import pyarrow.parquet as pq

    record = load_record(config, file)
    sensors = hub.make_sensors(config.sensors)
    signals = listen(config, sensors, record, 0)
    schemes = [one for one in hub.resolve_all(config.schemes, config) if one.name not in failed]
    (folder / "estimates").mkdir(parents=True, exist_ok=True)
    if record.steps > LONG:
        rows = record.steps * len(schemes)
        say(
            f"writing {rows:,} rows of estimates, some {rows * ROW[0] / 1e9:.1f} GB of CSV and "
            f"{rows * ROW[1] / 1e9:.1f} GB of Parquet"
        )
    fields = [(name, pa.string() if name == "scheme" else pa.float64()) for name in COLUMNS]
    schema = pa.schema(fields)
    schema_of_csv = schema.remove(schema.get_field_index("scheme"))
    edges = cut_into_pieces(record.steps, WRITTEN)
    with (
        _replace_when_written(folder / "estimates.parquet") as target,
        pq.ParquetWriter(target, schema, write_page_checksum=True) as writer,
    ):
        for scheme in schemes:
            pieces = estimate_pieces(config, scheme, sensors, [signals], edges)
            with (
                _replace_when_written(folder / "estimates" / f"{scheme.name}.csv") as temporary,
                pc.CSVWriter(temporary, schema_of_csv) as text,
            ):
                for columns in _make_columns(record, pieces, scheme.name):
                    table = pa.table(columns, schema=schema)
                    writer.write_table(table)
                    text.write_table(table.drop_columns(["scheme"]))
    record.release_memory()


@contextmanager
def _replace_when_written(path: Path) -> Iterator[str]:
    """Give the name of a temporary file inside a `with` block; then rename this file to `path`."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield str(temporary)
        os.replace(temporary, path)
    except OSError as error:
        error.add_note(str(path))  # the error itself has the temporary name, or none
        raise
    finally:
        temporary.unlink(missing_ok=True)


def _make_columns(
    record: ReplayRecord, pieces: Iterator[tuple[Trajectory, ...]], name: str
) -> Iterator[dict[str, object]]:
    origin = np.concatenate([record.origin, np.zeros(2)])
    first = 0
    for (estimated,) in pieces:
        part = slice(first, first + len(estimated.state))
        first = part.stop
        numbers = np.vstack([(estimated.state + origin).T, estimated.deviation.T])
        names = [name] * len(estimated.state)
        yield dict(zip(COLUMNS, (record.time_at(part), names, *numbers), strict=True))
