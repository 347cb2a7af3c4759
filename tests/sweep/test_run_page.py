"""A run's page, its picture in a notebook, and its values as a dataset."""

from __future__ import annotations

import base64
import json
import shutil
import struct

import numpy as np
import pytest
from pages import read_data, run_script

import owtsweep
from owtsweep.cli import main
from owtsweep.errors import InputError
from owtsweep.report.gallery_page import make_gallery
from owtsweep.results.criteria import Criterion
from owtsweep.sweep.asked import DETAILS
from owtsweep.sweep.page import pack
from owtsweep.sweep.run import sweep

SMALL = [
    "grid.natural_period=[4.0]", "grid.amplitude=[0.05,0.5]", "grid.most=8", "record.duration=40",
    "sensors.imu.rate=20", "measures.settling_time=5", "compute.workers=1",
    "compute.backend=threading",
]  # fmt: skip


@pytest.fixture(scope="module")
def made(tmp_path_factory, kernels):
    """The folder of a run of the hub."""
    return owtsweep.run([*SMALL, f"results={tmp_path_factory.mktemp('made')}"]).folder


@pytest.fixture
def hub_run(made, tmp_path):
    """A copy of this run, to write into."""
    return owtsweep.load(shutil.copytree(made, tmp_path / "results" / made.name))


def test_a_run_without_a_map_has_its_text_and_its_tables(study, config):
    run = sweep(study, config()).run
    page = run.write_report().read_text(encoding="utf-8")
    assert "Table summary.csv" in page
    assert 'id="data"' not in page
    assert run._repr_html_().startswith("<pre>")
    with pytest.raises(InputError, match=r"dataset: the rows of the study dummy are no map"):
        run.dataset()
    with pytest.raises(InputError, match=r"--details: a run of the study dummy has no map"):
        run.keep_details()


def test_what_is_missing_or_has_failed_is_told(faulty, config, tmp_path):
    run = sweep(faulty(**{"A1.0": "case", "B2.0": "raise"}), config()).run
    page = run.write_report(tmp_path / "page.html").read_text(encoding="utf-8")
    assert "1 blocks of the plan are missing" in page
    assert "Rows without a number" in page
    assert "it diverged" in page


def test_the_page_of_a_hub_run_agrees_with_its_table_and_names_no_folder(hub_run, tmp_path):
    path = hub_run.write_report()
    assert path == hub_run.folder / "report.html"
    page = path.read_text(encoding="utf-8")
    assert str(tmp_path) not in page
    assert hub_run.config.results not in page
    assert "<dt>MKF</dt><dd>multirate Kalman filter on the undelayed IMU</dd>" in page
    assert "<dt>NONE</dt><dd>no estimator: zero position, zero velocity</dd>" in page
    assert "Sensors: GNSS 0.03 m, 1 Hz, 0.2 s late; IMU 0.15 m/s²" in page
    best = hub_run.best_scheme()
    best = best[best["criterion"] == "position"]
    code = """
        return listMapCells(part, [0, 0]).map(({at}) => judgeCell(part,
          {criterion: "position", window: "settled", records: Infinity}, at));
    """
    found = {cell["row"]["at"][1]: cell for cell in run_script(read_data(page), code)}
    for place, row in enumerate(best.to_dict("records")):
        cell = found[place]
        assert (cell["best"], cell["next"]) == (row["best"], row["runner_up"])
        assert (cell["verdict"], cell["error"]) == (row["verdict"], row["error_best"])
    shown = hub_run._repr_html_()
    assert '<svg class="map"' in shown
    assert 'report.html">' in shown


def test_details_are_the_estimates_of_record_0(hub_run):
    hub_run.keep_details()
    kept = json.loads((hub_run.folder / DETAILS).read_text(encoding="utf-8"))[""]
    first, last = kept["cells"]
    assert (first["at"], last["at"]) == ([0, 0], [0, 1])
    overrides = [word for word in SMALL if "amplitude" not in word]
    record = owtsweep.estimate([*overrides, "grid.amplitude=[0.5]"], 0)
    step = record.time[1] - record.time[0]
    every = round(last["step"] / step)
    start = round(last["start"] / step)
    for name, scale, text in last["series"]:
        numbers = np.frombuffer(base64.b64decode(text), "<i2")
        truth = record.truth["position"][start::every, 0]
        wanted = record.estimates[name]["position"][start::every, 0] - truth if name else truth
        np.testing.assert_allclose(scale * numbers, wanted[: len(numbers)], atol=scale)
    assert {line[0] for line in kept["spectra"]} == {"EKF", "MKF", "HME1", "HME2"}
    page = hub_run.write_report().read_text(encoding="utf-8")
    code = "return findStretch(part, [0, 1], null).errors.length"
    assert run_script(read_data(page), code) == len(record.estimates)


