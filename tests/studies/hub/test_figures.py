"""Figures and terminal map: what they show is what the tables hold."""

from __future__ import annotations

import io
import itertools
import math
from functools import partial

import numpy as np
import pandas as pd
import pytest
from looks import LOOKS
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle
from rich.console import Console
from tools import configure

from experiments.ren2019 import published
from experiments.ren2019.figures import add_printed
from experiments.ren2019.histories import measure_histories
from experiments.ren2019.two_maps import Crossing, make_way
from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.figures import best_scheme_map, distributions, margin, style, terminal
from owtsweep.figures.drawings import draw_each
from owtsweep.figures.plane import Plane
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.cube import Cube
from owtsweep.results.summary import summarise
from owtsweep.studies import compose
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import StoredHubScheme
from owtsweep.studies.hub.figures import error_spectra, mse_over_amplitude
from owtsweep.studies.hub.figures.listing import drawings
from owtsweep.studies.hub.measures import CRITERIA
from owtsweep.studies.hub.worlds import CONDITIONS

SCHEMES = ["EKF", "MKF", "HME1", "HME2"]


def best_table(periods, amplitudes, *, criterion: str = "position") -> pd.DataFrame:
    """HME1 in the upper left, HME2 in the lower right, hatched where they meet."""
    rows = []
    for (i, period), (j, amplitude) in itertools.product(enumerate(periods), enumerate(amplitudes)):
        rows.append(
            {
                "natural_period": period,
                "amplitude": amplitude,
                "criterion": criterion,
                "window": "full",
                "best": "HME1" if j > i else "HME2",
                "runner_up": "HME2" if j > i else "HME1",
                "error_best": 0.04,
                "error_runner_up": 0.05,
                "verdict": "won" if abs(i - j) > 1 else "open",
            }
        )
    return pd.DataFrame(rows)


def bare() -> HubConfig:
    return configure(f"schemes=[{','.join(SCHEMES)}]", "baselines=[]", "measures.window=full")


def summary_table(period: float, amplitudes, *, relative_margin: float = 0.1) -> pd.DataFrame:
    rows = []
    for (rank, scheme), amplitude in itertools.product(enumerate(SCHEMES), amplitudes):
        for measure, factor in (("position", 1.0), ("velocity", 0.4)):
            mean = factor * (4e-3 + 1e-3 * rank + (4 - rank) * 2e-3 * amplitude**2)
            rows.append(
                {
                    "scheme": scheme,
                    "natural_period": period,
                    "amplitude": amplitude,
                    "measure": measure,
                    "window": "full",
                    "mean": mean,
                    "ci_low": mean * (1 - relative_margin),
                    "ci_high": mean * (1 + relative_margin),
                    "n": 20,
                }
            )
    return pd.DataFrame(rows)


def texts(figure) -> str:
    """All words of a figure, line breaks taken out."""
    found = figure.findobj(lambda artist: hasattr(artist, "get_text"))
    return " ".join(" ".join(artist.get_text() for artist in found).split())


def cells_of(figure, *, hatched: bool) -> dict[tuple[int, int], Rectangle]:
    patches = [p for p in figure.axes[0].patches if isinstance(p, Rectangle)]
    return {
        (round(p.get_x() + 0.5), round(p.get_y() + 0.5)): p
        for p in patches
        if bool(p.get_hatch()) == hatched
    }


@pytest.mark.parametrize(
    ("periods", "amplitudes"),
    [
        ([3.0, 4.0, 6.0, 8.0], [0.05, 0.2, 1.0, 2.0, 10.0]),
        ([3.8], [0.2]),
        ([3.0, 8.0], list(np.geomspace(0.05, 10, 30).round(3))),
    ],
)
def test_map_colours_and_hatches_every_cell_as_the_table_says(periods, amplitudes):
    table = best_table(periods, amplitudes).sample(frac=1.0, random_state=1)
    figure = best_scheme_map.draw(
        table,
        SCHEMES,
        CONDITIONS,
        criterion="position",
        window="full",
        tuning="paper",
        quantity="position MSE",
        records="20 records per cell",
    )
    colours, hatches = cells_of(figure, hatched=False), cells_of(figure, hatched=True)
    assert len(colours) == len(table)
    for row in table.to_dict("records"):
        place = periods.index(row["natural_period"]), amplitudes.index(row["amplitude"])
        expected = margin.fill_cell(LOOKS[row["best"]], 1.25)  # error_runner_up / error_best
        assert to_hex(colours[place].get_facecolor()) == expected.lower()
        assert (place in hatches) == (row["verdict"] == "open")
    shown = texts(figure)
    assert "+25 %" in shown
    assert margin.EXPLANATION in shown
    for part in ("position MSE", "full record", "tuning: paper", "20 records per cell", "Hatched"):
        assert part in shown
    axes = figure.axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == [f"{a:g}" for a in amplitudes]


