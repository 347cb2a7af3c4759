"""Measure the page of a run: size, time to write it, and how fast a browser answers.

    python -m benchmarks.report_page RUN...

Times of the browser are medians of five, in headless chromium with chromedriver; without them the
first two figures are printed alone. The goals are those of docs/report.md.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import owtsweep

TIMES = 5
#: What a reader does -> JavaScript that does it; it returns false where the page has no such thing.
ACTIONS = {
    "a cell": """
        const cells = document.querySelectorAll("g.cell");
        cells[Math.floor(cells.length * Math.random())].dispatchEvent(new MouseEvent("click"));
    """,
    "the amplitude": """
        const slider = document.getElementById("amplitude");
        if (!slider) return false;
        slider.value = String(Math.floor(1000 * Math.random()));
        slider.dispatchEvent(new Event("input"));
    """,
    "the filter": """
        const field = document.getElementById("filter");
        field.value = String(Math.floor(9 * Math.random()));
        field.dispatchEvent(new Event("input"));
    """,
    **{
        f"the {name}": f"""
            const select = document.getElementById("{name}");
            if (!select) return false;
            select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
            select.dispatchEvent(new Event("change"));
        """
        for name in ("tuning", "criterion", "window", "records")
    },
}
TIMED = """
    const done = arguments[0], began = performance.now();
    const act = () => { %s return true; };
    if (!act()) return done(-1);
    requestAnimationFrame(() => setTimeout(() => done(performance.now() - began), 0));
"""


def measure(folder: str) -> Iterator[tuple[str, str]]:
    """Yield what was measured of the page of a run, and its value in words."""
    run = owtsweep.load(folder)
    results = run.make_results(run.stored()[0])
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "report.html"
        began = time.perf_counter()
        run.write_report(path, results)
        yield "written in", f"{time.perf_counter() - began:.2f} s"
        yield "size", f"{path.stat().st_size / 1e3:.0f} kB"
        driver = shutil.which("chromedriver")
        if driver is not None:
            yield from _measure_browser(path, driver)


def _measure_browser(path: Path, driver: str) -> Iterator[tuple[str, str]]:
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu"):
        options.add_argument(word)
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    paints = []
    for _ in range(TIMES):
        browser.get("about:blank")
        browser.get(path.as_uri())
        time.sleep(0.5)
        script = "return performance.getEntriesByType('paint')[0].startTime"
        paints.append(browser.execute_script(script))
    yield "first paint", f"{statistics.median(paints):.0f} ms"
    for name, action in ACTIONS.items():
        took = [browser.execute_async_script(TIMED % action) for _ in range(TIMES)]
        if took[0] >= 0:
            yield name, f"{statistics.median(took):.0f} ms"
    browser.quit()


if __name__ == "__main__":
    for run in sys.argv[1:]:
        told = ", ".join(f"{what} {value}" for what, value in measure(run))
        print(f"{Path(run).name}: {told}")
