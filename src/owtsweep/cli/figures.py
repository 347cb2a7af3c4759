"""The command `figures`: draw all figures of a run, or its map with a structure's envelope."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import DONE
from owtsweep.errors import printable
from owtsweep.io.files import refuse_in_one_line, write_atomically


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Draw figures of the run `options.run` into its subfolder figures/, and return 0.

    Draw all figures, with an index.html of them; or, if `options.envelope` names a structure, the
    map with its envelope alone.
    `options` are the parsed arguments of the command; `argv` is not used.
    """
    from owtsweep.api import load
    from owtsweep.io.terminal import show_steps, tell_step
    from owtsweep.report.gallery_page import INDEX, make_gallery

    opened = load(options.run)
    folder = opened.place / "figures"
    sentences: list[str] = []
    with refuse_in_one_line(folder), show_steps():
        if options.envelope is None:
            files = opened.draw()
            pictures = [file for file in files if file.suffix == ".png"]
            if pictures:
                index = pictures[0].with_name(INDEX)
                title = f"Figures of the run {printable(opened.folder.name)}"
                write_atomically(index, make_gallery(title, pictures))
                files.append(index)
        else:
            from owtsweep.structures import find_structure
            from owtsweep.studies.hub.figures.envelope import save_envelope

            structure = find_structure(options.envelope)
            tell_step(f"motion of {structure.name} in many sea states")
            files, sentences = save_envelope(opened, structure, folder)
    for sentence in sentences:
        print(sentence)
    print(f"{len(files)} files: {printable(str(folder))}/")
    return DONE
