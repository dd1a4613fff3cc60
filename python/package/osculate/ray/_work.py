"""What a worker does: annotates the files of a task, one after the other, and tells what became of each."""

from __future__ import annotations

import json
import os
import posixpath
import random
import time
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import pyarrow as pa

from .._native import Batch
from . import _stage
from ._find import Job
from ._log import Record
from ._marks import Marks
from ._stage import Contents
from ._store import Store

# Seconds before the first repetition; every further one waits twice as long.
_FIRST_PAUSE = 0.5

# Errors of file systems that stay as they are.
_LASTING = (FileNotFoundError, PermissionError, IsADirectoryError, NotADirectoryError)

_CONTENTS = pa.list_(pa.struct([("name", pa.string()), ("content", pa.large_binary())]))
_JOBS = pa.schema(
    [
        ("input", pa.string()),
        ("output", pa.string()),
        ("bytes", pa.int64()),
        ("modified", pa.float64()),
        ("task", pa.int64()),
        # Of a file system that only the driver sees.
        ("contents", _CONTENTS),
    ]
)
# A record travels as JSON: it is small, and one of a fixed form is easier to tell from a broken one than a table's.
_DONE = pa.schema([("output", pa.string()), ("record", pa.string()), ("contents", _CONTENTS)])


@dataclass(frozen=True)
class Work:
    """What all files of a run have in common."""

    source: Store
    target: Store
    folder: str
    """The output folder, in the target."""
    marks: Marks
    settings: str
    """Those of ``osculate batch``: names and texts, as JSON."""
    retries: int

    def task(self, number: int, jobs: Iterable[Job]) -> pa.Table:
        """The jobs of one task, as they travel to a worker."""
        rows = []
        for job in jobs:
            contents = _listed(_stage.load(self.source, job.input)) if self.source.is_private else None
            rows.append({**vars(job), "task": number, "contents": contents})
        return pa.Table.from_pylist(rows, schema=_JOBS)

    def record(self, job: Job, **what: Any) -> Record:
        """A record of a job, to be completed by ``what``."""
        return {
            "input": self.source.uri(job.input),
            "output": job.output,
            "status": "failed",
            "message": None,
            "seconds": 0.0,
            "counts": None,
            "defects": None,
            "settings": batch(self.settings).fingerprint,
            "input_bytes": job.bytes,
            "input_modified": job.modified,
            "attempts": 0,
            **what,
        }


@lru_cache(maxsize=8)
def batch(settings: str) -> Batch:
    """The settings as the program has them; made once in every process."""
    return Batch([(name, values) for name, values in json.loads(settings)])


def annotate(table: pa.Table, work: Work) -> pa.Table:
    """Annotates the files of a task; the function that Ray Data maps over them."""
    jobs = table.to_pylist()
    rows = []
    with work.marks.of(jobs[0].pop("task")) as mark:
        for row in jobs:
            row.pop("task", None)
            contents = row.pop("contents")
            job = Job(**row)
            # Outputs that travel with the records are lost with them.
            text = None if work.target.is_private else mark.done.get(job.output)
            outputs: Contents = {}
            if text is None:
                deaths = mark.starts.get(job.output, 0)
                if deaths >= max(work.retries, 1):
                    record = work.record(job, message=f"{work.source.uri(job.input)}: {_LETHAL}", attempts=1 + deaths)
                else:
                    mark.start(job.output)
                    record, outputs = _annotate(work, job, None if contents is None else _named(contents))
                text = json.dumps(record)
                mark.finish(job.output, text)
            rows.append({"output": job.output, "record": text, "contents": _listed(outputs)})
    return pa.Table.from_pylist(rows, schema=_DONE)


_LETHAL = (
    "the worker died each time that it came to this file, most likely for want of memory; give each worker more with "
    'ray_options={"memory": BYTES}, or look into the logs of Ray'
)


def records(table: pa.Table, work: Work) -> list[Record]:
    """The records that came back from a worker; outputs that came along are put in their places."""
    found = []
    for row in table.to_pylist():
        for name, content in _named(row["contents"]).items():
            work.target.put(_target(work, row["output"], name), content)
        found.append(json.loads(row["record"]))
    return found


def _annotate(work: Work, job: Job, contents: Contents | None) -> tuple[Record, Contents]:
    start = time.monotonic()
    for attempt in range(1, work.retries + 2):
        outputs: Contents = {}
        try:
            done, outputs = _attempt(work, job, contents)
            is_transient = done.pop("transient")
        except Exception as error:  # of a file system, of which each has its own kinds
            uri = work.source.uri(job.input)
            done = {"status": "failed", "message": f"{uri}: {_in_words(error)}"}
            is_transient = not isinstance(error, _LASTING)
        if done["status"] != "failed" or not is_transient or attempt > work.retries:
            break
        time.sleep(_FIRST_PAUSE * 2 ** (attempt - 1) * random.uniform(0.5, 1.5))
    done["seconds"] = time.monotonic() - start
    return work.record(job, **done, attempts=attempt), outputs


def _in_words(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _attempt(work: Work, job: Job, contents: Contents | None) -> tuple[dict[str, Any], Contents]:
    name = posixpath.basename(job.output)
    if work.source.is_local and work.target.is_local:
        output = posixpath.join(work.folder, job.output)
        os.makedirs(posixpath.dirname(output), exist_ok=True)
        return json.loads(batch(work.settings).annotate(job.input, output)), {}
    with _stage.folder() as top:
        inputs, written = top / "in", top / "out"
        inputs.mkdir()
        written.mkdir()
        input = Path(job.input)
        if not work.source.is_local:
            input = inputs / posixpath.basename(job.input)
            if contents is None:
                _stage.fetch(work.source, job.input, inputs)
            else:
                _stage.unload(contents, inputs)
        if work.target.is_local:
            written = Path(work.folder, posixpath.dirname(job.output))
            written.mkdir(parents=True, exist_ok=True)
        done = json.loads(batch(work.settings).annotate(str(input), str(written / name)))
        if done["message"]:
            # The user knows nothing of the copies.
            for copy, store, path in (
                (inputs, work.source, job.input),
                (top / "out", work.target, posixpath.join(work.folder, job.output)),
            ):
                done["message"] = done["message"].replace(f"{copy}/", f"{store.uri(posixpath.dirname(path))}/")
        outputs: Contents = {}
        if done["status"] != "failed" and not work.target.is_local:
            for file in _stage.outputs(written, name):
                if work.target.is_private:
                    outputs[file.name] = file.read_bytes()
                else:
                    work.target.put_file(_target(work, job.output, file.name), file)
        return done, outputs


def _target(work: Work, output: str, name: str) -> str:
    return posixpath.join(work.folder, posixpath.dirname(output), name)


def _listed(contents: Contents) -> list[dict[str, Any]]:
    return [{"name": name, "content": content} for name, content in contents.items()]


def _named(contents: list[dict[str, Any]]) -> Contents:
    return {entry["name"]: entry["content"] for entry in contents}
