"""The README's example is the one that the tests run, and the files it names exist."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd

from owtsweep.studies import compose

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_example_scheme_is_the_tested_one():
    (example,) = re.findall(r"```python\n(import numpy.*?)```", README, flags=re.DOTALL)
    tested = (ROOT / "tests/studies/hub/hold_last_fix.py").read_text(encoding="utf-8")
    _, _, code = tested.split('"""', 2)
    assert example.strip() == code.strip()


def test_each_extra_that_is_named_is_declared_and_tested():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
        "optional-dependencies"
    ]
    files = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "src").rglob("*.py")]
    text = " ".join(file.read_text("utf-8") for file in files)
    named = set(re.findall(r"owtsweep\[(\w+)\]", text))
    assert "launchers" in named
    assert named <= set(extras)
    assert all(set(extras[name]) <= set(extras["test"]) for name in named - {"test", "bench"})


def test_the_readings_name_every_key():
    from owtsweep.config.hints import list_keys
    from owtsweep.studies.hub.config import HubConfig

    text = (ROOT / "docs/readings.md").read_text(encoding="utf-8")
    for key in re.findall(r"^\| `([\w.]+)`", text, flags=re.MULTILINE):
        assert key in list_keys(HubConfig), key


def test_links_lead_somewhere():
    kept = (ROOT / "results" / "reference").rglob("*.md")
    documents = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *kept]
    for document in documents:
        links = re.findall(r"\]\((?!https?:)([^)#]+)\)", document.read_text(encoding="utf-8"))
        for link in links:
            assert (document.parent / link).exists(), f"{document.relative_to(ROOT)}: {link}"


def test_every_page_is_linked_from_the_readme_or_from_another():
    pages = sorted((ROOT / "docs").glob("*.md"))
    others = [ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    for page in pages:
        linking = [other for other in (*others, *pages) if other != page]
        assert any(f"{page.name}" in other.read_text("utf-8") for other in linking), page.name


def read_map(run):
    best = pd.read_csv(ROOT / f"results/reference/{run}/best_scheme.csv")
    return best[best["criterion"] == "position"]


def test_what_the_readme_says_of_the_matched_map():
    told = r"run HME1\nwhere the motion is larger than some (\.\d) m, and MKF from some (\.\d+) to"
    ((hme1_from, mkf_from),) = re.findall(told, README)
    best = read_map("matched_on_paper")
    assert set(best.loc[best["amplitude"] > 0.2, "best"]) == {"HME1"}
    assert set(best.loc[best["amplitude"] == 0.2, "best"]) == {"MKF"}
    small = best["amplitude"] <= 0.1
    assert (best["baseline_wins"] == small).all()
    assert set(best.loc[small, "baseline"]) == {"NONE"}
    # between the cells: errors of MKF and of zero grow as the square of the amplitude
    wide = best.pivot(index="natural_period", columns="amplitude", values="mse_best")
    growth = (wide[0.2] - wide[0.1]) / (0.2**2 - 0.1**2)
    steady = wide[0.1] - growth * 0.1**2
    of_zero = best[small].groupby("natural_period")["mse_baseline"].first() / 0.05**2
    equal = np.sqrt(steady / (of_zero - growth))
    assert np.allclose(equal, float(mkf_from), atol=0.006)
    equal = np.sqrt((wide[0.5] - steady) / growth)
    assert np.allclose(equal, float(hme1_from), atol=0.06)


def test_what_the_readme_says_of_the_papers_map():
    best = read_map("paper")
    (percent,) = re.findall(r"MKF comes within (\d+) % of HME2 at \.1 m and below", README)
    near = best[best["amplitude"] <= 0.1]
    assert set(near["best"]) == {"HME2"}
    assert set(near["runner_up"]) == {"MKF"}
    assert (near["mse_runner_up"] / near["mse_best"]).max() < 1.0 + int(percent) / 100
    assert set(best["best"]) == {"HME1", "HME2"}
    largest = best[best["best"] == "HME2"].groupby("natural_period")["amplitude"].max()
    assert largest.is_monotonic_increasing  # small and slow

    numbers = pd.read_csv(ROOT / "results/reference/paper/fidelity_numbers.csv")
    told = r"The (\d+) numbers are met to a median factor of ([\d.]+)\."
    ((count, factor),) = re.findall(told, README)
    assert len(numbers) == int(count)
    assert f"{2 ** numbers['log2'].abs().median():.2f}" == factor

    claims = pd.read_csv(ROOT / "results/reference/paper/fidelity.csv")
    verdicts = claims.loc[claims["kind"] == "statement", "agrees"]
    told = r"(\d+) of the paper's\n(\d+) statements are reproduced, (\d+) are not"
    ((yes, total, no),) = re.findall(told, README)
    assert len(verdicts) == int(total)
    counts = {"reproduced": int(yes), "not reproduced": int(no)}
    assert verdicts.value_counts().to_dict() == counts


def test_the_readme_names_the_truth_of_its_maps():
    from owtsweep.config.stored import read_stored

    for run in ("paper", "matched_on_paper"):
        config, _ = read_stored(ROOT / f"results/reference/{run}/config.yaml")
        imu, records = config["sensors"]["imu"], config["grid"]["replicates"]
        told = (config["record"]["duration"], imu["bias_initial"], imu["bias_walk"], records)
        assert told == (1000.0, 0.02, 1e-4, 100)
        assert config["seed"] == 2019
    assert "records of 1000 s, IMU bias .02 m/s² with a walk of 1e-4 m/s²/√s, 100 records" in README


def test_what_the_pages_set_of_a_tower_is_accepted():
    text = (ROOT / "docs/tower.md").read_text(encoding="utf-8")
    overrides = re.findall(r"`(sensors\.[^`]*\])`", text)
    assert overrides
    for words in overrides:
        compose(["study=tower", *words.split()])  # refuses heights where no sensor can sit
