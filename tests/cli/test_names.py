"""What the command line says of names: slips of the pen, `list NAME`, keys of a study."""

from __future__ import annotations

import pytest

from owtsweep.cli import BAD_INPUT, DONE, main


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["sweeep"], "sweeep: there is no such command; did you mean sweep?"),
        (["varry"], "did you mean vary"),
        (["zzzzz"], "zzzzz: there is no such command; `owtsweep --help` lists all"),
        (["sweep", "--multrun"], "did you mean --multirun?"),
        (["list", "flaoter"], "flaoter: no study, config group or scheme; did you mean floater?"),
        (["list", "HMEE1"], "did you mean HME1"),
        (["list", "#"], "`owtsweep list` has all names"),
        (["list", "HOLD", "MEKF"], "give one name, e.g. HME1 or HOLD study=blade"),
        (["list", "MEKF", "study=tower"], "MEKF: no study, config group or scheme"),
        (["list", "HOLD", "study=blad"], "there is no study 'blad'; did you mean blade?"),
    ],
)
def test_a_slip_is_one_line(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == BAD_INPUT
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1


def test_list_of_a_study_has_that_study_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "tower"]) == DONE
    out = capsys.readouterr().out
    assert main(["list", "study=tower"]) == DONE  # as other commands name a study
    assert capsys.readouterr().out == out
    assert out.startswith("  tower            The tower study")
    assert "AKF_LAGGED" in out
    assert "study=tower seas" in out
    assert "study=floater" not in out


def test_list_of_a_name_in_one_study(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "HOLD", "study=blade"]) == DONE
    assert capsys.readouterr().out.startswith("study=blade schemes=[HOLD]: the last GNSS fix, held")


def test_list_of_a_group_has_the_options_of_all_studies(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["list", "tuning"]) == DONE
    out = capsys.readouterr().out
    assert out.startswith("tunings (tuning=...):\n  matched")
    assert "study=tower tunings (tuning=...):" in out
    assert "schemes" not in out.partition("\n")[0]


def test_list_of_a_scheme_says_what_it_can_do(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "HME1"]) == DONE
    lines = [line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines()]
    assert lines[0] == ["schemes=[HME1]:", "delayed MKF, online smoother, predictor"]
    facts = {line[0]: line[1] for line in lines[1:]}
    assert facts["size"] == "19 states and tuned numbers"
    assert facts["time"] == "in real time"
    assert facts["can"] == "linear, runs by compiled kernels, runs on board"
    assert facts["keys"] == "hme1, hme.smoother_window, hme.predictor"


def test_list_of_a_scheme_says_when_it_is_late(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "MDE"]) == DONE
    out = capsys.readouterr().out
    assert "4 states and tuned numbers" in out
    assert "after the end of the record" in out


def test_help_of_a_study_has_its_keys(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "--help", "study=floater"]) == DONE
    out = capsys.readouterr().out
    assert "  record.duration=500.0 s\n      " in out
    assert "natural_period" not in out
    assert max(map(len, out.splitlines())) <= 120
    with pytest.raises(SystemExit):
        main(["sweep", "--help"])
    short = " ".join(capsys.readouterr().out.split())
    assert "`--help study=NAME`" in short
    assert main(["sweep", "--help", "study=nowhere"]) == BAD_INPUT
