"""A sweep as a whole: what it computes, what it reuses, what it survives."""

from __future__ import annotations

import logging
import os
import tempfile
import time

import pandas as pd
import pytest
from dummy_study import BASE

from owtsweep.cli.running import setback_lines
from owtsweep.errors import InputError
from owtsweep.sweep.execute import Executor
from owtsweep.sweep.keys import run_folder
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.rows import Setback
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run


def shards(outcome):
    return sorted(outcome.run.store.cases.glob("part-*.parquet"))


def test_first_sweep_computes_all_and_the_second_nothing(study, config):
    first = sweep(study, config())
    assert (first.computed, first.reused, first.failed) == (12, 0, [])
    assert len(shards(first)) == 6
    times = [path.stat().st_mtime_ns for path in shards(first)]
    second = sweep(study, config())
    assert (second.computed, second.reused, second.failed) == (0, 12, [])
    assert [path.stat().st_mtime_ns for path in shards(second)] == times


def test_resume_computes_only_what_is_missing(study, config):
    first = sweep(study, config())
    before = first.run.cases()
    content = shards(first)[2].read_bytes()
    shards(first)[2].unlink()
    second = sweep(study, config())
    assert (second.computed, second.reused) == (2, 10)
    assert shards(second)[2].read_bytes() == content
    pd.testing.assert_frame_equal(second.run.cases(), before, check_exact=True)


def test_larger_grid_adds_and_smaller_grid_reads_only_its_own(study, config):
    sweep(study, config())
    more = sweep(study, config(level=[5.0, 1.0, 2.0, 0.3], schemes=["A", "B", "C"]))
    assert (more.computed, more.reused) == (12, 12)
    less = sweep(study, config(level=[5.0]))
    assert (less.computed, less.reused) == (0, 4)
    assert set(less.run.cases()["level"]) == {5.0}
    assert set(less.run.summary()["level"]) == {5.0}


def test_damaged_shard_is_recomputed_and_kept(study, config, caplog):
    first = sweep(study, config())
    path = shards(first)[0]
    whole = path.read_bytes()
    path.write_bytes(whole[:50] + bytes([whole[50] ^ 1]) + whole[51:])
    second = sweep(study, config())
    assert (second.computed, second.reused) == (2, 10)
    assert path.read_bytes() == whole
    assert path.with_name(f"{path.name}.damaged").exists()
    assert "is damaged" in caplog.text


def test_fresh_computes_all_again(study, config):
    first = sweep(study, config())
    stray = first.run.store.path("f" * 32)
    stray.write_text("")
    again = sweep(study, config(), fresh=True)
    assert (again.computed, again.reused) == (12, 0)
    assert not stray.exists()


def test_bits_do_not_depend_on_workers_backend_or_grid_order(study, config, tmp_path, monkeypatch):
    def files(folder, **changes):
        outcome = sweep(study, config(results=folder, **changes))
        assert outcome.computed == 12
        paths = [*shards(outcome), *outcome.run.folder.glob("*.csv")]
        assert len(paths) == 8
        return {path.name: path.read_bytes() for path in paths}

    expected = files(tmp_path / "1")
    assert files(tmp_path / "2", workers=2) == expected
    assert files(tmp_path / "3", level=[0.3, 2.0, 1.0], schemes=["B", "A"]) == expected
    assert files(tmp_path / "4", workers=2, backend="loky") == expected
    # Workers that live on still stand in the old folder; a relative path means the new one.
    (tmp_path / "there").mkdir()
    monkeypatch.chdir(tmp_path / "there")
    assert files("5", workers=2, backend="loky") == expected
    assert (tmp_path / "there" / "5").is_dir()


def test_raising_block_fails_alone_and_is_tried_again(faulty, config, caplog):
    broken = sweep(faulty(**{"B2.0": "raise"}), config())
    (failure,) = broken.failed
    assert failure.label == "B2.0"
    assert failure.reason == "ArithmeticError: no convergence"
    assert failure.cases == 2
    assert (broken.computed, broken.reused) == (10, 0)
    assert "B2.0: ArithmeticError" in caplog.text
    assert set(broken.run.summary()["level"]) == {0.3, 1.0, 2.0}
    assert "Traceback" in (broken.run.folder / "run.log").read_text()
    mended = sweep(faulty(), config())
    assert (mended.computed, mended.reused, mended.failed) == (2, 10, [])


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("raise", "ArithmeticError"),
        ("silent", "RuntimeError"),
        ("memory", "MemoryError"),
        ("exit", "SystemExit"),
        ("statusless", "WrongRows"),
    ],
)
def test_blocks_beside_a_fault_are_kept(faulty, config, fault, reason):
    outcome = sweep(faulty(**{"B2.0": fault}), config(schemes=["A", "B", "C"], level=[2.0]))
    assert set(outcome.run.cases()["scheme"]) == {"A", "C"}
    (failure,) = outcome.failed
    assert failure.label == "B2.0"
    assert failure.reason.startswith(reason)


