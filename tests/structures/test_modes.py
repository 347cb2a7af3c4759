"""Modes against closed forms, tables and Ren et al. (2019), Table 3."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

from owtsweep.errors import InputError
from owtsweep.structures import Structure, compute_modes, read_structure
from owtsweep.structures.description import Point
from owtsweep.structures.modes import assemble
from owtsweep.structures.sections import initial_modulus

CONF = Path(__file__).parents[2] / "conf" / "structure"
LENGTH, DIAMETER, WALL, DENSITY, MODULUS = 100.0, 0.2, 0.01, 7850.0, 2.1e11
AREA = np.pi / 4.0 * (DIAMETER**2 - (DIAMETER - 2.0 * WALL) ** 2)
INERTIA = np.pi / 64.0 * (DIAMETER**4 - (DIAMETER - 2.0 * WALL) ** 4)


def slender(**changes: object) -> Structure:
    """Return a clamped tube without weight, so slender that shear and rotary inertia vanish."""
    tube = {
        "name": "tube", "bottom": 0.0, "top": LENGTH, "diameter": [DIAMETER] * 2,
        "thickness": [WALL] * 2, "density": DENSITY,
    }  # fmt: skip
    plain = {
        "name": "slender", "source": "test", "mudline": 0.0, "tubes": [tube], "clamped": True,
        "damping": 0.01, "gravity": 0.0,
    }  # fmt: skip
    structure = Structure.model_validate(plain | changes)
    structure.check()
    return structure


def beam_frequency(root: float) -> float:
    """Return the frequency (Hz) of Euler's beam whose eigenvalue is `root` = k L."""
    return (root / LENGTH) ** 2 * np.sqrt(MODULUS * INERTIA / (DENSITY * AREA)) / (2.0 * np.pi)


def test_a_clamped_tube_has_eulers_frequencies():
    roots = [brentq(lambda x: np.cos(x) * np.cosh(x) + 1.0, *span) for span in ((1, 3), (4, 5.5))]
    found = compute_modes(slender(), 2).frequency
    np.testing.assert_allclose(found, [beam_frequency(root) for root in roots], rtol=1e-4)


def test_a_clamped_tube_with_a_tip_mass_has_the_closed_form():
    ratio = 2.5  # tip mass over the tube's mass
    mass = ratio * DENSITY * AREA * LENGTH

    def determinant(x: float) -> float:
        c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
        return float(1.0 + c * ch + ratio * x * (c * sh - s * ch))

    root = brentq(determinant, 0.5, 1.5)
    top = {"name": "top", "height": LENGTH, "mass": mass}
    found = compute_modes(slender(points=[top]), 1).frequency[0]
    assert found == pytest.approx(beam_frequency(root), rel=1e-4)


def test_a_static_load_bends_the_tube_as_the_beam_tables_say():
    beam = assemble(slender())
    load = np.zeros(beam.stiffness.shape[0])
    load[beam.hub] = 1.0
    K = beam.stiffness[beam.free][:, beam.free].toarray()
    answer = np.zeros_like(load)
    answer[beam.free] = np.linalg.solve(K, load[beam.free])
    assert answer[beam.hub] == pytest.approx(LENGTH**3 / (3 * MODULUS * INERTIA), rel=1e-4)
    assert answer[beam.hub_slope] == pytest.approx(LENGTH**2 / (2 * MODULUS * INERTIA), rel=1e-4)


def test_weight_lowers_the_frequency_to_zero_at_the_buckling_load():
    tip = 0.999 * np.pi**2 * MODULUS * INERTIA / (4.0 * LENGTH**2)  # N, Euler's load
    light = {"name": "top", "height": LENGTH, "mass": tip / 9.81}
    thin = slender(points=[light]).tubes[0].model_copy(update={"density": 1e-3})
    near = slender(points=[light], gravity=9.81).model_copy(update={"tubes": [thin]})
    free = near.model_copy(update={"gravity": 0.0})
    ratio = compute_modes(near, 1).frequency[0] / compute_modes(free, 1).frequency[0]
    assert ratio < 0.05
    over = near.model_copy(update={"gravity": 1.01 * 9.81})
    with pytest.raises(InputError, match="buckles"):
        compute_modes(over, 1)


def test_table_3_of_ren():
    structure = read_structure(CONF / "ren2019.yaml")
    for blades, printed, within in ((0, 0.258, 0.01), (1, 0.249, 0.015), (2, 0.239, 0.03)):
        modes = compute_modes(structure, 4, blades)
        assert modes.frequency[0] == pytest.approx(printed, rel=within)
        assert modes.slope[0] == pytest.approx(0.0138, rel=0.02)  # rad/m


