"""The section `record` of studies whose records have samples of one rate."""

from __future__ import annotations

from owtsweep.config.section import NotNegative, Positive, Section, key
from owtsweep.errors import require

#: Least samples of a record that can be judged.
LEAST_SAMPLES = 100


class Record(Section):
    """The section `record`: a record of motion and measurements."""

    duration: Positive = key("length", unit="s")
    rate: Positive = key("samples per second", unit="Hz")
    settling: NotNegative = key("left out at the beginning of every comparison", unit="s")

    @property
    def steps(self) -> int:
        """The number of samples."""
        return round(self.duration * self.rate)

    @property
    def settled(self) -> int:
        """The number of the first sample that is judged."""
        return round(self.settling * self.rate)

    def check_samples(self, most: int) -> None:
        """Check that there are not too many samples, and enough of them after the settling.

        Raises
        ------
        InputError
            If there are fewer than 100 in the record or after its settling, or more than `most`.
        """
        require(
            LEAST_SAMPLES <= self.steps <= most,
            f"record.duration: {self.duration:g} s at {self.rate:g} Hz are {self.steps} samples; "
            f"give {LEAST_SAMPLES} to {most}",
        )
        require(
            self.steps - self.settled >= LEAST_SAMPLES,
            f"record.settling: {self.settling:g} s leave {max(self.steps - self.settled, 0)} "
            f"samples of a record of {self.duration:g} s; at least {LEAST_SAMPLES} must be left",
        )
