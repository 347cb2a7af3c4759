"""Frozen runs: the rows and random streams of small runs, kept before the house is rebuilt.

    OPENBLAS_NUM_THREADS=1 python tests/frozen/freezing.py --make      # rows.parquet, streams.json
    OPENBLAS_NUM_THREADS=1 python tests/frozen/freezing.py [STUDY...]  # compare; all by default

`runs.yaml` names the runs. Rows are those of `Run.cases()`, with all columns. Rows are matched by
what identifies them (study, run, conditions, replicate, scheme, measure, window and so on), not by
their order.

How near numbers must be depends on where they are made:

- On the machine that made the fixture (`machine()` is equal: processor, Python, libraries, BLAS
  threads), numbers are equal to 1e-9 of the largest magnitude of their column in the same run,
  scheme, measure and window: since the fixture was made, kernels no longer add products with
  fused multiply-add, which moves last digits.
- On another machine, numbers are equal to `ELSEWHERE` of that magnitude, 1e-9. There are two
  exceptions. They are from the machine that made the fixture with the kernels of an old processor
  (OPENBLAS_CORETYPE=Nehalem, numpy without AVX2 and FMA), where all else differed by 5e-11 or less.
  The tower's damage did by 1.4e-5 (MDE's stress cycles on the default turbine): 1e-4 is asked of
  the tower. What a replay fits to a record, by an optimiser, did by 4e-3: 1e-2 is asked of that.

Texts, statuses, counts and gaps (NaN) are equal everywhere. A run whose rows are in the fixture but
are not made, or the reverse, is a difference.

To freeze anew is to give up the comparison with what was before: do it only before the first change
of a rebuild, or for a change of numbers that is meant, and say so in the commit.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import json
import os
import platform
import runpy
import shutil
import sys
import tempfile
import time
import zlib
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from unittest import mock

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import yaml

import owtsweep
from owtsweep import streams

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
ROWS, STREAMS = HERE / "rows.parquet", HERE / "streams.json"
STUDIES = yaml.safe_load((HERE / "runs.yaml").read_text("utf-8"))
#: Columns that hold results; all others say which row it is.
RESULTS = (
    "motion", "cross", "noise", "value", "n_samples", "status", "reason",
)  # fmt: skip
#: Columns that are compared as what they are, never nearly.
EXACT = ("n_samples", "status", "reason")
#: Columns with which the largest magnitude is sought, besides the run.
SCALES = ("tuning", "scheme", "measure", "window")
HERE_AGAIN = 1e-9
#: Study -> how near numbers must be on another machine; "" is all others.
ELSEWHERE = {"tower": 1e-4, "": 1e-9}
#: Values of the column `scheme` in rows that hold what a replay fits; how near these must be.
FITTED, NEAR_FITS = ("", "noise_of_record"), 1e-2
#: Run -> seconds of the processor that it took in this process.
SECONDS: dict[str, float] = {}
#: Normals that are kept of each stream.
NORMALS = 3


def machine() -> dict[str, str]:
    """Return what may change the last digits of a number: equal on equal machines."""
    processor = platform.processor()
    with contextlib.suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
        processor = next((x.split(":")[1].strip() for x in lines if "model name" in x), processor)
        # a name such as "AMD EPYC" stands for processors of which BLAS takes different kernels
        for what in ("cpu family", "model\t", "stepping"):
            found = next((x.split(":")[1].strip() for x in lines if x.startswith(what)), "")
            processor += f" {found}"
    libraries = ("numpy", "scipy", "numba", "pandas", "casadi", "optuna", "llvmlite")
    return {
        "processor": f"{platform.machine()} {processor}",
        "python": ".".join(platform.python_version_tuple()[:2]),
        "threads": os.environ.get("OPENBLAS_NUM_THREADS", "all"),
        **{name: version(name) for name in libraries},
    }


def list_runs(study: str) -> dict[str, list[str]]:
    """Return name -> words of the runs of a study in `runs.yaml`."""
    told = STUDIES[study]
    return {name: [*told["all"].split(), *words.split()] for name, words in told["runs"].items()}


def make_rows(study: str, runs: Sequence[str] = ()) -> tuple[pd.DataFrame, list[dict]]:
    """Make the runs of a study (all, or those named) in this process, in an empty folder.

    Returns
    -------
    DataFrame, list
        The rows of all runs, with the columns `study` and `run`; and the random streams that were
        asked for, each once (`listen`).
    """
    for cached in gc.get_objects():  # or a truth that is kept would draw nothing
        if isinstance(cached, functools._lru_cache_wrapper) and (
            str(getattr(cached, "__module__", "")).startswith("owtsweep.")
        ):
            cached.cache_clear()
    tables, heard = [], {}
    with _elsewhere(), listen(heard):
        write_inputs()
        for name, words in list_runs(study).items():
            if runs and name not in runs:
                continue
            before = time.process_time()
            table = _run(study, [*words, f"name={name}"]).cases()
            table.insert(0, "study", study)
            table.insert(1, "run", name)
            tables.append(table)
            SECONDS[f"{study} {name}"] = time.process_time() - before
    return _tidy(pd.concat(tables, ignore_index=True)), [heard[key] for key in sorted(heard)]


def _run(study: str, words: list[str]) -> owtsweep.Run:
    if study != "replay":
        return owtsweep.run(words)
    files = [word for word in words if "=" not in word]
    return owtsweep.replay(files, [word for word in words if "=" in word]).run


@contextlib.contextmanager
def _elsewhere() -> Iterator[None]:
    """Work in an empty folder, with an empty cache of results, and with users' schemes at hand."""
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        sys.path.insert(0, str(HERE))
        try:
            with mock.patch.dict(os.environ, {"XDG_CACHE_HOME": folder}):
                yield
        finally:
            os.chdir(before)
            sys.path.remove(str(HERE))


