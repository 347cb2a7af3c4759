"""Studies are found by name: ours, and those that another package installs."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest
import yaml

import owtsweep
from owtsweep import studies
from owtsweep.cli import main
from owtsweep.config import changed, dump
from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study, locate
from owtsweep.sweep.plan import dump_plan, make_plan

PACKAGES = Path(__file__).with_name("stranger")


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def stranger(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of installed packages with the stranger's study; returns it."""
    site = tmp_path / "site"
    monkeypatch.delitem(sys.modules, "stranger_study", raising=False)
    shutil.copytree(PACKAGES, site, ignore=shutil.ignore_patterns("broken*"))
    monkeypatch.syspath_prepend(str(site))
    return site


@pytest.fixture
def broken(stranger: Path) -> None:
    """A second package, whose studies do not work."""
    name = "broken_study-1.0.dist-info"
    shutil.copytree(PACKAGES / name, stranger / name)


def test_without_a_study_it_is_the_hub() -> None:
    assert compose([]) == compose(["study=hub"])
    assert locate(["tuning=matched"]).study is None


def test_a_file_that_names_another_study_is_refused(tmp_path: Path) -> None:
    (tmp_path / "experiment").mkdir()
    (tmp_path / "experiment/mine.yaml").write_text("# @package _global_\nstudy: replay\n")
    with pytest.raises(InputError, match=r"^study: 'hub' is named, but the study's files or "):
        compose(["study=hub", "experiment=mine"], str(tmp_path))


@pytest.mark.usefixtures("stranger")
def test_a_study_composes_its_own_tree() -> None:
    config = compose(["study=stranger"])
    assert (config.study, config.tuning, config.sigma) == ("stranger", "quick", 0.5)  # type: ignore
    matched = compose(["tuning=matched", "study=stranger", "grid.level=[{linear:[1,3,5]}]"])
    assert matched.sigma == 0.25  # type: ignore
    assert matched.grid.level == [1.0, 1.5, 2.0, 2.5, 3.0]  # type: ignore
    with pytest.raises(InputError, match=r"^tuning: there is no 'paper'; use matched or quick$"):
        compose(["study=stranger", "tuning=paper"])
    with pytest.raises(InputError, match=r"^spectrum: there is no such key"):
        compose(["study=stranger", "spectrum=printed"])
    with pytest.raises(InputError, match=r"^grid\.levl: .* did you mean grid\.level\?"):
        compose(["study=stranger", "grid.levl=[1]"])


@pytest.mark.usefixtures("stranger")
def test_a_users_folder_is_searched_besides_any_studys_tree() -> None:
    Path("mine/tuning").mkdir(parents=True)
    Path("mine/tuning/own.yaml").write_text("# @package _global_\ntuning: own\nsigma: 7.0\n")
    assert compose(["study=stranger", "tuning=own"], "mine").sigma == 7.0  # type: ignore


