"""Finds what a sensor set-up sees of the substructure and its loads; refuses blind set-ups.

The model is that of the scheme AKF: the substructure between the cuts, whose loads are random
walks. It is one and the same for both directions.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.observability import Observability
from owtsweep.studies.base.schemes import Unable, identify
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS, INPUTS, Channel, Kind, Setting
from owtsweep.studies.tower.measuring import list_places
from owtsweep.studies.tower.models import model_cut
from owtsweep.studies.tower.schemes import SCHEMES
from owtsweep.studies.tower.schemes.filtered import observe, tell_blindness
from owtsweep.studies.tower.setting import make_setting, model_substructure

#: Noise by which a set-up is judged before there is a record, in SI units. Only orders of magnitude
#: matter for what is seen.
NOMINAL: dict[Kind, float] = {"x": 1e-3, "theta": 1e-5, "a": 1e-3, "strain": 1e-6}
#: Least part of an unseen direction that names a state or a load.
NAMED = 0.05
SHIFT, LEAN = "rigid translation", "rigid rotation"
#: Set-ups that were found to be no blind ones.
_passed: set[Hashable] = set()


def require_sight(config: TowerConfig) -> None:
    """Refuse a set-up at which every scheme of the run is blind or unstable.

    Raise `InputError` if no scheme can work; the message names loads that are unseen, and sensors
    that would do.
    """
    parts = config.structure, config.sensors, config.filters, config.model, config.schemes
    setup = identify((config.heights, config.record.rate, *parts))
    if setup not in _passed:
        _require_sight(config)
        _passed.add(setup)


def _require_sight(config: TowerConfig) -> None:
    setting = set_up(config)
    if not tell_blindness(setting, model_cut(setting)):
        return
    reasons = []
    # The last schemes of the list are the quickest to prepare.
    for scheme in reversed(SCHEMES.resolve_all(config.schemes)):
        try:
            scheme.prepare(setting)
        except Unable as reason:
            reasons.append(str(reason))
        else:
            return
    loads = [name for name in INPUTS if name in find_missed(setting, observe(model_cut(setting)))]
    text = f"it does not tell {', '.join(loads)} apart" if loads else reasons[-1]
    raise InputError(
        f"sensors: no scheme can work with the set-up {config.sensors.name}: {text}; "
        f"{_advise(setting, config.structure.mudline)}"
    )


def set_up(config: TowerConfig) -> Setting:
    """Return the setting fore-aft with nominal noise."""
    part, places = model_substructure(config), list_places(config.sensors, config.nodes)
    channels = [Channel(place.kind, place.node, NOMINAL[place.kind]) for place in places]
    return make_setting(config, part, DIRECTIONS[0], 1.0, channels, None)


def _name_states(setting: Setting) -> list[str]:
    numbers: dict[str, int] = {}
    coordinates = []
    for kind in setting.reduced.kinds:
        numbers[kind] = numbers.get(kind, 0) + 1
        rigid = (SHIFT, LEAN)[numbers[kind] - 1] if kind == "rigid" else ""
        coordinates.append(rigid or f"{kind} mode {numbers[kind]}")
    return [*coordinates, *(f"rate of {name}" for name in coordinates), *INPUTS]


def find_missed(setting: Setting, seen: Observability) -> set[str]:
    """Return the names of states and loads that have a part in what is unseen."""
    parts = [np.abs(found.directions).max(axis=1) for found in seen.unseen]
    names = _name_states(setting)
    return {name for part in parts for name, size in zip(names, part, strict=True) if size > NAMED}


def _count_unseen(setting: Setting) -> int:
    seen = observe(model_cut(setting))
    return seen.states - seen.rank


def _advise(setting: Setting, ground: float) -> str:
    heights = setting.cut.heights
    chosen: list[int] = []
    while tell_blindness(setting, model_cut(setting)):
        unseen = _count_unseen(setting)
        taken = [each.node for each in setting.channels if each.kind in ("theta", "x")]
        for node in _order_by_distance(heights, taken):
            further = Channel("theta", node, NOMINAL["theta"])
            added = replace(setting, channels=(*setting.channels, further))
            if _count_unseen(added) < unseen:
                setting = added
                chosen.append(node)
                break
        else:
            return "add inclinometers and accelerometers at more heights"
    *others, last = (f"{heights[node] - ground:g}" for node in sorted(chosen))
    if not others:
        return f"add an inclinometer at {last} m"
    return f"add inclinometers at {', '.join(others)} and {last} m"


def _order_by_distance(heights: Array, taken: Sequence[int]) -> list[int]:
    """Return the nodes that are not taken, the one farthest from those taken first."""
    free = [node for node in range(len(heights)) if node not in taken]
    if not taken:
        return free[::-1]
    return sorted(free, key=lambda n: np.abs(heights[list(taken)] - heights[n]).min(), reverse=True)