def test_the_kept_table_3_is_what_the_structure_has():
    kept = pd.read_csv(CONF.parents[1] / "results" / "reference" / "plant" / "table_3.csv")
    structure = read_structure(CONF / "ren2019.yaml")
    found = [compute_modes(structure, 1, blades).frequency[0] for blades in kept["blades"]]
    np.testing.assert_allclose(kept["reproduced"], found, rtol=1e-6)


def test_nrels_turbine_on_the_monopile_of_oc3():
    """NREL's BModes input of this structure, clamped, has .276 (fore-aft) and .274 Hz."""
    oc3 = read_structure(CONF / "oc3_monopile.yaml")
    found = [compute_modes(oc3, 1, blades).frequency[0] for blades in (0, 3)]
    assert found[0] == pytest.approx(0.304, rel=0.03)  # a prototype, no blades
    assert found[1] == pytest.approx(0.275, rel=0.03)


def test_nrels_turbine_on_land():
    """Jonkman et al. (2009), Table 9-1: first tower mode, fore-aft, .324 Hz by FAST."""
    oc3 = read_structure(CONF / "oc3_monopile.yaml")
    tower = read_structure(CONF / "ren2019.yaml").tubes[-1]
    land = oc3.model_copy(update={"mudline": 0.0, "tubes": [tower], "water": None})
    assert compute_modes(land, 1, 3).frequency[0] == pytest.approx(0.324, rel=0.05)


def test_masses_are_those_of_table_2():
    structure = read_structure(CONF / "ren2019.yaml")
    for tube, tonnes in zip(structure.tubes, (571.0, 347.5), strict=True):
        height = np.linspace(tube.bottom, tube.top, 2001)
        mass = np.trapezoid(tube.density * tube.area(height), height)
        assert mass == pytest.approx(1e3 * tonnes, rel=0.01)


def test_stiffness_of_the_soil_is_that_of_the_diagram():
    for angle, power, parabola in ((33.0, 16.4, 14.6), (35.0, 23.0, 21.0), (38.5, 35.9, 36.1)):
        assert initial_modulus(angle, "power") == pytest.approx(1e6 * power, rel=0.01)
        assert initial_modulus(angle, "parabola") == pytest.approx(1e6 * parabola, rel=0.01)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"clamped": False}, "it floats"),
        ({"tubes": [{"thickness": [0.2, 0.01]}]}, "exceeds the radius"),
        ({"tubes": [{"thickness": [-0.01, 0.01]}]}, "above zero"),
        ({"tubes": [{"top": -1.0}]}, "must be above bottom"),
        ({"soil": {"layers": [{"bottom": 5.0}]}}, "friction_angle"),
        ({"soil": {"layers": [{"bottom": 5.0, "friction_angle": 20.0}]}}, "28"),
        ({"points": [{"name": "top", "height": 101.0, "mass": 1.0}]}, "height 101 m"),
        ({"points": [{"name": "top", "height": 9.0, "mass": 1e30}]}, "points[0].mass: 1e+30"),
        ({"tubes": [{"top": 1e-4}]}, "top 0.0001 m must be above bottom 0 m, by 0.001 m or more"),
        ({"tubes": [{"diamter": [0.2, 0.2]}]}, "did you mean tubes[0].diameter?"),
        ({"name": "../mine"}, "structure.name: '../mine' cannot be part of a file's name"),
        ({"water": {}}, "structure.gravity: 0 m/s^2 leaves no waves on the structure's water"),
    ],
)
def test_a_structure_that_cannot_be_is_refused_in_one_line(tmp_path, change, words):
    import yaml

    plain = slender().model_dump()
    plain["tubes"][0] |= change.pop("tubes", [{}])[0]
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(plain | change))
    with pytest.raises(InputError) as caught:
        read_structure(path)
    assert words in str(caught.value)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_rounding_makes_no_short_element():
    """Gaps between tubes, and points just beside them, of the size of rounding."""
    whole, close = slender(), 0.5e-9
    tube = whole.tubes[0]
    body = Point(name="body", height=50.0 + 3.0 * close, mass=1000.0)
    lower = tube.model_copy(update={"name": "lower", "top": 50.0})
    upper = tube.model_copy(update={"name": "upper", "bottom": 50.0 + close})
    cut = whole.model_copy(update={"tubes": [lower, upper], "mudline": close, "points": [body]})
    cut.check()
    assert np.diff(assemble(cut).heights).min() > 0.1
    exact = whole.model_copy(update={"points": [body.model_copy(update={"height": 50.0})]})
    found, expected = (compute_modes(one, 2).frequency for one in (cut, exact))
    np.testing.assert_allclose(found, expected, rtol=1e-7)


def test_more_modes_than_degrees_of_freedom_are_refused():
    with pytest.raises(InputError, match="modes: 400 of structure slender"):
        compute_modes(slender(), 400)