def test_labels_of_a_map_lie_beside_the_line_that_crosses_it():
    """The line and its bars run through the middle of the columns; labels are at the left."""
    table, schemes = best_table([3.0, 4.0, 5.0], [0.2, 1.0, 10.0]), ["HME1", "HME2"]
    plane = Plane.of(table, CONDITIONS)
    heights = np.array([0.1, 1.0, 0.9])
    line = Crossing(np.arange(3.0), heights, heights - 0.1, np.array([0.2, 1.1, 1.8]))
    with style.context():
        figure = style.new_figure(6.0, 3.0)
        axes = figure.add_subplot()
        rows = table.to_dict("records")
        best_scheme_map.draw_cells(axes, rows, schemes, plane, labels="best")
        make_way(axes, line)
    figure.draw_without_rendering()
    moved = set()
    for text in axes.texts:
        box = text.get_window_extent().transformed(axes.transData.inverted())
        column, row = round(text.get_position()[0] + 0.2), round(text.get_position()[1])
        middle = np.linspace(box.x0, box.x1, 9)
        inside = np.interp(middle, line.columns, line.heights)
        assert not np.any((inside > box.y0) & (inside < box.y1)), (column, row)
        if box.x0 < column < box.x1:
            assert line.high[column] < box.y0 or line.low[column] > box.y1, (column, row)
        else:
            moved.add((column, row))
    assert moved == {(0, 0), (1, 1), (2, 1), (2, 2)}


def test_map_names_coinciding_schemes_together_and_explains_holes():
    table = best_table([3.0, 4.0], [0.2, 1.0]).iloc[:-1]
    table["verdict"] = "won"
    table.loc[0, "runner_up"] = "MKF"
    figure = best_scheme_map.draw(
        table,
        SCHEMES,
        CONDITIONS,
        criterion="position",
        window="full",
        tuning="matched",
        quantity="position MSE",
        coinciding=[("EKF", "MKF")],
    )
    shown = texts(figure)
    assert "EKF = MKF (0 cells)" in shown
    assert "EKF and MKF give the same numbers and are shown as MKF." in shown
    assert "no result" in shown
    assert "Hatched" not in shown
    assert not cells_of(figure, hatched=True)


@pytest.mark.parametrize("amplitudes", [[0.2, 1.0], np.geomspace(0.1, 1.0, 400)])
def test_map_tells_of_coinciding_schemes_only_where_it_names_them(amplitudes):
    """Neither on a map without them, nor on one without labels where they are second best."""
    table = best_table([3.0, 4.0], amplitudes)
    table["runner_up"] = "MKF" if len(amplitudes) > 300 else "HME1"
    figure = best_scheme_map.draw(
        table, SCHEMES, CONDITIONS, criterion="position", window="full", tuning="matched",
        quantity="position MSE", coinciding=[("EKF", "MKF")],
    )  # fmt: skip
    shown = texts(figure)
    assert "EKF (0 cells)" in shown
    assert "MKF (0 cells)" in shown
    assert "give the same numbers" not in shown
    assert "=" not in shown


def test_map_of_many_schemes_says_of_no_winner_that_it_is_best_nowhere():
    """KF_A, which equals the best, is not in the legend by itself."""
    names = [*(f"KF_{n}" for n in range(9)), "KF_A", "HME1", "HME2"]
    figure = best_scheme_map.draw(
        best_table([3.0, 4.0], [0.2, 1.0]), names, CONDITIONS, criterion="position", window="full",
        tuning="matched", quantity="position MSE", coinciding=[("KF_A", "HME1"), ("KF_0", "KF_1")],
    )  # fmt: skip
    shown = texts(figure)
    assert "KF_A = HME1" in shown
    assert f"Best in no cell: {', '.join(names[:9])}." in shown
    assert "KF_0 and KF_1" not in shown


def test_map_without_a_runner_up_names_the_best_alone():
    table = best_table([3.0], [0.2]).assign(runner_up="", error_runner_up=math.nan, verdict="open")
    figure = best_scheme_map.draw(
        table, ["HME2"], CONDITIONS, criterion="position", window="full", tuning="paper",
        quantity="position MSE",
    )  # fmt: skip
    assert [text.get_text() for text in figure.axes[0].texts] == ["HME2", "0.0400"]


def test_map_refuses_a_criterion_without_rows():
    with pytest.raises(InputError, match=r"^best: no cell judged by velocity"):
        best_scheme_map.draw(
            best_table([3.0], [0.2]),
            SCHEMES,
            CONDITIONS,
            criterion="velocity",
            window="full",
            tuning="paper",
            quantity="velocity MSE",
        )


