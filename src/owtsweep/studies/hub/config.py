"""The configuration of the hub-motion study: its keys, types, bounds and meanings.

Units are SI, but angles (wave direction) are in degrees. The sections are in `sections` and
`scheme_sections`.
"""

from __future__ import annotations

import re
from typing import ClassVar, Literal

from owtsweep.config import Config, Finite, Positive, key, require
from owtsweep.config.tuned import ABSENT, TunedConfig
from owtsweep.structures import Structure
from owtsweep.studies.base.schemes import SchemeEntries
from owtsweep.studies.hub.scheme_sections import FilterTuning, Hme, Skf, Switch, Tuning
from owtsweep.studies.hub.sections import (
    Grid,
    Measures,
    MotionConfig,
    Record,
    SensorConfig,
    SpectrumConfig,
    Tune,
)

#: In a run of several tunings, these sections stand in `tunings.<name>`, not at the top.
TUNED = tuple(Tuning.model_fields)


class HubConfig(TunedConfig):
    """The configuration of the hub-motion study, with all its keys.

    With several tunings, `tuning` is the list of their names, `tunings` holds their sections, and
    the sections `ekf` to `hme` are absent. `by_tuning` gives the configuration of each.
    """

    inert: ClassVar[frozenset[str]] = Config.inert | {
        "tuning", "tune", "baselines", "measures.window", "measures.criterion",
        "measures.efficiency",
    }  # fmt: skip
    tuned: ClassVar[tuple[str, ...]] = TUNED
    swept: ClassVar[tuple[str, ...]] = (
        "motion.hs", "motion.tp", "motion.blades", "motion.friction_angle",
    )  # fmt: skip
    from_files: ClassVar[tuple[str, ...]] = ("structure",)

    engine: Literal["batch", "reference", "expected"] = key(
        "batch: compiled; reference: the algorithms as written, slow; expected: the mean over all "
        "records, without one",
        default="batch",
    )
    evaluation: Literal["superposed", "direct"] = key(
        "superposed: linear schemes run once for all amplitudes; direct: each amplitude is run"
    )
    grid: Grid = key("the axes of the sweep")
    record: Record = key("a record of motion and measurements")
    motion: MotionConfig = key("where the motion comes from", default=MotionConfig())
    structure: Structure | None = key(
        "the structure that moves; with motion=plant only", default=None
    )
    spectrum: SpectrumConfig = key("the spectrum of the motion")
    normalise: Literal["peak", "rms"] = key(
        "what is 1 m before the amplitude is applied: the largest displacement or its standard "
        "deviation"
    )
    band: list[Positive] = key(
        "edges of the synthesised motion",
        unit="Hz",
        form="two edges in Hz, e.g. band=[0.05,0.6]",
        min_length=2,
        max_length=2,
    )
    wave_direction: Finite = key("of the motion, from north towards east", unit="deg")
    sensors: SensorConfig = key("GNSS and IMU")
    tuning: str | list[str] = key(
        "name of the file that sets the keys of the schemes, or a list of names, whose tunings run "
        "on the same records"
    )
    tunings: dict[str, Tuning] = key(
        "name: the sections ekf, mkf, hme1, hme2, hme of this tuning; only with several tunings",
        default={},
    )
    schemes: SchemeEntries = key(
        "names, or {_target_: package.Class, ...} for a scheme of your own"
    )
    baselines: list[Literal["NONE", "HOLD", "DELTA"]] = key(
        "shown beside the schemes: no estimator, the last fix, the last two fixes extrapolated; "
        "[]: none",
        default=[],
    )
    ekf: FilterTuning = key("the filter of EKF", default=ABSENT)
    mkf: FilterTuning = key("the filter of MKF", default=ABSENT)
    hme1: FilterTuning = key("the filter of HME1", default=ABSENT)
    hme2: FilterTuning = key("the filter of HME2", default=ABSENT)
    hme: Hme = key("smoother of HME1 and HME2, MHE of HME2", default=ABSENT)
    skf: Skf = key(
        "SKF and SKFA, which know the spectrum of the motion, or track it; on request, "
        "schemes=[...,SKF,SKFA]",
        default=Skf(),
    )
    switch: Switch = key("the scheme SWITCH", default=Switch())
    measures: Measures = key("what is measured, and what the map judges")
    tune: Tune = key("what the command `tune` searches", default=Tune())

    def check(self) -> None:
        """Check also that each tuning has a name that can be part of a file's name.

        Raises
        ------
        InputError
            If not; also as `TunedConfig.check`.
        """
        super().check()
        for name in self.tunings:
            require(
                re.fullmatch(r"[\w.+=-]+", name) is not None,
                f"tuning: {name!r} cannot be part of a file's name; use letters, digits, . _ - + =",
            )
