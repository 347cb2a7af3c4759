"""`tuning=FILE`: a file of the user's own beside the tunings that have a name."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest
import yaml
from hydra.core.config_store import ConfigStore

from owtsweep import InputError
from owtsweep.cli import BAD_INPUT, main
from owtsweep.config import as_mapping
from owtsweep.config.option_files import place_files
from owtsweep.studies import compose
from owtsweep.studies.hub.config import TUNED


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A complete tuning file, with a number of its own."""
    config = as_mapping(compose(["tuning=matched"]))
    sections = {section: config[section] for section in TUNED}
    sections["hme1"]["q_a"] = 3.5
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(sections))
    return path


def test_a_file_is_a_tuning_with_the_files_name(mine: Path) -> None:
    config = compose([f"tuning={mine}"])
    assert (config.tuning, config.hme1.q_a) == ("mine", 3.5)
    assert compose([f"tuning={mine}", "hme1.q_a=7"]).hme1.q_a == 7.0


def test_it_stands_beside_others_and_is_found_without_a_slash(
    mine: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(mine.parent)
    parts = compose(["tuning=[matched,mine.yaml]"]).by_tuning()
    assert {name: part.hme1.q_a for name, part in parts.items()} == {"matched": 1.07, "mine": 3.5}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("seed: 3\n", "not seed"),
        ("hme1: {q_a: '${oc.env:HOME}'}\n", "interpolation"),
        ("hme1: &a {q_a: 1.0}\nmkf: *a\n", "alias"),
        ("tuning: [a]\n", "is no text"),
        ("- 1\n", "mapping"),
    ],
)
def test_a_file_sets_nothing_but_a_tuning(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=told) as caught:
        compose([f"tuning={path}"])
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_messages_name_the_file_as_the_user_did(mine: Path) -> None:
    with pytest.raises(InputError, match=str(mine)):
        compose([f"tuning=[matched,{mine}]", "hme1.q_a=2"])
    with pytest.raises(InputError, match="there is no file"):
        compose(["tuning=./nowhere.yaml"])


def test_a_multirun_takes_no_files(mine: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "-m", f"tuning=matched,{mine}"]) == BAD_INPUT
    assert "--config-dir" in capsys.readouterr().err


def test_a_name_that_is_too_long_is_no_file() -> None:
    with pytest.raises(InputError, match=r"^tuning: there is no file a+ "):
        compose([f"tuning={'a' * 300}.yaml"])
    with pytest.raises(InputError, match=r"^structure: there is no file a+"):
        compose(["motion=plant", f"structure={'a' * 300}.yaml"])
    with pytest.raises(InputError, match=r"^tuning: there is no file ~no_such_user/mine.yaml"):
        compose(["tuning=~no_such_user/mine.yaml"])


@pytest.mark.parametrize("study", ["hub", "tower", "floater", "blade"])
def test_processes_can_send_a_configuration_of_several_tunings(study: str) -> None:
    config = compose([f"study={study}", "tuning=[paper,matched]"])
    assert pickle.loads(pickle.dumps(config)) == config


def test_a_file_is_forgotten_after_it_was_read(mine: Path) -> None:
    """A study without the group says so, also after another one had a file in it."""
    compose([f"tuning={mine}"])
    with pytest.raises(InputError, match="blade: tuning: there is no 'nope'"):
        compose(["study=mating", "tuning=nope"])


def test_threads_that_read_files_at_once_get_their_own(mine: Path, tmp_path: Path) -> None:
    """Each waits with its file placed until both have placed theirs."""
    values = yaml.safe_load(mine.read_text())
    other = tmp_path / "other.yaml"
    other.write_text(yaml.safe_dump(values))
    model = type(compose([]))
    with place_files([f"tuning={mine}"], model) as first:
        with place_files([f"tuning={other}"], model) as second:
            assert first != second
        assert ConfigStore.instance().repo["tuning"]  # still there
    assert "tuning" not in ConfigStore.instance().repo
