"""What became of every file: the log that a later run goes by, and the records as Parquet.

The log is that of ``osculate batch``, so that each goes on where the other has stopped. On a local file system it is
one file to which lines are added. Object stores cannot add to a file; there every few seconds' lines are an object
of their own.
"""

from __future__ import annotations

import json
import posixpath
import time
import uuid
from collections.abc import Iterable
from typing import IO, Any

import pyarrow as pa
import pyarrow.parquet as pq

from ..errors import BusyError
from ._lease import Lease
from ._lock import try_lock
from ._store import Store

LOG = "osculate-batch.jsonl"
PARTS = "osculate-batch.parts"
MARKS = "osculate-batch.marks"
RECORDS = "osculate-batch.parquet"
# Seconds whose lines a killed driver may lose on an object store, and lines that are put at the latest.
_PART_SECONDS, _PART_LINES = 10.0, 10_000

Record = dict[str, Any]

# Keys of a line, in the order in which `osculate batch` writes them.
_KEYS = ("input", "output", "status", "message", "seconds", "counts", "settings", "input_bytes", "input_modified")
_COUNTS = (
    "faces",
    "vertices",
    "components",
    "boundary_loops",
    "degenerate_faces",
    "duplicate_faces",
    "non_finite_faces",
    "flipped_faces",
    "non_manifold_edges",
)
SCHEMA = pa.schema(
    [
        pa.field("input", pa.string(), nullable=False),
        ("output", pa.string()),
        pa.field("status", pa.string(), nullable=False),
        ("message", pa.string()),
        pa.field("seconds", pa.float64(), nullable=False),
        ("faces", pa.int64()),
        ("counts", pa.struct([(name, pa.int64()) for name in _COUNTS])),
        ("defects", pa.list_(pa.string())),
        pa.field("settings", pa.string(), nullable=False),
        pa.field("input_bytes", pa.int64(), nullable=False),
        ("input_modified", pa.float64()),
        pa.field("attempts", pa.int32(), nullable=False),
    ]
)


class Log:
    """The log of an output folder, open for adding to."""

    def __init__(self, store: Store, folder: str, resume: bool) -> None:
        """Opens the log and locks it: by the system's locks where it is local, by a lease where others see it.

        Raises:
            BusyError: While another program writes to it.
        """
        self._store, self._folder = store, folder
        self._file: IO[bytes] | None = None
        self._lease: Lease | None = None
        self._waiting: list[bytes] = []
        self._since = time.monotonic()
        # Parts are read in the order of their names.
        self._name = f"{time.time_ns():020}-{uuid.uuid4().hex[:8]}"
        self._count = 0
        path = posixpath.join(folder, LOG)
        if store.is_local:
            self._file = open(path, "a+b")
            if not try_lock(self._file):
                self._file.close()
                raise BusyError(folder, "another batch is writing to this folder; wait for it to end")
        elif not store.is_private:
            self._lease = Lease(store, folder)
        if not resume:
            self._forget()

    def _forget(self) -> None:
        if self._file is not None:
            self._file.truncate(0)
        else:
            self._store.remove(posixpath.join(self._folder, LOG))
        for part in self._parts():
            self._store.remove(part)

    def _parts(self) -> list[str]:
        return sorted(file.path for file in self._store.files(posixpath.join(self._folder, PARTS)))

    def records(self) -> dict[str, Record]:
        """The last record of each output."""
        records = {}
        for line in self._lines():
            record = json.loads(line)
            if record["output"] is not None:
                records[record["output"]] = record
        return records

    def _lines(self) -> list[bytes]:
        """All lines that are whole: one that was cut short is as good as none."""
        if self._file is not None:
            self._file.seek(0)
            text = self._file.read()
            if text and not text.endswith(b"\n"):
                self._file.write(b"\n")
        else:
            log = posixpath.join(self._folder, LOG)
            text = self._store.read(log) if self._store.find(log) is not None else b""
        text = b"\n".join([text, *map(self._store.read, self._parts())])
        return [line for line in text.split(b"\n") if _is_whole(line)]

    def add(self, records: Iterable[Record]) -> None:
        """Adds a line for each, all of them with one write."""
        if self._lease is not None:
            self._lease.check()
        lines = [json.dumps({key: record[key] for key in _KEYS}).encode() + b"\n" for record in records]
        if self._file is not None:
            self._file.write(b"".join(lines))
            self._file.flush()
            return
        self._waiting += lines
        if len(self._waiting) >= _PART_LINES or time.monotonic() - self._since > _PART_SECONDS:
            self._put()

    def _put(self) -> None:
        if self._waiting:
            name = f"{PARTS}/{self._name}-{self._count:06}.jsonl"
            self._store.put(posixpath.join(self._folder, name), b"".join(self._waiting))
            self._count += 1
        self._waiting, self._since = [], time.monotonic()

    def close(self) -> None:
        """Writes what still waits, and makes one file of all parts."""
        try:
            self._put()
            if self._lease is not None:
                # Whoever has taken over reads the parts; the log is theirs.
                self._lease.check()
            if parts := self._parts():
                self._store.put(posixpath.join(self._folder, LOG), b"".join(line + b"\n" for line in self._lines()))
                for part in parts:
                    self._store.remove(part)
                self._store.remove_folder(posixpath.join(self._folder, PARTS))
        finally:
            if self._file is not None:
                self._file.close()
            if self._lease is not None:
                self._lease.close()

    def __enter__(self) -> Log:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _is_whole(line: bytes) -> bool:
    try:
        record = json.loads(line)
        return all(key in record for key in _KEYS)
    except (ValueError, TypeError):
        return False


def write_records(store: Store, folder: str, records: pa.Table) -> str:
    """Writes all records of a run as one Parquet file and gives its path."""
    path = posixpath.join(folder, RECORDS)
    sink = pa.BufferOutputStream()
    pq.write_table(records, sink, compression="zstd")
    store.put(path, sink.getvalue().to_pybytes())
    return path
