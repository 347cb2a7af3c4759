"""Measure speed and memory of owtsweep, and compare them with the goals and with other software.

`python -m benchmarks` (or `make bench`) measures everything and writes report.md; every part runs
alone as `python -m benchmarks.<part>`. All times come from `benchmarks.timing`.
"""

from pathlib import Path

#: The folder of the checkout.
ROOT = Path(__file__).resolve().parents[1]
#: The truth, the tuning and the four schemes of everything that is measured, unless an override
#: says otherwise: those of all earlier reports.
STUDY = ("experiment=study", "tuning=paper", "baselines=[]")


def put(name: str, text: str, page: str = "scaling.md") -> None:
    """Replace the part called `name` of a page of docs/, between two marks, by whole lines."""
    path = ROOT / "docs" / page
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->\n"
    before, rest = path.read_text(encoding="utf-8").split(begin)
    _, after = rest.split(end)
    path.write_text(f"{before}{begin}{text}{end}{after}", encoding="utf-8")
