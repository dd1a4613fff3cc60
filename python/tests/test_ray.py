"""Many files on Ray with two local workers: what comes out, what is told, and what is left after a kill."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any, Callable, Iterator

import pytest

pytest.importorskip("ray", reason="needs osculate[ray]")
import fsspec
import pyarrow.fs as pafs
import pyarrow.parquet as pq
import ray

from osculate._native import Batch
from osculate.ray import annotate_dataset
from osculate.ray import _find, _stage, _work
from osculate.ray._log import LOG, RECORDS, Log
from osculate.ray._marks import Marks
from osculate.ray._store import Store, locate

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
Row = dict[str, Any]


def lethal_files() -> None:
    """Set up in every worker: files of this name kill it, as a mesh too large for the memory does."""
    from osculate.ray import _work

    annotate = _work._annotate

    def dies(work: Any, job: Any, contents: Any) -> Any:
        if job.input.endswith("lethal.stl"):
            os.kill(os.getpid(), signal.SIGKILL)
        return annotate(work, job, contents)

    _work._annotate = dies


@pytest.fixture(scope="module", autouse=True)
def two_workers() -> Iterator[None]:
    # Workers cannot import a test.
    ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])
    hook = {"worker_process_setup_hook": lethal_files}
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, runtime_env=hook)
    yield
    ray.shutdown()


def tree(folder: Path, files: dict[str, str]) -> Path:
    """A folder with fixtures under these names."""
    for name, of in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(FIXTURES / of, folder / name)
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """All outputs below a folder, also while they are written."""
    found = {}
    for path in folder.rglob("*"):
        name = str(path.relative_to(folder))
        try:
            if path.is_file() and not name.startswith("osculate-batch."):
                found[name] = path.read_bytes()
        except FileNotFoundError:
            # Put in its place this moment.
            continue
    return found


def rows(dataset: Any) -> dict[str, Row]:
    """The records by output, or by input where there is none."""
    return {row["output"] or row["input"]: row for row in dataset.take_all()}


def batch(*arguments: Any) -> int:
    command = [sys.executable, "-m", "osculate", "batch", *map(str, arguments), "-q"]
    return subprocess.run(command, check=False, stderr=subprocess.DEVNULL).returncode


def lines(out: Path) -> list[Row]:
    return [json.loads(line) for line in (out / LOG).read_text().splitlines()]


MIXED = {
    "part.stl": "fillet_part.stl",
    "sub/head.ply": "suzanne.ply",
    "sub/scene.gltf": "two_meshes.gltf",
    "sub/two_meshes.bin": "two_meshes.bin",
    "worn.stl": "fillet_degenerate.stl",
}


def test_it_writes_and_tells_what_osculate_batch_does(tmp_path: Path) -> None:
    source = tree(tmp_path / "in", MIXED)
    (source / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")
    settings: Row = {"format": "glb", "color_by": "gauss", "stats": True}
    found = rows(annotate_dataset([source, source / "none.stl"], tmp_path / "ray", **settings))
    assert batch(source, source / "none.stl", "-o", tmp_path / "batch", "--color-by", "gauss", "--stats") == 1

    written, expected = contents(tmp_path / "ray"), contents(tmp_path / "batch")
    assert written.keys() == expected.keys() and len(written) == 8
    assert all(written[name] == expected[name] for name in written if name.endswith(".glb"))
    told = {row["output"] or row["input"]: row for row in lines(tmp_path / "batch")}
    assert found.keys() == told.keys()
    for name, row in found.items():
        same = ["input", "output", "status", "counts", "settings", "input_bytes", "input_modified"]
        assert {key: row[key] for key in same} == {key: told[name][key] for key in same}, name
        assert row["status"] == "failed" or row["message"] == told[name]["message"]
    assert (
        found["worn.glb"]["status"] == "defects" and found["worn.glb"]["faces"] == told["worn.glb"]["counts"]["faces"]
    )
    assert "8 faces without area" in found["worn.glb"]["message"] and found["worn.glb"]["defects"]
    assert found["part.glb"]["status"] == "done" and found["part.glb"]["defects"] == []
    assert "line 2" in found["broken.glb"]["message"] and found["broken.glb"]["attempts"] == 1
    assert "no such file" in found[str(source / "none.stl")]["message"]

    table = pq.read_table(tmp_path / "ray" / RECORDS)
    assert table.to_pylist() == sorted(found.values(), key=lambda row: row["input"])
    assert sorted(os.listdir(tmp_path / "ray")) == sorted(
        ["osculate-batch.jsonl", RECORDS, "part.glb", "part.stats.json", "sub", "worn.glb", "worn.stats.json"]
    )


def statuses(source: Path, out: Path, **settings: Any) -> dict[str, str]:
    return {name: row["status"] for name, row in rows(annotate_dataset(source, out, resume=True, **settings)).items()}


def test_resume_does_what_is_missing_changed_or_made_otherwise(tmp_path: Path) -> None:
    source = tree(tmp_path / "in", {"a.stl": "suzanne.stl", "b.ply": "suzanne.ply", "c.off": "sphere.off"})
    out = tmp_path / "out"
    everything = dict.fromkeys(["a.glb", "b.glb", "c.glb"], "done")
    nothing = dict.fromkeys(everything, "skipped")
    assert statuses(source, out) == everything
    assert statuses(source, out) == nothing
    (out / "b.glb").unlink()
    assert statuses(source, out) == {**nothing, "b.glb": "done"}
    shutil.copy(FIXTURES / "fillet_part.stl", source / "a.stl")
    assert statuses(source, out) == {**nothing, "a.glb": "done"}
    os.utime(source / "c.off", (1e9, 1e9))
    assert statuses(source, out) == {**nothing, "c.glb": "done"}
    assert statuses(source, out, color_by="k_max") == everything
    assert statuses(source, out, color_by="k_max", edges=True) == everything
    (out / "a.edges.glb").unlink()
    skipped = rows(annotate_dataset(source, out, resume=True, color_by="k_max", edges=True))
    assert {name: row["status"] for name, row in skipped.items()} == {**nothing, "a.glb": "done"}
    assert skipped["b.glb"]["faces"] == 968 and skipped["b.glb"]["counts"]["vertices"] > 0
    # Without it all is done again, and the log begins anew.
    assert len(lines(out)) > 3
    assert {row["status"] for row in rows(annotate_dataset(source, out)).values()} == {"done"}
    assert len(lines(out)) == 3


def test_batch_and_ray_go_on_where_the_other_has_stopped(tmp_path: Path) -> None:
    source = tree(tmp_path / "in", {"a.stl": "suzanne.stl", "worn.stl": "fillet_degenerate.stl"})
    out = tmp_path / "out"
    assert batch(source, "-o", out, "--unit", "mm") == 3
    taken = rows(annotate_dataset(source, out, resume=True, unit="mm"))
    assert {row["status"] for row in taken.values()} == {"skipped"}
    assert "8 faces without area" in taken["worn.glb"]["message"]
    tree(source, {"new.ply": "suzanne.ply"})
    assert statuses(source, out, unit="mm")["new.glb"] == "done"
    before = (out / LOG).read_text()
    assert batch(source, "-o", out, "--unit", "mm", "--resume") == 3
    assert (out / LOG).read_text() == before, "batch has found nothing to do"


def worker_ids() -> list[int]:
    """Workers of this very Ray, and no other on the machine, that annotate files at this moment."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if path.read_bytes().startswith(b"ray::MapBatches(annotate)") and is_ours(path.parent):
                found.append(int(path.parent.name))
        except OSError:
            continue
    return found


