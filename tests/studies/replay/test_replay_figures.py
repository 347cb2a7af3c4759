"""What the figures of a replay show: the record's place with its intervals, the advised scheme."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from owtsweep.figures import style, time_histories
from owtsweep.studies.replay.figures import histories, place
from owtsweep.studies.replay.figures.traces import Traces
from owtsweep.studies.replay.place import compute_rms_error

NAMES = ["MKF", "HME1", "HME2"]


def test_the_rms_of_records_scatters_as_its_error_says():
    """Records of a flat spectrum are sums of lines of exponentially distributed power."""
    config, record = SimpleNamespace(fit_band=(0.1, 0.5)), {"duration": 100.0}
    flat = SimpleNamespace(density=np.ones_like)
    lines = 40  # of width 1 / duration in the band
    power = np.random.default_rng(1).exponential(size=(4000, lines)).mean(axis=1)
    expected = np.std(np.sqrt(power)) / np.mean(np.sqrt(power))
    assert compute_rms_error(config, record, flat) == pytest.approx(expected, rel=0.05)


def test_the_star_has_bars_and_the_map_keeps_its_limits():
    with style.context():
        figure = style.new_figure(4.0, 3.0)
        axes = figure.add_subplot()
        axes.set(xlim=(3.0, 8.0), ylim=(0.05, 10.0), yscale="log")
        place._mark(axes, (4.0, 0.2), (0.3, np.log(1.5)))
    assert (axes.get_xlim(), axes.get_ylim()) == ((3.0, 8.0), (0.05, 10.0))
    across, upwards = (bars.get_segments()[0] for bars in axes.collections[-2:])
    assert across[:, 0] == pytest.approx([3.7, 4.3])
    assert upwards[:, 1] == pytest.approx([0.2 / 1.5, 0.2 * 1.5])


def make_traces(size: float) -> Traces:
    time = np.arange(0.0, 10.0, 0.1)
    line = [(time, np.where(time < 1.0, size, 0.5))]
    errors = dict.fromkeys(NAMES, line)
    pairs = dict.fromkeys(NAMES, (line, line))
    return Traces((0.0, 10.0), pairs, errors)


def test_the_advised_scheme_is_on_top_and_what_is_cut_is_told():
    session = SimpleNamespace(names=NAMES, advised="HME1")
    traces = make_traces(size=3.0)
    values = histories._make_values_panel(session, "position", 0, traces)
    errors = histories._make_errors_panel(session, "position", traces)
    for panel in (values, errors):
        heights = [mark.look["zorder"] for mark in panel.marks if hasattr(mark, "look")]
        assert heights == [2.5, time_histories.ON_TOP, 2.5]
    assert errors.note == "not shown: errors beyond ±0.6 m at the start"
    inside = histories._make_errors_panel(session, "position", make_traces(size=0.55))
    assert inside.note == ""
