"""From the description of a structure of your own to the scheme that should run on it.

    python examples/own_structure.py [STRUCTURE.yaml] [RUN]

STRUCTURE.yaml describes the structure (default: my_tower.yaml beside this script). RUN is the
folder of a run of the hub study; without it, one of the default study is made, or the stored one
opened. Printed are the natural frequencies, the tilt of the hub, the motion in one sea, and which
scheme is best in which sea. The map with the structure's envelope, and the table behind it, are
written into the folder of the structure's name. A bad structure ends the program with one line that
says what is wrong, and exit code 2.
"""

import sys
from functools import partial
from pathlib import Path

import numpy as np

import owtsweep
from owtsweep.motion.plant import Plant
from owtsweep.streams import stream
from owtsweep.structures import compute_modes, read_structure
from owtsweep.studies.hub.figures.envelope import save_envelope
from owtsweep.waves import Sea

SEA = Sea(hs=2.0, tp=7.0)


def main(arguments: list[str]) -> int:
    file = arguments[0] if arguments else Path(__file__).with_name("my_tower.yaml")
    try:
        structure = read_structure(file)
        for blades in (0, 1, 2) if structure.blade else (0,):
            modes = compute_modes(structure, 2, blades)
            f1, f2 = modes.frequency
            print(
                f"blades mounted: {blades}; natural frequencies {f1:.3f} and {f2:.2f} Hz; the hub "
                f"leans by {modes.slope[0]:.4f} rad per metre"
            )
        draw = partial(stream, 1, "hub", (), 0)
        position = Plant(structure, SEA).realise(draw, steps=20_000, step=0.05).position
        print(
            f"Hs {SEA.hs:g} m, Tp {SEA.tp:g} s: the hub moves {position.std():.2f} m rms, at most "
            f"{np.abs(position).max():.2f} m"
        )
        run = owtsweep.load(arguments[1]) if len(arguments) > 1 else owtsweep.run()
        files, sentences = save_envelope(run, structure, Path(structure.name))
    except owtsweep.InputError as error:
        print(f"own_structure: {error}", file=sys.stderr)
        return 2
    print(*sentences, *files, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
