"""The tower study as a sweep: contract, command line, refusals."""

from __future__ import annotations

from pathlib import Path

import pytest

from owtsweep.studies import compose, get_study
from owtsweep.testing import check_study

STRUCTURE = Path(__file__).with_name("small.yaml")
#: A small structure, a short record, quick schemes, two cells.
TINY = [
    "study=tower", f"structure={STRUCTURE}", "record.duration=20", "record.rate=20",
    "record.settling=10", "truth.subdivision=1", "grid.noise=[1]", "grid.soil_factor=[0.5,1]",
    "grid.replicates=1", "sensors.inclinometers=[0,20,80,110]", "sensors.accelerometers=[50,110]",
    "schemes=[MDE,QUASI_STATIC]", "compute.backend=threading", "compute.workers=1",
]  # fmt: skip


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_study_keeps_the_contract() -> None:
    check_study(get_study("tower"), compose(TINY))
