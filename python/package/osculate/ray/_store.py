"""File systems by one interface: the machine's own, pyarrow's and fsspec's."""

from __future__ import annotations

import os
import posixpath
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pyarrow as pa
import pyarrow.fs as pafs

# Object stores show an object when all of it is there, so that one put needs no second name.
_OBJECT_STORES = {"s3", "s3a", "gcs", "gs", "abfs", "abfss", "az", "oss", "memory"}
# Up to here a file is put in one piece; larger ones get a name of their own first.
_ONE_PUT = 64 << 20
_CHUNK = 8 << 20
# What no other program looks at, and the next run removes.
_PREFIX, _SUFFIX = ".osculate-", ".part"


@dataclass(frozen=True)
class File:
    """A file as a listing tells of it."""

    path: str
    """Within its store, with ``/`` between folders."""
    bytes: int
    """Size; 0 where the file system does not tell."""
    modified: float | None
    """Seconds from 1970 to the last change; ``None`` where the file system does not tell."""


class Store:
    """A file system. Paths are absolute within it, without its scheme."""

    def __init__(self, filesystem: pafs.FileSystem, scheme: str = "") -> None:
        self._fs = filesystem
        self.scheme = scheme
        """What stands before a path in messages and records, such as ``s3://``; nothing for local files."""
        handler = getattr(filesystem, "handler", None)
        kinds = {filesystem.type_name}
        if isinstance(handler, pafs.FSSpecHandler):
            protocol = handler.fs.protocol
            kinds = {protocol} if isinstance(protocol, str) else set(protocol)
        self.is_local = bool(kinds & {"local", "file"})
        """Whether the operating system opens its files by their paths."""
        self.is_private = "memory" in kinds
        """Whether it lives in this process alone, so that workers see nothing of it."""
        self._puts_whole = bool(kinds & _OBJECT_STORES)

    def uri(self, path: str) -> str:
        """The path as a user would write it."""
        return f"{self.scheme}{path}"

    def find(self, path: str) -> File | None:
        """The file of this path, or ``None`` where there is no file."""
        if self.is_local:
            return local_file(path) if os.path.isfile(path) else None
        info = self._fs.get_file_info(path)
        return _file(info) if info.type == pafs.FileType.File else None

    def is_folder(self, path: str) -> bool:
        if self.is_local:
            return os.path.isdir(path)
        return bool(self._fs.get_file_info(path).type == pafs.FileType.Directory)

    def files(self, folder: str) -> Iterator[File]:
        """All files in a folder and below it; none where there is no folder."""
        for info in self._fs.get_file_info(pafs.FileSelector(folder, recursive=True, allow_not_found=True)):
            if info.type == pafs.FileType.File:
                yield _file(info)

    def read(self, path: str) -> bytes:
        with self._fs.open_input_stream(path, compression=None) as stream:
            return bytes(stream.readall())

    def fetch(self, path: str, to: Path) -> None:
        """Copies a file to a local path."""
        with self._fs.open_input_stream(path, compression=None) as stream, open(to, "wb") as out:
            while chunk := stream.read(_CHUNK):
                out.write(chunk)

    def put(self, path: str, content: bytes) -> None:
        """Writes a file, which appears whole or not at all."""
        self._put(path, pa.BufferReader(content), len(content))

    def put_file(self, path: str, local: Path) -> None:
        """Copies a local file, which appears whole or not at all."""
        with pa.OSFile(str(local)) as source:
            self._put(path, source, source.size())

    def _put(self, path: str, source: Any, size: int) -> None:
        if not self._puts_whole:
            self._fs.create_dir(posixpath.dirname(path), recursive=True)
        elif size <= _ONE_PUT:
            content = source.read()
            with self._fs.open_output_stream(path) as out:
                out.write(content)
            return
        part = posixpath.join(posixpath.dirname(path), f"{_PREFIX}{uuid.uuid4().hex}{_SUFFIX}")
        try:
            with self._fs.open_output_stream(part) as out:
                while chunk := source.read(_CHUNK):
                    out.write(chunk)
            self._fs.move(part, path)
        except BaseException:
            self.remove(part)
            raise

    def remove(self, path: str) -> None:
        """Removes a file if it is there."""
        try:
            self._fs.delete_file(path)
        except OSError:
            pass

    def remove_folder(self, path: str) -> None:
        """Removes a folder if it is there. Object stores have none."""
        try:
            self._fs.delete_dir(path)
        except OSError:
            pass


