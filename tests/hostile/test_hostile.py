"""Run every subcommand on hostile inputs; `judge.judge` checks how each command ends.

A case is a good file with one damage, or words that a tired user may type. The test's id names the
file and the damage, or the words. `make test` runs some cases, `make test-faults` the others.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml
from damage import ANY, BOMB, ESCAPES, GZIP, TEX, TEXT, Damage, flip
from judge import judge

from owtsweep.cli.program import main
from worlds import RECORDS, TINY

Copy = Callable[[str], Path]

#: The files of a run that a reader of the run opens; cases/* stands for the first shard.
RUN_FILES = (
    "config.yaml", "plan.json", "manifest.json", "cases/*", "summary.csv", "asked/*/config.yaml",
)  # fmt: skip
#: Name -> value to store at each of the `KEYS`, most of which expect another kind of value.
VALUES = {
    "null": None, "text": "much", "empty": "", "list": [], "mapping": {"a": 1}, "true": True,
    "zero": 0, "negative": -1, "tiny": 1e-300, "huge": 1e300, "not_a_number": float("nan"),
    "infinite": float("inf"), "long": "x" * 100_000, "escapes": ESCAPES, "tex": TEX,
    "interpolation": "${oc.env:HOME}", "harmful": {"_target_": "os.system", "command": "touch x"},
    "harmful_list": [{"_target_": "subprocess.Popen", "args": "touch x"}], "deep": [[[[[[1]]]]]],
}  # fmt: skip


def some(items: list[tuple[object, ...]], each: int) -> Iterator[object]:
    """Yield all cases as pytest parameters; `make test` runs the first of every `each` cases.

    The other cases are marked `faults`, so `make test-faults` runs them.
    """
    for number, item in enumerate(items):
        marks = () if number % each == 0 else (pytest.mark.faults,)
        yield pytest.param(*item, marks=marks, id="-".join(str(part) for part in item[:3]))


def damage_file(run: Path, name: str, damage: Damage) -> None:
    damage(next(run.glob(name)))


@pytest.mark.parametrize(
    ("command", "file", "name"),
    [
        *some([("show", file, name) for file in RUN_FILES for name in ANY], 2),
        *some([("compare", file, name) for file in RUN_FILES for name in ANY], 25),
        *some([("fidelity", file, name) for file in RUN_FILES for name in list(ANY)[::5]], 99),
    ],
)
def test_a_damaged_run(command: str, file: str, name: str, copy: Copy) -> None:
    run = copy("a")
    damage_file(run, file, ANY[name])
    others = [str(copy("m"))] if command == "compare" else []
    judge(main, [command, str(run), *others], run.parent)


@pytest.mark.parametrize("name", [*some([(name,) for name in ANY], 5)])
def test_a_damaged_record_of_a_multirun(name: str, copy: Copy) -> None:
    multirun = copy("m")
    damage_file(multirun, "multirun.json", ANY[name])
    judge(main, ["compare", str(multirun)], multirun.parent)


@pytest.mark.parametrize("folder", ["../../etc", "/etc", "..", "", "a\0b", ESCAPES, "x" * 5000, 3])
def test_a_multirun_that_names_other_folders(folder: object, copy: Copy) -> None:
    multirun = copy("m")
    path = multirun / "multirun.json"
    record = json.loads(path.read_text())
    record["runs"][0]["folder"] = folder
    path.write_text(json.dumps(record))
    judge(main, ["compare", str(multirun)], multirun.parent)


def list_keys(mapping: dict[str, object], prefix: str = "") -> Iterator[str]:
    for key, value in mapping.items():
        yield f"{prefix}{key}"
        if isinstance(value, dict):
            yield from list_keys(value, f"{prefix}{key}.")


KEYS = (
    "study", "experiment", "results", "name", "seed", "engine", "evaluation", "config_version",
    "grid", "grid.amplitude", "grid.natural_period", "grid.replicates", "record.duration", "band",
    "spectrum.kind", "sensors.gnss.rate", "sensors.imu.rate", "sensors.gnss.delay", "tuning",
    "schemes", "ekf", "mkf.r", "hme.mhe.horizon", "measures.window", "compute", "compute.backend",
    "compute.workers", "wave_direction",
)  # fmt: skip


@pytest.mark.parametrize(
    ("key", "value"), [*some([(key, value) for key in KEYS for value in VALUES], 11)]
)
def test_a_stored_key_of_another_kind(key: str, value: str, copy: Copy) -> None:
    run = copy("a")
    path = run / "config.yaml"
    config = yaml.safe_load(path.read_text())
    section = config
    *sections, last = key.split(".")
    for part in sections:
        section = section.setdefault(part, {})
    section[last] = VALUES[value]
    path.write_text(yaml.safe_dump(config))
    judge(main, ["show", str(run)], run.parent)


@pytest.mark.parametrize(
    ("record", "name"), [*some([(record, name) for record in RECORDS for name in ANY], 2)]
)
def test_a_damaged_recording(record: str, name: str, copy: Copy) -> None:
    path = copy(f"records/{record}")
    ANY[name](path)
    judge(main, ["replay", "--describe", str(path)], path.parent)


@pytest.mark.parametrize("name", TEXT)
def test_a_table_that_is_no_record(name: str, copy: Copy) -> None:
    path = copy("records/r.csv")
    TEXT[name](path)
    judge(main, ["replay", "--describe", str(path)], path.parent)


@pytest.mark.parametrize("name", GZIP)
def test_a_compressed_table(name: str, copy: Copy) -> None:
    path = copy("records/r.csv.gz")
    GZIP[name](path)
    judge(main, ["replay", "--describe", str(path)], path.parent)


@pytest.mark.faults
@pytest.mark.parametrize("name", TEXT)
def test_a_table_that_is_replayed(name: str, copy: Copy) -> None:
    path = copy("records/r.csv")
    TEXT[name](path)
    words = ["columns.position_x=x", "columns.position_y=y", "replay.replicates=1", "schemes=[MKF]"]
    judge(main, ["replay", str(path), *words, "sensors.imu.rate=20"], path.parent)


WORDS = {
    "nothing": [], "empty": [""], "equals": ["="], "plus": ["+"], "tilde": ["~x"],
    "dots": ["a.b.c=1"], "dash": ["-"], "two_dashes": ["--"], "unknown_flag": ["--unknown"],
    "twice": ["--cfg", "--cfg"], "half_flag": ["--config-dir"],
    "no_folder": ["--config-dir", "nowhere"], "hydra": ["hydra.run.dir=x"],
    "escapes": ["seed=\x1b[31m"], "surrogate": ["name=\udcff"], "newline": ["name=a\nb"],
    "long": ["name=" + "x" * 300], "longer": ["results=" + "x" * 5000],
    "deep": ["grid.amplitude=" + "[" * 200 + "]" * 200], "interpolation": ["seed=${nowhere}"],
    "resolver": ["seed=${oc.env:NOWHERE}"], "study": ["study=nowhere"],
    "two_studies": ["study=hub,tower"], "no_study": ["study="],
    "group": ["tuning=../../secret"], "empty_grid": ["grid={}"], "no_schemes": ["schemes=[]"],
    "nested": ["schemes=[[MKF]]"], "number_target": ["schemes=[{_target_: 3}]"],
    "empty_target": ["schemes=[{_target_: ''}]"],
    "harmful": ["schemes=[{_target_: os.system, command: touch x}]"],
    "popen": ["schemes=[{_target_: subprocess.Popen, args: touch x}]"],
    "long_axis": ["grid.amplitude=[{log:[0.1,10,1000000000000]}]"],
    "falling_axis": ["grid.amplitude=[{log:[10,0.05,3]}]"],
    "huge_amplitude": ["grid.amplitude=[1e160]"], "tiny_period": ["grid.natural_period=[1e-300]"],
    "huge_period": ["grid.natural_period=[1e300]"], "replicates": ["grid.replicates=1000000000"],
    "duration": ["record.duration=1e12"], "imu_rate": ["sensors.imu.rate=1e12"],
    "gnss_rate": ["sensors.gnss.rate=1e-12"], "delay": ["sensors.gnss.delay=1e9"],
    "seed": ["seed=-1"], "huge_seed": ["seed=" + "9" * 40], "nan": ["sensors.gnss.sigma=nan"],
    "band": ["band=[0.3,0.3000001]"], "horizon": ["hme.mhe.horizon=1000000000"],
    "bomb": ["+x=" + BOMB.replace("\n", " ")], "many": [f"+k{n}=1" for n in range(300)],
    "digits": ["seed=" + "9" * 100_000], "range": ["record.duration=range(1,1000000)"],
    "endless_range": ["record.duration=range(1,2,0)"],
}  # fmt: skip


@pytest.mark.parametrize("name", WORDS)
def test_words_of_a_tired_user(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ended = judge(main, ["sweep", "--cfg", *WORDS[name]], tmp_path)
    assert not any(tmp_path.iterdir()), ended


@pytest.mark.parametrize(
    "command",
    ["show", "figures", "fidelity", "compare", "replay", "spectrum", "vary", "place", "list"],
)
@pytest.mark.parametrize(
    "word", ["nowhere", "", "\x1b[31m", "\udcff", "x" * 5000, "/dev/zero", "--unknown", "."]
)
def test_a_path_that_is_none(
    command: str, word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert judge(main, [command, word], tmp_path).code == 2


@pytest.mark.faults
@pytest.mark.parametrize("seed", range(700))
def test_flipped_bits_of_a_run(seed: int, copy: Copy) -> None:
    run = copy("a")
    chosen = random.Random(seed)
    damage_file(run, chosen.choice(RUN_FILES), flip(seed, chosen.choice((1, 3, 30))))
    judge(main, ["show", str(run)], run.parent)


@pytest.mark.faults
@pytest.mark.parametrize("seed", range(700))
def test_flipped_bits_of_a_recording(seed: int, copy: Copy) -> None:
    chosen = random.Random(seed)
    path = copy(f"records/{chosen.choice(RECORDS)}")
    flip(seed, chosen.choice((1, 3, 30)))(path)
    judge(main, ["replay", "--describe", str(path)], path.parent)


@pytest.mark.faults
@pytest.mark.parametrize("name", WORDS)
def test_words_that_are_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    judge(main, ["sweep", *TINY, *WORDS[name]], tmp_path)


@pytest.mark.faults
@pytest.mark.parametrize("name", WORDS)
def test_words_of_a_multirun(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    judge(main, ["sweep", "-m", "--cfg", "seed=1,2", *WORDS[name]], tmp_path)
