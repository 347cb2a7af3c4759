"""MDE: modal decomposition and expansion in several bands, as practised on monopiles.

Iliopoulos et al. (2016, Mech. Syst. Signal Process. 68-69), Maes et al. (2016, Mech. Syst. Signal
Process. 76); with a quasi-static band Iliopoulos et al. (2017, Wind Energy 20). A model of the
whole turbine gives shapes; sensors give their coordinates by least squares, one instant at a time;
the shapes then expand to every node:

- quasi-static band: inclinometers, displacement sensors and strain gauges, mean included, on the
  static shapes under a force and a moment at the top. Without such sensors this band is zero.
- band of the first mode: accelerations, integrated twice in the frequency domain, on its shape.
- upper band: accelerations, integrated twice, on the lowest `MODES` shapes. The higher ones would
  let noise into the band of the first mode, where they hardly move and integration magnifies noise.

Bands meet at `SPLIT` and `UPPER` times the model's first natural frequency: the lower one below the
resonance, where the shapes of first mode and static load are almost one; the upper one below the
blade-passing line of common turbines. Their gains sum to 1 and have no phase: the scheme needs the
whole record, so it is an offline one. Interface loads follow from the motion (see `models`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

from owtsweep.arrays import Array
from owtsweep.structures.reduction import reduce_held
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.tower.contract import Direct, Estimates, Setting
from owtsweep.studies.tower.models import (
    balance_loads,
    decompose,
    list_whole_dof,
    respond_statically,
)

#: Where the quasi-static band ends and the upper one begins, over the first natural frequency.
SPLIT, UPPER = 0.8, 1.8
#: Number of mode shapes in the upper band; fewer if there are fewer accelerometers.
MODES = 3
#: Order of the filters; a low-pass has the gain of a Butterworth filter run there and back.
ORDER = 4
#: Time for which a record is continued beyond its ends, in periods of the lowest split frequency.
MARGIN = 10.0


@dataclass(frozen=True)
class Expander:
    """Shapes in one band, and how sensors give their coordinates.

    `decompose`: coordinates (or their accelerations) for unit signals, shape (shapes, channels).
    `shapes`: displacements of the cut's degrees of freedom for unit coordinates, shape (dof,
    shapes). `loads`: interface loads for unit displacement, velocity and acceleration of the
    coordinates, each of shape (4, shapes).
    """

    decompose: Array
    shapes: Array
    loads: tuple[Array, Array, Array]


@dataclass(frozen=True)
class Expansion:
    """The scheme made ready for one setting: an expander per band, upwards.

    `splits` are the frequencies in Hz at which the bands meet, `step` the sampling interval in s.
    """

    expanders: tuple[Expander, ...]
    splits: tuple[float, ...]
    step: float

    def run(self, measured: Array) -> Estimates:
        """Estimate from measurements, shape (steps, channels)."""
        bands = Bands(len(measured), self.step, self.splits)
        displacement: Array = np.zeros((len(measured), len(self.expanders[0].shapes)))
        inputs: Array = np.zeros((len(measured), 4))
        for band, expander in enumerate(self.expanders):
            signals = measured @ expander.decompose.T
            take = bands.integrate if band else bands.differentiate
            motions = take(signals, band)
            displacement += motions[0] @ expander.shapes.T
            for motion, load in zip(motions, expander.loads, strict=True):
                inputs += motion @ load.T
        return Estimates(displacement, inputs, latency=self.step * len(measured))


def prepare(setting: Setting) -> Expansion:
    """Compute shapes, and coordinates from sensors.

    Raise `Unable` if there is no accelerometer, or the sensors of a band do not tell its shapes
    apart.
    """
    moved = [i for i, channel in enumerate(setting.channels) if channel.kind == "a"]
    others = [i for i, channel in enumerate(setting.channels) if channel.kind != "a"]
    if not moved:
        raise Unable("MDE is blind to dynamics: it needs an accelerometer")
    at = list_whole_dof(setting)
    held = reduce_held(setting.whole, min(MODES, len(moved)))
    loads = np.eye(len(setting.whole.mass))[:, at[-2:]]
    static = respond_statically(setting.whole, loads[:, : min(2, len(others))])
    first = held.omega[0] / (2.0 * np.pi)
    return Expansion(
        expanders=(
            _expand(setting, others, static),
            _expand(setting, moved, held.basis[:, :1]),
            _expand(setting, moved, held.basis),
        ),
        splits=(SPLIT * first, UPPER * first),
        step=setting.step,
    )


def _expand(setting: Setting, numbers: list[int], whole_shapes: Array) -> Expander:
    """Make the expander of shapes of the whole (dof, shapes) from channels with these numbers.

    Accelerometers count alike, as in practice: what they read beyond the modes is larger than their
    noise, most of all near the ground, where motion and therefore noise are least. Other sensors
    differ in unit, and are weighted by their noise.
    """
    shapes = whole_shapes[list_whole_dof(setting)]
    coordinates = np.zeros((shapes.shape[1], len(setting.channels)))
    if numbers:
        sensors = [setting.channels[i] for i in numbers]
        weight = np.array([1.0 if s.kind == "a" else 1.0 / s.sigma for s in sensors])
        rank, coordinates[:, numbers] = decompose(sensors, weight, shapes, setting.strain)
        if rank < shapes.shape[1]:
            raise Unable(
                f"MDE is blind: its sensors see {rank} of {shapes.shape[1]} shapes of a band"
            )
    return Expander(coordinates, shapes, balance_loads(setting, whole_shapes))


class Bands:
    """Bands between split frequencies, with gains that sum to 1, for records of one length.

    Records, of 2 `steps` or more, are continued beyond both ends by their reflection in the end
    point, so that they neither jump there nor wrap around. The `splits` at which bands meet are in
    Hz, upwards; `step` is in s.
    """

    def __init__(self, steps: int, step: float, splits: Sequence[float]) -> None:
        self.steps = steps
        self.margin = min(steps - 1, round(MARGIN / (splits[0] * step)))
        self.size = next_fast_len(steps + 2 * self.margin, real=True)
        frequency = rfftfreq(self.size, step)
        below = [1.0 / (1.0 + (frequency / split) ** (2 * ORDER)) for split in splits]
        #: Gain of each band, upwards, shape (splits + 1, frequencies).
        self.gains = np.diff(below, axis=0, prepend=0.0, append=1.0)
        self.rate = 2j * np.pi * frequency

    def differentiate(self, signal: Array, band: int) -> tuple[Array, Array, Array]:
        """Return signals (steps, signals) in a band, their first and their second derivative."""
        inside = self._transform(signal, band)
        rate = self.rate[:, None]
        return self._back(inside), self._back(inside * rate), self._back(inside * rate**2)

    def integrate(self, acceleration: Array, band: int) -> tuple[Array, Array, Array]:
        """Return displacement, velocity and acceleration in a band other than the lowest."""
        inside = self._transform(acceleration, band)
        inverse = np.zeros_like(self.rate)
        inverse[1:] = 1.0 / self.rate[1:]
        once = inside * inverse[:, None]
        return self._back(once * inverse[:, None]), self._back(once), self._back(inside)

    def _transform(self, signal: Array, band: int) -> Array:
        both = (self.margin, self.margin), (0, 0)
        padded = np.pad(signal, both, mode="reflect", reflect_type="odd")
        # The rest of the transform's length leads from the last value back to the first.
        rest = np.linspace(padded[-1], padded[0], self.size - len(padded) + 2)[1:-1]
        spectrum = rfft(np.concatenate([padded, rest]), axis=0)
        return np.asarray(spectrum * self.gains[band][:, None])

    def _back(self, spectrum: Array) -> Array:
        whole = irfft(spectrum, self.size, axis=0)
        return np.ascontiguousarray(whole[self.margin : self.margin + self.steps])


SCHEME = Direct("MDE", prepare)