def is_ours(process: Path) -> bool:
    """Whether this process has started it, or started what started it."""
    while process.name not in ("0", "1"):
        parent = (process / "stat").read_text().rpartition(")")[2].split()[1]
        if parent == str(os.getpid()):
            return True
        process = process.parent / parent
    return False


def kill_one(is_time: Callable[[], bool]) -> threading.Thread:
    """Kills a worker as soon as it is time."""

    def run() -> None:
        deadline = time.monotonic() + 300
        while time.monotonic() < deadline:
            if is_time() and (found := worker_ids()):
                os.kill(found[0], signal.SIGKILL)
                killed.append(found[0])
                return
            time.sleep(0.002)

    killed: list[int] = []
    thread = threading.Thread(target=run)
    thread.killed = killed  # type: ignore[attr-defined]
    thread.start()
    return thread


def many(folder: Path, count: int) -> Path:
    folder.mkdir()
    for i in range(count):
        (folder / str(i % 7)).mkdir(exist_ok=True)
        shutil.copy(FIXTURES / "suzanne.stl", folder / str(i % 7) / f"{i}.stl")
    return folder


def test_a_killed_worker_costs_nothing(tmp_path: Path) -> None:
    source = many(tmp_path / "in", 120)
    assert batch(source, "-o", tmp_path / "whole", "--format", "gltf") == 0
    whole, out = contents(tmp_path / "whole"), tmp_path / "out"
    half_written: list[str] = []

    def in_the_middle() -> bool:
        there = contents(out) if out.exists() else {}
        half_written.extend(
            name for name, content in there.items() if ".osculate-" not in name and whole[name] != content
        )
        return len(there) > 60

    killer = kill_one(in_the_middle)
    found = annotate_dataset(source, out, format="gltf", files_per_task=10).take_all()
    killer.join()
    assert killer.killed, "nobody was killed"  # type: ignore[attr-defined]
    assert len(found) == 120 and {row["status"] for row in found} == {"done"}, "nothing is lost, nothing is there twice"
    assert len({row["output"] for row in found}) == 120
    assert sorted(row["output"] for row in lines(out)) == sorted(row["output"] for row in found)
    assert not half_written
    assert contents(out) == whole, "nothing is left over"
    assert not (out / "osculate-batch.marks").exists()
    assert {row["status"] for row in annotate_dataset(source, out, format="gltf", resume=True).take_all()} == {
        "skipped"
    }