def test_mse_figure_draws_the_means_and_the_published_points():
    amplitudes = [0.05, 0.2, 1.0, 10.0]
    table = summary_table(8.0, amplitudes).sample(frac=1.0, random_state=1)
    figure = add_printed(partial(mse_over_amplitude.draw, bare(), table, 8.0), SCHEMES, 8.0)
    print_ = published.mse_tables().query("natural_period == 8")
    panels = (("position", ["x", "y"]), ("velocity", ["vx", "vy"]))
    for axes, (measure, parts) in zip(figure.axes, panels, strict=True):
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
        lines = axes.get_lines()
        assert len(lines) == 2 * len(SCHEMES)
        count = len(SCHEMES)
        bands = [band for band in axes.collections if isinstance(band, PolyCollection)]
        bars = [bar for bar in axes.collections if isinstance(bar, LineCollection)]
        drawn = zip(SCHEMES, lines[:count], lines[count:], bands, bars, strict=True)
        for scheme, line, points, band, bar in drawn:
            own = table[(table["scheme"] == scheme) & (table["measure"] == measure)]
            own = own.sort_values("amplitude")
            assert line.get_xdata().tolist() == amplitudes
            assert line.get_ydata().tolist() == own["mean"].tolist()
            ends = {tuple(point) for point in band.get_paths()[0].vertices}
            for interval in ("ci_low", "ci_high"):  # the table's, whatever draws them
                assert set(zip(amplitudes, own[interval], strict=True)) <= ends
            assert sorted(tuple(end[:, 1]) for end in bar.get_segments()) == sorted(
                zip(own["ci_low"], own["ci_high"], strict=True)
            )
            assert (to_hex(line.get_color()), line.get_marker()) == (
                LOOKS[scheme].color.lower(), LOOKS[scheme].marker,
            )  # fmt: skip
            assert line.is_dashed() == (LOOKS[scheme].line != "-")
            chosen = print_[(print_["scheme"] == scheme) & print_["measure"].isin(parts)]
            expected = chosen.groupby("amplitude")["published"].sum()
            assert list(points.get_xdata()) == [0.2, 1.0]
            assert list(points.get_ydata()) == pytest.approx(expected.tolist())
            assert points.get_markerfacecolor() == "none"
    shown = texts(figure)
    for part in ("m²/s²", "natural period 8 s", "hollow: published (Tables 7, 8)", "misprint"):
        assert part in shown


def test_mse_figure_without_published_points_or_intervals():
    table = summary_table(5.0, [0.2]).assign(ci_low=math.nan, ci_high=math.nan, n=1)
    figure = add_printed(partial(mse_over_amplitude.draw, bare(), table, 5.0), SCHEMES, 5.0)
    shown = texts(figure)
    assert "published" not in shown
    assert "95 %" not in shown
    with pytest.raises(InputError, match=r"^natural_period: no result at 6 s .* this run has 5$"):
        mse_over_amplitude.draw(bare(), table, 6.0)


@pytest.mark.parametrize("relative_margin", [1.5, 1.0 - 1e-9])
def test_mse_figure_survives_intervals_that_reach_zero(tmp_path, relative_margin):
    table = summary_table(5.0, [0.2, 1.0], relative_margin=relative_margin)
    figure = mse_over_amplitude.draw(bare(), table, 5.0)
    style.save(figure, tmp_path, "wide")
    assert min(axes.get_ylim()[0] for axes in figure.axes) > 1e-5
    assert "cut at 0.1 of the mean" in texts(figure)


def run_rows(schemes, periods) -> pd.DataFrame:
    """The rows of a run whose EKF and MKF coincide, with one failed case."""
    rows = []
    for rank, scheme in enumerate(schemes):
        for period, replicate in itertools.product(periods, range(3)):
            for measure, window in itertools.product(("position", "velocity"), ("full", "settled")):
                level = max(rank, 1) * 1e-3 + replicate * 1e-5
                rows.append(
                    {
                        "natural_period": period,
                        "replicate": replicate,
                        "scheme": scheme,
                        "measure": measure,
                        "window": window,
                        "amplitude": math.nan,
                        "motion": level,
                        "cross": 0.0,
                        "noise": level,
                        "value": math.nan,
                        "status": "ok",
                    }
                )
    table = pd.DataFrame(rows)
    lost = (table["scheme"] == "HME2") & (table["replicate"] == 2)
    failed = table[lost].head(1).assign(status="failed", measure="", window="")
    return pd.concat([table[~lost], failed])


