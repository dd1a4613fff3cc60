"""Which files a run is over, and where the output of each goes: by the rules of ``osculate batch``."""

from __future__ import annotations

import glob
import os
import posixpath
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from .._native import Batch, is_mesh_name
from ..errors import UsageError
from ._store import File, Store, is_unfinished, local_file


@dataclass(frozen=True)
class Job:
    """A file to annotate."""

    input: str
    """Within the inputs' store."""
    output: str
    """Relative to the output folder."""
    bytes: int
    modified: float | None


@dataclass(frozen=True)
class Failure:
    """Something that was named, or found, and cannot be annotated."""

    input: str
    message: str


@dataclass
class Found:
    jobs: list[Job] = field(default_factory=list)
    failures: list[Failure] = field(default_factory=list)


@dataclass(frozen=True)
class _Candidate:
    file: File
    root: str
    """The folder that an argument stands for, without links."""
    below: str
    """The file's path from there."""

    @property
    def real(self) -> str:
        return posixpath.join(self.root, self.below)


def find(store: Store, paths: Sequence[str], out: tuple[Store, str], batch: Batch, keep_extension: bool) -> Found:
    """Finds all files, once each.

    Args:
        store: Where all of them are.
        paths: Files, folders with all mesh files in and below them, and patterns (``*``, ``?``, ``[ab]``, ``**``).
        out: The output folder.
        batch: What tells the outputs' extension, and which files an input becomes.
        keep_extension: Whether that extension stands behind the inputs' own instead of in its place.

    Raises:
        UsageError: For paths that cannot be meant.
    """
    found = Found()
    candidates: list[_Candidate] = []
    outputs = _real(store, out[1]) if _same_place(store, out[0]) else None
    for path in paths:
        if (file := store.find(path)) is not None:
            folder, name = posixpath.split(path)
            candidates.append(_Candidate(file, _real(store, folder), name))
        elif store.is_folder(path):
            if outputs == _real(store, path):
                what = "is the output folder too, so that outputs would lie among the inputs"
                raise UsageError(f"{store.uri(path)}: {what}")
            candidates += _in_folder(store, path, outputs, found)
        elif _literal_part(path) != path:
            matches = list(_matching(store, path))
            candidates += matches
            if not matches:
                found.failures.append(Failure(path, "no file matches this pattern"))
        else:
            found.failures.append(Failure(path, "cannot read: there is no such file or folder"))
    if not candidates and not found.failures:
        raise UsageError(f"no mesh files in {', '.join(store.uri(path) for path in paths)}")

    once = {candidate.real: candidate for candidate in reversed(candidates)}
    candidates = [candidate for candidate in candidates if once.get(candidate.real) is candidate]
    top = _common([candidate.root for candidate in candidates])
    for candidate in candidates:
        below = posixpath.relpath(candidate.real, top) if top else candidate.below
        file, output = candidate.file, output_name(below, batch.extension, keep_extension)
        found.jobs.append(Job(file.path, output, file.bytes, file.modified))
    _refuse_clashes(found, set(once), outputs, batch)
    return found


def _in_folder(store: Store, folder: str, outputs: str | None, found: Found) -> Iterator[_Candidate]:
    root = _real(store, folder)
    if store.is_local:
        yield from _walk(folder, folder, root, (root,), outputs, found)
        return
    for file in sorted(store.files(folder), key=lambda file: file.path.split("/")):
        below = posixpath.relpath(file.path, folder)
        is_hidden = any(part.startswith(".") for part in below.split("/"))
        is_output = outputs is not None and file.path.startswith(outputs + "/")
        if not is_hidden and not is_output and is_mesh_name(below):
            yield _Candidate(file, root, below)


def _walk(
    folder: str, top: str, root: str, above: tuple[str, ...], outputs: str | None, found: Found
) -> Iterator[_Candidate]:
    """Local folders are walked here, since links are followed and may lead round in circles."""
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError as error:
        found.failures.append(Failure(folder, f"cannot read: {error.strerror}"))
        return
    for entry in entries:
        if entry.name.startswith("."):
            continue
        path = posixpath.join(folder, entry.name)
        if entry.is_dir():
            real = os.path.realpath(path)
            if entry.is_symlink() and real in above:
                found.failures.append(Failure(path, "cannot read: a link that leads to a folder above itself"))
            elif real != outputs:
                yield from _walk(path, top, root, (*above, real), outputs, found)
        elif is_mesh_name(path) and (file := _readable(path, found)) is not None:
            yield _Candidate(file, root, posixpath.relpath(path, top))