def test_a_file_that_kills_its_workers_is_given_up_and_no_other(tmp_path: Path) -> None:
    source = many(tmp_path / "in", 12)
    shutil.copy(FIXTURES / "suzanne.stl", source / "3" / "lethal.stl")
    found = rows(annotate_dataset(source, tmp_path / "out", retries=1))
    assert found["3/lethal.glb"]["status"] == "failed" and "the worker died" in found["3/lethal.glb"]["message"]
    assert found["3/lethal.glb"]["attempts"] == 2
    assert len(found) == 13 and sum(row["status"] == "done" for row in found.values()) == 12
    assert len(contents(tmp_path / "out")) == 12


DRIVER = """
import sys, ray
ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
import osculate.ray
osculate.ray.annotate_dataset(sys.argv[1], sys.argv[2], files_per_task=4)
"""


def test_after_a_killed_driver_batch_goes_on(tmp_path: Path) -> None:
    source, out = many(tmp_path / "in", 200), tmp_path / "out"
    environment = {name: value for name, value in os.environ.items() if not name.startswith("RAY_")}
    driver = subprocess.Popen(
        [sys.executable, "-c", DRIVER, source, out],
        env=environment,
        stderr=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )
    deadline = time.monotonic() + 120
    while not (out / LOG).exists() or len((out / LOG).read_bytes().splitlines()) < 20:
        assert driver.poll() is None and time.monotonic() < deadline, "it does not get on"
        time.sleep(0.005)
    driver.kill()
    driver.wait()
    # Its workers go with it; until then their files are not abandoned.
    while subprocess.run(["fuser", "-s", *map(str, out.rglob("*.part"))], check=False).returncode == 0:
        time.sleep(0.1)
    done = len(lines(out))
    assert 20 <= done < 200
    assert batch(source, "-o", out, "--resume") == 0
    assert len(lines(out)) == 200 and len({row["output"] for row in lines(out)}) == 200
    assert len(contents(out)) == 200


def test_what_may_pass_is_tried_again_and_what_may_not_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_work, "_FIRST_PAUSE", 0.01)
    source = tree(tmp_path / "in", {"a.stl": "suzanne.stl"})
    store, folder = locate("memory://again")
    asked = []

    class Weak(Store):
        def put_file(self, path: str, local: Path) -> None:
            asked.append(path)
            if len(asked) < 3:
                raise TimeoutError("the line is dead")
            super().put_file(path, local)

    target = Weak(store._fs, "memory://")
    target.is_private = False
    job = _find.Job(str(source / "a.stl"), "a.glb", 1, 1.0)
    work = _work.Work(locate(source)[0], target, folder, Marks(target, "/marks"), '[["threads", ["1"]]]', retries=2)
    record, _ = _work._annotate(work, job, None)
    assert (record["status"], record["attempts"], len(asked)) == ("done", 3, 3)
    asked.clear()
    record, _ = _work._annotate(_work.Work(**{**vars(work), "retries": 1}), job, None)
    assert (record["status"], record["attempts"]) == ("failed", 2) and "the line is dead" in record["message"]
    gone = _find.Job(str(source / "none.stl"), "none.glb", 1, 1.0)
    record, _ = _work._annotate(work, gone, None)
    assert (record["status"], record["attempts"]) == ("failed", 1) and str(source / "none.stl") in record["message"]


