"""What a tired user types: names with special characters, misspelt files, folders, links."""

from __future__ import annotations

from pathlib import Path

import pytest
from replay_tools import motion_file

from owtsweep.errors import InputError
from owtsweep.motion.recorded import read
from owtsweep.studies.replay.running import compose_replay, expand, quote_text


@pytest.mark.parametrize(
    "name",
    ["m/s^2", "TwHt1TPxi [m]", "State pos x  coo: global", "a,b", "it's", "x=1", "°", "a\\'b"],
)
def test_names_of_channels_and_units_need_no_quotes(name):
    config = compose_replay([f"columns.position_x={name}", f"units.position_x={name}"])
    assert config.columns.position_x == name
    assert config.units.position_x == name


def test_other_overrides_stay_as_they_are():
    words = [
        "columns.time=null", "columns.time=", "columns.time='a b'", 'columns.time="a b"',
        "columns.time=${experiment}", "replay.band=[0.1,0.5]", "columns.time=t_1.x/y-z",
    ]  # fmt: skip
    assert [quote_text(word) for word in words] == words


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("towr.csv", "towr.csv: there is no such file; did you mean tower.csv?"),
        ("./d/towr.csv", "./d/towr.csv: there is no such file; did you mean d/tower.csv?"),
        ("nothing.outb", "nothing.outb: there is no such file"),
        ("no/tower.csv", "no/tower.csv: there is no such file, and no folder no"),
        ("*.outb", "*.outb: nothing matches this pattern"),
        ("d/", 'd/: this is a folder; name files in it, e.g. "d/*.csv"'),
        ("", "FILE: the name is empty; name a record's file or a pattern"),
        ("https://a.b/c.csv", "https://a.b/c.csv: files are not read from the network"),
    ],
)
def test_a_file_that_is_not_there(tmp_path, monkeypatch, word, said):
    monkeypatch.chdir(tmp_path)
    Path("d").mkdir()
    Path("tower.csv").touch()
    Path("d/tower.csv").touch()
    with pytest.raises(InputError) as caught:
        expand([word])
    assert str(caught.value).startswith(said)
    assert str(caught.value) == said or "network" in said


def test_units_of_a_role_that_no_channel_has_are_told(tmp_path):
    path = motion_file(tmp_path / "a.csv", duration=5.0)
    notes = read(path, units={"position_x": "m", "fix_x": "mm"}).notes
    assert "without effect, no channel has this role: units.fix_x" in notes