@pytest.mark.usefixtures("stranger")
def test_a_multirun_keeps_study_and_tuning_and_list_shows_the_groups(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The other commands: test_contributing.py."""
    assert main(["sweep", "study=stranger", "--cfg"]) == 0
    assert yaml.safe_load(capsys.readouterr().out)["study"] == "stranger"
    assert main(["sweep", "--multirun", "study=stranger", "sigma=0.1,0.2", "tuning=matched"]) == 0
    runs = [yaml.safe_load(path.read_text()) for path in Path().glob("results/*/*/config.yaml")]
    assert sorted(run["sigma"] for run in runs) == [0.1, 0.2]
    assert {(run["study"], run["tuning"]) for run in runs} == {("stranger", "matched")}
    capsys.readouterr()
    assert main(["list"]) == 0
    shown = capsys.readouterr().out
    assert "study=stranger tunings (tuning=...):" in shown
    assert "The stranger's own." in shown
    assert "the first letter" in shown


@pytest.mark.usefixtures("broken")
def test_studies_that_do_not_work_leave_the_others_alone(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name, says in (
        ("missing", r"ModuleNotFoundError: No module named 'no_such_module'"),
        ("lacking", r"TypeError: Can't instantiate .*conditions'?, '?config_type"),
        ("alien", r"Alien is no subclass of Study"),
        ("renamed", r"the study's `name` is 'stranger'"),
        ("untyped", r"config_type\(\) returns no subclass of Config"),
    ):
        told = rf"^study: '{name}' of the package broken-study does not work \({says}"
        with pytest.raises(InputError, match=told) as caught:
            compose([f"study={name}"])
        assert "\n" not in str(caught.value)
    assert compose(["study=stranger"]).study == "stranger"
    assert main(["list"]) == 0
    out = capsys.readouterr().out
    assert out.count("broken-study") == 5
    assert "The stranger's own." in out


def test_a_study_that_two_packages_have_is_one_line(
    stranger: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    twin = stranger / "twin_study-1.0.dist-info"
    shutil.copytree(stranger / "stranger_study-1.0.dist-info", twin)
    (twin / "METADATA").write_text("Metadata-Version: 2.1\nName: twin-study\nVersion: 1.0\n")
    told = r"^study: 'stranger' is in the packages (stranger|twin)-study and .*; uninstall all but "
    with pytest.raises(InputError, match=told):
        compose(["study=stranger"])
    assert compose([]).study == "hub"
    assert main(["list"]) == 0
    assert capsys.readouterr().out.count("is in the packages") == 1


def test_a_list_blames_a_package_whose_schemes_or_files_cannot_be_read(
    stranger: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (stranger / "stranger_study/conf/tuning/quick.yaml").write_bytes(b"# \xff\n")
    assert main(["list"]) == 0
    out = capsys.readouterr().out
    assert "'stranger' of the package stranger-study does not work (UnicodeDecodeError" in out
    assert "tunings (tuning=...):" in out


def test_commands_name_the_study_that_is_not_installed(
    stranger: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for sigma in ("0.1", "0.2"):
        assert main(["sweep", "study=stranger", f"sigma={sigma}", f"name=s{sigma}"]) == 0
    monkeypatch.setattr(sys, "path", [path for path in sys.path if path != str(stranger)])
    before = sorted(Path().rglob("*"))
    for command in ("show", "figures", "fidelity", "compare"):
        capsys.readouterr()
        assert main([command, "results/s0.1"]) == 2
        told = capsys.readouterr().err
        assert told.startswith("owtsweep: results/s0.1/config.yaml: the study 'stranger' of this ")
        assert "is not installed; install its package (there are hub, replay" in told
        assert told.count("\n") == 1
    assert sorted(Path().rglob("*")) == before


@pytest.mark.usefixtures("stranger")
def test_runs_of_two_studies_are_not_compared(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "study=stranger", "name=theirs"]) == 0
    config = changed(compose([]), name="ours")
    text, plan = dump(config), make_plan(get_study("hub"), config)
    Path("results/ours").mkdir()
    Path("results/ours/config.yaml").write_text(text)
    Path("results/ours/plan.json").write_text(dump_plan(plan, get_study("hub"), config, text))
    capsys.readouterr()
    assert main(["compare", "results/ours", "results/theirs"]) == 2
    assert capsys.readouterr().err == (
        "owtsweep: compare: these are runs of several studies, hub, stranger; compare runs of one "
        "study\n"
    )
    assert not list(Path("results").glob("comparison*"))


@pytest.mark.usefixtures("stranger")
@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        (["study=stranger", "grid.nothing=[1]"], "grid.nothing: there is no such key; there are "),
        (["study=stranger", "grid.level=[{log:[3,1,2]}]"], "grid.level: {log: [3, 1, 2]} does not"),
        (["grid.amplitude=[{log:[0.1,1]}]"], "grid.amplitude: {log: [0.1, 1]} is no entry of an "),
        (
            ["grid.replicates=[{log:[1,2,3]}]"],
            "grid.replicates: [{'log': [1, 2, 3]}] is neither a whole number nor auto",
        ),
        (["grid.amplitude={log:[1,2,3]}"], "grid.amplitude: {log:[1,2,3]} is no list; use e.g. gr"),
        (["sensors.imu=[1]"], "sensors.imu: [1] is a list where keys are expected; use sensors.im"),
    ],
)
def test_wrong_axes_and_mixed_studies_are_one_line(
    overrides: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for words in (["sweep"], ["sweep", "--cfg"], ["sweep", "--multirun"], ["spectrum"]):
        assert main([*words, *overrides]) == 2
        told = capsys.readouterr().err
        assert told.startswith(f"owtsweep: {says}")
        assert told.count("\n") == 1
    assert [path.name for path in Path().iterdir()] == ["site"]


def test_a_study_without_a_tree_says_where_it_belongs(stranger: Path) -> None:
    shutil.rmtree(stranger / "stranger_study/conf")
    with pytest.raises(InputError, match=r"package stranger-study has no .*conf/sweep\.yaml$"):
        compose(["study=stranger"])


@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        (["study=huub"], r"study: there is no study 'huub'; did you mean hub\? There are hub, "),
        (
            ["study=x"],
            r"study: there is no study 'x'; there are hub, .*, tower, floater, blade, mating$",
        ),
        (["study=hub,tower"], r"study: 'hub,tower' are several studies; run one at a time"),
        (["study="], r"study=: name a study, e\.g\. study=hub$"),
        (["+study=hub"], r"\+study=hub: name a study"),
        (["study=replay"], r"study: 'replay' needs records; use `owtsweep replay FILE`"),
    ],
)
def test_a_wrong_study_is_one_line(overrides: list[str], says: str) -> None:
    for words in (["sweep"], ["sweep", "--multirun"]):
        assert main([*words, *overrides]) == 2
    with pytest.raises(InputError, match=f"^{says}"):
        compose(overrides)
    assert not any(Path().iterdir())


def test_a_run_of_a_study_that_is_not_installed_names_it() -> None:
    Path("a").mkdir()
    Path("a/config.yaml").write_text("study: jacket\nsoil_factor: 2\n")
    with pytest.raises(InputError, match=r"^a/config\.yaml: the study 'jacket' .* not installed"):
        owtsweep.load("a")


def test_every_study_of_ours_answers_to_the_protocol() -> None:
    for name in studies.names():
        assert get_study(name).name == name
