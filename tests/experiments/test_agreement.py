"""What `make reproduce` says of results/reference: equal, nearly equal, other."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from looks import LOOKS
from matplotlib.colors import to_rgb
from PIL import Image

from experiments import keeping, reproduce
from experiments.agreement import compare_folders, compare_numbers
from experiments.keeping import copy_small
from owtsweep.figures import style
from owtsweep.figures.palette import mix_with_white
from owtsweep.studies import compose
from owtsweep.studies.hub.figures.listing import TIME_HISTORIES
from owtsweep.studies.hub.histories import choose_sea

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "results" / "reference" / "default"


@pytest.fixture
def made(tmp_path) -> Path:
    return Path(shutil.copytree(KEPT, tmp_path / "made"))


def test_a_copy_agrees(made):
    (made / "manifest.json").write_text("{}")  # another day, another machine
    assert compare_folders(made, KEPT) == {}


@pytest.mark.parametrize(("factor", "agrees"), [(1.0 + 1e-9, True), (1.001, False)])
def test_numbers_agree_to_a_tolerance(made, factor, agrees):
    table = made / "best_scheme.csv"
    lines = table.read_text().splitlines()
    cells = lines[1].split(",")
    place = next(i for i, cell in enumerate(cells) if "." in cell and "e-0" not in cell and i > 5)
    cells[place] = repr(float(cells[place]) * factor)
    table.write_text("\n".join([lines[0], ",".join(cells), *lines[2:]]) + "\n")
    assert (compare_folders(made, KEPT) == {}) == agrees


def test_what_differs_is_named(made):
    table = made / "best_scheme.csv"
    table.write_text(table.read_text().replace("HME2", "MKF", 1))
    (made / "fidelity.csv").unlink()
    (made / "more.md").write_text("text")
    shutil.copy(KEPT.parent / "two_maps.png", made / "figure_18_best_scheme.png")
    config = made / "config.yaml"
    config.write_text(config.read_text().replace("seed: 2019", "seed: 7"))
    differences = compare_folders(made, KEPT)
    assert set(differences) == {
        "best_scheme.csv", "fidelity.csv", "more.md", "figure_18_best_scheme.png", "config.yaml",
    }  # fmt: skip
    assert "MKF instead of HME2" in differences["best_scheme.csv"]


def test_a_part_that_was_never_kept_is_new(made, tmp_path):
    assert set(compare_folders(made, tmp_path / "none").values()) == {"is new"}


@pytest.mark.parametrize(("number", "agrees"), [("0", True), ("", False), ("nan", False)])
def test_a_zero_agrees_with_zero_alone(made, number, agrees):
    table = made / "zero.csv"
    kept = Path(shutil.copytree(made, made.parent / "kept"))
    (kept / "zero.csv").write_text("a\n0.0\n")
    table.write_text(f"a\n{number}\n")
    assert (compare_folders(made, kept) == {}) == agrees
    assert (compare_folders(kept, made) == {}) == agrees


def test_a_shorter_table_differs(made):
    table = made / "best_scheme.csv"
    table.write_text("\n".join(table.read_text().splitlines()[:-1]) + "\n")
    assert "best_scheme.csv" in compare_folders(made, KEPT)


def test_the_pictures_of_a_kept_report_stand_beside_it(tmp_path):
    report = tmp_path / "report.md"
    square = "0.3 m\N{SUPERSCRIPT TWO}"
    report.write_text(f"![one](figures/one.png) [two](other/two.csv) {square}", "utf-8")
    copy_small(report, tmp_path / "kept.md")
    kept = (tmp_path / "kept.md").read_text("utf-8")
    assert kept == f"![one](one.png) [two](other/two.csv) {square}"


def test_a_kept_picture_has_its_colours(tmp_path):
    """Small swatches beside many shades of one colour: median cut makes some of them equal."""
    with style.context():
        figure = style.new_figure(6.0, 4.0)
        axes = figure.add_subplot()
        shades = [mix_with_white(LOOKS["HME1"].color, share) for share in np.linspace(0.3, 1, 60)]
        axes.bar(range(60), 1.0, 1.0, color=shades)
        for number, (name, look) in enumerate(LOOKS.items()):
            axes.bar(6 * number + 2, 0.05, 1.5, 1.1, color=look.color)
            axes.text(6 * number, 1.2, name, color=look.color)
        axes.plot([0, 59], [0.0, 1.0], color="black")
        png, _ = style.save(figure, tmp_path, "drawn")
    copy_small(png, tmp_path / "kept.png")
    drawn, kept = (
        np.asarray(Image.open(path).convert("RGB"), dtype=float)
        for path in (png, tmp_path / "kept.png")
    )
    flat = {tuple(round(255 * part) for part in to_rgb(look.color)) for look in LOOKS.values()}
    for colour in flat:
        there = (drawn == colour).all(axis=2)
        assert there.sum() > 100
        assert (kept[there] == colour).all()
    assert np.linalg.norm(drawn - kept, axis=2).max() < 30.0  # of 442 from black to white
    assert (tmp_path / "kept.png").stat().st_size < 0.6 * png.stat().st_size


@pytest.mark.parametrize("copies", [False, True])
def test_what_differs_is_listed_and_copied_if_asked(copies, monkeypatch, tmp_path):
    monkeypatch.setattr(keeping, "REFERENCE", tmp_path / "reference")
    kept, made = tmp_path / "reference" / "mating", tmp_path / "results" / "mating"
    for folder, number in ((kept, "1.0"), (made, "2.0")):
        folder.mkdir(parents=True)
        (folder / "summary_a.csv").write_text(f"mean\n{number}\n")
        (folder / "summary_b.csv").write_text("mean\n3.0\n")
    keeper = keeping.Keeper(tmp_path / "results", copies=copies)
    keeper.keep("mating")
    assert keeper.differing == ["mating/summary_a.csv"]
    assert (kept / "summary_a.csv").read_text() == f"mean\n{'2.0' if copies else '1.0'}\n"


def test_figures_9_to_14_are_kept_in_the_sea_of_their_captions(monkeypatch, tmp_path):
    """The run of the plant has the sea, `make reproduce` copies the figures, the docs show them."""
    (sweep,) = (
        step for step in reproduce.PARTS["plant"]["steps"] if step.startswith("sweep plant_seas")
    )
    overrides = [*sweep.split()[3:], "tuning=paper"]  # after the number of records
    sea = choose_sea(compose(overrides))
    assert (sea["hs"], sea["tp"]) == (2.0, 6.0)
    page = (ROOT / "docs" / "research" / "plant.md").read_text("utf-8")
    for name in TIME_HISTORIES:
        picture = f"results/reference/plant/{name}.png"
        assert (ROOT / picture).is_file()
        assert f"](../../{picture})" in page
    drawn = [f"{name}_{tuning}" for name in TIME_HISTORIES for tuning in ("paper", "matched")]
    files = [f"figures/{name}.png" for name in (*drawn, "figure_03_record", "figure_04_spectrum")]
    files += [f"fidelity/{tuning}/fidelity_claims.csv" for tuning in ("paper", "matched")]
    (tmp_path / "plant").mkdir()
    for file in files:
        (tmp_path / "plant_seas" / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "plant_seas" / file).write_text(file)
    keeper = SimpleNamespace(keep=lambda *_: None, keep_file=lambda *_: None)
    for verb in ("sweep", "command", "script"):  # nothing runs
        monkeypatch.setattr(reproduce.Reproduction, verb, lambda *_: None)
    reproduce.Reproduction(tmp_path, 1, keeper).make("plant")
    for name in TIME_HISTORIES:
        assert (tmp_path / "plant" / f"{name}.png").read_text() == f"figures/{name}_paper.png"


def test_the_steps_of_make_reproduce_are_there():
    """Each script that a step runs is a file, and each part that is kept has a folder."""
    for name, part in reproduce.PARTS.items():
        for verb, *words in map(str.split, part.get("steps", ())):
            assert verb in ("sweep", "figures", "report", "copy", "script")
            if verb == "script":
                path = ROOT.joinpath("experiments", *words[0].split("."))
                assert path.with_suffix(".py").is_file() or (path / "__main__.py").is_file()
        assert "keep" not in part or (keeping.REFERENCE / name).is_dir()


def test_stars_of_copies_stand_for_the_same(tmp_path):
    for name in ("one", "two"):
        (tmp_path / f"map_{name}.png").write_text(name)
    whole = reproduce.Reproduction(tmp_path, 1, SimpleNamespace())
    whole.copy("map_*.png", "kept_*_paper.png")
    assert (tmp_path / "kept_one_paper.png").read_text() == "one"
    assert (tmp_path / "kept_two_paper.png").read_text() == "two"
    with pytest.raises(SystemExit, match="nothing of this name"):
        whole.copy("chart.png", "kept.png")


BEST = "best,runner_up,mse_best,mse_runner_up,difference,ci_low,ci_high\n"


@pytest.mark.parametrize(
    ("line", "agrees"),
    [
        ("MKF,EKF,1.0,2.0,1.0,0.5,1.5", True),
        ("MKF,EKF,1.0000000001,2.0,1.0,0.5,1.5", True),
        ("MKF,EKF,1.00000001,2.0,1.0,0.5,1.5", False),
        ("MKF,EKF,1.0,2.0,1.0,0.5,1.500000001", True),  # 1e-9 of 2, the larger error
        ("MKF,EKF,1.0,2.0,1.0,0.5,1.50000001", False),
        ("EKF,MKF,1.0,2.0,1.0,0.5,1.5", False),
        ("MKF,EKF,1.0,2.0,1.0,0.5,nan", False),
    ],
)
def test_numbers_alone(tmp_path, line, agrees):
    for name, text in (("kept", "MKF,EKF,1.0,2.0,1.0,0.5,1.5"), ("made", line)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "best.csv").write_text(f"{BEST}{text}\n")
        (tmp_path / name / "report.md").write_text(name)
    found = compare_numbers(tmp_path / "made", tmp_path / "kept")
    assert (found == {}) == agrees


def test_a_winner_by_nothing_may_be_the_other(tmp_path):
    for name, line in (("kept", "A,B,1.0,1.0,1e-12,0,0"), ("made", "B,A,1.0,1.0,-1e-12,0,0")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "best.csv").write_text(f"{BEST}{line}\n")
    assert compare_numbers(tmp_path / "made", tmp_path / "kept") == {}


def test_numbers_of_a_folder_of_results_are_compared_with_its_rows(tmp_path):
    import pandas as pd

    made, kept = tmp_path / "made", tmp_path / "kept"
    for folder in (made, kept):
        (folder / "paper" / "fidelity").mkdir(parents=True)
        (folder / "paper" / "fidelity" / "consistency.csv").write_text("nees\n1.0\n")
        (folder / "paper" / "summary.csv").write_text("scheme,mean\nMKF,1.0\n")
        (folder / "paper" / "cases").mkdir()
    rows = pd.DataFrame({"scheme": ["A", "A", "B"], "replicate": [0, 1, 0], "value": [1.0, 2, 3]})
    rows.to_parquet(kept / "paper" / "cases" / "part-1.parquet")
    rows.iloc[::-1].to_parquet(made / "paper" / "cases" / "part-2.parquet")
    keeper = keeping.NumbersKeeper(made, kept)
    keeper.keep("paper")
    keeper.keep_rows("paper")
    assert keeper.differing == []
    rows.assign(value=[1.0, 2.1, 3]).to_parquet(made / "paper" / "cases" / "part-2.parquet")
    (made / "paper" / "fidelity" / "consistency.csv").write_text("nees\n1.1\n")
    keeper.keep("paper")
    keeper.keep_rows("paper")
    assert keeper.differing == ["paper/consistency.csv", "rows of paper/cases"]


def test_kept_files_of_results_have_the_numbers_of_themselves():
    keeper = keeping.NumbersKeeper(KEPT.parent, KEPT.parent)
    for name in keeping.KEPT:
        keeper.keep(name)
    assert keeper.differing == []
