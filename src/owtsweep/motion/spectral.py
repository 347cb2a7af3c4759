"""A spectrum as a source of motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from owtsweep.motion.source import Motion
from owtsweep.motion.spectra import Spectrum
from owtsweep.motion.synthesis import synthesise


@dataclass(frozen=True)
class SpectralSource:
    """Random-phase realisations of a spectrum, along one direction and of any length.

    Attributes
    ----------
    spectrum
        Shape of the spectrum.
    band
        Lower and upper edge of the lines that are drawn, Hz.
    normalise
        "peak" or "rms": the property of the displacement that is 1 m (`synthesis.synthesise`).
    """

    spectrum: Spectrum
    band: tuple[float, float]
    normalise: str = "peak"
    streams: ClassVar[tuple[str, ...]] = ("phase",)
    duration: ClassVar[None] = None

    def realise(
        self,
        stream: Callable[[str], np.random.Generator],
        *,
        steps: int,
        step: float,
        history: int = 0,
    ) -> Motion:
        """Draw one record."""
        return synthesise(
            self.spectrum,
            stream("phase"),
            steps=steps,
            step=step,
            band=self.band,
            normalise=self.normalise,
            history=history,
        )
