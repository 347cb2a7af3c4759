"""Names that a user or a stranger may give: homes, long names, TeX, and folders that are taken."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

import owtsweep
from owtsweep.cli.program import main
from owtsweep.errors import InputError
from owtsweep.io import files
from owtsweep.studies import compose
from owtsweep.studies.hub.contract import SCHEMES
from owtsweep.sweep.keys import run_folder, run_hash

SMALL = (
    "grid.natural_period=[4.0]", "grid.amplitude=[1.0]", "grid.replicates=2", "schemes=[MKF]",
    "record.duration=10", "measures.settling_time=1", "sensors.imu.rate=20", "tuning=paper",
    "compute.backend=threading", "compute.workers=1",
)  # fmt: skip
ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))


@pytest.fixture
def run(kernels) -> Path:
    """A run without any picture."""
    folder = owtsweep.run([*SMALL, "name=mine"]).folder
    assert not (folder / "figures").exists()
    return folder


def test_a_tilde_is_the_home_folder_as_in_a_shell(capsys):
    home = f"{Path('home').absolute()}/runs"
    plain = compose(["results=elsewhere"])
    for typed in ("results=~/runs", "++results=~/runs", "results='~/runs'"):
        config = compose([typed])
        assert config.results == home
        assert run_hash(config) == run_hash(plain)
    assert compose(["results=~nobody_here/x"]).results == "~nobody_here/x"
    assert main(["sweep", "--cfg", "-m", "seed=1,2", "results=~/runs"]) == 0
    assert capsys.readouterr().out.count(f"results: {home}\n") == 2
    with pytest.raises(InputError, match=f"^{home}: there is no such folder"):
        owtsweep.load("~/runs")


@pytest.mark.parametrize(
    ("override", "says"),
    [
        (f"name={'a' * 256}", "name: the run folder's name would have 256 characters"),
        (f"results={'a' * 300}", "results: aaa"),
        ('results="a\x1b[31m"', r"results: 'a\\x1b\[31m' holds a character"),
        ('results="a\0"', r"results: 'a\\x00' holds a character"),
        ("results='a\udcff'", r"results: 'a\\udcff' holds a character"),
        ("schemes=[{_target_:user_schemes.HoldLastFix,name:'a\tb'}]", "schemes: the name 'a"),
        (f"schemes=[{{_target_:user_schemes.HoldLastFix,name:{'b' * 61}}}]", "of 1 to 60 print"),
    ],
)
def test_a_name_that_cannot_be_used_is_refused_before_anything_is_written(override, says):
    with pytest.raises(InputError, match=says):
        owtsweep.run([*SMALL, override])
    assert list(Path.cwd().iterdir()) == []


def test_a_long_experiment_is_refused_by_its_key():
    config = compose([]).model_copy(update={"experiment": "a" * 250})
    with pytest.raises(InputError, match=r"^experiment: .* would have 261 characters"):
        run_folder(config)


@pytest.mark.parametrize("name", ["\x1b[31m", "b" * 61])
def test_a_stored_name_that_cannot_be_shown_is_refused(name):
    described = [{"name": name, "linear": True, "batched": "", "simplicity": 99}]
    with pytest.raises(InputError, match=r"^schemes: the name '.*' cannot be used"):
        SCHEMES.stand_in([{"_target_": "theirs.Scheme"}], described)


slow = pytest.mark.faults


@pytest.mark.parametrize(
    ("command", "taken"),
    [
        ("figures", "figures"),
        ("fidelity", "fidelity"),
        pytest.param("figures", "figures/figure_18_best_scheme.png/", marks=slow),
        pytest.param("fidelity", "fidelity/fidelity_claims.csv/", marks=slow),
        pytest.param("spectrum", "spectrum", marks=slow),
        pytest.param("spectrum", "spectrum/spectrum.csv/", marks=slow),
    ],
)
def test_a_folder_or_file_that_is_taken_is_named_in_one_line(run, capsys, command, taken):
    if taken.endswith("/"):
        (run / taken).mkdir(parents=True)
    else:
        (run / taken).write_text("")
    words = [*SMALL, "name=mine"] if command == "spectrum" else [str(run)]
    assert main([command, *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert taken.rstrip("/") in line
    assert "cannot be written" in line


@pytest.fixture
def full(run, monkeypatch) -> None:
    """A disk that takes no more than cases and what stands beside them."""
    through = files._write_through

    def refuse(path, data):
        beside = run in (path.parent, path.parents[2]) or path.name.startswith(".latest.")
        if "parquet" not in path.name and not beside:
            raise OSError(errno.EROFS, "no more")
        through(path, data)

    monkeypatch.setattr(files, "_write_through", refuse)


@pytest.mark.parametrize(
    ("command", "file"),
    [
        ("figures", "figure_18_best_scheme.png"),
        pytest.param("fidelity", "fidelity_claims.csv", marks=slow),
        pytest.param("spectrum", "error_spectra.png", marks=slow),
        pytest.param("compare", "best_scheme_maps.png", marks=slow),
    ],
)
def test_a_disk_that_takes_no_more_is_one_line(run, capsys, command, file, request):
    words = [*SMALL, "name=mine"] if command == "spectrum" else [str(run)]
    if command == "compare":
        words.append(str(owtsweep.run([*SMALL, "name=other", "seed=3"]).folder))
    request.getfixturevalue("full")
    assert main([command, *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"{file}: cannot be written (no more)" in line


@pytest.mark.usefixtures("full")
def test_a_sweep_whose_map_cannot_be_written_keeps_its_cases(run, capsys):
    assert main(["sweep", *SMALL, "name=mine", "grid.replicates=3"]) == 1
    told = capsys.readouterr()
    assert "map could not be drawn: results/mine/asked/" in told.err
    assert "/figures/figure_18_best_scheme.png: cannot be written (no more)" in told.err
    assert "Traceback" not in told.err
    assert len(owtsweep.load(run).cases().replicate.unique()) == 3
