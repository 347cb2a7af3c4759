"""The envelope's points are those of the plant, and its region holds 95 % of them."""

from functools import partial

import numpy as np
import pandas as pd
import pytest

from owtsweep.errors import InputError
from owtsweep.motion.envelope import RATE, compute_points, find_region, list_seas
from owtsweep.motion.plant import Plant
from owtsweep.streams import stream
from owtsweep.structures import find_structure
from owtsweep.waves import Sea

DURATION = 200.0
DRAW = partial(stream, 7, "hub", (), 0)


def test_points_are_records_of_the_plant():
    structure, seas = find_structure("ren2019"), [Sea(2.0, 6.0)]
    points = compute_points(
        structure, seas, DRAW, duration=DURATION, blades=(0, 2), friction_angles=(None, 33.0)
    )
    assert len(points) == 2 * 2
    softer = structure.model_copy(update={"soil": structure.soil.with_angle(33.0)})
    for row in points.to_dict("records"):
        own = structure if np.isnan(row["friction_angle"]) else softer
        plant = Plant(own, Sea(row["hs"], row["tp"]), row["blades"])
        motion = plant.realise(DRAW, steps=int(DURATION * RATE), step=1.0 / RATE)
        assert row["amplitude"] == pytest.approx(np.abs(motion.position).max(), rel=1e-9)
        assert row["rms"] == pytest.approx(motion.position.std(), rel=1e-9)
        assert row["natural_period"] == pytest.approx(1.0 / plant.vibration.frequency[0], rel=1e-9)
        assert row["fitted_period"] == pytest.approx(row["natural_period"], rel=0.3)


def test_a_structure_without_soil_has_one_soil():
    points = compute_points(
        find_structure("oc3_monopile"), [Sea(1.0, 8.0)], DRAW, duration=60.0, blades=(0,)
    )
    assert len(points) == 1
    assert points["friction_angle"].isna().all()


def test_no_sea_is_refused():
    with pytest.raises(InputError, match="at least one sea state"):
        compute_points(find_structure("ren2019"), [], DRAW, duration=60.0)


def test_seas_are_those_of_section_2_that_do_not_break():
    seas = list_seas()
    assert {sea.tp for sea in seas} == {4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0}
    assert max(sea.hs for sea in seas) == 3.0
    assert max(sea.hs for sea in seas if sea.tp == 4.0) == 1.5  # 1/15 of 25 m is 1.67 m
    assert Sea(1.66, 4.0).is_found
    assert not Sea(1.67, 4.0).is_found
    assert not Sea(10.5, 10.5).is_found  # 1/15 would allow 11.5 m
    assert not Sea(15.0, 15.0).is_found


def test_the_region_holds_95_percent_of_the_points():
    generator = np.random.default_rng(1)
    period = np.repeat(np.linspace(3.8, 4.8, 11), 400)
    amplitude = period * generator.lognormal(size=len(period))
    places, low, high = find_region(
        pd.DataFrame({"natural_period": period, "amplitude": amplitude})
    )
    index = np.searchsorted(places, period)
    inside = (amplitude >= low[index]) & (amplitude <= high[index])
    assert inside.mean() == pytest.approx(0.95, abs=0.005)
    assert (amplitude < low[index]).mean() == pytest.approx(0.025, abs=0.005)
    assert high[-1] > high[0]
