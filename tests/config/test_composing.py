"""In this suite, Hydra joins each choice of files once: what is composed must be the same."""

from __future__ import annotations

import pytest

from owtsweep.config import composition
from owtsweep.config.stored import dump
from owtsweep.errors import InputError
from owtsweep.studies import compose


@pytest.mark.parametrize(
    "words",
    [
        ["grid.replicates=3", "tuning=paper", "record.duration=50", "tuning=matched"],
        ["tuning=[paper,matched]", "mkf.q_a=2.0", "name=b c", "results='~/x'"],
        ["skf.states=8", "motion.envelope=[[0,1],[9,2]]", "experiment=paper", "seed=1", "seed=2"],
        ["motion=plant", "structure=ren2019", "sensors.imu.tilt=structure", "baselines=[]"],
        ["study=tower", "schemes=[{_target_: a.B, c: {d: 1}}]", "grid.snr=[1e2]"],
        ["study=floater", "sensors={yaw: 3}"],
        ["hme.mhe.constraints={bias: 0.5}", "hme.mhe.constraints={position: 2}"],
        ["hme.mhe.horizon=null"],
        ["sensors.imu.rat=5"],
        ["+seed=5"],
        ["~seed"],
        ["seed=1,2"],
        ["tuning=none"],
        ["seed=[1"],
        ["name=${seed}"],
        ["name=${nothing}"],
        ["tuning@here=paper"],
        ["grid={natural_period: [4]}", "grid.amplitude=[2]"],
        ["tuning={mkf: {q_a: 1}}"],
    ],
)
def test_words_are_composed_as_by_hydra_alone(
    words: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def tell() -> str:
        try:
            return dump(compose(words))
        except InputError as error:
            return str(error)

    here = tell()
    monkeypatch.setattr(composition, "compose_hydra", composition.compose_hydra.__wrapped__)  # type: ignore[attr-defined]
    assert tell() == here
