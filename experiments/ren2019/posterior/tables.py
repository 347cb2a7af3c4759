"""Tables of components over a design that fills each scheme's settings, kept by their hash."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from experiments.ren2019.posterior.components import Components, base_config, simulate_all
from experiments.ren2019.posterior.settings import FORCES, LENGTHS, MOTIONS, OF_SCHEME, SPECTRA
from owtsweep.arrays import Array
from owtsweep.config import as_mapping
from owtsweep.io.files import write_atomically
from owtsweep.studies.hub.study import HubStudy
from owtsweep.sweep.keys import hash_text

#: Points of each scheme's design. The EKF diverges at two points of five; HME2 has eight settings.
POINTS = {"EKF": 512, "MKF": 256, "HME1": 512, "HME2": 512}


def make_design(scheme: str, points: int) -> Array:
    """Return Sobol points of the unit cube of a scheme's settings, shape (points, settings)."""
    sampler = qmc.Sobol(len(OF_SCHEME[scheme]), rng=np.random.default_rng(42))
    return np.asarray(sampler.random(points))


def load_table(scheme: str, folder: Path) -> tuple[Array, Components]:
    """Return a scheme's design and its components, one row per point; simulate what is not kept."""
    design = make_design(scheme, POINTS[scheme])

    def make() -> dict[str, Array]:
        made = simulate_all(scheme, design)
        motion, noise = (np.array(part) for part in zip(*made, strict=True))
        return {"motion": motion, "noise": noise}

    said = (scheme, OF_SCHEME[scheme], MOTIONS, FORCES, SPECTRA, LENGTHS, design.tobytes())
    return design, Components(**keep(folder, scheme.lower(), said, make))


def keep(
    folder: Path, name: str, said: object, make: Callable[[], dict[str, Array]]
) -> dict[str, Array]:
    """Return arrays by name: kept in a file named by all that they depend on, or made and kept.

    said: what they depend on besides the configuration and the hub's numerics version.
    """
    content = (said, as_mapping(base_config()), HubStudy.numerics_version)
    file = folder / f"{name}-{hash_text(repr(content))}.npz"
    if not file.exists():
        stream = io.BytesIO()
        np.savez_compressed(stream, **make())
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(file, stream.getvalue())
    with np.load(file) as kept:
        return {key: kept[key] for key in kept.files}