@contextlib.contextmanager
def listen(heard: dict) -> Iterator[None]:
    """Collect every random stream that is made: (seed, *spawn key) -> the stream in words.

    A stream in words has its `seed`, its spawn `key` (a text's CRC-32 as the text), the bit
    `generator`, and its first `normals`.
    """
    texts: dict[int, str] = {}

    def crc32(data: bytes) -> int:
        code = zlib.crc32(data)
        texts[code] = data.decode()
        return code

    class Random:
        def __getattr__(self, name: str) -> object:
            return getattr(np.random, name)

        def Generator(self, bits: np.random.BitGenerator) -> np.random.Generator:
            seeds = bits.seed_seq
            key = tuple(int(part) for part in seeds.spawn_key)
            if (seeds.entropy, *key) not in heard:
                again = type(bits)(np.random.SeedSequence(seeds.entropy, spawn_key=key))
                heard[(seeds.entropy, *key)] = {
                    "seed": seeds.entropy,
                    "key": [texts.get(part, part) for part in key],
                    "generator": type(bits).__name__,
                    "normals": np.random.Generator(again).standard_normal(NORMALS).tolist(),
                }
            return np.random.Generator(bits)

    class Numpy:
        random = Random()

        def __getattr__(self, name: str) -> object:
            return getattr(np, name)

    with mock.patch.object(streams, "np", Numpy()), mock.patch.object(streams, "crc32", crc32):
        yield