def is_unfinished(path: str) -> bool:
    """Whether this is a name that a file has while it is being written."""
    name = posixpath.basename(path)
    return name.startswith(_PREFIX) and name.endswith(_SUFFIX)


def locate(
    path: str | os.PathLike[str], filesystem: Any = None, storage_options: dict[str, Any] | None = None
) -> tuple[Store, str]:
    """The store of a path or URI, and the path within it.

    Args:
        path: A path, or a URI such as ``s3://bucket/folder``.
        filesystem: A file system of pyarrow or fsspec, whose paths these are. Otherwise the URI tells: pyarrow's own
            for ``s3://``, ``gs://`` and ``hdfs://``, fsspec's for all others.
        storage_options: Given to fsspec, which is then taken for every URI.
    """
    text = os.fspath(path)
    scheme = urlsplit(text).scheme if "://" in text else ""
    if filesystem is not None:
        return _store_of(filesystem, scheme, text)
    if scheme in ("", "file", "local"):
        local = text.split("://", 1)[1] if scheme else text
        return Store(pafs.LocalFileSystem()), os.path.abspath(local).replace(os.sep, "/")
    if scheme in ("s3", "gs", "gcs", "hdfs", "viewfs") and not storage_options:
        # Of the server only: a path may hold wildcards, which a URI gives another meaning.
        filesystem, _ = pafs.FileSystem.from_uri(f"{scheme}://{urlsplit(text).netloc}/")
        parts = urlsplit(text)
        if scheme in ("hdfs", "viewfs"):
            return Store(filesystem, f"{scheme}://{parts.netloc}"), _plain(text.split("://", 1)[1][len(parts.netloc) :])
        # Of object stores the bucket is part of the path.
        return Store(filesystem, f"{scheme}://"), _plain(text.split("://", 1)[1])
    import fsspec

    return _store_of(fsspec.filesystem(scheme, **(storage_options or {})), scheme, text)


def _store_of(filesystem: Any, scheme: str, text: str) -> tuple[Store, str]:
    if isinstance(filesystem, pafs.FileSystem):
        within = text.split("://", 1)[1] if scheme else text
    else:
        within = filesystem._strip_protocol(text)
        filesystem = pafs.PyFileSystem(_Handler(filesystem))
    store = Store(filesystem, f"{scheme}://" if scheme else "")
    if store.is_local:
        return Store(pafs.LocalFileSystem()), os.path.abspath(within).replace(os.sep, "/")
    return store, _plain(within)


def _plain(path: str) -> str:
    return posixpath.normpath(path) if path.strip("/") else path


class _Handler(pafs.FSSpecHandler):  # type: ignore[misc]
    """fsspec's file systems each have a name of their own for the time of the last change."""

    @staticmethod
    def _create_file_info(path: str, info: dict[str, Any]) -> pafs.FileInfo:
        keys = ("mtime", "LastModified", "last_modified", "updated", "modified", "created")
        times = [_seconds(info[key]) for key in keys if info.get(key) is not None]
        size = info["size"] if info["type"] == "file" else None
        kinds = {"file": pafs.FileType.File, "directory": pafs.FileType.Directory}
        return pafs.FileInfo(
            path, kinds.get(info["type"], pafs.FileType.Unknown), size=size, mtime=times[0] if times else None
        )


def _seconds(time: Any) -> float:
    if isinstance(time, str):
        time = datetime.fromisoformat(time.replace("Z", "+00:00"))
    if isinstance(time, datetime):
        return (time if time.tzinfo else time.replace(tzinfo=timezone.utc)).timestamp()
    return float(time)


def _file(info: pafs.FileInfo) -> File:
    modified = None if info.mtime_ns is None else seconds_of(info.mtime_ns)
    return File(info.path, info.size or 0, modified)


def local_file(path: str) -> File:
    status = os.stat(path)
    return File(path, status.st_size, seconds_of(status.st_mtime_ns))


def seconds_of(nanoseconds: int) -> float:
    """Seconds as `osculate batch` writes them, to the last bit."""
    whole, rest = divmod(nanoseconds, 1_000_000_000)
    return whole + rest / 1e9
