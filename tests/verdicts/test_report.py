"""One document in two renderings, and the files of a report."""

from __future__ import annotations

import pandas as pd

from owtsweep.figures import style
from owtsweep.figures.drawings import save_figure
from owtsweep.verdicts.claims_file import read_claims
from owtsweep.verdicts.page import Bullets, Heading, Paragraph, Picture, TextTable
from owtsweep.verdicts.report import count_verdicts, write_page, write_verdicts
from owtsweep.verdicts.score_table import ScoreTable


def test_a_page_is_written_as_markdown_and_as_html(tmp_path):
    picture, _ = save_figure(lambda: style.new_figure(2.0, 1.0), {"run": "3f2a"})(
        tmp_path / "figures", "empty"
    )
    blocks = [
        Heading("A run & a paper", 1),
        Paragraph("It <agrees>."),
        Bullets(["one", "two"]),
        TextTable(["item", "value"], [["a|b", "1.5"], ["verdict", "reproduced"]], ["value"]),
        Picture(picture, "Nothing."),
    ]
    files = write_page(tmp_path, "A title", blocks)
    assert [path.name for path in files] == ["fidelity.md", "fidelity.html"]
    markdown = files[0].read_text(encoding="utf-8")
    assert markdown.startswith("# A run & a paper\n\nIt &lt;agrees>.\n\n- one\n- two\n\n")
    assert "| item | value |\n| --- | ---: |\n| a\\|b | 1.5 |" in markdown
    assert markdown.endswith("![Nothing.](figures/empty.png)\n")
    html = files[1].read_text(encoding="utf-8")
    assert "<h1>A run &amp; a paper</h1>" in html
    assert '<td class="number good">reproduced</td>' in html
    assert 'src="data:image/png;base64,' in html


def test_the_page_counts_verdicts_and_shows_statements_and_goals(tmp_path):
    path = tmp_path / "claims.toml"
    one = 'name = "{0}1"\ntext = "it is {1}"\nprinted = "here"\ndefinition = "{0} below 1."\n'
    claim = 'text = "small"\nreason = "r"\n'
    path.write_text(
        'note = "Written before."\nkind = "bound"\nside = "below"\nbound = 1.0\n'
        '[[statements]]\n' + one.format("F", "small")
        + f'[[statements.claims]]\n{claim}select = {{ scenario = ["a", "c"] }}\n'
        + '[[goals]]\n' + one.format("G", "best")
        + f'[[goals.claims]]\n{claim}select = {{ scenario = "b" }}\n'
    )  # fmt: skip
    rows = [("a", 0, 0.1), ("a", 1, 0.2), ("b", 0, 2.0), ("b", 1, 2.1)]
    scores = ScoreTable(pd.DataFrame(rows, columns=["scenario", "replicate", "value"]))
    write_verdicts(
        tmp_path / "page", read_claims(path), [scores], title="A paper", about="Two records.",
        middle=[Heading("Between")], end=[Heading("Last")],
    )  # fmt: skip
    page = (tmp_path / "page" / "fidelity.md").read_text(encoding="utf-8")
    assert "- Statements F1-F1: 1 missing.\n- Goals G1-G1: 1 not reproduced." in page
    headings = [line for line in page.splitlines() if line.startswith("#")]
    assert headings == [
        "# A paper", "## In short", "## Statements", "### F1: missing", "## Between",
        "## Goals of the project", "### G1: not reproduced", "## Last",
    ]  # fmt: skip
    assert "small: missing, 1 of 1 hold in the mean, a 0.15" in page
    assert "Written before. Of each claim" in page
    table = pd.read_csv(tmp_path / "page" / "fidelity_claims.csv")
    assert table["statement"].tolist() == ["F1", "G1"]
    assert table["missing"].tolist()[0] == "c"
    assert table["holding"].tolist() == [1, 0]


def test_nothing_is_counted_as_nothing():
    assert count_verdicts([]) == ""
