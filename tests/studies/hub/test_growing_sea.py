"""`motion.envelope`: a sea that grows and falls, in the records of the study."""

from __future__ import annotations

import numpy as np
import pytest
from tools import configure, plan_blocks

from owtsweep.errors import InputError
from owtsweep.motion.departing import Modulation
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.registry import get_study

GROWS = "motion.envelope=[[0,0.1],[15,10],[30,0.1]]"


def test_records_grow_and_fall_and_sensors_feel_it() -> None:
    steady, growing = (make_records(configure(*words), 4.0, [0]) for words in ((), (GROWS,)))
    before, after = steady.motion[0], growing.motion[0]
    time = steady.sensors.step * np.arange(steady.steps)
    factor = Modulation([[0, 0.1], [15, 10], [30, 0.1]]).factor(time)
    np.testing.assert_allclose(after.position, factor * before.position, rtol=1e-12)
    # v^2 of a fast oscillation is the envelope's square times the old one's, nearly
    assert np.var(after.velocity) > 20 * np.var(before.velocity)
    for ours, theirs in zip(growing.noise[0], steady.noise[0], strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_an_envelope_names_the_blocks() -> None:
    assert plan_blocks(configure())[0].content["envelope"] is None
    assert plan_blocks(configure(GROWS))[0].content["envelope"] == [[0, 0.1], [15, 10], [30, 0.1]]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("motion.envelope=[[0,1],[9,0]]",), "motion.envelope: the factor 0 at 9 s is not above"),
        ((GROWS, "engine=expected"), "motion.envelope: engine=expected needs motion of one steady"),
    ],
)
def test_an_envelope_that_cannot_be_is_refused(words: tuple[str, ...], told: str) -> None:
    with pytest.raises(InputError) as error:
        configure(*words)
    assert str(error.value).startswith(told)
    assert "\n" not in str(error.value)


def test_commands_that_need_a_steady_sea_say_so() -> None:
    with pytest.raises(InputError, match=r"motion\.envelope: `tune` needs motion of one steady"):
        get_study("hub").count_trials(configure(GROWS))
