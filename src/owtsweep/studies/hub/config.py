"""The configuration of the hub-motion study: its keys, types, bounds and meanings.

Units are SI, but angles (wave direction) are in degrees. The sections are in `sections`.
"""

from __future__ import annotations

import re
from typing import Any, ClassVar, Literal

from owtsweep.config import Config, Finite, Positive, key, require
from owtsweep.config.tuned import ABSENT, TunedConfig
from owtsweep.structures import Structure
from owtsweep.studies.hub.sections import (
    FilterTuning,
    Grid,
    Hme,
    Measures,
    MotionConfig,
    Record,
    SensorConfig,
    SpectrumConfig,
    Tuning,
)
from owtsweep.studies.hub.skf_section import Skf
from owtsweep.studies.hub.switching.section import Switch
from owtsweep.studies.hub.tuning.settings import Tune

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
    schemes: list[Any] = key("names, or {_target_: package.Class, ...} for a scheme of your own")
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

    @classmethod
    def complete(cls, plain: dict[str, Any]) -> dict[str, Any]:
        """Return the keys with numbers in place of `auto`, from the sensors by rule."""
        from owtsweep.studies.hub.tilt import warn_of_growth
        from owtsweep.studies.hub.tuning.rules import fill_in

        warn_of_growth(plain)
        return fill_in(plain)

    def describe_origin(self) -> str:
        """Return in a line the tuning, the truth, and the number of records with their seed."""
        from owtsweep.studies.hub.origin import describe_origin

        return f"Tuning {self.tuning_name}. {' '.join(describe_origin(self).split())}"

    def describe_code(self) -> Any:
        """Return what a run stores of its schemes: a list with one mapping per scheme.

        Each mapping holds the scheme's name, whether the scheme is linear, and whether it has a
        kernel.
        """
        from owtsweep.studies.hub.schemes import resolve_all
        from owtsweep.studies.hub.schemes.stored import describe

        one = next(iter(self.by_tuning().values()))
        return describe(resolve_all(self.schemes, one))

    @classmethod
    def hide_code(cls, plain: dict[str, Any], described: Any) -> dict[str, Any]:
        """Return the keys of a stored run with a stand-in for each user's scheme.

        So the code of these schemes need not be imported. `plain` maps the keys to their values;
        `described` is what `describe_code` returned when the run was stored.
        """
        from owtsweep.studies.hub.schemes.stored import stand_in

        return {**plain, "schemes": stand_in(plain.get("schemes"), described)}

    def check(self) -> None:
        """Check that the values can work together.

        Raises
        ------
        InputError
            If two values cannot work together; the message says what would work.
        """
        super().check()
        from owtsweep.studies.hub.checks import check

        self._check_tunings()
        for config in self.by_tuning().values():
            check(config)

    def _check_tunings(self) -> None:
        """Check that each tuning has its sections, and a name that can be part of a file's name."""
        self.check_tuning()
        for name in self.tunings:
            require(
                re.fullmatch(r"[\w.+=-]+", name) is not None,
                f"tuning: {name!r} cannot be part of a file's name; use letters, digits, . _ - + =",
            )
