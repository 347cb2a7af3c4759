"""docs/python.md: the record that it takes has what the page says."""

import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs/python.md").read_text(encoding="utf-8")


def test_one_record_of_the_blade():
    (code,) = re.findall(r"```python\n(record = .*?)```", PAGE, flags=re.DOTALL)
    names: dict = {}
    exec(f"import owtsweep\n{code}", names)
    record, error = names["record"], names["error"]
    assert error.shape == (len(error), 3)
    assert record.units["root"] == "m"
    assert record.latencies == {"MEKF": 0.0}
