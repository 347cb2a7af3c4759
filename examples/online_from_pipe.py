"""Estimate the hub's motion while its sensors report, line by line from a pipe.

    sensor_logger | python examples/online_from_pipe.py HME1 tuning=matched > estimates.csv

Input: one line per IMU sample: time, fx, fy (m/s^2 in the IMU's frame). With a fix, x and y follow
(m, in NED, e.g. north and east of a map); without one, nothing or two empty fields. Times are
numbers in s or ISO 8601 (2026-03-01T12:00:00.05Z); all of them have one form.

Output: one line for each, at once: the time as it came; x, y, vx, vy, in the coordinates of the
fixes; and their standard deviations. Until the first fix the estimates are nan, their deviations
inf. The schemes start from zero about this fix, or about the point that the word origin=X,Y states.

Rates, delay, yaw and tuning are overrides. Empty lines and lines that start with # or with the word
time (in capitals or quotes, too) are skipped. Any other bad line ends the program with one line
that names it and exit code 2.
"""

import math
import sys
from collections.abc import Iterator
from datetime import UTC, datetime

import owtsweep

HEADER = "time,x,y,vx,vy,sd_x,sd_y,sd_vx,sd_vy"
Sample = tuple[float, list[float], list[float] | None]


def main(arguments: list[str]) -> int:
    scheme = arguments[0] if arguments else "HME1"
    origins = [word for word in arguments[1:] if word.startswith("origin=")]
    overrides = [word for word in arguments[1:] if word not in origins]
    origin = origins[-1].removeprefix("origin=").strip("()[]").split(",") if origins else None
    try:
        estimator = owtsweep.online(scheme, overrides, origin=origin)
    except owtsweep.InputError as error:
        print(f"online_from_pipe: {error}", file=sys.stderr)
        return 2
    print(HEADER, flush=True)
    previous = None
    for number, text in enumerate(sys.stdin, start=1):
        line = text.removeprefix("\ufeff")  # byte order mark
        if not line.strip() or is_comment(line):
            continue
        try:
            time, force, fix = parse(line)
            late = 0.0 if previous is None else time - previous - estimator.step
            if abs(late) > 0.5 * estimator.step:
                raise ValueError(
                    f"time: {time:.13g} s is not one IMU step of {estimator.step:g} s after "
                    f"{previous:.13g} s"
                )
            estimate = estimator.update(force, fix)
        except (ValueError, ArithmeticError) as error:
            print(f"online_from_pipe: line {number}: {error}", file=sys.stderr)
            return 2
        previous = time
        deviations = [math.sqrt(estimate.covariance[i, i]) for i in range(4)]
        # 12 digits: 10 micrometres at the 6 million metres of a map
        position = [f"{value:.12g}" for value in estimate.position]
        others = [f"{value:.6g}" for value in (*estimate.velocity, *deviations)]
        print(line.split(",")[0].strip(), *position, *others, sep=",", flush=True)
    return 0


def is_comment(line: str) -> bool:
    """Say whether the line is a comment or a header, which begins with the name of the time."""
    return line.lstrip(" \t\"'").lower().startswith(("#", "time"))


def parse(line: str) -> Sample:
    """Time (s), force and fix (or None) of a line.

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
    time = read_time(fields[0])
    values = list(read_numbers(fields[1:]))
    return time, values[:2], values[2:] or None


def read_time(field: str) -> float:
    """The time in s, of a number or of a date and time; one without a zone is in UTC."""
    if ":" not in field:
        return next(read_numbers([field]))
    try:
        moment = datetime.fromisoformat(field)
    except ValueError:
        raise ValueError(f"{field!r} is no date and time of ISO 8601") from None
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


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
    sys.stdin.reconfigure(errors="replace")  # a byte that is no UTF-8 makes its own line bad
    try:
        sys.exit(main(sys.argv[1:]))
    except (BrokenPipeError, KeyboardInterrupt):  # nobody reads the output, or the user stops it
        sys.stderr.close()
        sys.exit(130)
