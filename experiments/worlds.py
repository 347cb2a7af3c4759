"""Which scheme to run if nobody knows the world: the table that the default answer quotes.

    python -m experiments.worlds [FOLDER]

Runs experiment=worlds (some 7 minutes of a processor; what is stored in results/ is reused) and
writes into FOLDER (default: results/reference/worlds) its tables regret, regret_summary and worlds,
and origin.yaml: date, command, tuning, sensors and records.
"""

import datetime

import yaml

import owtsweep
from experiments.command import read_words, write
from owtsweep.config import as_mapping


def main():
    """Run the sweep, and write its tables and where they come from."""
    folder, _, _ = read_words("results/reference/worlds", 0)
    run = owtsweep.run(["experiment=worlds"])
    names = ("regret", "regret_summary", "worlds")
    write(folder, {name: run.table(name) for name in names})
    config = as_mapping(run.config)
    origin = {
        "date": str(datetime.date.today()),
        "command": "owtsweep sweep experiment=worlds",
        "worlds": len(run.table("worlds")),
        "tuning": config["tuning"],
        "sensors": config["sensors"],
        "replicates": config["grid"]["replicates"],
        "duration": config["record"]["duration"],
    }
    (folder / "origin.yaml").write_text(yaml.safe_dump(origin, sort_keys=False))


if __name__ == "__main__":
    main()