def write_inputs() -> None:
    """Write the files that runs name, into the working folder: sines, always the same."""
    shutil.copy(HERE / "paper.yaml", "paper.yaml")
    shutil.copy(HERE.parent / "studies/tower/small.yaml", "small.yaml")
    shutil.copy(ROOT / "examples" / "mast.yaml", "mast.yaml")
    script = runpy.run_path(str(ROOT / "experiments" / "tower" / "make_recorded.py"))
    from owtsweep.structures import read_structure

    script["write"](script["make"](read_structure(Path("mast.yaml")), 3500), Path("mast.csv"))
    draw = np.random.default_rng(36)

    def waves(time: np.ndarray, size: float, period: float, shift: float = 0.0) -> np.ndarray:
        phase = 2.0 * np.pi * time / period + shift
        return size * (np.sin(phase) + 0.3 * np.sin(1.7 * phase) + 0.1 * np.sin(2.9 * phase + 1.0))

    slow = 0.1 * np.arange(600)
    _write("basin.csv", time=slow, **{
        name: waves(slow, size, 12.0 + number, number)
        for number, (name, size) in enumerate(
            {"x": 1.0, "y": 0.5, "z": 0.3, "phi": 0.02, "theta": 0.03, "psi": 0.02}.items()
        )
    })  # fmt: skip
    wind = 0.5 * np.arange(200)
    _write(
        "wind.csv", time=wind, thrust=1e6 + waves(wind, 1e5, 10.0),
        moment=-1e7 + waves(wind, 1e6, 7.0), side=waves(wind, 1e4, 5.0),
        side_moment=waves(wind, 1e6, 4.0),
    )  # fmt: skip
    for name, period, size in (("motion", 4.0, 0.4), ("other", 6.0, 1.0), ("third", 8.0, 0.2)):
        _write(f"{name}.csv", time=0.05 * np.arange(600), **{
            f"position_{axis}": waves(0.05 * np.arange(600), part * size, period)
            for axis, part in (("x", 0.87), ("y", 0.5))
        })  # fmt: skip
    Path("seastates.csv").write_text("file,Hs,Tp\nmotion.csv,1,8\nother.csv,2,8\nthird.csv,1,9\n")
    _write(
        "platform.csv", Time=slow, TTDspFA=waves(slow, 0.1, 3.0), PtfmSurge=waves(slow, 2.0, 13.0),
        PtfmPitch=waves(slow, 2.0, 10.0),
    )  # fmt: skip
    time = 0.01 * np.arange(4000)
    omega, size = 2.0 * np.pi * np.array([0.25, 0.2]), np.array([0.4, 0.3])
    position = size * np.sin(np.outer(time, omega))
    force = -(omega**2) * position + 0.15 * draw.standard_normal(position.shape)
    fixes = np.full(position.shape, np.nan)
    fixes[40::100] = position[20::100]  # .2 s late
    fixes[40::100] += 0.03 * draw.standard_normal(fixes[40::100].shape)
    _write(
        "sensors.csv", time=time, specific_force_x=force[:, 0], specific_force_y=force[:, 1],
        reference_x=position[:, 0], reference_y=position[:, 1], fix_x=fixes[:, 0],
        fix_y=fixes[:, 1],
    )  # fmt: skip
    time = 0.02 * np.arange(2000)  # a blade that swings without turning
    swing = 0.3 * np.sin(0.5 * time)
    felt = 0.01 * draw.standard_normal((len(time), 3)) + [0.0, 0.0, 9.81]
    felt[:, 0] -= 0.25 * swing
    turn = 1e-4 * draw.standard_normal((len(time), 3))
    _write("imu.csv", time=time, **dict(zip(("fx", "fy", "fz"), felt.T, strict=True)),
           **dict(zip(("wx", "wy", "wz"), turn.T, strict=True)))  # fmt: skip
    fix = 0.006 * draw.standard_normal((len(time[::10]), 3))
    fix[:, 0] += swing[::10]
    _write("gnss.csv", time=time[::10], **dict(zip("xyz", fix.T, strict=True)))


def _write(name: str, **columns: np.ndarray) -> None:
    pd.DataFrame(columns).to_csv(name, index=False, float_format="%.9g")


