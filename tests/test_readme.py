"""The README's example is the one that the tests run, and the files it names exist."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_example_scheme_is_the_tested_one():
    (example,) = re.findall(r"```python\n(import numpy.*?)```", README, flags=re.DOTALL)
    tested = (ROOT / "tests/hub/hold_last_fix.py").read_text(encoding="utf-8")
    _, _, code = tested.split('"""', 2)
    assert example.strip() == code.strip()


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
