"""How much delay of the optical system a closed loop bears with each scheme.

    python -m experiments.floater.delay_margin [FOLDER]

FOLDER (default: results/floater_delay_margin) gets delay_margin.csv: a row per motion (floater: 38
s at 20 Hz; buoy: 10.4 s at 200 Hz) and scheme, tuning matched, 20 dB, bias .03. The module
`owtsweep.studies.floater.delay_margin` says which loop that is.
"""

import sys
from pathlib import Path

import pandas as pd

from owtsweep.io.steps import show_steps, tell_step
from owtsweep.studies import compose
from owtsweep.studies.floater.delay_margin import LONGEST, find_margins

MOTIONS = ("floater", "buoy")
WORDS = ["tuning=matched", "axes=[snr,loss]", "grid.snr=[20]", "grid.delay=[0]", "grid.bias=[.03]"]

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/floater_delay_margin")
rows = []
with show_steps():
    for motion in MOTIONS:
        tell_step(f"delay margins, motion={motion}")
        config = compose(["study=floater", f"motion={motion}", *WORDS])
        period = config.motion.freedoms["x"].resonance.period
        for scheme, margin in find_margins(config).items():
            row = {"motion": motion, "scheme": scheme, "margin_s": margin, "reason": ""}
            if isinstance(margin, str):
                row |= {"margin_s": float("nan"), "reason": margin}
            elif margin == float("inf"):
                row["reason"] = f"stable with every delay up to {LONGEST * period:g} s"
            rows.append(row)
folder.mkdir(parents=True, exist_ok=True)
table = pd.DataFrame(rows)
table.to_csv(folder / "delay_margin.csv", index=False, float_format="%.4g")
print(table.to_string(index=False, float_format="{:.3g}".format))
print(folder / "delay_margin.csv")