def _tidy(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows in one order, with plain text and numbers; paths lose their folders."""
    rows = rows.copy()
    for name in rows:
        column = rows[name]
        if not pd.api.types.is_numeric_dtype(column) or column.dtype == bool:
            texts = [None if pd.isna(text) else str(text) for text in column.astype(object)]
            rows[name] = pd.Series(texts, dtype=object, index=rows.index)
            if name == "file":
                rows[name] = [None if text is None else Path(text).name for text in rows[name]]
        elif not pd.api.types.is_integer_dtype(column):
            rows[name] = column.astype(float)
    rows = rows.dropna(axis="columns", how="all")
    return rows.sort_values(find_keys(rows), kind="stable", ignore_index=True)


def find_keys(rows: pd.DataFrame) -> list[str]:
    """Return the columns that say which row it is; `noise` is an axis of the tower."""
    results = RESULTS if "motion" in rows else [name for name in RESULTS if name != "noise"]
    return [name for name in rows if name not in results]


def read_rows(study: str, runs: Sequence[str] = ()) -> tuple[pd.DataFrame, dict[str, str]]:
    """Return the frozen rows of a study (of all runs, or of those named), and who made them."""
    table = pq.read_table(ROWS)
    rows = table.to_pandas()
    wanted = (rows["study"] == study) & (rows["run"].isin(runs) if runs else True)
    return _tidy(rows[wanted]), json.loads(table.schema.metadata[b"machine"])


def compare(study: str, made: pd.DataFrame, kept: pd.DataFrame, *, same: bool) -> list[str]:
    """Return how rows differ from frozen ones: one line per run and column; empty if they agree.

    `same` says whether both were made on the same machine.
    """
    if set(made) != set(kept):
        return [f"{study}: columns {sorted(set(made) ^ set(kept))} are in one of both alone"]
    keys = find_keys(kept)
    made, kept = (rows.assign(turn=rows.groupby(keys, dropna=False).cumcount()) for rows in
                  (made, kept))  # fmt: skip
    both = kept.merge(made, "outer", on=[*keys, "turn"], suffixes=("", " made"), indicator="side")
    alone = both[both["side"] != "both"]
    if len(alone):
        where = ", ".join(sorted(set(alone["run"])))
        sides = alone["side"].value_counts()
        return [f"{study}: {sides['left_only']} rows are not made, {sides['right_only']} are new, "
                f"in {where}"]  # fmt: skip
    lines = []
    for name in kept:
        if name in keys or name == "turn":
            continue
        differs = _differs(study, both, name, same=same)
        for run, some in both[differs].groupby("run"):
            first = some.iloc[0]
            place = {key: first[key] for key in keys[2:] if not pd.isna(first[key])}
            lines.append(f"{study} {run}: {name} differs in {len(some)} rows, first in {place}: "
                         f"{first[f'{name} made']!r} instead of {first[name]!r}")  # fmt: skip
    return lines


def _differs(study: str, both: pd.DataFrame, name: str, *, same: bool) -> np.ndarray:
    """Return for each row whether a column differs by more than the rule of this file allows."""
    one, other = both[name], both[f"{name} made"]
    gaps = one.isna().to_numpy() | other.isna().to_numpy()
    unequal = np.where(gaps, one.isna() != other.isna(), one.to_numpy() != other.to_numpy())
    if name in EXACT or not pd.api.types.is_float_dtype(one):
        return unequal.astype(bool)
    scales = ["run", *(key for key in SCALES if key in both)]
    most = one.abs().groupby([both[key] for key in scales], dropna=False).transform("max")
    near = np.full(len(both), HERE_AGAIN if same else ELSEWHERE.get(study, ELSEWHERE[""]))
    if study == "replay" and not same:
        near[both["scheme"].fillna("").isin(FITTED)] = NEAR_FITS
    far = (one - other).abs().to_numpy() > near * most.to_numpy()
    return unequal.astype(bool) & (far | gaps)


def check(study: str, runs: Sequence[str] = ()) -> list[str]:
    """Make the runs of a study (all, or those named), and say how they differ from frozen ones."""
    made, heard = make_rows(study, runs)
    kept, made_on = read_rows(study, runs)
    frozen = json.loads(STREAMS.read_text("utf-8"))[study]
    return [
        *compare(study, made, kept, same=made_on == machine()),
        *compare_streams(study, heard, frozen, whole=not runs),
    ]


def compare_streams(
    study: str, heard: list[dict], kept: list[dict], *, whole: bool = True
) -> list[str]:
    """Return which random streams are new, gone or have other numbers.

    `whole` says whether all runs of the study were made, so that no stream may be missing.
    """
    made, frozen = ({json.dumps([s["seed"], s["key"], s["generator"]]): s["normals"] for s in some}
                    for some in (heard, kept))  # fmt: skip
    return [
        *(f"{study}: the random stream {key} is new" for key in sorted(made.keys() - frozen)),
        *(f"{study}: nobody draws from {key}" for key in sorted(frozen.keys() - made) if whole),
        *(f"{study}: {key} begins with {made[key]} instead of {frozen[key]}"
          for key in sorted(made.keys() & frozen) if made[key] != frozen[key]),
    ]  # fmt: skip


def make() -> None:
    """Make all runs, and write the fixtures."""
    tables, heard = [], {}
    for study in STUDIES:
        rows, heard[study] = make_rows(study)
        tables.append(rows)
        print(f"{study}: {rows['run'].nunique()} runs, {len(rows)} rows, "
              f"{len(heard[study])} random streams", flush=True)  # fmt: skip
    table = pa.Table.from_pandas(_tidy(pd.concat(tables, ignore_index=True)), preserve_index=False)
    table = table.replace_schema_metadata({"machine": json.dumps(machine())})
    pq.write_table(table, ROWS, compression="zstd", compression_level=19)
    lines = (
        f'"{study}": [\n' + ",\n".join(json.dumps(one) for one in some) + "\n]"
        for study, some in heard.items()
    )
    STREAMS.write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")


if __name__ == "__main__":
    if sys.argv[1:] == ["--make"]:
        make()
    else:
        found = [line for study in sys.argv[1:] or STUDIES for line in check(study)]
        sys.exit("\n".join(found) or 0)
