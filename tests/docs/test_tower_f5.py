"""What docs/research/tower_reproduction.md says of the cause of F5 is what the kept table holds."""

import re
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[2]


def test_the_declared_variance_of_displacements_is_the_cause_of_f5():
    table = pd.read_csv(ROOT / "results/reference/tower/declared_noise.csv")
    assert set(table["records"]) == {10}
    off = table.set_index(["change", "sensors", "direction"])["worst_deviation"]
    page = " ".join((ROOT / "docs/research/tower_reproduction.md").read_text("utf-8").split())
    percent = (100.0 * off).round().astype(int)
    none, quiet, slow = (
        percent[change] for change in ("none", "displacement variance 1e-8", "moments walk a tenth")
    )
    sparse = "sparse_theta_a"
    along, across = (
        f"{quiet[sparse, way]} % instead of {none[sparse, way]} %" for way in ("fa", "ss")
    )
    assert f"off by {along} fore-aft and by {across} side-side" in page
    x_a = "dense_x_a"
    told = (
        f"only Dense: x-a stays above F5's 15 % ({quiet[x_a, 'fa']} and {quiet[x_a, 'ss']} %; "
        f"it was {none[x_a, 'fa']} and {none[x_a, 'ss']} %)"
    )
    assert told in page
    failing = off["displacement variance 1e-8"][off["displacement variance 1e-8"] > 0.15]
    assert set(failing.index.get_level_values("sensors")) == {x_a}
    assert f"they leave {slow[sparse, 'fa']} and {slow[sparse, 'ss']} % with sparse" in page
    (low, high) = re.search(r"is (\d+) to (\d+) % too high fore-aft", page).groups()
    along_wind = none.xs("fa", level="direction")
    assert [int(low), int(high)] == [along_wind.min(), along_wind.max()]
    # both changes help, the displacements' variance by more, with every set-up and direction
    assert (off["displacement variance 1e-8"] < off["moments walk a tenth"]).all()
    assert (off["moments walk a tenth"] < off["none"]).all()
