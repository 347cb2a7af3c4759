"""The truth of the tower study against a second model and a second integration in time.

The beam is assembled by hand from Hermite's shape functions, and the whole of its first-order
system is advanced by one matrix exponential for loads that are linear between samples.
"""

from itertools import pairwise

import numpy as np
from scipy.linalg import eigh, expm
from turbine import ROUGH, STEP, STRUCTURE, WIND, make, streams

from owtsweep.motion.lines import Span
from owtsweep.structures.bernoulli import PlaneBeam
from owtsweep.studies.tower.waves import make_wave_loads
from owtsweep.studies.tower.wind import make_top_loads

STEPS = 400
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(8)
WATER = 1025.0


def describe(tube, z):
    """Return second moment of area and masses per length, without and with water, at heights z."""
    part = (z - tube.bottom) / (tube.top - tube.bottom)
    outer = tube.diameter[0] + part * (tube.diameter[1] - tube.diameter[0])
    inner = outer - 2.0 * tube.thickness[0]
    steel = tube.density * np.pi / 4.0 * (outer**2 - inner**2)
    water = np.where(z < 0.0, WATER * np.pi / 4.0 * outer**2, 0.0)
    return np.pi / 64.0 * (outer**4 - inner**4), steel, steel + water


def assemble():
    """Return heights of the nodes, mass, stiffness and softening by weight of the bare beam."""
    pieces = []
    for tube in STRUCTURE.tubes:
        middle = 0.5 * (tube.bottom + tube.top)
        pieces += [(tube, tube.bottom, middle), (tube, middle, tube.top)]
    size = 2 * len(pieces) + 2
    mass, stiffness, softening = np.zeros((3, size, size))
    above = STRUCTURE.points[0].mass
    s, w = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS
    for number, (tube, low, high) in reversed(list(enumerate(pieces))):
        length = high - low
        inertia, _, total = describe(tube, low + length * s)
        shape = np.array([1 - 3 * s**2 + 2 * s**3, length * (s - 2 * s**2 + s**3),
                          3 * s**2 - 2 * s**3, length * (s**3 - s**2)])  # fmt: skip
        slope = np.array([6 * s**2 - 6 * s, length * (1 - 4 * s + 3 * s**2),
                          6 * s - 6 * s**2, length * (3 * s**2 - 2 * s)]) / length  # fmt: skip
        bend = np.array([12 * s - 6, length * (6 * s - 4), 6 - 12 * s, length * (6 * s - 2)])
        bend /= length**2
        rest = high - low - length * s  # of the element above each point
        weight = above + rest * (w @ describe(tube, high - np.outer(1.0 - s, rest))[1])
        at = np.ix_(*2 * [range(2 * number, 2 * number + 4)])
        mass[at] += length * (shape * w * total) @ shape.T
        stiffness[at] += length * (bend * w * tube.youngs_modulus * inertia) @ bend.T
        softening[at] += length * STRUCTURE.gravity * (slope * w * weight) @ slope.T
        above += length * (w @ describe(tube, low + length * s)[1])
    heights = np.array([pieces[0][1], *(high for _, _, high in pieces)])
    return heights, mass, stiffness, softening


def test_a_second_model_and_integration_give_the_same_truth():
    heights, mass, elastic, softening = assemble()
    size, body, springs = len(mass), STRUCTURE.points[0], STRUCTURE.foundation
    first = np.sqrt(eigh(elastic, mass, eigvals_only=True)[2])
    own_damping = 2.0 * STRUCTURE.damping / first * elastic
    own = elastic - softening
    whole_mass, damping, stiffness = mass.copy(), own_damping.copy(), own.copy()
    offset = body.offset
    whole_mass[-2:, -2:] += body.mass * np.array([[1.0, offset], [offset, offset**2]])
    whole_mass[-1, -1] += body.inertia
    stiffness[-1, -1] -= body.mass * STRUCTURE.gravity * offset
    stiffness[:2, :2] += [[springs.lateral, springs.coupling], [springs.coupling, springs.rotation]]
    damping[-2, -2] += WIND.damping
    beam = PlaneBeam(heights, mass, own, np.arange(size))
    waves = make_wave_loads(STRUCTURE, beam, ROUGH, streams(), Span(STEPS, STEP, STEPS))
    of_waves = np.zeros((2 * STEPS, size))
    of_waves[:, waves.dof] = np.cos(np.deg2rad(ROUGH.yaw)) * waves.series
    loads = of_waves.copy()
    loads[:, -2:] += make_top_loads(WIND, streams(), steps=STEPS, step=STEP, lead=STEPS)[:, :2]

    inverse = np.linalg.inv(whole_mass)
    block = np.zeros((4 * size, 4 * size))
    block[:size, size : 2 * size] = STEP * np.eye(size)
    block[size : 2 * size, :size] = -STEP * inverse @ stiffness
    block[size : 2 * size, size : 2 * size] = -STEP * inverse @ damping
    block[size : 2 * size, 2 * size : 3 * size] = STEP * inverse
    block[2 * size : 3 * size, 3 * size :] = np.eye(size)
    moved = expm(block)[: 2 * size]
    state = np.concatenate([np.linalg.solve(stiffness, loads[0]), np.zeros(size)])
    states = [state]
    for now, then in pairwise(loads):
        state = moved @ np.concatenate([state, now, then - now])
        states.append(state)
    shift, speed = np.split(np.array(states), 2, axis=1)
    push = (loads - shift @ stiffness - speed @ damping) @ inverse
    through = push @ mass + speed @ own_damping + shift @ own - of_waves

    motion = make(steps=STEPS, sea=ROUGH)["fa"]
    nodes = np.arange(size).reshape(-1, 2)[::2].reshape(-1)
    for got, expected in (
        (motion.displacement, shift[STEPS:, nodes]),  # the loads' lead brings it to motion
        (motion.inputs, through[STEPS:, [0, 1, -2, -1]]),
    ):
        assert np.all(np.abs(got - expected).max(axis=0) <= 1e-6 * expected.std(axis=0))
