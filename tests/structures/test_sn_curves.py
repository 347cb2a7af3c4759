"""The table of S-N curves checks itself, and a user's own curve is checked."""

import numpy as np
import pytest

from owtsweep.config import typed
from owtsweep.errors import InputError
from owtsweep.structures.sn_curves import Branch, Fatigue, find_curve, make_curve, measure_gap

CLASSES = ["B1", "B2", "C", "C1", "C2", "D", "E", "F", "F1", "F3", "G", "W1", "W2", "W3"]
#: Intercepts have three decimals: log_a of the first branch goes in by m2/m1 at most 5/3.
ROUNDING = 0.0005 * (1.0 + 5.0 / 3.0) + 1e-12


@pytest.mark.parametrize("environment", ["air", "seawater"])
def test_both_branches_of_every_class_meet_at_the_knee(environment):
    for name in CLASSES:
        assert measure_gap(find_curve(name, environment)) <= ROUNDING, name


def test_both_tables_agree_where_the_standard_says_so():
    lives = []
    for name in CLASSES:
        air, water = find_curve(name, "air"), find_curve(name, "seawater")
        assert (air.knee, water.knee) == (1e7, 1e6)
        assert air.m == water.m
        assert air.log_a[1] == water.log_a[1]  # the second branch is shared
        assert air.log_a[0] - water.log_a[0] == pytest.approx(0.2 if air.m[0] == 4.0 else 0.4)
        lives.append(1.0 / air.spend(np.array(100e6)))
    assert sorted(lives, reverse=True) == lives  # the classes are in the order of strength


def test_cycles_to_failure_follow_either_branch():
    curve = find_curve("D", "seawater")
    stress = np.array([20e6, 200e6])
    expected = [10.0**15.606 / 20.0**5, 10.0**11.764 / 200.0**3]
    np.testing.assert_allclose(1.0 / curve.spend(stress), expected, rtol=1e-12)
    # at the knee, the life is the knee's on both sides
    around = curve.knee_range * np.array([1.0 - 1e-9, 1.0, 1.0 + 1e-9])
    np.testing.assert_allclose(1.0 / curve.spend(around), 1e6, rtol=0.004)
    assert curve.knee_range == pytest.approx(83.4e6, rel=1e-3)


def test_the_papers_line_spends_97_5_times_what_class_d_spends():
    paper, stress = find_curve("paper"), np.array([5e6, 20e6, 50e6])
    ratio = paper.spend(stress) / find_curve("D").spend(stress)  # below the knee of D
    np.testing.assert_allclose(ratio, 97.5, rtol=1e-3)
    below = stress[:2]  # below the knee of W3, 21 MPa
    np.testing.assert_allclose(paper.spend(below), find_curve("W3").spend(below), rtol=1e-14)


def test_welds_under_water_take_the_curve_of_seawater():
    curves = Fatigue(curve="E").find_curves(np.array([-30.0, -0.1, 0.0, 100.0]))
    assert [curve.knee for curve in curves] == [1e6, 1e6, 1e7, 1e7]
    for environment, knee in (("air", 1e7), ("seawater", 1e6)):
        curves = Fatigue(environment=environment).find_curves(np.array([-1.0, 1.0]))
        assert {curve.knee for curve in curves} == {knee}


def test_an_own_curve_equal_to_class_d_spends_the_same():
    branches = [{"m": 3, "log_a": 12.164}, {"m": 5, "log_a": 15.606}]
    fatigue = typed(Fatigue, {"curve": "own", "branches": branches, "knee": 1e7})
    fatigue.check()
    (own,) = fatigue.find_curves(np.zeros(1))
    stress = np.geomspace(1e6, 3e8, 50)
    np.testing.assert_array_equal(own.spend(stress), find_curve("D").spend(stress))


@pytest.mark.parametrize(
    ("plain", "message"),
    [
        ({"curve": "own", "branches": [{"m": 3}]}, r"branches\[0\]\.log_a: .* no value"),
        ({"curve": "own"}, r"fatigue\.branches: .* one branch or two, not 0"),
        ({"curve": "own", "branches": [{"m": 3, "log_a": 12}] * 3}, "one branch or two, not 3"),
        ({"curve": "own", "branches": [{"m": 3, "log_a": 12}], "knee": 1e7}, "has no knee"),
        ({"curve": "W4"}, r"no S-N curve is named 'W4'; did you mean W"),
        ({"curve": "D", "knee": 1e6}, r"fatigue\.knee: 'D' has a knee of its own"),
        ({"branches": [{"m": 3, "log_a": 12}]}, r"set fatigue\.curve=own"),
    ],
)
def test_a_wrong_section_is_refused_by_its_key(plain, message):
    with pytest.raises(InputError, match=message):
        typed(Fatigue, plain).check()


@pytest.mark.parametrize(
    ("m", "log_a", "knee", "message"),
    [
        ([3.0, 5.0], [12.164, 15.606], None, "two branches need"),
        ([3.0, 5.0], [12.164, 15.606], 1e6, r"meet at 1e\+07 cycles, not at 1e\+06"),
        ([5.0, 3.0], [15.606, 12.164], 1e7, "must be flatter"),
    ],
)
def test_a_wrong_own_curve_is_refused(m, log_a, knee, message):
    with pytest.raises(InputError, match=message):
        make_curve([Branch(m=m[0], log_a=log_a[0]), Branch(m=m[1], log_a=log_a[1])], knee)
