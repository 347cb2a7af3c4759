"""The worlds of the floater study: what moves, by `motion.kind`, and what follows from it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import require
from owtsweep.io.reading import expand_home, hash_file
from owtsweep.motion.lines import HIGHEST, Series, Span
from owtsweep.motion.recorded import tell_alone
from owtsweep.streams import Streams
from owtsweep.studies.base.schemes import list_names
from owtsweep.studies.floater.config import FloaterConfig, Motion
from owtsweep.studies.floater.contract import DOF, Truth
from owtsweep.studies.floater.motion_recorded import read_file, read_motion
from owtsweep.studies.floater.motion_synthetic import decay, draw_motion
from owtsweep.studies.floater.schemes import LARGE_ANGLES, SCHEMES


@dataclass(frozen=True)
class World(ABC):
    """What moves: how it is made (as by `draw_motion`), checked and described."""

    draw: Callable[[Motion, Streams, Span, float | None], Series]

    @abstractmethod
    def check(self, config: FloaterConfig) -> None:
        """Raise `InputError` if the section `motion` cannot be moved by."""

    def check_outside(self, config: FloaterConfig) -> None:  # noqa: B027
        """Raise `InputError` if a file cannot be used."""

    @abstractmethod
    def describe(self, motion: Motion) -> str:
        """Return the motion in words."""

    @abstractmethod
    def find_frequencies(self, motion: Motion, truth: Truth) -> Array:
        """Return natural frequencies in rad/s, shape (6,)."""

    def find_periods(self, motion: Motion) -> list[float]:
        """Return the periods in s of what moves; none if nobody says."""
        return []

    def list_files(self, motion: Motion) -> dict[str, str]:
        """Return key of the section -> hash of the file that it names."""
        return {}

    def warn(self, motion: Motion) -> None:  # noqa: B027
        """Log what a user should know of the file."""


@dataclass(frozen=True)
class Simulated(World):
    """A structure that answers to waves, or to its release in still water, in resonances.

    reach: How many times its standard deviation, or its deflection, an angle reaches.
    words: what is said before the natural periods.
    waves: whether there are waves.
    """

    reach: float
    words: str
    waves: bool

    def check(self, config: FloaterConfig) -> None:
        """Check that all degrees of freedom move, and that angles stay below 90 degrees.

        Raise `InputError` if a degree of freedom is missing or at rest, or an angle too large for
        the schemes.
        """
        _check_freedoms(config)
        _check_angles(config, self.reach)

    def describe(self, motion: Motion) -> str:
        """Return kind, natural periods and the period of the waves."""
        slow = sorted({freedom.resonance.period for freedom in motion.freedoms.values()})
        periods = f"{slow[0]:g} to {slow[-1]:g} s" if len(slow) > 1 else f"{slow[0]:g} s"
        waves = f", waves of {motion.wave_period:g} s" if self.waves else ""
        return f"{motion.kind} motion, {self.words} {periods}{waves}"

    def find_frequencies(self, motion: Motion, truth: Truth) -> Array:
        """Return those of the section `motion`."""
        periods = [motion.freedoms[name].resonance.period for name in DOF]
        return 2.0 * np.pi / np.array(periods)

    def find_periods(self, motion: Motion) -> list[float]:
        """Return the natural periods, and that of the waves."""
        natural = [freedom.resonance.period for freedom in motion.freedoms.values()]
        return [*natural, motion.wave_period] if self.waves else natural


class Recorded(World):
    """A motion from a file."""

    def check(self, config: FloaterConfig) -> None:
        """Raise `InputError` if there is no file, or its roll shall be another one."""
        require(
            config.grid.roll is None,
            "grid.roll: a recorded motion has its own; use grid.roll=null",
        )
        require(
            config.motion.file is not None,
            "motion.file: kind=recorded needs a file; give motion.file=basin.csv",
        )

    def check_outside(self, config: FloaterConfig) -> None:
        """Raise `InputError` if the file cannot be used."""
        record = config.record
        read_motion(config.motion, None, Span(record.steps, 1.0 / record.rate))

    def describe(self, motion: Motion) -> str:
        """Return the file, and that all records have its motion."""
        return tell_alone(str(motion.file))

    def find_frequencies(self, motion: Motion, truth: Truth) -> Array:
        """Return those of zero crossings."""
        return np.asarray(truth.velocity.std(axis=0) / truth.position.std(axis=0))

    def list_files(self, motion: Motion) -> dict[str, str]:
        """Return the hash of the file."""
        return {"file": hash_file(expand_home(str(motion.file)))}

    def warn(self, motion: Motion) -> None:
        """Log what was left out of the file, or resampled."""
        read_file(motion).log_notes()


WORLDS: dict[str, World] = {
    # angles go some three standard deviations from their mean
    "synthetic": Simulated(draw_motion, reach=3.0, words="resonances of", waves=True),
    "decay": Simulated(decay, reach=1.0, words="release, natural periods", waves=False),
    "recorded": Recorded(read_motion),
}


def _check_freedoms(config: FloaterConfig) -> None:
    """Check that every degree of freedom moves, in a resonance that the samples show."""
    motion, record = config.motion, config.record
    for name in DOF:
        require(
            name in motion.freedoms,
            f"motion.freedoms: {name} is missing; give all of {', '.join(DOF)}",
        )
        freedom = motion.freedoms[name]
        require(
            freedom.resonance.sigma + freedom.waves > 0.0,
            f"motion.freedoms.{name}: it does not move, so no error is relative to it; give it a "
            "small motion",
        )
        highest = HIGHEST / min(freedom.resonance.period, motion.wave_period)
        require(
            record.rate >= 2.0 * highest,
            f"record.rate: {record.rate:g} Hz cannot show motion up to {highest:.4g} Hz ({name}); "
            f"give {np.ceil(2e3 * highest) / 1e3:g} Hz or more",
        )


def _check_angles(config: FloaterConfig, times: float) -> None:
    """Check that pitch stays below 90 degrees, and roll, too, if a scheme takes angles for small.

    At a pitch of 90 degrees roll and yaw are the same (Eq. 2 divides by its cosine). Other schemes
    bear any roll below 180 degrees, where the angle jumps.
    """
    motion, grid = config.motion, config.grid
    names = list_names(config.schemes)
    angled = [name for name in names if name in SCHEMES.listed and name not in LARGE_ANGLES]
    most = 90.0 if angled else 180.0
    who = f", where Euler angles fail ({', '.join(angled)})" if angled else ""
    instead = ", or schemes=[ERROR_STATE]" if angled else ""
    checked = {"phi": (most, who, instead), "theta": (90.0, ", where Euler angles fail", "")}
    if grid.roll is not None:
        checked.pop("phi")
        mean = abs(motion.freedoms["phi"].mean)
        free = max(np.floor((most - mean) / times - 1e-9), 0.0)
        require(
            mean + times * max(grid.roll) < most,
            f"grid.roll: {max(grid.roll):g} deg reaches {most:g} deg{who}; give at most "
            f"{free:g}{instead}",
        )
    for name, (limit, where, otherwise) in checked.items():
        freedom = motion.freedoms[name]
        own = times * np.hypot(freedom.resonance.sigma, freedom.waves)
        require(
            abs(freedom.mean) + own < limit,
            f"motion.freedoms.{name}: a mean of {freedom.mean:g} deg and {own:.3g} deg about it "
            f"reach {limit:g} deg{where}; give less motion{otherwise}",
        )
