"""The run as a whole: find, leave out what is done, hand the rest to Ray Data, note what comes back."""

from __future__ import annotations

import json
import logging
import os
import posixpath
import tempfile
import time
import uuid
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Union

import pyarrow as pa
import ray.data
from pyarrow.fs import LocalFileSystem

from .._given import texts
from .._native import remove_abandoned_outputs
from ..errors import UsageError
from . import _work
from ._find import Found, Job, find
from ._log import MARKS, SCHEMA, Log, Record, write_records
from ._marks import Marks
from ._store import Store, is_unfinished, locate
from ._work import Work

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ..settings import BatchSettings

PathLike = Union[str, "os.PathLike[str]"]

# A task ends when it has files of so many bytes, however few they are. From a task's end to the next one's start Ray
# Data, which looks ten times a second, takes 0.12 to 0.2 seconds, in which a worker has nothing to do, so that tasks
# should take seconds; at the end of a run smaller ones have all workers end at about the same time.
_MOST_TASK_BYTES, _LEAST_TASK_BYTES = 256 << 20, 8 << 20
# Files that travel with their task, and outputs with its records, are in memory all at once.
_MOST_TRAVELLING_BYTES = 32 << 20
_logger = logging.getLogger("osculate.ray")


def annotate_dataset(
    paths: PathLike | Sequence[PathLike],
    out: PathLike,
    *,
    resume: bool = False,
    filesystem: Any = None,
    out_filesystem: Any = None,
    storage_options: dict[str, Any] | None = None,
    files_per_task: int = 256,
    retries: int = 2,
    concurrency: int | None = None,
    ray_options: dict[str, Any] | None = None,
    **settings: Unpack[BatchSettings],
) -> ray.data.Dataset:
    """Annotates many mesh files, each on one thread of one of Ray's workers.

    Args:
        paths: Mesh files, folders with all mesh files in and below them, and patterns (``*``, ``?``, ``[ab]``, ``**``
            for any number of folders): local paths or URIs, all of one file system.
        out: The folder to write to, on the same or another file system. It mirrors the tree below the deepest folder
            that holds all inputs, with ``osculate-batch.jsonl``, the log, and ``osculate-batch.parquet``, the
            records of this run.
        resume: Leaves inputs alone whose output is newer and was made with the same settings by the same version, as
            the log tells, whether it was this function or ``osculate batch --resume`` that made it.
        filesystem: A file system of pyarrow or fsspec for ``paths``, and for ``out`` unless ``out_filesystem`` is
            given. By default URIs tell: pyarrow's own for ``s3://``, ``gs://`` and ``hdfs://``, fsspec's for others.
        out_filesystem: One for ``out``.
        storage_options: Given to fsspec, which is then taken for every URI.
        files_per_task: At most so many files are handed to a worker at once; if it dies, they are done again.
        retries: How often a file is tried again after a failure that may pass: a file system that does not answer, or a
            worker that died.
        concurrency: Most workers at a time; by default as many as there are processors in the cluster.
        ray_options: Further arguments of Ray's ``Dataset.map_batches``, such as ``{"memory": 4 << 30}``: the bytes
            that Ray sets aside for each worker.
        **settings: Those of ``osculate batch``: ``format``, ``keep_extension``, ``legend``, ``edges``, ``stats`` and
            all of :func:`osculate.convert`. ``threads`` (1 by default) is also the number of processors that Ray
            reserves for each worker.

    Returns:
        One row per input, in the order of their names: ``input``, ``output`` (relative to ``out``), ``status``,
        ``message``, ``seconds``, ``faces``, ``counts``, ``defects``, ``settings``, ``input_bytes``,
        ``input_modified``, ``attempts``. ``status`` is ``done``, ``defects`` (written, but repaired or with
        defects), ``failed`` or ``skipped`` (done by an earlier run, whose counts and message stand here).

    Raises:
        UsageError: For arguments and settings that make no sense, before anything is written.
        BusyError: While another run writes to the folder.
    """
    start = time.monotonic()
    if retries < 0 or files_per_task < 1:
        raise UsageError("retries must be 0 or more and files_per_task 1 or more")
    given = {**settings, "threads": 1 if settings.get("threads") is None else settings["threads"]}
    text = json.dumps(texts("batch", given))
    batch = _work.batch(text)

    named = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    if not named:
        raise UsageError("paths is empty; name a file, a folder or a pattern")
    if any(os.fspath(path) == "-" for path in named):
        raise UsageError("files are read by their names; standard input is for osculate.convert")
    sources = [locate(path, filesystem, storage_options) for path in named]
    source = sources[0][0]
    if any(other.scheme != source.scheme for other, _ in sources):
        raise UsageError("paths lie on several file systems; make one run for each")
    target, folder = locate(out, out_filesystem or filesystem, storage_options)

    marks = _marks(target, folder)
    work = Work(source, target, folder, marks, text, retries)
    keep_extension = bool(given.get("keep_extension"))
    found = find(source, [path for _, path in sources], (target, folder), batch, keep_extension)
    if target.is_local:
        os.makedirs(folder, exist_ok=True)
    with Log(target, folder, resume) as log:
        _remove_unfinished(target, folder, found.jobs)
        marks.clear()
        before = log.records() if resume else {}
        done = _failures(found, work)
        log.add(done)
        skipped, left = _split(found.jobs, work, before)
        done += skipped
        options = {"num_cpus": int(str(given["threads"])), "concurrency": concurrency, **(ray_options or {})}
        most_bytes = _MOST_TRAVELLING_BYTES if source.is_private or target.is_private else _MOST_TASK_BYTES
        parts = _tasks(left, files_per_task, most_bytes, _workers(options) if left else 1)
        tasks = [work.task(number, jobs) for number, jobs in enumerate(parts)]
        done += _run(work, tasks, log, options)
        _remove_unfinished(target, folder, found.jobs)
        marks.clear()
        table = _table(done)
        path = write_records(target, folder, table)
    counts = Counter(table.column("status").to_pylist())
    told = ", ".join(f"{count} {status}" for status, count in sorted(counts.items()))
    _logger.info("%d files in %.1f s: %s; %s", len(table), time.monotonic() - start, told, target.uri(path))
    return ray.data.from_arrow(table)


