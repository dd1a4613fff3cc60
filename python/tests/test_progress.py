"""Progress, cancelling, interrupts and other threads."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path
from typing import Any, Callable

import numpy as np
import osculate
import pytest
from conftest import FIXTURES, Arrays, torus
from osculate import _native


@pytest.fixture(scope="module")
def rough() -> Arrays:
    """Noise makes the windows large, and the run long: more than a second of the processor."""
    vertices, faces = torus(320, 160)
    return vertices + np.random.default_rng(1).normal(0, 0.005, vertices.shape), faces


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


class Enough(Exception):
    """Cancels."""


def processor_seconds(work: Callable[[], object]) -> float:
    """Of all threads; unlike those of the clock they are the same whatever else runs."""
    started = time.process_time()
    work()
    return time.process_time() - started


def test_what_the_callback_raises_cancels(rough: Arrays, tmp_path: Path) -> None:
    def progress(stage: str, done: int, total: int) -> None:
        if stage == "estimate":
            raise Enough

    def cancelled() -> None:
        with pytest.raises(Enough):
            osculate.annotate(*rough, progress=progress)

    assert processor_seconds(cancelled) < 0.8 * processor_seconds(lambda: osculate.annotate(*rough))
    source = tmp_path / "rough.ply"
    osculate.bridges.meshio.mesh(osculate.Mesh(*rough)).write(source)
    with pytest.raises(Enough):
        osculate.convert(source, tmp_path / "out.glb", progress=progress)
    assert [path.name for path in tmp_path.iterdir()] == ["rough.ply"]
    # Nothing is left that would hinder the next call.
    osculate.convert(FIXTURES / "suzanne.stl", tmp_path / "out.glb")


def test_traces_sections_and_writing_tell_and_are_cancelled(tmp_path: Path) -> None:
    told: list[tuple[str, int, int]] = []

    def listen(*news: Any) -> None:
        told.append(news)

    def stop(*news: Any) -> None:
        raise Enough

    mesh = osculate.Mesh(*torus(300, 150))
    curvature = mesh.annotate()
    mesh.trace(seeds=40, steps=20, progress=listen)
    mesh.section((0, 0, 1, 0), progress=listen)
    mesh.write(tmp_path / "out.glb", curvature, progress=listen)
    last = {stage: (done, total) for stage, done, total in told}
    assert list(last) == ["trace", "cut", "write"] and all(done == total for done, total in last.values())
    assert last["trace"] == (40, 40) and last["cut"] == (len(mesh), len(mesh))

    # Cancelled within a trace: there is one only.
    def trace(progress: Any) -> None:
        assert mesh.trace(face=7, steps=20_000, progress=progress)[0].end == "steps"

    def cancelled() -> None:
        with pytest.raises(Enough):
            trace(stop)

    assert processor_seconds(cancelled) < 0.5 * processor_seconds(lambda: trace(None))
    for call in (
        lambda: mesh.section((0, 0, 1, 0), progress=stop),
        lambda: mesh.write(tmp_path / "no.glb", curvature, progress=stop),
    ):
        with pytest.raises(Enough):
            call()
    # Written in less time than it takes to look up, or not at all.
    assert {path.read_bytes() for path in tmp_path.iterdir()} == {(tmp_path / "out.glb").read_bytes()}


@pytest.mark.skipif(sys.platform == "win32", reason="no such signal")
def test_an_interrupt_ends_a_file_of_a_batch(rough: Arrays, tmp_path: Path) -> None:
    source = tmp_path / "rough.ply"
    osculate.bridges.meshio.mesh(osculate.Mesh(*rough)).write(source)
    # Walks so long that on any machine the interrupt comes first.
    batch = _native.Batch([("threads", ["1"]), ("estimator", ["osculating"]), ("radius_factor", ["100"])])
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            batch.annotate(source, tmp_path / "out.glb")
    finally:
        signal.signal(signal.SIGINT, before)
    assert [path.name for path in tmp_path.iterdir()] == ["rough.ply"]


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
    # Were they kept waiting, there would be one or two.
    assert turns > 5


def test_an_interrupt_ends_the_call() -> None:
    script = """
        import os, signal, sys, time, numpy as np, osculate
        sys.path.insert(0, "{tests}")
        from conftest import torus
        vertices, faces = torus(900, 450)
        vertices = vertices + np.random.default_rng(1).normal(0, 0.002, vertices.shape)
        # Started in the background, a process ignores it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        begun, told = time.process_time(), []
        def progress(stage, done, total):
            if done and not told:
                told.append((done / total, time.process_time() - begun))
                os.kill(os.getpid(), signal.SIGINT)
        try:
            osculate.annotate(vertices, faces, progress=progress)
        except KeyboardInterrupt:
            share, before = told[0]
            after = time.process_time() - begun - before
            print("interrupted", share, before / share, after)
    """
    script = textwrap.dedent(script).replace("{tests}", str(Path(__file__).parent))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=600, check=True)
    what, *numbers = done.stdout.split()
    share, whole, after = map(float, numbers)
    # Of the work that was left, next to nothing was done.
    assert what == "interrupted" and share < 0.5 and after < 0.2 * whole


def _in_child(arrays: Arrays) -> float:
    return float(osculate.annotate(*arrays).k_max.sum())


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
def test_forked_processes_work(ring: Arrays) -> None:
    expected = _in_child(ring)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(_in_child, [ring] * 4).get(timeout=60) == [expected] * 4
