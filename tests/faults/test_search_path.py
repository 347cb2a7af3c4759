"""Workers import nothing that lies in the folder in which a sweep is started."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from owtsweep.process import no_modules_of_this_folder

TOWER = (
    "study=tower", "experiment=quick", "record.duration=20", "record.settling=5",
    "grid.noise=[1.0]", "grid.replicates=1", "schemes=[AKF]", "compute.workers=2",
)  # fmt: skip
#: Modules that workers, joblib's trackers or launchers import, by the names of a stranger's files.
NAMES = ("joblib", "numpy", "signal", "pickle", "pandas", "owtsweep", "submitit", "hydra")
STRANGE = "open({marker!r}, 'a').write(__name__)\nraise ImportError('a stranger')\n"


def sweep(folder: Path, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a sweep in a folder as a user does, by the environment's script."""
    script = shutil.which("owtsweep", path=str(Path(sys.executable).parent))
    if script is None:
        pytest.skip("the script owtsweep is not installed")
    kept = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONSAFEPATH")}
    return subprocess.run(
        [script, "sweep", *words], cwd=folder, env=kept | environment,
        capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip


@pytest.fixture
def strange(tmp_path: Path) -> Path:
    """A folder with files that write to the file `ran` beside the folder when they are imported."""
    folder = tmp_path / "strange"
    folder.mkdir()
    for name in NAMES:
        (folder / f"{name}.py").write_text(STRANGE.format(marker=str(tmp_path / "ran")))
    return folder


@pytest.mark.faults
@pytest.mark.parametrize("words", [(), ("-m", "seed=1,2"), ("-m", "hydra/launcher=joblib")])
def test_workers_import_nothing_that_lies_in_the_folder(strange, words):
    if "hydra/launcher=joblib" in words:
        pytest.importorskip("hydra_plugins.hydra_joblib_launcher")
        words = (*words, "seed=1,2")
    done = sweep(strange, *TOWER, *words)
    assert not (strange.parent / "ran").exists()
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.faults
def test_a_module_that_the_user_names_reaches_the_workers(tmp_path):
    """A user's own folder on PYTHONPATH is searched: a scheme of it runs in processes."""
    source = Path(__file__).parents[1] / "helpers/user_schemes.py"
    shutil.copy(source, tmp_path / "mine.py")
    done = sweep(
        tmp_path, "grid.natural_period=[4.0]", "grid.amplitude=[1.0]", "grid.replicates=1",
        "record.duration=25", "schemes=[MKF,{_target_: mine.HoldLastFix}]", "compute.backend=loky",
        PYTHONPATH=".",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_the_folder_is_left_off_only_where_this_process_does_not_search_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    monkeypatch.setattr(sys, "path", ["/usr/lib"])
    with no_modules_of_this_folder():
        assert os.environ["PYTHONSAFEPATH"] == "1"
    assert "PYTHONSAFEPATH" not in os.environ
    for own in ("", ".", str(tmp_path)):  # python -c, PYTHONPATH=., python -m
        monkeypatch.setattr(sys, "path", [own])
        with no_modules_of_this_folder():
            assert "PYTHONSAFEPATH" not in os.environ
