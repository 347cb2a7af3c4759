"""Reading a run opens no file that the run names; a file that is taken is looked at first."""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
import signal
import sys
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml
from judge import judge

import owtsweep
from owtsweep.cli.program import main
from owtsweep.config.composition import compose_plain
from owtsweep.errors import InputError
from owtsweep.structures import read_structure
from owtsweep.studies.registry import find_tree, get_study
from owtsweep.sweep.keys import list_versions
from owtsweep.sweep.plan import digest
from owtsweep.sweep.store import MOST_BYTES

TOWER = (
    "study=tower", "experiment=quick", "record.duration=20", "record.settling=5",
    "grid.noise=[1.0]", "grid.replicates=1", "schemes=[AKF]", "results=.",
)  # fmt: skip
#: What a command may take that opens no file, s. (A busy machine needs more than an idle one.)
SOON = 30
#: An unpacked size, bytes, of a table that compresses a thousandfold: more than is unpacked.
HUGE = 400_000_000


#: The columns that the readers want: without them they would not unpack the rows.
COLUMNS = "time,thrust,moment,side,side_moment,a_0,x,y,z,phi,theta,psi,fx,fy,fz,wx,wy,wz"


def bomb(path: Path) -> None:
    """Write a compressed table of 1 MB that unpacks to hundreds."""
    line = "0" + COLUMNS.count(",") * ",1" + "\n"
    block = gzip.compress(400_000 * line.encode(), 9)
    with path.open("wb") as stream:
        stream.write(gzip.compress(f"{COLUMNS}\n".encode()))
        for _ in range(HUGE // (400_000 * len(line))):
            stream.write(block)


#: Name -> what stands where a file is named.
TRAPS: dict[str, Callable[[Path], object]] = {
    "pipe": os.mkfifo,
    "device": lambda path: path.symlink_to("/dev/zero"),
    "bomb": bomb,
    "gone": lambda path: None,
}


@pytest.fixture(autouse=True)
def _in_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    def expire(*_: object) -> None:
        pytest.fail("a file was opened")  # no `TimeoutError`: a reader would take it as its own

    monkeypatch.chdir(tmp_path)
    before = signal.signal(signal.SIGALRM, expire)
    signal.alarm(SOON)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def write_loads(path: Path) -> None:
    """Write loads of 30 s on a turbine's top."""
    time = np.arange(0.0, 30.0, 0.1)
    loads = [1e6 + 1e5 * np.sin(time + k) for k in range(4)]
    head = "time,thrust,moment,side,side_moment"
    np.savetxt(path, np.column_stack([time, *loads]), "%.6g", ",", header=head, comments="")


@pytest.fixture(scope="module")
def tower(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run of the tower, `one`, that was made with loads.csv.gz, and its copy."""
    folder = tmp_path_factory.mktemp("tower")
    before = os.getcwd()
    os.chdir(folder)
    try:
        write_loads(Path("loads.csv.gz"))
        words = (*TOWER, f"wind.file={folder / 'loads.csv.gz'}", "compute.backend=threading")
        assert main(["sweep", *words, "name=one"]) == 0
        shutil.copytree("one", "two")
    finally:
        os.chdir(before)
    return folder


@pytest.mark.parametrize("trap", TRAPS)
def test_reading_a_run_opens_no_file_that_it_names(tower: Path, trap: str) -> None:
    named = tower / "loads.csv.gz"
    named.unlink(missing_ok=True)
    TRAPS[trap](named)
    one, two = str(tower / "one"), str(tower / "two")
    assert len(owtsweep.load(one).summary()) > 0
    for words in (["show", one], ["figures", one]):
        assert judge(main, words, tower).code == 0
    for words in (["compare", one, two], ["fidelity", one]):  # a study may have no such report
        assert judge(main, words, tower).code in (0, 2)


def store(keys: dict[str, object], *words: str) -> Path:
    """Write what a stranger may send: a folder with a configuration and a plan that fits."""
    study, *others = words
    plain = compose_plain(find_tree(study), list(others)) | {"study": study, **keys}
    plain = get_study(study).complete(plain)
    Path("sent").mkdir()
    text = yaml.safe_dump(plain)
    Path("sent", "config.yaml").write_text(text, encoding="utf-8")
    tuning = plain["tuning"]
    block = [["0" * 32, "a block", 1, 1, *([tuning] if isinstance(tuning, list) else [])]]
    plan = {"versions": list_versions(get_study(study)), "config_digest": digest(text)}
    Path("sent", "plan.json").write_text(json.dumps({**plan, "blocks": block}))
    return Path("sent")


@pytest.mark.parametrize("trap", ["pipe", "device"])
@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("wind.file", ["tower"]), ("recorded.file", ["tower", "criterion=displacement"]),
        ("motion.file", ["floater", "motion.kind=recorded"]),
        ("recorded.imu", ["blade", "experiment=recorded", "++recorded.heading=0"]),
    ],
)  # fmt: skip
def test_reading_a_folder_that_holds_no_case_opens_no_file_that_it_names(
    key: str, words: list[str], trap: str
) -> None:
    named = Path("named.csv").absolute()
    TRAPS[trap](named)
    gnss = [f"++recorded.gnss=[{named}]"] if key == "recorded.imu" else []
    run = owtsweep.load(store({}, *words, *gnss, f"++{key}={named}"))
    assert len(run.plan()) == 1
    with pytest.raises(InputError, match="all 1 blocks are missing"):
        run.cases()


def test_the_other_studies_of_a_stored_mating_run_are_not_composed() -> None:
    name = "stranger_scheme"
    Path(f"{name}.py").write_text("raise SystemExit(3)\n")
    sys.path.insert(0, str(Path.cwd()))
    try:
        run = owtsweep.load(store({"hub_scheme": f"{{_target_: {name}.Any}}"}, "mating"))
        assert run.study.describe_origin(run.config)
        assert len(run.plan()) == 1
    finally:
        sys.path.remove(str(Path.cwd()))
    assert name not in sys.modules


@pytest.mark.parametrize("trap", ["pipe", "device", "bomb"])
@pytest.mark.parametrize(
    "words",
    [
        (*TOWER, "wind.file=FILE.csv.gz"),
        (*TOWER, "recorded.file=FILE.csv.gz", "criterion=displacement"),
        (*TOWER, "structure=FILE.yaml"), (*TOWER, "tuning=./FILE.yaml"),
        ("study=floater", "motion.kind=recorded", "motion.file=FILE.csv.gz"),
        ("study=blade", "experiment=recorded", "recorded.imu=FILE.csv.gz", "recorded.heading=0",
         "recorded.gnss=[FILE.csv.gz]"),
    ],
    ids=lambda words: next(word for word in words if "FILE" in word).partition("=")[0],
)  # fmt: skip
def test_a_sweep_takes_no_pipe_no_device_and_no_bomb(words: tuple[str, ...], trap: str) -> None:
    (name,) = {w.partition("FILE")[2].strip("]") for w in words if "FILE" in w}
    named = Path(f"FILE{name}")
    if trap == "bomb" and name == ".yaml":
        named.write_bytes(b"a: 1\n" * 3_000_000)
    else:
        TRAPS[trap](named)
    ended = judge(main, ["sweep", *words], Path())
    assert ended.code == 2
    told = r"this is a pipe or a device; name a file"
    if trap == "bomb":
        told = r"is larger than \d+ MB" if name == ".yaml" else r"unpacks to more than 150 MB"
    assert re.search(f"FILE.*{told}", ended.err), ended.err


def test_a_large_file_is_refused_before_it_is_read(
    copy, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file may claim any size: its holes cost nothing on the disk, and much memory to read."""
    copy("a")
    first, second, *_ = sorted(Path("a/cases").iterdir())
    os.truncate(first, MOST_BYTES + 1_000_000_000)
    os.truncate(second, MOST_BYTES - 1_000_000_000)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("owtsweep.sweep.store.decode", None)  # would be given what was read
        assert main(["show", "a"]) == 0  # not `judge`, which reads all files
    told = capsys.readouterr().err
    assert f"{first}: it is larger than 2000 MB" in told
    assert f"{second}: its 1000 MB have holes" in told
    os.truncate("a/plan.json", MOST_BYTES - 1)
    assert main(["show", "a"]) == 2
    assert "plan.json: its 2000 MB have holes" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ("study=tower", "grid.noise=[{log:[0.1,10,1000000]}]"),
        ("study=floater", "plane=snr_loss", "grid.snr=[{linear:[1,60,1000000]}]"),
        ("study=blade", "grid.sigma=[{log:[0.1,10,1000000]}]"),
        ("study=mating", "grid.sigma=[{log:[0.1,10,1000000]}]"),
        ("study=hub", "grid.amplitude=[{log:[0.1,10,1000000]}]", "evaluation=direct"),
    ],
    ids=lambda words: words[0],
)
def test_a_grid_that_is_too_large_is_refused_before_it_is_planned(words: tuple[str, ...]) -> None:
    ended = judge(main, ["sweep", *words, "--dry-run"], Path())
    assert ended.code == 2
    assert "grid: a sweep would have" in ended.err


def test_a_structure_of_too_many_parts_is_refused_before_it_is_taken(tmp_path: Path) -> None:
    ends = np.linspace(-30.0, 60.0, 20_001)
    tubes = [
        f"- {{name: t, bottom: {low:.4f}, top: {high:.4f}, diameter: [6, 6], thickness: [0.1, 0.1],"
        " density: 8000}"
        for low, high in pairwise(ends)
    ]
    start = "name: many\nsource: none\nmudline: -20.0\nclamped: true\ndamping: 0.01\ntubes:\n"
    Path("many.yaml").write_text(start + "\n".join(tubes) + "\n")
    ended = judge(main, ["sweep", *TOWER, "structure=many.yaml"], tmp_path)
    assert ended.code == 2
    assert "many.yaml: it holds more than 2000 mappings" in ended.err
    Path("many.yaml").write_text(start + "\n".join(tubes[:301]) + "\n")
    with pytest.raises(InputError, match=r"structure\.tubes: it has 301 parts, more than 300"):
        read_structure("many.yaml")
