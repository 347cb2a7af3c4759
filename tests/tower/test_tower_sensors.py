"""examples/tower_sensors.py, and the set-up of a choice for a structure of the user's."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from owtsweep.structures import find_structure
from owtsweep.structures.bernoulli import assemble_cut
from owtsweep.studies.composing import compose
from owtsweep.studies.tower.placement import predict
from owtsweep.studies.tower.placement_case import divide_tubes, make_case, simulate

EXAMPLE = Path(__file__).parents[2] / "examples" / "tower_sensors.py"
SHORT = ["record.duration=30", "record.settling=10"]


def test_the_example_chooses_for_a_clamped_monopile(capsys):
    main = runpy.run_path(str(EXAMPLE))["main"]
    heights = ["10", "25", "40", "60", "90", "107"]
    assert main(["oc3_monopile", *heights, *SHORT]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0] == "oc3_monopile: 107.6 m from the ground to the upper cut"
    assert [line.split()[0] for line in told[2:]] == ["3", "4", "5", "a"]
    chosen = told[4].split(" at ")[1].split(" m:")[0].split(", ")
    assert len(chosen) == 5
    assert set(chosen) < set(heights)
    left = (set(heights) - set(chosen)).pop()
    assert told[5].startswith(f"a sixth, best at {left} m, would lower the stress error by")
    for words, reason in (
        (["oc3_monopile", "0", "40", "60"], "nothing moves at 0 m above the ground, where the"),
        (["oc3_monopile", "top"], "'top' is no height; give numbers in m above the ground"),
        (["nowhere"], "there is no 'nowhere'"),
    ):
        assert main([*words, *SHORT]) == 2
        assert reason in capsys.readouterr().err


def test_divided_tubes_are_the_same_structure():
    whole = find_structure("oc3_monopile")
    parts = divide_tubes(whole, 5.0, [25.5])
    parts.check()
    ends = assemble_cut(parts, parts.mudline, parts.hub).heights - parts.mudline
    assert np.diff(ends).max() <= 5.0 + 1e-9
    assert 25.5 in ends
    coarse, fine = (
        assemble_cut(s, whole.mudline, whole.hub, subdivision=n)
        for s, n in ((whole, 64), (parts, 2))
    )
    lean = np.zeros(len(coarse.mass)), np.zeros(len(fine.mass))
    for beam, shape in zip((coarse, fine), lean, strict=True):
        shape[0::2], shape[1::2] = beam.heights**2, 2.0 * beam.heights
    for matrix in ("mass", "stiffness"):
        energies = [
            shape @ getattr(beam, matrix) @ shape
            for beam, shape in zip((coarse, fine), lean, strict=True)
        ]
        assert energies[0] == pytest.approx(energies[1], rel=1e-9)


def test_what_is_predicted_to_be_better_is_better_on_records():
    config = compose(["study=tower", *SHORT])
    case = make_case(config, find_structure("iea15"))
    heights = list(case.problem.heights)
    for criterion, good, bad in (("stress", (0, 136, 175), (20, 35, 40)),
                                 ("moment", (0, 15, 45), (123, 149, 175))):  # fmt: skip
        said, found = [], []
        for places in (good, bad):
            chosen = [heights.index(place) for place in places]
            said.append(predict(case.problem, chosen).error(criterion))
            found.append(simulate(case, chosen, config.record.settled)[criterion == "moment"])
        assert said[0] < 0.5 * said[1]
        assert found[0] < 0.5 * found[1]
        # of one size; the truth is no random walk, so not more
        assert np.all(np.abs(np.log2(np.array(found) / said)) < 1.5)
