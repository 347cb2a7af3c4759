"""The command line as users and tired users meet it, in process and at small size."""

import json
import re
import runpy
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
import yaml

import owtsweep
from owtsweep.cli import main
from owtsweep.cli.program import COMMANDS
from owtsweep.cli.running import tell_further

ROOT = Path(__file__).parents[2]
SMALL = [
    "grid.natural_period=[4.0]",
    "grid.amplitude=[0.2,1.0]",
    "grid.replicates=2",
    "record.duration=40",
    "experiment=study",
    "tuning=paper",
    "baselines=[]",
]


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="module")
def once(tmp_path_factory):
    """A folder in which `sweep` has made one run."""
    folder = tmp_path_factory.mktemp("once")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main(["sweep", *SMALL, "schemes=[MKF]"]) == 0
    return folder


@pytest.fixture
def swept(once):
    """As if `sweep` had just made a run here."""
    shutil.copytree(once, ".", symlinks=True, dirs_exist_ok=True)


def only_run(folder: str = "results") -> Path:
    """The one run folder below `folder`."""
    (config,) = Path(folder).glob("*/config.yaml")
    return config.parent


def test_the_examples_of_the_help_are_one_line(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    for command in COMMANDS:
        with pytest.raises(SystemExit):
            main([command, "--help"])
        assert capsys.readouterr().out.splitlines()[-1].startswith(f"example: owtsweep {command}")


def test_sweep_writes_what_the_readme_says(capsys):
    assert main(["sweep", *SMALL, "schemes=[MKF,HME1]", "sensors.gnss.delay=0.4"]) == 0
    run = only_run()
    assert {path.name for path in run.iterdir()} == {
        "config.yaml", "plan.json", "manifest.json", "cases", "summary.csv", "best_scheme.csv",
        "ratios.csv", "figures", "run.log", "asked", "report.html",
    }  # fmt: skip
    assert {path.name for path in (run / "figures").iterdir()} == {
        "figure_18_best_scheme.png",
        "figure_18_best_scheme.svg",
    }
    assert yaml.safe_load((run / "config.yaml").read_text())["sensors"]["gnss"]["delay"] == 0.4
    out, err = capsys.readouterr()
    # Plain when piped: the first and the last line of the progress, then where it lies.
    assert err.splitlines()[0] == "8 cases, 0 of them stored already"
    # In between may be one every 30 s, where kernels are compiled on a busy machine.
    lines = [line for line in err.splitlines()[1:] if "compiling kernels, once" not in line]
    assert all(" of 8 cases, 0 failed, " in line for line in lines)
    assert err.splitlines()[-1].startswith("8 of 8 cases, ")
    assert max(map(len, out.splitlines()[:-1])) <= 80
    assert "Error of the best: " in out
    assert str(run) in out.splitlines()[-1]


def test_open_cells_are_told_with_records_and_minutes():
    cells = {
        "criterion": ["position"] * 3 + ["velocity"], "more": [0.0, 20.0, 100.0, 900.0],
        "left": ["A", "A; B", "A; B; C", "A; B"], "n": [8, 256, 256, 256],
    }  # fmt: skip
    results = {"": SimpleNamespace(tables={"best_scheme": pd.DataFrame(cells)})}
    outcome = SimpleNamespace(results=results, computed=200, seconds=400.0)
    # 20 records of two and 100 of three contenders, 2 s each
    assert tell_further(outcome) == [
        "Open cells: grid.most=512, some 11 minutes more, would decide them."
    ]
    decided = {"": SimpleNamespace(tables={"best_scheme": pd.DataFrame(cells).head(1)})}
    assert tell_further(SimpleNamespace(results=decided, computed=200, seconds=1.0)) == []


@pytest.mark.usefixtures("undrawn")
def test_a_second_sweep_computes_nothing(swept, capsys):
    assert main(["sweep", *SMALL, "schemes=[MKF]"]) == 0
    out = capsys.readouterr().out
    assert out.splitlines()[-1].startswith("0 cases computed, 4 were there")


def test_figures_draws_everything(swept, capsys, monkeypatch):
    monkeypatch.setattr("owtsweep.figures.style.RESOLUTION", 20)  # dots are not looked at here
    assert main(["figures", str(only_run())]) == 0
    drawn = {path.name for path in (only_run() / "figures").iterdir()}
    assert capsys.readouterr().out.startswith(f"{len(drawn)} files")
    assert {"figure_15_mse_4s.png", "figure_09_position.svg", "error_spectra.png"} <= drawn
    assert "best_scheme_velocity.svg" in drawn


@pytest.mark.faults  # slow: all figures of a paper
def test_scripts_draw_their_figures(capsys, monkeypatch):
    main(["sweep", *SMALL, "grid.natural_period=[4.0,6.0,8.0]", "schemes=[MKF,HME1]"])
    for name, count in (("figures", 24), ("tables_6_to_9", 2)):
        capsys.readouterr()
        monkeypatch.setattr(sys, "argv", [name, str(only_run())])
        monkeypatch.delitem(sys.modules, f"experiments.ren2019.{name}", raising=False)
        runpy.run_module(f"experiments.ren2019.{name}", run_name="__main__")
        files = [Path(line) for line in capsys.readouterr().out.splitlines()]
        assert len(set(files)) == count
        assert all(file.is_file() and name[:-1] in file.name for file in files)


def test_show_prints_the_manifest(swept, capsys):
    assert main(["show", str(only_run())]) == 0
    shown = capsys.readouterr().out
    manifest = json.loads((only_run() / "manifest.json").read_text())
    assert all(key in shown for key in manifest)


def test_list_names_everything_there_is(capsys):
    assert main(["list"]) == 0
    shown = capsys.readouterr().out
    for name in ("EKF", "MKF", "HME1", "HME2", "paper", "matched", "translated", "ren2019"):
        assert name in shown
    entries = [line for line in shown.splitlines() if line.startswith("  ")]
    assert all(re.match(r"  \S+ +\S", line) for line in entries)  # long names too
    assert not [line for line in entries if line.endswith((":", ","))]  # no sentence is cut off


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("place", [0, 2, 5])
def test_multirun_works_anywhere_in_the_line(place, capsys):
    words = ["schemes=[MKF]", "sensors.gnss.delay=0.4,0.1", *SMALL[:2], "record.duration=30"]
    words.append("tuning=paper")
    words.insert(place, "--multirun" if place else "-m")
    assert main(["sweep", *words, "grid.replicates=1", "baselines=[]"]) == 0
    configs = [yaml.safe_load(p.read_text()) for p in Path("results").glob("*/*/config.yaml")]
    assert sorted(c["sensors"]["gnss"]["delay"] for c in configs) == [0.1, 0.4]
    for log in Path("results").glob("*/*/run.log"):
        assert "done: 2 computed" in log.read_text()  # Hydra's logging must not switch ours off
    assert not list(Path().rglob(".hydra"))
    assert not Path("outputs").exists()
    assert not Path("multirun").exists()


def test_a_multirun_with_one_bad_value_runs_nothing(capsys):
    assert main(["sweep", *SMALL, "-m", "sensors.gnss.delay=0.1,0.123"]) == 2
    assert "0.12 or 0.13" in capsys.readouterr().err
    assert not Path("results").exists()


def test_cfg_prints_the_configuration_and_stops(capsys):
    assert main(["sweep", "--cfg", "job", "grid.replicates=3"]) == 0
    assert yaml.safe_load(capsys.readouterr().out)["grid"]["replicates"] == 3
    assert not Path("results").exists()


def test_config_dir_adds_a_users_own_options(capsys):
    Path("mine/sensors").mkdir(parents=True)
    text = (ROOT / "conf/sensors/ren2019.yaml").read_text().replace("sigma: 0.03", "sigma: 0.01")
    Path("mine/sensors/rtk.yaml").write_text(text)
    assert main(["sweep", "--cfg", "--config-dir", "mine", "sensors=rtk"]) == 0
    assert yaml.safe_load(capsys.readouterr().out)["sensors"]["gnss"]["sigma"] == 0.01


@pytest.mark.usefixtures("undrawn")
def test_fresh_asks_before_it_deletes(swept, capsys, monkeypatch):
    monkeypatch.setattr("sys.stdin.isatty", lambda: False, raising=False)
    assert main(["sweep", *SMALL, "schemes=[MKF]", "--fresh"]) == 2
    assert "--yes" in capsys.readouterr().err
    assert main(["sweep", "--fresh", *SMALL, "--yes", "schemes=[MKF]"]) == 0
    assert "4 cases computed in" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["sweep", "--frech"], "--frech"),
        (["sweeep"], "sweeep"),
        (["figures"], "RUN"),
        (["figures", "nowhere"], "nowhere"),
        (["show", "nowhere"], "nowhere"),
        (["sweep", "grid.replicats=2"], "grid.replicates"),
        (["sweep", "tuning=mached"], "matched"),
        (["sweep", "schemes=[{_target_:user_schemes.NoScheme}]"], "owtsweep.schemes.hub.Scheme"),
        (["sweep", "schemes=[{_target_:user_schemes.Nothing}]"], "user_schemes.Nothing"),
        (["sweep", "schemes=[MKF,MKF]"], "twice"),
        (["sweep", "grid=5"], "grid"),
        (["sweep", "--config-dir", "nowhere"], "nowhere"),
        (["sweep", "name=a/b"], "name"),
        (["sweep", "study=replay"], "replay FILE"),
        (["spectrum", "study=replay"], "replay FILE"),
        (["sweep", "hme.mhe.constraints.bais=1"], "constraints.bias"),
        (["sweep", "hme.mhe.constraints.foo=1"], "there are hme.mhe.constraints.position"),
        (["sweep", "-m", "seed=1,2", "hydra/launcher=no"], "hydra/launcher: there is no 'no'"),
        (["sweep", "-m", "seed=1,2", "hydra/launcher=no"], "pip install 'owtsweep[launchers]'"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(words, says, capsys):
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("owtsweep: ")
    assert err.count("\n") == 1
    assert says in err
    assert not any(Path().iterdir())


def test_a_results_folder_that_cannot_be_written_is_refused(capsys):
    Path("file").write_text("not a folder")
    assert main(["sweep", *SMALL, "results=file/results"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert [path.name for path in Path().iterdir()] == ["file"]


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("how", ["raising", "not finite", "shape"])
def test_a_users_scheme_that_fails_takes_nothing_else_down(how, capsys):
    target = f"schemes=[MKF,{{_target_:user_schemes.Broken,how:'{how}'}}]"
    assert main(["sweep", *SMALL, target, "compute.backend=threading"]) == 1
    err = capsys.readouterr().err
    assert f"broken by {how}" in err
    assert "the same command tries again" in err
    cases = owtsweep.load(only_run()).cases()
    failed = cases[cases.status == "failed"]
    assert set(failed.scheme) == {f"broken by {how}"}
    assert sorted(failed.replicate) == [0, 1]
    assert all("\n" not in reason and reason for reason in failed.reason)
    best = owtsweep.load(only_run()).best_scheme()
    assert set(best.best) == {"MKF"} or best.empty


def test_users_schemes_linear_or_not_stand_beside_ours():
    users = "{_target_:user_schemes.HoldLastFix},{_target_:user_schemes.Saturated,name:clip}"
    run = owtsweep.run(
        [*SMALL, f"schemes=[MKF,{users}]", "compute.backend=threading", "record.duration=25"]
    )
    summary = run.summary()
    position = summary[(summary.measure == "position") & (summary.window == "full")]
    table = position.pivot_table(index="amplitude", columns="scheme", values="mean")
    assert list(table.columns) == ["MKF", "clip", "hold"]
    assert (table.hold > table.MKF).all()
    assert table.loc[1.0, "clip"] != pytest.approx(table.loc[1.0, "hold"], rel=0.01)
    direct = run.cases()
    assert set(direct[direct.scheme == "clip"].amplitude.dropna()) == {0.2, 1.0}
    assert direct[direct.scheme == "hold"].amplitude.isna().all()


def test_an_edited_scheme_is_a_new_scheme(monkeypatch):
    import inspect

    from owtsweep.studies import compose, get_study

    config = compose([*SMALL, "schemes=[{_target_:user_schemes.HoldLastFix}]"])
    before = get_study("hub").engine(config).plan(config)[0].content
    source = inspect.getsource(sys.modules["user_schemes"])
    monkeypatch.setattr(inspect, "getsource", lambda _: source + "# edited")
    assert get_study("hub").engine(config).plan(config)[0].content != before


def test_python_interface_reads_back_what_it_ran():
    run = owtsweep.run([*SMALL, "schemes=[MKF]", "name=mine"])
    again = owtsweep.load(run.folder)
    assert again.config == run.config
    pd.testing.assert_frame_equal(again.cases(), run.cases())
    pd.testing.assert_frame_equal(again.summary(), run.summary())


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["-m", "grid.replicates=1,2"], "share the run folder"),
        (["-m", "name=x", "sensors.gnss.delay=0.1,0.2"], "share the run folder"),
        (["-m", "results=a,b", "seed=1"], "results"),
        (["-m", "hydra/launcher=nowhere", "seed=1,2"], "launcher"),
        (["sensors.gnss.delay=0.1,0.2"], "--multirun"),
        (["results="], "results"),
        (["schemes=[MKF,{_target_:sys.exit}]"], "sys.exit"),
    ],
)
def test_slips_with_several_runs_are_refused(words, says, capsys):
    assert main(["sweep", *SMALL, *words]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert says in err
    assert not any(Path().iterdir())


@pytest.mark.usefixtures("undrawn")
def test_a_folder_named_by_the_user_keeps_one_run(capsys):
    words = ["sweep", *SMALL, "schemes=[MKF]", "name=mine"]
    assert main(words) == 0
    assert main([*words, "sensors.gnss.sigma=0.05"]) == 2
    assert "other settings" in capsys.readouterr().err
    assert main([*words, "grid.amplitude=[0.2,1.0,3.0]"]) == 0
    assert main([*words, "sensors.gnss.sigma=0.05", "--fresh", "--yes"]) == 0
    capsys.readouterr()
    assert main(["sweep", "study=tower", "name=mine"]) == 2  # another study's keys
    assert "other settings" in capsys.readouterr().err


@pytest.mark.usefixtures("undrawn")
def test_failed_cases_are_counted_at_every_amplitude(capsys):
    target = "schemes=[MKF,{_target_:user_schemes.Broken,how:raising}]"
    assert main(["sweep", *SMALL, target, "compute.backend=threading"]) == 1
    out, err = capsys.readouterr()
    assert "4 cases failed" in err
    assert out.splitlines()[-1].startswith("4 cases computed")


@pytest.mark.parametrize("name", ["manifest.json", "config.yaml"])
@pytest.mark.parametrize("text", ["{bad", "[1]", "just text", "\x00\xff"])
def test_damaged_files_of_a_run_give_one_line(name, text, swept, capsys):
    (only_run() / name).write_text(text)
    command = "show" if name == "manifest.json" else "figures"
    assert main([command, str(next(Path("results").iterdir()))]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert name in err


def test_figures_need_a_case_that_succeeded(capsys):
    target = "schemes=[{_target_:user_schemes.Broken,how:raising}]"
    main(["sweep", *SMALL, target, "compute.backend=threading"])
    capsys.readouterr()
    assert main(["figures", str(only_run())]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not (only_run() / "figures").exists()


def test_a_current_folder_that_is_gone_is_told(tmp_path, monkeypatch, capsys):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert main(["sweep", *SMALL]) == 2
    assert "the current folder has been deleted" in capsys.readouterr().err


def test_an_output_that_cannot_be_written_is_one_line(monkeypatch, capsys):
    def full(*words, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("owtsweep.cli.list.names", full)
    assert main(["list"]) == 1
    assert capsys.readouterr().err == "owtsweep: OSError: [Errno 28] No space left on device\n"


def test_an_error_that_a_library_makes_of_ctrl_c_is_ctrl_c(monkeypatch, capsys):
    def interrupted(*words, **options):
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt:
            raise AttributeError("a half-made object")  # noqa: B904

    monkeypatch.setattr("owtsweep.cli.list.names", interrupted)
    assert main(["list"]) == 130
    assert capsys.readouterr().err.startswith("owtsweep: interrupted; ")


def test_a_warning_is_printed_once_in_a_command(capsys: pytest.CaptureFixture[str]) -> None:
    """Both cells' configurations lie beyond the rules of tuning=matched."""
    words = ["sweep", "--cfg", "sensors.gnss.sigma=3", "seed=1,2", "--multirun"]
    for _ in range(2):  # in the next command again
        assert main(words) == 0
        assert capsys.readouterr().err.count("lies beyond") == 1
