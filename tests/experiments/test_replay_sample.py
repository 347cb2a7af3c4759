"""The sample records: made again they are the same, and they overwrite no other file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from experiments import make_sample
from owtsweep.cli import main
from owtsweep.studies.replay.files import MOTION, SENSORS, find_data
from owtsweep.sweep.runs import Run


def test_made_again_the_sample_has_the_same_numbers(tmp_path):
    for path in make_sample.make(tmp_path):
        kept = find_data() / path.name
        assert len(kept.read_bytes()) < 150_000
        made, shipped = pd.read_csv(path), pd.read_csv(Path(str(kept)))
        assert list(made) == list(shipped)
        for name in shipped:  # one of the last digit: other processors round differently
            digit = 1e-3 if name.startswith("acc") else 1e-4
            np.testing.assert_allclose(made[name], shipped[name], rtol=0.0, atol=1.01 * digit)


def test_the_sample_overwrites_nothing_else(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Run, "draw", lambda *args, **options: [])  # drawing takes most of the time
    assert main(["replay", "--sample"]) == 0
    out = capsys.readouterr().out
    assert f"replay {MOTION}\n" in out
    Path(MOTION).write_text("mine")
    Path(SENSORS).unlink()
    assert main(["replay", "--sample"]) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"owtsweep: --sample: {MOTION} is there already, with other content")
    assert Path(MOTION).read_text() == "mine"
    assert not Path(SENSORS).exists()
    assert main(["replay", "--sample", "tower.csv"]) == 2
    assert "leave out FILE" in capsys.readouterr().err