def test_files_in_the_memory_of_the_driver(tmp_path: Path) -> None:
    memory = fsspec.filesystem("memory")
    memory.put(str(tree(tmp_path / "in", MIXED)), "/scans", recursive=True)
    found = rows(annotate_dataset("memory://scans", "memory://annotated", format="gltf"))
    assert {row["status"] for row in found.values()} == {"done", "defects"} and len(found) == 4
    assert batch(tmp_path / "in", "-o", tmp_path / "out", "--format", "gltf") == 3
    expected = contents(tmp_path / "out")
    written = {name.removeprefix("/annotated/"): memory.cat_file(name) for name in memory.find("/annotated")}
    assert {name: content for name, content in written.items() if "osculate-batch" not in name} == expected
    assert found["sub/scene.gltf"]["input"] == "memory:///scans/sub/scene.gltf"
    again = rows(annotate_dataset("memory://scans", "memory://annotated", format="gltf", resume=True))
    assert {row["status"] for row in again.values()} == {"skipped"}
    memory.rm("/scans", recursive=True)
    memory.rm("/annotated", recursive=True)


@pytest.fixture(scope="module")
def s3() -> Iterator[str]:
    """The address of a server that speaks S3."""
    moto = pytest.importorskip("moto.server")
    server = moto.ThreadedMotoServer(port=0)
    server.start()
    host, port = server.get_host_and_port()
    keys = {"AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test", "AWS_DEFAULT_REGION": "eu-west-1"}
    with pytest.MonkeyPatch.context() as patch:
        for name, value in keys.items():
            patch.setenv(name, value)
        yield f"http://{host}:{port}"
    server.stop()


def s3_of(kind: str, address: str) -> tuple[Any, Any]:
    import s3fs

    at = {"endpoint_url": address, "client_kwargs": {"region_name": "eu-west-1"}, "key": "test", "secret": "test"}
    filesystem = s3fs.S3FileSystem(**at, skip_instance_cache=True)
    if kind == "fsspec":
        return filesystem, filesystem
    own = pafs.S3FileSystem(access_key="test", secret_key="test", endpoint_override=address, region="eu-west-1")
    return filesystem, own


@pytest.mark.parametrize("kind", ["pyarrow", "fsspec"])
def test_an_object_store(tmp_path: Path, s3: str, kind: str) -> None:
    client, filesystem = s3_of(kind, s3)
    client.mkdir(kind)
    local = tree(tmp_path / "in", MIXED)
    client.put(str(local), f"{kind}/scans", recursive=True)
    client.pipe_file(f"{kind}/scans/broken.obj", b"v 0 0 0\nf 1 2 3\n")
    before = set(client.find(kind))

    def run(**more: Any) -> dict[str, Row]:
        inputs, out = f"s3://{kind}/scans/**/*.[!b]*", f"s3://{kind}/annotated"
        return rows(annotate_dataset(inputs, out, format="gltf", filesystem=filesystem, **more))

    found = run()
    broken = found["broken.gltf"]
    assert broken["status"] == "failed" and broken["message"].startswith(f"s3://{kind}/scans/broken.obj: line 2")
    others = {name: row["status"] for name, row in found.items() if name != "broken.gltf"}
    assert others == {"part.gltf": "done", "sub/head.gltf": "done", "sub/scene.gltf": "done", "worn.gltf": "defects"}
    client.invalidate_cache()
    written = {
        name.removeprefix(f"{kind}/annotated/"): client.cat_file(name) for name in set(client.find(kind)) - before
    }
    assert batch(local, "-o", tmp_path / "out", "--format", "gltf") == 3
    expected = contents(tmp_path / "out")
    # pyarrow makes an empty object for the folder.
    written.pop("", None)
    assert {name: written[name] for name in written if "osculate-batch" not in name} == expected
    assert sorted(name for name in written if "osculate-batch" in name) == sorted([LOG, RECORDS])
    again = {name: row["status"] for name, row in run(resume=True).items() if name in others}
    assert set(again.values()) == {"skipped"}
    assert client.size(f"{kind}/annotated/{RECORDS}") > 0


def test_names_that_a_gltf_gives_are_found_and_no_others(tmp_path: Path) -> None:
    document = {
        "buffers": [{"uri": "a%20b.bin"}, {"uri": "data:,x"}, {"uri": "../up.bin"}, {"uri": "sub/../c.bin"}, {}],
        "images": [{"uri": "sub/d.png"}, {"uri": "https://e/f.png"}, {"uri": "/etc/passwd"}, {"uri": 7}, "g"],
    }
    text = json.dumps(document).encode()
    chunk = text + b" " * (-len(text) % 4)
    glb = (
        b"glTF"
        + (2).to_bytes(4, "little")
        + (20 + len(chunk)).to_bytes(4, "little")
        + len(chunk).to_bytes(4, "little")
        + b"JSON"
        + chunk
    )
    import gzip
    import io

    for content in (text, b"\xef\xbb\xbf \n" + text, glb, gzip.compress(text), gzip.compress(glb)):
        assert _stage.named_files(io.BytesIO(content)) == ["a b.bin", "c.bin", "sub/d.png"]
    for content in (b"", b"{", b"[1]", b"\x1f\x8b", b"glTF", b"solid x", b"{" * 100000, b'{"buffers": 3}', glb[:30]):
        assert _stage.named_files(io.BytesIO(content)) == []


