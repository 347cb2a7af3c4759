"""`spectrum`: files, table and refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tools import SMALL

from owtsweep.cli import BAD_INPUT, DONE, main


@pytest.mark.usefixtures("kernels")
def test_it_writes_curves_and_floors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    small = [*SMALL, "tuning=matched", "schemes=[MKF]", f"results={tmp_path}", "name=s"]
    assert main(["spectrum", *small]) == DONE
    folder = tmp_path / "s" / "spectrum"
    curves = pd.read_csv(folder / "spectrum.csv")
    assert list(curves.columns) == ["scheme", "frequency", "position", "velocity"]
    assert set(curves["scheme"]) == {"MKF"}
    floors = pd.read_csv(folder / "noise_floor.csv")
    parts = floors[floors["measure"] == "position"].set_index("source")["mse"]
    assert np.isclose(parts["all"], parts[["gnss", "imu", "bias"]].sum())
    assert (folder / "error_spectra.png").is_file()
    printed = capsys.readouterr().out
    assert "MKF" in printed
    assert f"{100 * np.sqrt(parts['all']):.3g} cm" in printed


def test_bad_input_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["spectrum", f"results={tmp_path / 'r'}", "band=[0.6,0.05]"]) == BAD_INPUT
    assert capsys.readouterr().err.startswith("owtsweep: band: ")
    assert not (tmp_path / "r").exists()


def test_it_says_which_studies_it_serves(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["spectrum", "study=blade"]) == BAD_INPUT
    assert "`spectrum` serves hub only" in capsys.readouterr().err
