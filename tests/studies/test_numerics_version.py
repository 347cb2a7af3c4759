"""A study's numerics_version: its own base and the versions of the rooms that it uses."""

from __future__ import annotations

from types import ModuleType

import pytest

from owtsweep import motion
from owtsweep.studies import get_study
from owtsweep.studies.hub import kernels
from owtsweep.studies.hub.study import ROOMS
from owtsweep.sweep.study import add_versions


@pytest.mark.parametrize(
    ("name", "version"),
    [
        ("hub", 11),
        ("replay", 14),
        ("tower", 5),
        ("floater", 3),
        ("blade", 2),
        ("mating", 14),
    ],
)
def test_our_studies_stand_where_their_rooms_do(name: str, version: int) -> None:
    """Raised with a room, by a line in CHANGELOG.md under "Changed numbers"."""
    assert get_study(name).numerics_version == version


def test_a_room_raises_every_study_that_uses_it(monkeypatch: pytest.MonkeyPatch) -> None:
    rooms: tuple[ModuleType, ...] = ROOMS
    assert {motion, kernels} <= set(rooms)
    before = add_versions(1, *rooms)
    monkeypatch.setattr(motion, "NUMERICS_VERSION", motion.NUMERICS_VERSION + 1)
    assert add_versions(1, *rooms) == before + 1
