"""Every source of motion keeps the protocol."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from owtsweep.motion.departing import ModulatedSource, Modulation
from owtsweep.motion.source import Motion, Source, SpectralSource, translated
from owtsweep.testing import check_source

SPECTRAL = SpectralSource(translated(4.0), (0.05, 0.6))
MODULATED = ModulatedSource(SPECTRAL, Modulation([[0.0, 1.0], [50.0, 2.0]]))
SOURCES = [pytest.param(SPECTRAL, id="spectrum"), pytest.param(MODULATED, id="modulated")]


def streams(replicate: int):
    def stream(name: str) -> np.random.Generator:
        return np.random.default_rng([replicate, *name.encode()])

    return stream


@pytest.mark.parametrize("source", SOURCES)
def test_a_source_keeps_the_contract(source: Source) -> None:
    check_source(source, steps=1000, step=0.05)


@dataclass(frozen=True)
class Faulty:
    """A source whose motion is changed, or drawn from a stream that it does not name."""

    change: Callable[[Motion], dict[str, Any]]
    streams: tuple[str, ...] = ("phase",)
    duration: float | None = None

    def realise(self, stream, *, steps: int, step: float, history: int = 0) -> Motion:
        motion = SPECTRAL.realise(stream, steps=steps, step=step, history=history)
        return replace(motion, **self.change(motion))


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (Faulty(lambda m: {"velocity": 1.1 * m.velocity}), "velocity differs from the slope"),
        (Faulty(lambda m: {"acceleration": -m.acceleration}), "acceleration differs"),
        (Faulty(lambda m: {"before": m.before + 1.0}), "positions before t = 0 jump"),
        (Faulty(lambda m: {"before": m.before[1:]}), r"before has the shape \(9,\), not \(10,\)"),
        (Faulty(lambda m: {"step": 1.0}), "the step is 1 s"),
        (Faulty(lambda m: {}, streams=()), "draws from .'phase'., but `streams` names"),
        (Faulty(lambda m: {}, duration=5.0), "its duration is 5 s"),
        (
            Faulty(lambda m: {"position": m.position + 1e-9 * np.random.default_rng().random()}),
            "the same streams give another motion",
        ),
        (object(), "object: needs `streams`"),
    ],
)
def test_a_broken_contract_is_told(source: Any, message: str) -> None:
    with pytest.raises(AssertionError, match=message):
        check_source(source, steps=1000, step=0.05)


@pytest.mark.parametrize("source", SOURCES)
def test_a_source_keeps_the_protocol(source: Source) -> None:
    steps, step, history = 500, 0.05, 7
    realise = partial(source.realise, steps=steps, step=step, history=history)
    asked: list[str] = []

    def listening(name: str) -> np.random.Generator:
        asked.append(name)
        return streams(0)(name)

    motion = realise(listening)
    assert sorted(asked) == sorted(source.streams)
    again, other = realise(streams(0)), realise(streams(1))
    for name in ("position", "velocity", "acceleration"):
        series = getattr(motion, name)
        assert len(series) == steps
        np.testing.assert_array_equal(series, getattr(again, name))
        assert np.array_equal(series, getattr(other, name)) == (not source.streams)
    # history and record are one motion, and derivatives are its own
    assert len(motion.before) == history
    whole = np.concatenate([motion.before, motion.position])
    slope = (whole[history + 1 :] - whole[history - 1 : -2]) / (2 * step)
    np.testing.assert_allclose(slope, motion.velocity[:-1], atol=0.02)
    bend = np.diff(whole, 2, axis=0)[history - 1 :] / step**2
    inner = slice(40, -40)
    np.testing.assert_allclose(bend[inner], motion.acceleration[:-1][inner], atol=0.1)
    np.testing.assert_array_equal(motion.position_at(-history, 3, 100), whole[: 3 * 100 : 3])


def test_a_spectrum_gives_records_of_any_length() -> None:
    assert SPECTRAL.duration is None
