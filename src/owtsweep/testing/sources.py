"""Checks that a source of motion, e.g. a user's, keeps the contract in `owtsweep.motion.source`.

    from owtsweep.testing import check_source

    def test_my_source():
        check_source(MySource(), steps=1000, step=0.02)

If the source breaks the contract, the check raises `AssertionError`. Its message is one line that
names the broken part.
"""

from __future__ import annotations

import numpy as np

from owtsweep.motion.source import Motion, Source
from owtsweep.streams import Streams

#: Largest allowed difference between a derivative (e.g. velocity) and the slope of its series (e.g.
#: position), relative to the derivative's largest value.
TOLERANCE = 0.05
#: Share of a record that is left out at each end: a file's motion beyond its ends is not known.
EDGE = 0.1


def check_source(
    source: Source, *, steps: int, step: float, history: int = 10, tolerance: float = TOLERANCE
) -> None:
    """Run all checks on a source of motion.

    Raise `AssertionError` if a check fails. The message is one line that names the source and the
    broken part of the contract.

    source: an object that follows the protocol `owtsweep.motion.source.Source`.
    steps, step, history: the arguments of `Source.realise` for a record that the source can give.
        The step must be short compared with the periods of the motion, and `history` at least 1.
    tolerance: Largest allowed difference between velocity and the slope of position, relative to
        the largest velocity; also between acceleration and the slope of velocity, relative to the
        largest acceleration.

    >>> import numpy as np
    >>> from owtsweep.motion.source import Motion
    >>> class Sway:
    ...     streams = ("phase",)
    ...     duration = None
    ...     def realise(self, stream, *, steps, step, history=0):
    ...         phase = stream("phase").uniform(0.0, 2.0 * np.pi)
    ...         angle = 1.5 * step * np.arange(-history, steps) + phase
    ...         motion = np.sin(angle), 1.5 * np.cos(angle), -2.25 * np.sin(angle)
    ...         return Motion(step, *(each[history:] for each in motion), motion[0][:history])
    >>> check_source(Sway(), steps=1000, step=0.02)
    """
    name = type(source).__name__
    lacks = {"streams", "duration", "realise"} - {*dir(source)}
    assert not lacks, f"{name}: needs `streams`, `duration` and `realise`"
    motion = source.realise(_streams(0), steps=steps, step=step, history=history)
    length = (steps + history) * step
    assert source.duration is None or source.duration >= length - step * (1 + 1e-9), (
        f"{name}: gives {length:g} s with its history, but its duration is {source.duration:g} s"
    )
    _check_shapes(name, motion, steps, step, history)
    check_streams(source, steps=steps, step=step, history=history)
    check_derivatives(name, motion, tolerance)
    check_delayed_positions(name, motion)


def check_streams(source: Source, *, steps: int, step: float, history: int) -> None:
    """Check that a source draws only from the random streams that it names.

    Raise `AssertionError` if the streams that the source uses are not exactly those in
    `source.streams`, or if equal streams give motions that differ in any bit, or different streams
    give equal motions.
    """
    name = type(source).__name__
    drawn: set[str] = set()

    def listen(stream: str) -> np.random.Generator:
        drawn.add(stream)
        return _streams(0)(stream)

    first, again, other = (
        source.realise(streams, steps=steps, step=step, history=history)
        for streams in (listen, _streams(0), _streams(1))
    )
    assert drawn == set(source.streams), (
        f"{name}: draws from {sorted(drawn)}, but `streams` names {sorted(source.streams)}"
    )
    assert _is_same(first, again), f"{name}: the same streams give another motion"
    if source.streams:
        assert not _is_same(first, other), f"{name}: other streams give the same motion"
    else:
        assert _is_same(first, other), f"{name}: names no stream, but its realisations differ"


def check_derivatives(name: str, motion: Motion, tolerance: float = TOLERANCE) -> None:
    """Check that velocity is the slope of position, and acceleration the slope of velocity.

    A slope is a central difference of a series. For a motion of the angular frequency omega
    (rad/s), the slope's relative error is about (omega step)^2 / 6. `tolerance` is relative to the
    largest velocity or acceleration. Raise `AssertionError` if velocity or acceleration differs
    from the slope by more than allowed.
    """
    steps = len(motion.position)
    inner = slice(1 + int(EDGE * steps), steps - 1 - int(EDGE * steps))
    for series, derivative in (("position", "velocity"), ("velocity", "acceleration")):
        expected = getattr(motion, derivative)[inner]
        slope = np.gradient(getattr(motion, series), motion.step, axis=0)[inner]
        largest = float(np.max(np.abs(expected), initial=0.0))
        apart = float(np.max(np.abs(slope - expected), initial=0.0))
        assert apart <= tolerance * largest, (
            f"{name}: {derivative} differs from the slope of the {series} by {apart:.3g}, more "
            f"than {tolerance:g} of its largest value {largest:.3g}"
        )


def check_delayed_positions(name: str, motion: Motion) -> None:
    """Check that the positions before t = 0 lead into the record without a jump.

    A delayed sensor reports positions from before t = 0 at the beginning of the record. Raise
    `AssertionError` if the positions jump before or at t = 0, or if `motion.position_at` does not
    return the positions before t = 0 followed by those of the record.
    """
    history, steps = len(motion.before), len(motion.position)
    whole = np.concatenate([motion.before, motion.position])
    speed = np.max(np.abs(motion.velocity), initial=0.0)
    jump = np.max(np.abs(np.diff(whole[: history + 2], axis=0)), initial=0.0)
    assert jump <= 2.0 * motion.step * speed, (
        f"{name}: positions before t = 0 jump by {jump:.3g} in a step; at the record's largest "
        f"speed they move by {motion.step * speed:.3g}"
    )
    for stride in (1, 3):
        count = -(-(history + steps) // stride)
        assert np.array_equal(motion.position_at(-history, stride, count), whole[::stride]), (
            f"{name}: position_at({-history}, {stride}, {count}) is not the history and the record"
        )


def _check_shapes(name: str, motion: Motion, steps: int, step: float, history: int) -> None:
    """Raise `AssertionError` if a series has another length than requested, or other axes."""
    assert motion.step == step, f"{name}: the step is {motion.step:g} s, not {step:g} s"
    axes = motion.position.shape[1:]
    lengths = {"position": steps, "velocity": steps, "acceleration": steps, "before": history}
    for series, length in lengths.items():
        shape = getattr(motion, series).shape
        assert shape == (length, *axes), (
            f"{name}: {series} has the shape {shape}, not {(length, *axes)}"
        )


def _is_same(one: Motion, other: Motion) -> bool:
    names = ("position", "velocity", "acceleration", "before")
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)


def _streams(replicate: int) -> Streams:
    """Return a function from a stream's name to a new generator, equal for equal names."""
    return lambda name: np.random.default_rng([replicate, *name.encode()])
