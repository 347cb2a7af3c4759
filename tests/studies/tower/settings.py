"""What schemes are told, for tests of the tower study."""

from __future__ import annotations

import numpy as np
from turbine import CUTS, STEP, STRUCTURE

from owtsweep.structures.bernoulli import assemble_cut, assemble_whole, strain_matrix
from owtsweep.structures.reduction import reduce_free
from owtsweep.studies.tower.contract import Channel, Priors, Setting
from owtsweep.studies.tower.measuring import Place
from owtsweep.studies.tower.truth import find_damping
from owtsweep.studies.tower.tuning import Tuning
from owtsweep.studies.tower.waves import triangular_load

CUT = assemble_cut(STRUCTURE, *CUTS)
STRAIN = strain_matrix(STRUCTURE, CUT)
TUNING = Tuning(
    inputs="declared",
    process_noise=1e-3,
    initial=1e6,
    force=1.7e4,
    moment=1.7e6,
    wave=2e3,
    correlation_time=10.0,
    lag=0.3,
)
#: Heights above the ground of inclinometers and accelerometers in Table 2 of Simpson et al. (2025).
SPARSE = {"theta": (0, 30, 58, 149, 175), "a": (0, 35, 40, 84, 175)}


def place(heights: dict[str, tuple[float, ...]]) -> list[Place]:
    """Return the places of the channels at heights above the ground, in m."""
    return [
        Place(kind, CUT.find_node(height + STRUCTURE.mudline))
        for kind, those in heights.items()
        for height in those
    ]


def make_setting(
    heights: dict[str, tuple[float, ...]],
    sigma: np.ndarray | float,
    *,
    gravity: bool = False,
    whole_modes: int = 10,
) -> Setting:
    """Return a setting with sensors at heights above the ground and noise of sizes `sigma`."""
    places = place(heights)
    sigma = np.broadcast_to(sigma, len(places))
    change = np.array([1.7e4, 1.7e6, 1.7e4, 1.7e6, 2e3])
    damping = find_damping(STRUCTURE, CUT)
    return Setting(
        direction="fa",
        cut=CUT,
        cut_damping=damping,
        reduced=reduce_free(CUT, [0, 1, len(CUT.mass) - 2, len(CUT.mass) - 1], 2),
        whole=assemble_whole(STRUCTURE, gravity=gravity),
        whole_damping=damping,
        nodes=np.arange(len(CUT.heights)),
        wave_shape=triangular_load(STRUCTURE, CUT),
        strain=STRAIN,
        channels=tuple(Channel(k, n, float(s)) for (k, n, _), s in zip(places, sigma, strict=True)),
        step=STEP,
        priors=Priors(change, 30.0 * change, np.full(5, 10.0)),
        tuning=TUNING,
        rate_noise=TUNING.process_noise,
        whole_modes=whole_modes,
    )