@pytest.fixture
def run(monkeypatch):
    """Arguments of `drawings` for a small run."""
    periods, amplitudes = [4.0, 5.0], [0.2, 1.0]
    rows = run_rows(SCHEMES, periods)
    words = [f"grid.natural_period={periods}", f"grid.amplitude={amplitudes}", "grid.replicates=3"]
    words += [f"schemes=[{','.join(SCHEMES)}]", "baselines=[]", "tuning=paper"]
    words += ["measures.window=full"]
    config = compose(words)
    # what is drawn from the configuration alone: tests/studies/hub/test_more_figures.py
    monkeypatch.setattr("owtsweep.studies.hub.figures.listing._illustrations", lambda *_: {})
    cube = Cube.of_rows(rows, SCHEMES, CONDITIONS, {"amplitude": amplitudes})
    tables = {
        "summary": summarise(cube),
        "best_scheme": find_best_schemes(cube, "full", CRITERIA),
    }
    return config, tables, rows


def test_everything_of_a_run_is_drawn(run, tmp_path):
    files = draw_each(drawings(*run, {"run": "3f2a"}), tmp_path, None)
    assert all(file.is_file() for file in files)
    assert {file.name for file in files} == {
        f"{stem}.{suffix}"
        for stem in (
            "figure_18_best_scheme",
            "best_scheme_velocity",
            "figure_15_mse_4s",
            "mse_5s",
        )
        for suffix in ("png", "svg")
    }


def test_errors_of_single_records_are_drawn_if_there_are_several(run, tmp_path, monkeypatch):
    assert "distributions" not in drawings(*run)
    monkeypatch.setattr(distributions, "LEAST_RECORDS", 3)
    shown = []
    monkeypatch.setattr(
        style, "save", lambda figure, *_: shown.append(texts(figure)) or [tmp_path / "x.png"]
    )
    draw_each(drawings(*run), tmp_path, "distributions")
    for part in ("position MSE", "full record", "tuning: paper", "natural period 4 s, amplitude"):
        assert part in shown[0]
    config, tables, rows = run
    northwards = changed(config, measures=changed(config.measures, criterion="x"))
    along_x = rows[rows["measure"] == "position"].assign(measure="x")
    draw_each(drawings(northwards, tables, pd.concat([rows, along_x])), tmp_path, "distributions")
    assert "position MSE, x (m²)" in shown[1]


def test_one_figure_is_drawn_by_name(run, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(
        style, "save", lambda figure, *_: drawn.append(texts(figure)) or [tmp_path / "x.png"]
    )
    assert draw_each(drawings(*run), tmp_path, "figure_18_best_scheme") == [tmp_path / "x.png"]
    assert "EKF = MKF (4 cells)" in drawn[0]
    assert "up to 3 records per cell" in drawn[0]
    assert "1 case failed" in drawn[0]
    with pytest.raises(InputError, match=r"^only: this run has no figure 'map'; use figure_18_"):
        draw_each(drawings(*run), tmp_path, "map")


def rendered(renderable) -> str:
    console = Console(width=80, file=io.StringIO(), color_system=None)
    console.print(renderable)
    return console.file.getvalue()


def test_terminal_map_reads_without_colours():
    table = best_table([3.0, 8.0], [0.05, 1.0, 10.0])
    lines = rendered(terminal.grid(table, SCHEMES, CONDITIONS, "position", "full")).splitlines()
    body = [line.split() for line in lines if " m " in line]
    assert body == [
        ["10", "m", "HME1", "HME1", "~"],
        ["1", "m", "HME1", "~", "HME2", "~"],
        ["0.05", "m", "HME2", "~", "HME2", "~"],
    ]
    assert any("3 s" in line and "8 s" in line for line in lines)
    assert any("HME1 3, HME2 3; ~ open: the data" in line for line in lines)


def test_terminal_map_of_many_periods_and_of_missing_cells():
    periods = list(np.arange(3.0, 8.01, 0.25))
    table = best_table(periods, [0.2, 1.0]).iloc[1:]
    text = rendered(terminal.grid(table, SCHEMES, CONDITIONS, "position", "full"))
    assert all(f"{period:g} s" in text for period in periods)
    assert max(map(len, text.splitlines())) <= 80
    assert " - " in text
    nothing = rendered(terminal.grid(table, SCHEMES, CONDITIONS, "velocity", "full"))
    assert "No cell to compare" in nothing


def test_what_would_run_the_authors_code_is_left_out_and_told():
    described = {"name": "HME1", "linear": True, "batched": "chain", "simplicity": 99}
    theirs = StoredHubScheme({"_target_": "theirs.HME1"}, described)
    config = changed(configure(tuning="matched"), schemes=["MKF", "HME2", theirs])
    shown = error_spectra.compute(config, points=5)
    assert list(shown) == ["MKF", "HME2"]
    (told,) = error_spectra.unsettled(config, shown)
    assert told == "matched: no curve (code of the run's author is not run) for HME1."
    assert measure_histories(config) is None
