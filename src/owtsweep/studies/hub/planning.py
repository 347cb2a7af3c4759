"""Plans blocks, the units of work of the hub study, and says what each block's numbers depend on.

A block holds the cases of one scheme under one combination of conditions, e.g. at one natural
period, for up to eight replicates.
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import attrgetter

from owtsweep.config import Plain, Section, as_mapping
from owtsweep.studies.base.schemes import Entry
from owtsweep.studies.hub.conditions import find_world, list_record_conditions
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.names import list_entries
from owtsweep.studies.hub.resolving import SCHEMES, resolve_all
from owtsweep.studies.hub.sizes import REPLICATES_PER_BLOCK
from owtsweep.sweep.study import Block


def plan(config: HubConfig) -> list[Block]:
    """Return the blocks (units of work) of a configuration.

    There is one block per natural period, set of up to eight replicates, and scheme. A block covers
    all amplitudes if the scheme runs motion and noise separately (evaluation=superposed and a
    linear scheme that is not told the amplitude). Otherwise there is one block per amplitude. With
    motion=plant, there is one block per combination of the plant's conditions, set of replicates
    and scheme; its amplitude is 1, the motion as it is.
    """
    shared = shared_content(config)
    entries = list_entries(config)
    schemes = resolve_all(entries, config)
    # Made once per scheme: blocks share these parts, so that a large plan fits into memory.
    by_scheme = [
        ({**shared, **scheme_content(config, entry, scheme)}, SCHEMES.explain_anew(scheme))
        for entry, scheme in zip(entries, schemes, strict=True)
    ]
    world = find_world(config)
    expands = any(condition.expands for condition in world.conditions)
    blocks = []
    for conditions in list_record_conditions(config):
        name = world.describe_record(conditions)
        for first in range(0, config.grid.replicates, REPLICATES_PER_BLOCK):
            last = min(first + REPLICATES_PER_BLOCK, config.grid.replicates)
            replicates = list(range(first, last))
            numbers = f"replicates {first}-{last - 1}" if last - first > 1 else f"replicate {first}"
            group = f"{name}, {numbers}"
            for (part, anew), scheme in zip(by_scheme, schemes, strict=True):
                for amplitude in (
                    [None] if superposes(config, scheme) else world.list_amplitudes(config)
                ):
                    content = {**part, **conditions, "replicates": replicates}
                    label, shares = f"{scheme.name}, {group}", group
                    if scheme.told_motion:
                        # its gains, the same for all records of a cell, take longer than a motion
                        shares = f"{scheme.name}, {name}, {amplitude:g} m"
                    if amplitude is not None:
                        content["amplitude"] = float(amplitude)
                        label += f", {amplitude:g} m" if expands else ""
                    per_row = len(config.grid.amplitude) if amplitude is None else 1
                    cases = len(replicates) * per_row
                    blocks.append(Block(shares, label, content, cases, per_row, anew))
    return blocks


def _amplitudes(config: HubConfig, scheme: Scheme) -> Sequence[float | None]:
    """Return the amplitudes at which a scheme is run; None stands for all of them at once."""
    return [None] if superposes(config, scheme) else find_world(config).list_amplitudes(config)


def superposes(config: HubConfig, scheme: Scheme) -> bool:
    """Return whether the scheme runs once for all amplitudes, motion and noise apart.

    A scheme that is told the amplitude does not, for it has other gains at each; nor does a scheme
    with a kernel of its own.
    """
    alone = scheme.told_motion or scheme.batched == "own"
    return config.evaluation == "superposed" and scheme.linear and not alone


def shared_content(config: HubConfig) -> Plain:
    """Return the settings on which the numbers of every block (unit of work) depend.

    The values of the grid and the tuning of the schemes are not among them.
    """
    whole = as_mapping(config)
    content = {key: whole[key] for key in ("seed", "engine", "record", "wave_direction", "sensors")}
    content |= find_world(config).list_content(config)
    content["settling_time"] = config.measures.settling_time
    content["extremes"] = config.measures.extremes
    return content


def scheme_content(config: HubConfig, entry: Entry, scheme: Scheme) -> Plain:
    """Return what a scheme's rows depend on: the scheme's name, its tuning, and a user's code.

    The tuning consists of the sections of the configuration that the scheme's attribute `sections`
    names. For a user's scheme, the result also contains its entry and what identifies the code.

    Parameters
    ----------
    entry
        The scheme's entry in the key `schemes`: a name, or a mapping for a user's scheme.
    scheme
        The scheme that the entry stands for.

    Raises
    ------
    InputError
        If the scheme is a user's scheme of a stored run, whose code is not loaded.
    """
    tuning = {section: _plain(attrgetter(section)(config)) for section in scheme.sections}
    code = SCHEMES.describe_code(entry, scheme)
    return {"scheme": scheme.name, "tuning": tuning, **code}


def _plain(section: object) -> object:
    return as_mapping(section) if isinstance(section, Section) else section
