"""Logs, leases and tasks of runs on Ray, without workers."""

from __future__ import annotations

import posixpath
import threading
from typing import Any

import pytest

pytest.importorskip("ray", reason="needs osculate[ray]")

from osculate import BusyError
from osculate.ray import _dataset, _find, _lease
from osculate.ray._log import LOG, PARTS, Log
from osculate.ray._store import Store, locate


def test_a_log_on_an_object_store_survives_its_driver() -> None:
    store, folder = locate("memory://logged")
    record = {
        "input": "a",
        "output": "a.glb",
        "status": "failed",
        "message": None,
        "seconds": 1.0,
        "counts": None,
        "settings": "0",
        "input_bytes": 1,
        "input_modified": 2.5,
    }
    for status in ("failed", "done"):
        log = Log(store, folder, True)
        log.add([{**record, "status": status}])
        log._put()  # and is not closed: a killed driver
    store.put(posixpath.join(folder, PARTS, "9-0.jsonl"), b'{"input": "cut sho')
    with Log(store, folder, True) as log:
        assert log.records() == {"a.glb": {**record, "status": "done"}}
    assert [file.path for file in store.files(folder)] == [f"{folder}/{LOG}"], "gathered in one file"
    with Log(store, folder, True) as log:
        assert log.records()["a.glb"]["status"] == "done"
    with Log(store, folder, False) as log:
        assert log.records() == {}


@pytest.fixture
def shared(monkeypatch: pytest.MonkeyPatch) -> Store:
    """A store that other processes would see too, and leases that need little patience."""
    for name, seconds in {"_BEAT": 0.1, "_PATIENCE": 1.0, "_SETTLE": 0.2}.items():
        monkeypatch.setattr(_lease, name, seconds)
    store, _ = locate("memory://shared")
    store.is_private = False
    return store


def test_a_second_run_into_an_object_store_is_refused(shared: Store) -> None:
    with Log(shared, "/shared/refused", False) as log:
        with pytest.raises(BlockingIOError, match="another run is writing to this folder"):
            Log(shared, "/shared/refused", False)
        log.add([])
    assert not list(shared.files("/shared/refused")), "the lease is given back"
    Log(shared, "/shared/refused", False).close()


def test_of_two_runs_that_begin_at_once_one_goes_on(shared: Store) -> None:
    outcomes: list[Any] = []

    def begin() -> None:
        try:
            outcomes.append(_lease.Lease(shared, "/shared/once"))
        except BusyError as error:
            outcomes.append(error)

    threads = [threading.Thread(target=begin) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    held = [outcome for outcome in outcomes if isinstance(outcome, _lease.Lease)]
    assert len(held) == 1 and len(outcomes) == 2
    held[0].check()
    held[0].close()


def test_a_run_that_was_killed_is_followed_and_one_that_slept_ends(shared: Store) -> None:
    sleeper = _lease.Lease(shared, "/shared/slept")
    sleeper._over.set()  # No more beats, as of a process that is killed or asleep.
    sleeper._thread.join()
    with Log(shared, "/shared/slept", True) as log:
        log.add([])
        sleeper._over.clear()
        sleeper._beat()  # It wakes up.
        with pytest.raises(BlockingIOError, match="has taken this folder over"):
            sleeper.check()
        sleeper.close()
        log.add([])
        assert shared.find("/shared/slept/osculate-batch.lease") is not None, "it is the other's"
    assert not list(shared.files("/shared/slept"))


def test_tasks_become_smaller_towards_the_end() -> None:
    def sizes(count: int, most: int, workers: int, size: int = 1 << 20) -> list[int]:
        jobs = [_find.Job(str(i), str(i), size + i if size else 0, None) for i in range(count)]
        tasks = list(_dataset._tasks(jobs, most, 256 << 20, workers))
        assert sorted(int(job.input) for task in tasks for job in task) == list(range(count)), "each once"
        return [len(task) for task in tasks]

    of_many = sizes(1000, 256, 2)
    assert 250 <= of_many[0] <= 256 and max(of_many[-3:]) <= 9 and len(of_many) < 16
    assert of_many == sorted(of_many, reverse=True)
    assert max(sizes(10, 128, 2)) <= 5, "each worker has something to do"
    assert sizes(3, 128, 8) == [1, 1, 1]
    assert set(sizes(5, 128, 2, 1 << 30)) == {1}
    assert max(sizes(100, 7, 2)) == 7
    assert len(sizes(100, 256, 8, 0)) >= 8, "sizes may not be known"
    assert sizes(0, 128, 2) == []