@pytest.mark.parametrize("error", BASE)
@pytest.mark.parametrize(("backend", "workers"), [("threading", 1), ("threading", 2), ("loky", 2)])
def test_what_a_block_raises_never_ends_the_sweep(faulty, config, error, backend, workers):
    c = config(backend=backend, workers=workers)
    outcome = sweep(faulty(**{"A2.0": error, "B0.3": error}), c)
    assert outcome.computed == 8
    assert sorted((f.label, f.reason) for f in outcome.failed) == [("A2.0", error), ("B0.3", error)]


def test_failed_case_is_stored_told_and_tried_again(faulty, config):
    broken = sweep(faulty(**{"A1.0": "case"}), config())
    (failure,) = broken.failed
    assert (failure.label, failure.reason, failure.cases) == ("A1.0", "it diverged", 1)
    assert (broken.computed, broken.reused) == (11, 0)
    assert list(broken.run.cases()["status"]).count("failed") == 1
    mended = sweep(faulty(), config())
    assert (mended.computed, mended.reused, mended.failed) == (2, 10, [])
    assert set(mended.run.cases()["status"]) == {"ok"}


def test_failure_without_a_reason_is_told(faulty, config):
    (failure,) = sweep(faulty(**{"A1.0": "unexplained"}), config()).failed
    assert (failure.reason, failure.cases) == ("no reason given", 2)


@pytest.mark.parametrize("fault", ["raise", "cases"])
def test_nothing_succeeds(faulty, config, fault):
    outcome = sweep(faulty(**{"A1.0": fault, "B1.0": fault}), config(level=[1.0]))
    assert [failure.label for failure in outcome.failed] == ["A1.0", "B1.0"]
    assert [failure.cases for failure in outcome.failed] == [2, 2]
    assert outcome.computed == 0
    if fault == "raise":
        with pytest.raises(InputError, match=r"all 2 blocks are missing"):
            outcome.run.cases()
    else:
        assert len(outcome.run.cases()) == 4
    with pytest.raises(InputError, match=r"^summary: .* it has none yet"):
        outcome.run.summary()


@pytest.mark.parametrize("scheme", [pytest.param("A", marks=pytest.mark.faults), "B"])
def test_whoever_kills_its_worker_fails_alone(faulty, config, scheme):
    c = config(workers=2, backend="loky", level=[1.0, 2.0])
    broken = sweep(faulty(**{f"{scheme}1.0": "kill"}), c)
    (failure,) = broken.failed
    assert failure.label == f"{scheme}1.0"
    assert "TerminatedWorkerError" in failure.reason
    assert broken.computed + broken.reused == 6
    mended = sweep(faulty(), c)
    assert (mended.reused, mended.computed, mended.failed) == (6, 2, [])


@pytest.mark.parametrize("workers", [1, 2])
def test_interrupt_propagates_and_keeps_what_is_done(faulty, config, workers, caplog):
    caplog.set_level(logging.INFO, "owtsweep")
    with pytest.raises(KeyboardInterrupt):
        sweep(faulty(**{"B0.3": "interrupt"}), config(workers=workers))
    assert "interrupted: " in caplog.text
    resumed = sweep(faulty(), config())
    assert resumed.computed + resumed.reused == 12
    assert resumed.reused >= (10 if workers == 1 else 2)


class FailsToReport(Progress):
    def advance(self, cases):
        raise OSError("the terminal is gone")


@pytest.mark.parametrize(
    ("fault", "progress", "error"),
    [("interrupt", None, KeyboardInterrupt), ("raise", FailsToReport(), OSError)],
)
def test_threads_stop_after_the_block_they_are_at(faulty, config, fault, progress, error):
    schemes = [*"ABCDEFGHIJKL"]
    c = config(level=[1.0, 2.0], workers=2, schemes=schemes)
    study = faulty(**{"B1.0": fault}, **{f"{scheme}2.0": "slow" for scheme in schemes})
    with pytest.raises(error):
        sweep(study, c, progress=progress)
    shards_of = Run(run_folder(c), c, study).store.cases
    at_once = len(list(shards_of.glob("part-*")))
    time.sleep(0.5)
    later = len(list(shards_of.glob("part-*")))
    assert 1 <= at_once <= later <= at_once + 2  # one block of each thread


def test_run_log_holds_times_and_is_let_go(study, config, caplog):
    caplog.set_level(logging.WARNING, "owtsweep")
    logger = logging.getLogger("owtsweep")
    before = (list(logger.handlers), logger.level)
    outcome = sweep(study, config())
    assert (logger.handlers, logger.level) == before
    sweep(study, config())
    lines = (outcome.run.folder / "run.log").read_text().splitlines()
    assert len(lines) == 4
    assert "INFO 12 cases, 12 of them stored already" in lines[2]
    assert pd.Timestamp(lines[0].split()[0]).tz is not None


def test_unwritable_results_are_refused_before_anything_is_written(study, config, tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match=r"^results: .*file.* cannot be written"):
        sweep(study, config(results=tmp_path / "file" / "below"))
    with pytest.raises(InputError, match=r"^grid: it holds no case"):
        sweep(study, config(level=[]))
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_folder_that_refuses_files_is_left_as_it_was(study, config, tmp_path, monkeypatch):
    def refuse(**options):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(tempfile, "TemporaryFile", refuse)
    with pytest.raises(InputError, match=r"^results: .* \(Read-only file system\)"):
        sweep(study, config())
    assert list(tmp_path.iterdir()) == []


