"""Schemes for the floater study as users write them, some broken; tests name them by `_target_`."""

import sys

import numpy as np

from owtsweep.schemes import Unable, blade, floater, tower


class Held(floater.Scheme):
    """The last report, at rest: what CONTRIBUTING.md shows."""

    name = "HELD"

    def prepare(self, known):
        """Nothing is computed beforehand."""
        return self

    def run(self, measured):
        """Hold each report until the next one."""
        lost = np.isnan(measured.position).any(axis=1)
        last = np.maximum.accumulate(np.where(lost, 0, np.arange(len(lost))))
        held = np.nan_to_num(measured.position[last])
        return floater.Estimates(held, np.zeros_like(held))


class Plain(Held):
    """It says how simple it is: as LOWPASS."""

    name = "PLAIN"
    simplicity = 18


class Falls(tower.Scheme):
    """A scheme for the tower that divides by zero."""

    name = "FALLS"

    def prepare(self, known):
        """Nothing is computed beforehand."""
        return self

    def run(self, measured):
        """Fail."""
        return 1 / 0


class Other(blade.Scheme):
    """A scheme of another study."""

    name = "OTHER"

    def prepare(self, known):
        """Nothing is computed beforehand."""
        return self


class Taken(Held):
    """It has the name of one of ours."""

    name = "KF"


class Nameless(Held):
    """It lacks a name."""

    name = ""


class Exits(Held):
    """It calls sys.exit()."""

    name = "EXITS"

    def run(self, measured):
        """End the process."""
        sys.exit(3)


class Short(Held):
    """It leaves out the last sample."""

    name = "SHORT"

    def run(self, measured):
        """Return too little."""
        whole = super().run(measured)
        return floater.Estimates(whole.position[:-1], whole.velocity[:-1])


class Nan(Held):
    """Its estimates are not finite."""

    name = "NAN"

    def run(self, measured):
        """Return NaN."""
        nothing = np.full((len(measured.position), 6), np.nan)
        return floater.Estimates(nothing, nothing)


class Refuses(Held):
    """It is unable."""

    name = "REFUSES"

    def prepare(self, known):
        """Refuse."""
        raise Unable("no reports on Sundays")


class Forgetful(Held):
    """It changes what it is given."""

    name = "FORGETFUL"

    def run(self, measured):
        """Overwrite the reports."""
        whole = super().run(measured)
        measured.position[:] = 0.0
        return whole