def test_outputs_are_named_as_batch_names_them(tmp_path: Path) -> None:
    names = [
        "s/a.stl",
        "s/a.obj",
        "s/x/b.obj.gz",
        "s/x/y/c.d.PLY",
        "s/x/note.txt",
        "s/.trash/d.stl",
        "s/._a.stl",
        "s/[1].stl",
    ]
    tree(tmp_path, dict.fromkeys(names, "suzanne.stl"))
    out = tmp_path / "out"
    (tmp_path / "s/x/loop").symlink_to(tmp_path / "s")
    memory = fsspec.filesystem("memory")
    memory.put(str(tmp_path / "s"), "/named/s", recursive=True)
    for arguments in (
        ["s"],
        ["s", "s/a.stl", "s/x"],
        ["s/x/y"],
        ["s/x/y/c.d.PLY", "s/a.stl"],
        ["s/**/*.stl"],
        ["s/*/b.*"],
        ["s/x/*/?.*"],
        ["s/[1].stl"],
        ["s/[!b-z].stl"],
        ["s/*.off"],
        ["s/none.stl"],
    ):
        paths = [tmp_path / argument for argument in arguments]
        shutil.rmtree(out, ignore_errors=True)
        batch(*paths, "-o", out)
        expected = {(row["output"], row["status"] != "failed") for row in lines(out)}
        shutil.rmtree(out)
        store = locate(tmp_path)[0]
        found = _find.find(store, [str(path) for path in paths], (store, str(out)), Batch([]), False)
        named = {(job.output, True) for job in found.jobs} | {(None, False) for _ in found.failures}
        assert named == expected, arguments
        # The same tree elsewhere, where patterns are matched here; links are files of their own there.
        other, _ = locate("memory://named")
        same = _find.find(other, [f"/named/{a}" for a in arguments], (other, "/out"), Batch([]), False)
        here, there = ({job.output for job in jobs if "loop" not in job.output} for jobs in (found.jobs, same.jobs))
        assert here == there, arguments
    memory.rm("/named", recursive=True)


def test_what_is_written_beside_an_output_counts_too(tmp_path: Path) -> None:
    source = tree(tmp_path / "in", {"a.stl": "suzanne.stl", "a.edges.stl": "suzanne.stl", "b.stl": "suzanne.stl"})
    store = locate(source)[0]
    for batch_of, count in ((Batch([]), 3), (Batch([("edges", [])]), 1)):
        found = _find.find(store, [str(source)], (store, str(tmp_path / "out")), batch_of, False)
        assert len(found.jobs) == count, [failure.message for failure in found.failures]


def test_what_makes_no_sense_is_told_before_anything_is_written(tmp_path: Path) -> None:
    source, out = tree(tmp_path / "in", {"a.stl": "suzanne.stl"}), tmp_path / "out"
    (tmp_path / "empty").mkdir()
    nonsense: list[tuple[Any, Row, str]] = [
        (source, {"estimator": "best"}, "estimator"),
        (source, {"radiu": 1}, "radiu"),
        (source, {"radius": -1}, "radius"),
        (source, {"retries": -1}, "retries"),
        (source, {"threads": 0}, "threads"),
        ([], {}, "paths is empty"),
        ("-", {}, "standard input"),
        ([source, "memory://x"], {}, "several file systems"),
        (tmp_path / "empty", {}, "no mesh files in"),
    ]
    for paths, settings, told in nonsense:
        with pytest.raises(ValueError, match=told):
            annotate_dataset(paths, out, **settings)
        assert not out.exists()
    with pytest.raises(ValueError, match="output folder too"):
        annotate_dataset(source, source)
    out.mkdir()
    with Log(locate(out)[0], str(out), False):
        with pytest.raises(BlockingIOError, match="another batch is writing"):
            annotate_dataset(source, out)
    clash = rows(annotate_dataset(tree(source, {"a.obj": "suzanne.obj"}), out))
    assert {row["status"] for row in clash.values()} == {"failed"} and not contents(out)


def test_without_ray_the_import_says_what_to_install() -> None:
    program = (
        "import sys; sys.modules['ray'] = None\ntry:\n    import osculate.ray\nexcept ImportError as e:\n    print(e)"
    )
    told = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout
    assert "pip install 'osculate[ray]'" in told