def test_block_that_appeared_meanwhile_is_reused(study, config):
    """Two sweeps on one folder: the second has stored what the first is about to compute."""
    c = config(level=[1.0, 2.0])

    class StoresAll(Progress):
        def start(self, total, reused):
            assert reused == 0
            sweep(study, c)

    first = sweep(study, c, progress=StoresAll())
    assert (first.computed, first.reused, first.failed) == (0, 8, [])


def test_what_a_backend_loses_is_looked_for_and_run_again(study, config, monkeypatch):
    every = Executor._run_round
    rounds = []

    def losing_two(self, tasks, numbers, *arguments):
        rounds.append(len(numbers))
        results = every(self, tasks, numbers, *arguments)
        if len(rounds) == 1:
            next(results)  # its shards are stored
            for key in tasks[next(results).task]:  # and these are not
                self.work.store.path(key).unlink()
        yield from results

    monkeypatch.setattr(Executor, "_run_round", losing_two)
    outcome = sweep(study, config())
    assert rounds == [3, 1, 1]
    assert (outcome.computed, outcome.failed) == (12, [])


def test_a_block_that_never_answers_fails(study, config, monkeypatch):
    monkeypatch.setattr(Executor, "_run_round", lambda *arguments: iter(()))
    outcome = sweep(study, config())
    assert {failure.reason for failure in outcome.failed} == {"its worker gave no answer"}
    assert (outcome.computed, sum(failure.cases for failure in outcome.failed)) == (0, 12)


def test_missing_extra_is_told_before_anything_is_written(study, config, tmp_path, monkeypatch):
    from owtsweep.sweep import run as module

    monkeypatch.setattr(module, "find_spec", lambda name: None)
    c = config(backend="dask", scheduler="tcp://127.0.0.1:9")
    with pytest.raises(
        InputError, match=r"^compute.backend: dask .*pip install 'owtsweep\[dask\]'"
    ):
        sweep(study, c)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("backend", "scheduler", "says"),
    [
        ("dask", None, "compute.scheduler: compute.backend=dask needs an address; give tcp://"),
        ("loky", "tcp://a:1", "compute.scheduler: 'tcp://a:1' needs compute.backend=dask"),
        ("dask", "a:1", "compute.scheduler: 'a:1' is no address"),
        ("dask", "tcp://a", "compute.scheduler: 'tcp://a' is no address"),
        ("dusk", None, "compute.backend: 'dusk' is none of"),
    ],
)
def test_bad_scheduler_is_one_line(config, backend, scheduler, says):
    with pytest.raises(InputError) as caught:
        config(backend=backend, scheduler=scheduler).check()
    assert str(caught.value).startswith(says)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "address", ["tcp://10.0.0.7:8786", "tls://node-1.site:80", "tcp://[::1]:1"]
)
def test_good_scheduler(config, address):
    config(backend="dask", scheduler=address).check()


def test_failures_are_grouped_by_reason():
    failures = [Setback(f"block {i}", "it diverged", 2) for i in range(200)]
    failures += [Setback(f"other {i}", f"reason {i:02}", 1) for i in range(20)]
    lines = setback_lines("failed", failures)
    assert lines[0] == ("failed: 400 cases: it diverged: block 0; block 1; block 2 and 197 more")
    assert lines[1] == "failed: 1 case: reason 00: other 0"
    assert lines[-1] == "failed: 11 more reasons: see run.log"
    assert len(lines) == 11


def test_a_backend_that_is_none_is_told(study, config, monkeypatch):
    monkeypatch.setattr(type(study), "backend", lambda self, config: "threads")
    with pytest.raises(InputError, match=r"^study dummy: its backend is 'threads'; a study says"):
        sweep(study, config())


@pytest.mark.parametrize("name", ["run.log", "manifest.json"])
def test_a_pipe_in_place_of_a_file_is_refused(study, config, name):
    run = sweep(study, config()).run
    (run.folder / name).unlink()
    os.mkfifo(run.folder / name)
    with pytest.raises(InputError, match=f"{name}: this is a pipe or a device where a file"):
        sweep(study, config())


@pytest.mark.parametrize("name", ["means.csv", "summary.csv", "other.csv"])
def test_a_folder_in_place_of_a_table_is_refused_before_anything_is_written(study, config, name):
    folder = run_folder(config())
    (folder / name).mkdir(parents=True)
    with pytest.raises(InputError, match=f"{name}: this is a folder where a file belongs; move"):
        sweep(study, config())
    assert [path.name for path in folder.iterdir()] == [name]


def test_a_csv_file_of_the_users_own_in_the_run_folder_stops_no_sweep(study, config):
    (sweep(study, config()).run.folder / "notes.csv").write_text("a,b\n1\n")
    again = sweep(study, config())
    assert again.results[""].tables
    assert not again.failed
