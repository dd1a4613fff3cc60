"""Progress, cancelling, interrupts and other threads."""

from __future__ import annotations

import multiprocessing
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import numpy as np
import osculate
import pytest
from conftest import FIXTURES, Arrays, torus


@pytest.fixture(scope="module")
def rough() -> Arrays:
    """Noise makes the windows large, and the run long: more than a second on one thread."""
    vertices, faces = torus(160, 80)
    return vertices + np.random.default_rng(1).normal(0, 0.01, vertices.shape), faces


def test_every_stage_is_told_to_its_end(tmp_path: Path) -> None:
    told: list[tuple[str, int, int]] = []
    osculate.convert(FIXTURES / "suzanne.stl", tmp_path / "out.glb", progress=lambda *news: told.append(news))
    last = {stage: (done, total) for stage, done, total in told}
    assert list(last) == ["read", "estimate", "write"]
    assert last["estimate"] == (968, 968) and last["read"][0] == last["read"][1] == 48484
    assert all(done == total for done, total in last.values())


def test_progress_goes_on_in_the_calling_thread(rough: Arrays) -> None:
    told: list[int] = []
    threads = set()

    def progress(stage: str, done: int, total: int) -> None:
        assert stage == "estimate" and total == len(rough[1])
        told.append(done)
        threads.add(threading.get_ident())

    osculate.annotate(*rough, progress=progress)
    assert told == sorted(told) and told[-1] == len(rough[1]) and len(told) > 1
    assert threads == {threading.get_ident()}


def test_what_the_callback_raises_cancels(rough: Arrays, tmp_path: Path) -> None:
    class Enough(Exception):
        pass

    def progress(stage: str, done: int, total: int) -> None:
        if done > 0 and stage == "estimate":
            raise Enough

    started = time.monotonic()
    osculate.annotate(*rough)
    whole = time.monotonic() - started
    started = time.monotonic()
    with pytest.raises(Enough):
        osculate.annotate(*rough, progress=progress)
    assert time.monotonic() - started < 0.8 * whole
    source = tmp_path / "rough.ply"
    osculate.bridges.meshio.mesh(osculate.Mesh(*rough)).write(source)
    with pytest.raises(Enough):
        osculate.convert(source, tmp_path / "out.glb", progress=progress)
    assert [path.name for path in tmp_path.iterdir()] == ["rough.ply"]
    # Nothing is left that would hinder the next call.
    osculate.convert(FIXTURES / "suzanne.stl", tmp_path / "out.glb")


def test_bars_are_shown(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("tqdm")
    osculate.convert(FIXTURES / "suzanne.stl", tmp_path / "out.glb", progress=True)
    shown = capsys.readouterr().err
    assert "estimate: 100%" in shown and "write: 100%" in shown


def test_other_threads_run_meanwhile(rough: Arrays) -> None:
    worker = threading.Thread(target=osculate.annotate, args=rough)
    worker.start()
    turns = 0
    while worker.is_alive():
        turns += 1
        time.sleep(0.001)
    worker.join()
    assert turns > 20


def test_an_interrupt_ends_the_call() -> None:
    script = """
        import sys, time, numpy as np, osculate
        sys.path.insert(0, "{tests}")
        from conftest import torus
        vertices, faces = torus(900, 450)
        vertices = vertices + np.random.default_rng(1).normal(0, 0.002, vertices.shape)
        print("ready", flush=True)
        try:
            osculate.annotate(vertices, faces)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """
    script = textwrap.dedent(script).replace("{tests}", str(Path(__file__).parent))
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        time.sleep(0.7)
        sent = time.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "interrupted\n"
        # Welding and the like are not interrupted; on a busy machine they take some seconds. All takes a minute.
        assert time.monotonic() - sent < 20
        assert process.wait() == 0


def _in_child(arrays: Arrays) -> float:
    return float(osculate.annotate(*arrays).k_max.sum())


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
def test_forked_processes_work(ring: Arrays) -> None:
    expected = _in_child(ring)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(_in_child, [ring] * 4).get(timeout=60) == [expected] * 4