def _readable(path: str, found: Found) -> File | None:
    try:
        return local_file(path)
    except OSError as error:
        found.failures.append(Failure(path, f"cannot read: {error.strerror}"))
        return None


def _matching(store: Store, pattern: str) -> Iterator[_Candidate]:
    """All files that a pattern stands for. Names with a dot in front are found by a dot only."""
    folder = _literal_part(pattern)
    root = _real(store, folder)
    if store.is_local:
        for path in sorted(glob.iglob(pattern, recursive=True), key=lambda path: path.split("/")):
            if (file := store.find(path)) is not None:
                yield _Candidate(file, root, posixpath.relpath(path, folder))
        return
    matches = re.compile(_expression(posixpath.relpath(pattern, folder))).fullmatch
    for file in sorted(store.files(folder), key=lambda file: file.path.split("/")):
        below = posixpath.relpath(file.path, folder)
        if matches(below) and not is_unfinished(below):
            yield _Candidate(file, root, below)


def _expression(pattern: str) -> str:
    """The regular expression of a relative pattern."""
    parts = pattern.split("/")
    expression = ""
    for i, part in enumerate(parts):
        last = i + 1 == len(parts)
        if part == "**":
            expression += r"(?:[^./][^/]*/)*" + (r"[^./][^/]*" if last else "")
            continue
        if part[0] in "*?[":
            expression += r"(?!\.)"
        for token in re.findall(r"\[!?\]?[^\]]*\]|.", part):
            if token == "*":
                expression += "[^/]*"
            elif token == "?":
                expression += "[^/]"
            elif len(token) > 1:
                inside = token[1:-1].replace("\\", r"\\")
                expression += "[^/" + inside[1:] + "]" if inside.startswith("!") else f"[{inside}]"
            else:
                expression += re.escape(token)
        expression += "" if last else "/"
    return expression


def _literal_part(path: str) -> str:
    """The part of a path before the first component with a wildcard: all of it where there is none."""
    parts = path.split("/")
    literal = next((i for i, part in enumerate(parts) if any(c in part for c in "*?[")), len(parts))
    return "/".join(parts[:literal]) or "/"


def _common(folders: Iterable[str]) -> str:
    """The deepest folder that holds all of these."""
    parts = [folder.split("/") for folder in folders]
    same = os.path.commonprefix(parts) if parts else []
    return "/".join(same)


def _real(store: Store, folder: str) -> str:
    return os.path.realpath(folder) if store.is_local else folder


def _same_place(one: Store, other: Store) -> bool:
    return (one.is_local, one.scheme) == (other.is_local, other.scheme)


def output_name(below: str, extension: str, keep_extension: bool) -> str:
    """``sub/part.stl.gz`` becomes ``sub/part.glb``, or ``sub/part.stl.gz.glb``."""
    folder, name = posixpath.split(below)
    if not keep_extension:
        stem, last = posixpath.splitext(name)
        name = posixpath.splitext(stem)[0] if last.lower() == ".gz" else stem
    # Links may lead anywhere; outputs stay below the output folder.
    folders = [part for part in folder.split("/") if part not in ("", ".", "..")]
    return "/".join([*folders, f"{name}.{extension}"])


def _refuse_clashes(found: Found, inputs: set[str], outputs: str | None, batch: Batch) -> None:
    """Takes out jobs whose outputs would replace one another's, or an input."""
    files = [batch.files_of(job.output) for job in found.jobs]
    users = Counter(file for of_job in files for file in of_job)
    jobs, found.jobs = found.jobs, []
    for job, of_job in zip(jobs, files):
        shared = next((file for file in of_job if users[file] > 1), None)
        own = next((file for file in of_job if outputs is not None and posixpath.join(outputs, file) in inputs), None)
        if shared is not None:
            message = f"another input would also be written to {shared}; keep_extension=True keeps them apart"
            found.failures.append(Failure(job.input, message))
        elif own is not None:
            found.failures.append(Failure(job.input, f"{own} is an input; choose another output folder"))
        else:
            found.jobs.append(job)
