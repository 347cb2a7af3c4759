"""Make the record of a structure without blades: a slender mast that a shaker pulls at its top.

    python -m experiments.tower.make_recorded [FILE]

writes mast.csv (default) beside a structure's description, examples/mast.yaml: time, the shaker's
force, and displacement, velocity, acceleration and rotation at each node of the mesh, as a user
would hand in a record of a structure of the user's own (docs/tower.md). No noise is in it: the
study adds it. The mast is simulated on a mesh twice as fine as that of the estimators, with its
weight, which these leave out. Always the same bytes.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.streams import stream
from owtsweep.structures import Structure, read_structure
from owtsweep.structures.bernoulli import assemble_cut, assemble_whole
from owtsweep.structures.response import Outputs, respond
from owtsweep.studies.tower.truth import find_damping

STRUCTURE = Path(__file__).parents[2] / "examples" / "mast.yaml"
STEP = 0.01  # s
STEPS = 12_000
SUBDIVISION = 2
#: The shaker pulls slowly, and shakes weakly up to 4 Hz; near the mast's first frequency it does
#: not, or the motion would be all resonance, and the force a small difference of large ones.
SLOW, QUICK = (0.02, 0.5), (0.5, 4.0)  # Hz
WEAK = 0.05
LINES = 30
SPARED = (0.8, 1.3)  # Hz
FORCE = 500.0  # N, rms
RISE = 10.0  # s, in which the force grows from zero


def pull(steps: int) -> Array:
    """Make the shaker's force in N, shape (steps,): a sum of sines, the same each time."""
    draw = stream(2025, "mast", [], 0, "force")
    frequency = np.concatenate([draw.uniform(*band, LINES) for band in (SLOW, QUICK)])
    phase = draw.uniform(0.0, 2.0 * np.pi, 2 * LINES)
    size = np.where(frequency < SLOW[1], 1.0, WEAK)
    size[(frequency > SPARED[0]) & (frequency < SPARED[1])] = 0.0
    time = STEP * np.arange(steps)
    rise = np.sin(0.5 * np.pi * np.minimum(time / RISE, 1.0)) ** 2
    angle = 2.0 * np.pi * frequency * time[:, None] + phase
    return np.asarray(FORCE * np.sqrt(2.0 / np.sum(size**2)) * rise * (np.sin(angle) @ size))


def make(structure: Structure, steps: int = STEPS) -> dict[str, Array]:
    """Simulate the record: name of a column -> its values, shape (steps,)."""
    mesh = assemble_whole(structure, subdivision=SUBDIVISION)
    size = len(mesh.mass)
    damping = find_damping(structure, assemble_cut(structure, structure.bottom, structure.hub,
                                                   subdivision=SUBDIVISION))  # fmt: skip
    force = pull(steps)
    loads = np.zeros((size, 1))
    loads[size - 2] = 1.0
    pick, none = np.eye(size), np.zeros((size, size))
    free = mesh.free
    wanted = Outputs(*(np.vstack(rows)[:, free] for rows in (
        (pick, none, none), (none, pick, none), (none, none, pick),
    )))  # fmt: skip
    held = np.ix_(free, free)
    got = respond(
        mesh.mass[held], damping[held], mesh.stiffness[held], loads[free], force[:, None], STEP,
        wanted,
    )  # fmt: skip
    shift, speed, push = np.split(got, 3, axis=1)
    columns = {"time (s)": STEP * np.arange(steps)}
    ground = structure.mudline
    columns[f"F_{structure.hub - ground:03g} (N)"] = force
    for node in range(SUBDIVISION, len(mesh.heights), SUBDIVISION):  # the foot stands still
        at = f"{mesh.heights[node] - ground:03g}"
        columns[f"x_{at} (m)"] = shift[:, 2 * node]
        columns[f"v_{at} (m/s)"] = speed[:, 2 * node]
        columns[f"a_{at} (m/s^2)"] = push[:, 2 * node]
        columns[f"theta_{at} (rad)"] = shift[:, 2 * node + 1]
    return columns


def write(columns: dict[str, Array], file: Path) -> None:
    """Write columns as a CSV file."""
    table = np.column_stack(list(columns.values()))
    np.savetxt(file, table, "%.8g", ",", header=",".join(columns), comments="")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("mast.csv")
    write(make(read_structure(STRUCTURE)), target)
    print(f"{target} ({target.stat().st_size / 1e6:.1f} MB)")
