"""examples/own_structure.py: from the description of a structure to the scheme for each sea."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

import owtsweep
from owtsweep.studies.hub.figures import envelope
from owtsweep.waves import Sea

EXAMPLES = Path(__file__).parents[3] / "examples"


def test_the_example_walks_from_a_description_to_the_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(envelope, "list_seas", lambda: [Sea(3.0, 6.0)])
    run = owtsweep.run(
        [
            "grid.natural_period=[3.0,4.0]", "grid.amplitude=[0.2,1.0]", "schemes=[MKF,HME1]",
            "sensors.imu.rate=20", "record.duration=20", "grid.replicates=2", "tuning=matched",
            "measures.settling_time=5", "baselines=[]",
        ]
    )  # fmt: skip
    main = runpy.run_path(str(EXAMPLES / "own_structure.py"))["main"]
    assert main([str(EXAMPLES / "my_tower.yaml"), str(run.folder)]) == 0
    told = capsys.readouterr().out
    assert "blades mounted: 0; natural frequencies 0.336 and 1.66 Hz; the hub leans by 0.01" in told
    assert "Tuning matched: over all seas" in told
    assert (tmp_path / "my_tower" / "envelope.csv").is_file()
    assert (tmp_path / "my_tower" / "envelope.png").is_file()
    bad = tmp_path / "bad.yaml"
    bad.write_text((EXAMPLES / "my_tower.yaml").read_text().replace("[0.032,", "[3.0,"))
    assert main([str(bad)]) == 2
    assert "thickness 3 m at the bottom exceeds the radius" in capsys.readouterr().err
