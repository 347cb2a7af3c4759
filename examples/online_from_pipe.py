"""Estimate the hub's motion while its sensors report, line by line from a pipe.

    sensor_logger | python examples/online_from_pipe.py HME1 tuning=matched > estimates.csv

Input: one line per IMU sample: time, fx, fy (s; m/s^2 in the IMU's frame). With a fix, x and y
follow (m, in NED); without one, nothing or two empty fields. Output: one line for each, at once:
time, x, y, vx, vy and their standard deviations. Rates, delay, yaw and tuning are overrides. Lines
that start with # or with "time" are skipped. Any other bad line ends the program with one line that
names it and exit code 2.
"""

import math
import sys
from collections.abc import Iterator

import owtsweep

HEADER = "time,x,y,vx,vy,sd_x,sd_y,sd_vx,sd_vy"
Sample = tuple[float, list[float], list[float] | None]


def main(arguments: list[str]) -> int:
    scheme = arguments[0] if arguments else "HME1"
    try:
        estimator = owtsweep.online(scheme, arguments[1:])
    except owtsweep.InputError as error:
        print(f"online_from_pipe: {error}", file=sys.stderr)
        return 2
    print(HEADER, flush=True)
    previous = None
    for number, line in enumerate(sys.stdin, start=1):
        if not line.strip() or line.startswith(("#", "time")):
            continue
        try:
            time, force, fix = parse(line)
            if (
                previous is not None
                and abs(time - previous - estimator.step) > 0.5 * estimator.step
            ):
                raise ValueError(
                    f"time: {time:g} s is not one IMU step of {estimator.step:g} s after "
                    f"{previous:g} s"
                )
            estimate = estimator.update(force, fix)
        except (ValueError, ArithmeticError) as error:
            print(f"online_from_pipe: line {number}: {error}", file=sys.stderr)
            return 2
        previous = time
        deviations = [math.sqrt(estimate.covariance[i, i]) for i in range(4)]
        numbers = (*estimate.position, *estimate.velocity, *deviations)
        print(f"{time:.10g}", *(f"{value:.6g}" for value in numbers), sep=",", flush=True)
    return 0


def parse(line: str) -> Sample:
    """Time, force and fix (or None) of a line.

    Raises
    ------
    ValueError
        If the number of fields is not three or five, or a field is not a finite number.
    """
    fields = [field.strip() for field in line.split(",")]
    while len(fields) > 3 and not fields[-1]:
        fields.pop()
    if len(fields) not in (3, 5):
        raise ValueError(f"{len(fields)} fields; give time,fx,fy or time,fx,fy,x,y")
    values = list(read_numbers(fields))
    return values[0], values[1:3], values[3:] or None


def read_numbers(fields: list[str]) -> Iterator[float]:
    """The fields as finite numbers."""
    for field in fields:
        try:
            value = float(field)
        except ValueError:
            raise ValueError(f"{field!r} is not a number") from None
        if not math.isfinite(value):
            raise ValueError(f"{field!r} is not finite")
        yield value


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (BrokenPipeError, KeyboardInterrupt):  # nobody reads the output, or the user stops it
        sys.stderr.close()
        sys.exit(130)
