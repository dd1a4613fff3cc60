"""Copies of files for a program that reads and writes local paths: an input with all that it names, and outputs."""

from __future__ import annotations

import gzip
import io
import json
import posixpath
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Any, BinaryIO
from urllib.parse import unquote

from ._lock import try_lock
from ._store import Store

_PREFIX = "osculate-ray-"
_GLB_HEADER = 12
# More JSON than this is not looked through for names of other files.
_LARGEST_DOCUMENT = 1 << 30

# Files by their names relative to the first one's folder.
Contents = dict[str, bytes]


@contextmanager
def folder() -> Iterator[Path]:
    """A temporary folder. Those of workers that were killed are removed, told from others by their locks."""
    top = Path(tempfile.gettempdir())
    for left in top.glob(f"{_PREFIX}*"):
        _remove_abandoned(left)
    path = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=top))
    with open(path / "lock", "w") as lock:
        try_lock(lock)
        try:
            yield path
        finally:
            shutil.rmtree(path, ignore_errors=True)


def _remove_abandoned(path: Path) -> None:
    try:
        # One of this very moment may not have its lock yet.
        if time.time() - path.stat().st_mtime > 60:
            with open(path / "lock") as lock:
                if try_lock(lock):
                    shutil.rmtree(path, ignore_errors=True)
    except OSError:
        # Somebody else's.
        pass


def fetch(store: Store, path: str, to: Path) -> Path:
    """Copies a file, and those beside and below it that it names, into a folder. What is missing is left to the
    reader, which says so in its own words."""
    document = to / posixpath.basename(path)
    store.fetch(path, document)
    with open(document, "rb") as file:
        names = named_files(file)
    for name in names:
        beside = posixpath.join(posixpath.dirname(path), name)
        if store.find(beside) is not None:
            store.fetch(beside, _make_room(to, name))
    return document


def load(store: Store, path: str) -> Contents:
    """The contents of a file and of those that :func:`fetch` would copy."""
    contents = {posixpath.basename(path): store.read(path)}
    for name in named_files(io.BytesIO(contents[posixpath.basename(path)])):
        beside = posixpath.join(posixpath.dirname(path), name)
        if store.find(beside) is not None:
            contents[name] = store.read(beside)
    return contents


def unload(contents: Contents, to: Path) -> None:
    """Writes what :func:`load` gave into a folder."""
    for name, content in contents.items():
        _make_room(to, name).write_bytes(content)


def _make_room(folder: Path, name: str) -> Path:
    target = folder.joinpath(*PurePosixPath(name).parts)
    target.parent.mkdir(parents=True, exist_ok=True)
    return target


def outputs(written: Path, name: str) -> list[Path]:
    """What was written to a folder, the main output last: it names the others."""
    files = [path for path in written.iterdir() if path.is_file()]
    return sorted(files, key=lambda path: (path.name == name, path.name))


def named_files(document: BinaryIO) -> list[str]:
    """Files that a glTF document names, relative to it, whatever its own name ends in: buffers and images. Only
    those in its folder and below, since no others are read. Other formats name none that count: the materials of an
    OBJ are stepped over."""
    try:
        text = _gltf_json(document)
        tree: Any = json.loads(text) if text else {}
    except (OSError, ValueError, EOFError, RecursionError):
        # The reader will say what is wrong with it.
        return []
    names: list[str] = []
    for kind in ("buffers", "images"):
        entries = tree.get(kind) if isinstance(tree, dict) else None
        for entry in entries if isinstance(entries, list) else []:
            uri = entry.get("uri") if isinstance(entry, dict) else None
            if isinstance(uri, str) and not uri.startswith("data:"):
                name = posixpath.normpath(unquote(uri))
                if _is_below(name) and name not in names:
                    names.append(name)
    return names


def _is_below(name: str) -> bool:
    return not name.startswith(("/", "\\")) and name.split("/")[0] not in (".", "..") and not set(name) & set(":\0")


def _gltf_json(raw: BinaryIO) -> bytes | None:
    is_zipped = raw.read(2) == b"\x1f\x8b"
    raw.seek(0)
    file: Any = gzip.GzipFile(fileobj=raw) if is_zipped else raw
    head: bytes = file.read(_GLB_HEADER)
    if head[:4] == b"glTF":
        chunk = file.read(8)
        size = int.from_bytes(chunk[:4], "little")
        return bytes(file.read(size)) if chunk[4:] == b"JSON" and size <= _LARGEST_DOCUMENT else None
    if head.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] == b"{":
        return head + bytes(file.read(_LARGEST_DOCUMENT))
    return None
