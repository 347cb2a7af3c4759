"""Probes in compiled stretches against whole records, cycle by cycle in NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from tools import configure

from owtsweep.arrays import Array
from owtsweep.studies.hub import batch, estimates
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.error_curves import inputs, probing
from owtsweep.studies.hub.error_curves.inputs import Probe
from owtsweep.studies.hub.sensors import Sensors, fix_count
from owtsweep.studies.hub.settled import cycle_of, filling

pytestmark = pytest.mark.usefixtures("kernels")

DURATION, SETTLED = 600.0, 513


def squares(chain: Chain, sensors: Sensors, probe: Probe, steps: int) -> Array:
    """(steps, 2 measures, n) squared errors of the whole record."""
    k = np.arange(steps)[:, None]
    q = sensors.fix_interval * np.arange(fix_count(steps, sensors.fix_interval))[:, None]
    late = sensors.delay if probe.truth else 0
    total = np.zeros((steps, 2, len(probe.angle)))
    for turn in (0.5 * np.pi, 0.0) if probe.phasor else (0.0,):
        phase = probe.angle * k + probe.shift + turn
        fixes = np.sin(probe.angle * (q - late) + probe.shift + turn) * probe.fix
        found = estimates.trajectories(chain, np.sin(phase) * probe.force, fixes)
        rate = probe.angle / sensors.step
        truth = (np.sin(phase), rate * np.cos(phase)) if probe.truth else (0.0, 0.0)
        for measure in range(2):
            total[:, measure] += (found[measure] - truth[measure]) ** 2
    return total


def stop_of(chain: Chain, squared: Array, settled: int) -> int:
    """The first whole chunk after which the newest cycles of all phasors have the same sums."""
    cycle, chunk = cycle_of(chain), batch.chunk_of(chain)[0]
    wanted = max(filling(chain), settled) + (probing.JUDGED + 1) * cycle
    for end in range(chunk, len(squared), chunk):
        if end < wanted:
            continue
        whole = end // cycle
        newest = squared[(whole - probing.JUDGED) * cycle : whole * cycle]
        sums = newest.reshape(probing.JUDGED, cycle, *newest.shape[1:]).sum(axis=1)
        if np.all(np.ptp(sums, axis=0) <= probing.TOLERANCE * sums.max(axis=0)):
            return end
        wanted = end + probing.JUDGED * cycle
    return len(squared)


def expected_energies(chain: Chain, squared: Array, stop: int, settled: int) -> Array:
    cycle, steps = cycle_of(chain), len(squared)
    newest = squared[(stop // cycle - probing.JUDGED) * cycle : stop // cycle * cycle]
    rest = newest.sum(axis=0) * (steps - stop) / (probing.JUDGED * cycle)
    late = squared[settled:stop].sum(axis=0) + rest
    return np.stack([squared[:settled].sum(axis=0) + late, late], axis=1)


#: The numbers of `matched` at the default sensors: HME2 forgets its start within the record.
SETTLES_SOON = ("hme2.q_a=13.9", "hme2.r_gnss.scale=0.0611", "hme.mhe.smoother_window=32")


@pytest.mark.parametrize("name", ["EKF", "HME1", "HME2"])
@pytest.mark.parametrize("tolerance", [1e-3, 2e-5, -1.0])
def test_probes_are_whole_records(
    name: str, tolerance: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(probing, "TOLERANCE", tolerance)
    monkeypatch.setattr(probing, "JUDGED", 4)
    config = configure(f"record.duration={DURATION}", *SETTLES_SOON, tuning="matched")
    sensors = sensing.sensors(config.sensors)
    steps = round(DURATION / sensors.step)
    chain = resolve(name).kernel(Known(sensors, config), steps)
    fixes = fix_count(steps, sensors.fix_interval)
    probes = {
        # eleven: two pairs, the second of them not full, that settle at different times
        "motion": inputs.motion(np.geomspace(0.5, 0.06, 11), sensors),
        "forces": inputs.forces(np.arange(0.0, 33.0, 3.0), steps),
        "fixes": inputs.fixes(np.arange(0.0, 11.0), fixes, sensors),
        "walks": inputs.walks(np.arange(1.0, 22.0), steps),
        "constant": inputs.constant(),
    }
    space = probing.Workspace(chain, sensors, steps, SETTLED)
    stops = set()
    for kind, probe in probes.items():
        squared = squares(chain, sensors, probe, steps)
        stop = stop_of(chain, squared, SETTLED) if probe.phasor else steps
        stops.add(stop)
        found = space.energies(probe)
        exact = expected_energies(chain, squared, stop, SETTLED)
        np.testing.assert_allclose(found, exact, rtol=1e-9, err_msg=kind)
        alone = probing.Workspace(chain, sensors, steps, SETTLED).energies(probe)
        assert np.array_equal(found, alone)  # what a workspace held before does not matter
    assert tolerance != 1e-3 or len(stops) > 1


def test_pairs_stop_where_the_last_of_them_repeats() -> None:
    class Pair:
        cycle = 1

        def __init__(self, *repeating: int) -> None:
            self.repeating, self.done, self.repeats = repeating, 0, False

        def advance(self, stop: int, judged: int) -> None:
            while self.done < stop:
                self.done += probing.JUDGED
                if self.done >= judged and self.done in self.repeating:
                    self.repeats = True
                    return
            self.repeats = False

    J = probing.JUDGED
    early, late = Pair(2 * J, 3 * J, 7 * J, 9 * J), Pair(4 * J, 6 * J, 9 * J)
    assert probing._together([early, late], 20 * J, 2 * J) == 9 * J  # type: ignore[list-item]
    never = [Pair(2 * J, 5 * J), Pair(3 * J)]
    assert probing._together(never, 20 * J, 2 * J) == 20 * J  # type: ignore[arg-type]
    assert all(pair.done == 20 * J for pair in never)
