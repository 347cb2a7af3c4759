"""Write the report on a paper, whose claims and texts are the files beside its script."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from experiments.command import read_data
from owtsweep.verdicts.claims_file import read_claims
from owtsweep.verdicts.page import Block, Heading, Paragraph, TextTable
from owtsweep.verdicts.report import write_verdicts
from owtsweep.verdicts.score_table import ScoreTable


def write_paper(
    script: str,
    folder: Path,
    judged: Sequence[ScoreTable],
    tables: Mapping[str, pd.DataFrame],
    shown: TextTable,
    values: Mapping[str, object],
    end: Sequence[Block] = (),
) -> list[Path]:
    """Write fidelity.md, fidelity.html and tables into a folder; return the files.

    Parameters
    ----------
    script
        `__file__` of the script: beside it are claims.toml and, of its own name, the texts.
    folder
        Made if it does not exist.
    judged
        The tables of scores by which claims are judged.
    tables
        Tables to write, by name.
    shown
        The table of the page, below the heading and the paragraph of the texts.
    values
        What the texts name in braces.
    end
        What ends the page.
    """
    texts = read_data(script)
    return write_verdicts(
        folder,
        read_claims(Path(script).with_name("claims.toml")),
        judged,
        title=texts["title"],
        about=texts["about"].format(**values),
        tables=tables,
        middle=[Heading(texts["heading"]), Paragraph(texts["paragraph"]), shown],
        end=end,
    )
