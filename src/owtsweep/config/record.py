"""The section `record` of studies whose records have samples of one rate."""

from __future__ import annotations

from owtsweep.config.section import NotNegative, Positive, Section, key


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