@pytest.mark.parametrize(
    "text",
    ["[]", "{", '{"": {"label": 3}}', '{"": {"label": "x", "cells": [NaN], "spectra": []}}',
     '{"": {"label": "x", "cells": [{"at": [0], "start": Infinity}], "spectra": []}}'],
)  # fmt: skip
def test_details_of_a_stranger_are_refused_in_one_line(hub_run, text, capsys):
    (hub_run.place / DETAILS).write_text(text, encoding="utf-8")
    assert main(["report", str(hub_run.folder)]) == 2
    assert "this holds no details of a run; delete it" in capsys.readouterr().err


def test_details_begin_in_the_middle_of_the_judged_part(tmp_path, kernels):
    words = ["record.duration=125", "schemes=[MKF]", "grid.replicates=1"]
    run = owtsweep.run([*SMALL, *words, f"results={tmp_path / 'results'}"])
    run.keep_details()
    kept = json.loads((run.folder / DETAILS).read_text(encoding="utf-8"))[""]
    assert {cell["start"] for cell in kept["cells"]} == {65.0}  # of 5 to 125 s


def test_a_damaged_series_is_left_out(hub_run):
    cell = {"at": [0, 0], "start": 0.0, "step": 0.1, "series": [["", 1.0, "A"], ["MKF", 1.0, "??"]]}
    kept = {"": {"label": "x", "cells": [cell], "spectra": []}}
    (hub_run.place / DETAILS).write_text(json.dumps(kept), encoding="utf-8")
    page = hub_run.write_report().read_text(encoding="utf-8")
    code = "return findStretch(part, [0, 0], null).errors[0].points"
    assert run_script(read_data(page), code) == []


def test_numbers_of_16_bits_keep_zero_and_the_largest():
    name, scale, text = pack("A", np.array([0.0, -2.0, 1.0]))
    assert name == "A"
    assert struct.unpack("<3h", base64.b64decode(text)) == (0, -32767, 16384)
    assert scale == pytest.approx(2.0 / 32767)
    assert pack("A", np.zeros(2))[1] == 1.0


def test_a_dataset_has_named_dimensions_units_and_where_it_comes_from(hub_run, tmp_path):
    xarray = pytest.importorskip("xarray")
    found = hub_run.dataset()
    assert found["position"].dims == (
        "scheme", "natural_period", "amplitude", "window", "replicate"
    )  # fmt: skip
    assert found["amplitude"].attrs == {"long_name": "motion amplitude", "units": "m"}
    assert found["position"].attrs["error_unit"] == "m"
    assert found.attrs["study"] == "hub"
    assert "duration: 40" in found.attrs["config"]
    best = hub_run.best_scheme().query("criterion == 'position'").iloc[0]
    of_best = found["position"].sel(
        scheme=best["best"], amplitude=best["amplitude"], window="settled", natural_period=4.0
    )  # fmt: skip
    error = Criterion("", "square", "m", 0.0, "").express(float(of_best[: best["n"]].mean()))
    assert error == pytest.approx(best["error_best"])
    file = tmp_path / "run.nc"
    found.to_netcdf(file, engine="h5netcdf")
    with xarray.open_dataset(file, engine="h5netcdf") as again:
        xarray.testing.assert_identical(again.load(), found)


def test_the_index_of_figures_has_a_sentence_for_each(tmp_path):
    from matplotlib.figure import Figure

    from owtsweep.figures import style

    figure = Figure()
    figure.subplots().set_title("Errors <over> time\nof record 0")
    png, _ = style.save(figure, tmp_path, "errors")
    page = make_gallery("figures", [png])
    assert "Errors &lt;over&gt; time; of record 0" in page
    assert 'href="errors.png"' in page
    assert 'href="errors.svg"' in page


def test_the_command_writes_where_it_is_told(hub_run, tmp_path, capsys):
    target = tmp_path / "page.html"
    assert main(["report", str(hub_run.folder), "--output", str(target)]) == 0
    assert str(target) in capsys.readouterr().out
    assert target.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert main(["report", str(hub_run.folder), "--output", str(tmp_path)]) == 2
    assert "--output: " in capsys.readouterr().err


def test_a_multirun_and_its_comparison_have_pages(tmp_path, kernels, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = [*SMALL, "grid.replicates=8", "sensors.gnss.delay=0.1,0.3"]
    assert main(["sweep", "--multirun", *words]) == 0
    (folder,) = tmp_path.glob("results/multirun-*")
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count('/report.html">default-') == 2
    assert "sensors.gnss.delay" in page
    assert "of 2 cells (" in page
    assert main(["compare", str(folder)]) == 0
    compared = (folder / "comparison" / "report.html").read_text(encoding="utf-8")
    assert compared.count('src="data:image/png;base64,') >= 1
    assert "Table best_schemes.csv" in compared
