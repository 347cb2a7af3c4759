"""Draw the best-scheme maps of two tunings side by side, with the HME1/HME2 boundary and its cause.

    python experiments/two_maps.py PAPER_RUN MATCHED_RUN [FILE_STEM]

PAPER_RUN and MATCHED_RUN are the folders of two runs, or twice that of a run of both tunings. The
files are FILE_STEM.png and FILE_STEM.svg (default: two_maps in the current folder).
"""

import sys
from pathlib import Path

import owtsweep
from owtsweep.figures import style
from owtsweep.studies.hub.figures import two_maps

if len(sys.argv) not in (3, 4):
    sys.exit(f"usage: python {sys.argv[0]} PAPER_RUN MATCHED_RUN [FILE_STEM]")
runs = [owtsweep.load(path) for path in sys.argv[1:3]]
paper, matched = (
    run.by_tuning().get(tuning, run) for run, tuning in zip(runs, ("paper", "matched"), strict=True)
)
stem = Path(sys.argv[3] if len(sys.argv) == 4 else "two_maps")
metadata = {"paper": paper.hash, "matched": matched.hash}
for file in style.save(two_maps.draw(paper, matched), stem.parent, stem.name, metadata):
    print(file)
