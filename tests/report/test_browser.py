"""The page in a browser: what it shows, what it asks for, what keys and links do."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from pages import make_contents

from owtsweep.report.run_page import Extras, Origin, Shown, make_run_page

pytestmark = pytest.mark.browser
RECORDS = {"A": 32, "B": 32, "C": 16, "NONE": 8}
ORIGIN = Origin({"seed": "1"}, "owtsweep sweep", "seed: 1\n")


@pytest.fixture(scope="module")
def browser() -> Iterator[object]:
    program, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if program is None or driver is None:
        pytest.skip("there is no chromium with chromedriver on this machine")
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = program
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1280,900"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    opened = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    yield opened
    opened.quit()


@pytest.fixture
def page(tmp_path: Path) -> tuple[str, object]:
    contents = make_contents(RECORDS)
    shown = {"paper": Shown(contents), "matched": Shown(make_contents(RECORDS, seed=5))}
    path = tmp_path / "report.html"
    path.write_text(make_run_page("A run", shown, ORIGIN, Extras(help="Ask."), exact=False))
    return path.as_uri(), contents


def open_page(browser, address, end=""):
    browser.get("about:blank")
    browser.get(address + end)
    browser.get_log("browser")  # forget what other pages said


def find(browser, selector):
    return browser.find_elements("css selector", selector)


def test_every_cell_shows_the_table_and_nothing_is_asked_of_a_network(browser, page):
    address, contents = page
    open_page(browser, address)
    assert browser.execute_script("return performance.getEntriesByType('resource').length") == 0
    best = contents.cells[contents.cells["criterion"] == "position"]
    cells = find(browser, "g.cell")
    assert len(cells) == len(best) == 6
    labels = [cell.get_attribute("aria-label") for cell in cells]
    for row in best.to_dict("records"):
        where = f"natural period {row['natural_period']:g} s, amplitude {row['amplitude']:g} m: "
        (label,) = [label for label in labels if label.startswith(where)]
        ratio = row["error_runner_up"] / row["error_best"]
        assert label == (
            f"{where}{row['best']}, {row['verdict']}, error {row['error_best']:.3f} m; "
            f"next {row['runner_up']}, {ratio:.2f} times as much"
        )
    texts = [text.text for text in find(browser, "g.cell text.error")]
    assert sorted(texts) == sorted(f"{error:.3f}" for error in best["error_best"])
    assert len(find(browser, "table.cells tbody tr")) == 6
    assert browser.get_log("browser") == []


def test_links_keys_and_controls_change_map_curves_and_table_together(browser, page):
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select

    address, _ = page
    open_page(browser, address, "#tuning=matched&cell=4,0.5")
    assert find(browser, "#cell-title")[0].text == "natural period 4 s, amplitude 0.5 m"
    assert Select(find(browser, "#tuning")[0]).first_selected_option.text == "matched"
    (chosen,) = find(browser, "g.cell.chosen")
    browser.execute_script("arguments[0].focus()", chosen)
    chosen.send_keys(Keys.ARROW_UP)
    browser.switch_to.active_element.send_keys(Keys.ENTER)
    assert find(browser, "#cell-title")[0].text == "natural period 4 s, amplitude 2 m"
    assert browser.current_url.endswith("#tuning=matched&cell=4,2")
    assert find(browser, "table.cells tr.chosen td")[1].text == "2"
    assert find(browser, "#curves svg.chart")
    assert not find(browser, "#what-if")[0].is_displayed()
    Select(find(browser, "#records")[0]).select_by_value("8")
    assert find(browser, "#what-if")[0].is_displayed()
    assert find(browser, "#cell-verdict")[0].text.startswith("What if, no verdict: ")
    labels = [cell.get_attribute("aria-label") for cell in find(browser, "g.cell")]
    assert not [label for label in labels if ", won," in label or ", tie," in label]
    find(browser, "#filter")[0].send_keys("zzz")
    assert find(browser, "#found")[0].text == "0 of 6 cells"
    assert browser.get_log("browser") == []


def test_an_amplitude_between_those_of_the_grid_is_a_what_if(browser, page):
    address, _ = page
    open_page(browser, address, "#cell=3,0.5")
    (slider,) = find(browser, "#amplitude")
    browser.execute_script(
        "arguments[0].value = 700; arguments[0].dispatchEvent(new Event('input'))", slider
    )
    assert "amplitude 0.8" in find(browser, "#cell-title")[0].text
    assert find(browser, "#cell-verdict")[0].text.startswith("What if, no verdict: ")
    assert "amplitude=0.8" in browser.current_url


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_hinders_a_reader_who_does_not_see_the_page(browser, page, scheme):
    import axe_core_python

    source = Path(axe_core_python.__file__).with_name("axe.min.js").read_text(encoding="utf-8")
    features = [{"name": "prefers-color-scheme", "value": scheme}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    open_page(browser, page[0])
    browser.execute_script(source)
    found = browser.execute_async_script(
        "const done = arguments[0]; axe.run().then((r) => done(r.violations.map((v) => "
        "`${v.id}: ${v.nodes.map((n) => n.html).join(' ')}`)))"
    )
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert found == []


def test_a_link_to_a_cell_keeps_texts_with_commas_and_percent_signs(browser, tmp_path):
    names = ["5 %", "a, b", "c+d"]
    contents = make_contents(RECORDS, superposed=False)
    cube = replace(contents.cube, levels=(contents.cube.levels[0], names))
    texts = dict(zip([0.1, 0.5, 2.0], names, strict=True))
    cells = contents.cells.assign(sigma=contents.cells["sigma"].map(texts))
    path = tmp_path / "report.html"
    shown = {"": Shown(replace(contents, cube=cube, cells=cells))}
    path.write_text(make_run_page("A run", shown, ORIGIN, Extras(), exact=False))
    open_page(browser, path.as_uri())
    for name in names:
        labels = {cell.get_attribute("aria-label"): cell for cell in find(browser, "g.cell")}
        (cell,) = [labels[label] for label in labels if f"3 s, sigma {name}:" in label]
        cell.click()
        link = browser.current_url
        browser.get("about:blank")
        browser.get(link)
        assert find(browser, "#cell-title")[0].text.endswith(name)
    assert browser.get_log("browser") == []


def test_a_narrow_page_does_not_scroll_sideways(browser, page):
    size = {"width": 400, "height": 800, "deviceScaleFactor": 1, "mobile": True}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    open_page(browser, page[0])
    width = browser.execute_script("return document.documentElement.scrollWidth")
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert width <= 400