def _run(work: Work, tasks: list[pa.Table], log: Log, options: dict[str, Any]) -> list[Record]:
    """Has Ray do the tasks, and gives the records that come back."""
    if not tasks:
        return []
    dataset = ray.data.from_arrow(tasks).map_batches(
        _work.annotate,
        batch_size=None,
        batch_format="pyarrow",
        fn_kwargs={"work": work},
        **options,
    )
    # Records are small: Ray need not set memory aside for more.
    dataset.context.target_max_block_size = 1 << 20
    records: list[Record] = []
    for table in dataset.iter_batches(batch_size=None, batch_format="pyarrow"):
        came = _work.records(table, work)
        log.add(came)
        for record in came:
            if record["status"] == "failed":
                _logger.warning("%s", record["message"])
        records += came
    return records


def _marks(target: Store, folder: str) -> Marks:
    """Marks are among the outputs, or on this machine where the outputs are in this process alone."""
    if target.is_private:
        name = f"osculate-marks-{uuid.uuid4().hex}"
        return Marks(Store(LocalFileSystem()), posixpath.join(tempfile.gettempdir(), name))
    return Marks(target, posixpath.join(folder, MARKS))


def _workers(options: dict[str, Any]) -> int:
    """How many tasks can be done at a time."""
    if not ray.is_initialized():
        ray.init()
    processors = ray.cluster_resources().get("CPU", 1.0) / max(options["num_cpus"] or 0, 1)
    concurrency = options["concurrency"]
    return max(int(min(processors, concurrency) if isinstance(concurrency, int) else processors), 1)


def _tasks(jobs: Iterable[Job], most: int, most_bytes: int, workers: int) -> Iterator[list[Job]]:
    """The jobs of each task, at most so many and of so many bytes. Large files come first, and tasks become smaller
    towards the end: each is two thirds of a worker's share of what is left."""
    # Where a file system does not tell sizes, all count alike.
    sized = sorted(((max(job.bytes, 1), job) for job in jobs), key=lambda pair: -pair[0])
    left = sum(size for size, _ in sized)
    least = min(left // workers, _LEAST_TASK_BYTES)
    task: list[Job] = []
    taken, room = 0, 0
    for size, job in sized:
        if task and (len(task) == most or taken + size > room):
            yield task
            left -= taken
            task, taken = [], 0
        if not task:
            room = min(max(2 * left // (3 * workers), least), most_bytes)
        task.append(job)
        taken += size
    if task:
        yield task


def _failures(found: Found, work: Work) -> list[Record]:
    records = []
    for failure in found.failures:
        message = f"{work.source.uri(failure.input)}: {failure.message}"
        _logger.warning("%s", message)
        records.append(work.record(Job(failure.input, "", 0, 0.0), output=None, message=message))
    return records


def _split(jobs: list[Job], work: Work, before: dict[str, Record]) -> tuple[list[Record], list[Job]]:
    """The records of what is done, and the jobs that are left."""
    skipped: list[Record] = []
    left: list[Job] = []
    times = _times(work.target, work.folder) if before else {}
    batch = _work.batch(work.settings)
    for job in jobs:
        record = before.get(job.output)
        is_done = record is not None and _is_of(record, job, batch.fingerprint)
        if record is not None and is_done and _is_newer(job, batch.files_of(job.output), times):
            skipped.append(work.record(job, status="skipped", message=record["message"], counts=record["counts"]))
        else:
            left.append(job)
    return skipped, left


def _is_of(record: Record, job: Job, settings: str) -> bool:
    """Whether a record tells of what the job would make: from the same input, with the same settings."""
    is_same = (record["input_bytes"], record["input_modified"]) == (job.bytes, job.modified)
    return record["status"] != "failed" and record["settings"] == settings and is_same


def _is_newer(job: Job, files: list[str], times: dict[str, float]) -> bool:
    return job.modified is not None and all(times.get(file, float("-inf")) >= job.modified for file in files)


def _times(store: Store, folder: str) -> dict[str, float]:
    """When each output was written, by one listing: asking for a million files one by one takes hours."""
    return {
        posixpath.relpath(file.path, folder): file.modified for file in store.files(folder) if file.modified is not None
    }


def _remove_unfinished(store: Store, folder: str, jobs: list[Job]) -> None:
    """Removes what killed workers have left behind."""
    if store.is_local:
        for below in {posixpath.dirname(job.output) for job in jobs}:
            remove_abandoned_outputs(os.path.join(folder, below))
        return
    for file in list(store.files(folder)):
        if is_unfinished(file.path):
            store.remove(file.path)


def _table(records: list[Record]) -> pa.Table:
    rows = sorted(records, key=lambda record: (record["input"], record["output"] or ""))
    return pa.Table.from_pylist([{**row, "faces": (row["counts"] or {}).get("faces")} for row in rows], schema=SCHEMA)
