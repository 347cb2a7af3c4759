"""The command `fidelity`: judge what a paper says by a run."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import owtsweep
from owtsweep.cli.program import DONE
from owtsweep.errors import InputError, printable, require
from owtsweep.io.files import refuse_in_one_line

if TYPE_CHECKING:
    from owtsweep.verdicts.claims_file import ClaimsFile

#: In a checkout, the folder that holds the claims of the papers: <paper>/claims.toml.
PAPERS = Path(owtsweep.__file__).parents[2] / "experiments"


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Judge the claims of `options.claims` by the rows of the run `options.run`; return 0.

    Without a file, the claims are those of the paper of the run's study, which stand beside the
    package in a checkout. Verdicts and a page are written into the subfolder fidelity/ of the run's
    folder; with several tunings, each has a folder of its own: fidelity/<tuning>/. The page of the
    run is written again, with the verdicts. `argv` is not used.

    Raises InputError if there is no such file, it cannot be used, it is about another study, or the
        rows of a run can judge none of its statements; if the run holds expected values instead of
        records, or no case of it has succeeded.
    """
    from owtsweep.api import load
    from owtsweep.sweep.scores import collect_scores
    from owtsweep.verdicts.claims_file import read_claims
    from owtsweep.verdicts.judge import list_beyond
    from owtsweep.verdicts.report import write_verdicts

    opened = load(options.run)
    name = opened.study.name
    file = read_claims(Path(options.claims)) if options.claims else find_claims(name)
    require(
        file.study in ("", name),
        f"{options.claims}: its claims are about study {file.study!r}, and {opened.folder} is a "
        f"run of study {name!r}; give claims about {name}",
    )
    paper = file.paper or options.claims
    statements = [*file.statements, *file.goals]
    rest = f"python -m {file.script}" if file.script else "a table of scores"
    for tuning, part in opened.by_tuning().items():
        scores = collect_scores(part)
        beyond = list_beyond(statements, [scores])
        require(
            len(beyond) < len(statements),
            f"{opened.folder}: the rows of a run judge none of these statements, which compare "
            f"what no run of study {name!r} has; {rest} judges them",
        )
        folder = opened.place / "fidelity" / tuning
        about = f"{part.study.describe_origin(part.config)}. ".removeprefix(". ")
        with refuse_in_one_line(folder):
            files = write_verdicts(
                folder,
                file,
                [scores],
                title=f"How well run {opened.metadata()['folder']} reproduces {paper}",
                about=f"{about}Brackets are 95 % intervals over the records.",
            )
        if beyond:
            print(f"not judged by the rows of a run: {', '.join(beyond)}; {rest} judges them")
        print(f"{len(files)} files: {printable(str(folder / 'fidelity.html'))}")
    with refuse_in_one_line(opened.place):
        opened.write_report()  # with the verdicts
    return DONE


def find_claims(study: str) -> ClaimsFile:
    """Return the claims of a study's paper.

    Raises InputError if this is no checkout, or no paper there is about this study.
    """
    from owtsweep.verdicts.claims_file import read_claims

    for path in sorted(PAPERS.glob("*/claims.toml")):
        file = read_claims(path)
        if file.study == study:
            return file
    raise InputError(
        f"--claims: there are no claims about study {study!r} here; name a file of claims, e.g. of "
        "your own (a checkout of the project's repository has those of the papers, in experiments/)"
    )
