"""What can go wrong, in one hierarchy.

``Error`` catches everything; each class is also of the kind that Python has for such a thing, so that ``except
ValueError`` or ``except FileNotFoundError`` do what one expects. Every message is one sentence that says where, what
is wrong and, where there is a remedy, what to do. Whatever is raised, arrays are as they were, and no file is half
written.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any

__all__ = [
    "BugError",
    "BusyError",
    "DefectWarning",
    "EmptyMeshError",
    "Error",
    "ExistsError",
    "FileError",
    "MissingFileError",
    "MissingPackageError",
    "ParseError",
    "TooLargeError",
    "UsageError",
    "UsageTypeError",
]


class Error(Exception):
    """Anything that Osculate raises."""


class UsageError(Error, ValueError):
    """An argument, an array's shape or a setting that makes no sense, alone or together with others."""


class UsageTypeError(Error, TypeError):
    """An argument of a kind that cannot be what is asked for, such as faces of floats."""


class EmptyMeshError(Error, ValueError):
    """A mesh in which there is nothing to estimate: no faces, or none with an area and finite coordinates."""


class TooLargeError(Error, ValueError):
    """More faces than can be numbered, or than a file format can hold."""


class ParseError(Error, ValueError):
    """A file whose content is not what its format promises.

    Attributes: ``path`` (the file), ``line`` (from 1), ``byte`` (from 0) and ``json_path``; of the last three at most
    one, others are None.
    """

    path: str | None = None
    line: int | None = None
    byte: int | None = None
    json_path: str | None = None


class FileError(Error, OSError):
    """The system would not read or write a file: ``errno`` and ``filename`` as of every ``OSError``."""

    _sentence = ""

    def __str__(self) -> str:
        return self._sentence


class MissingFileError(FileError, FileNotFoundError):
    """A file or folder that is not there."""


class ExistsError(FileError, FileExistsError):
    """An output that exists, with ``no_clobber``."""


class BusyError(FileError, BlockingIOError):
    """A folder that another batch is writing to."""

    def __init__(self, folder: str, what: str) -> None:
        import errno

        super().__init__(errno.EWOULDBLOCK, what, folder)
        self._sentence = f"{folder}: {what}"


class MissingPackageError(Error, ImportError):
    """An optional package that this call needs is not installed."""


class BugError(Error, RuntimeError):
    """A bug in Osculate. Please report it, with the mesh if you can."""


class DefectWarning(UserWarning):
    """The mesh has defects, or its file was repaired: what the command line tells with exit code 3.

    Faces without an area or with NaN have no estimate; all others have one. To make it an error:
    ``warnings.simplefilter("error", osculate.DefectWarning)``.
    """


_KINDS = {"usage": UsageError, "empty": EmptyMeshError, "too_large": TooLargeError}


def _make(kind: str, message: str, **facts: Any) -> Error:
    """The exception for an error of the native half."""
    path = facts.get("path")
    path = None if path is None else str(path)
    if kind in ("file", "exists"):
        return _of_file(kind, message, facts, path)
    if kind == "parse":
        error = ParseError(message)
        error.path = path
        for name in ("line", "byte", "json_path"):
            setattr(error, name, facts.get(name))
        return error
    if kind == "bug":
        return BugError(f"this is a bug in Osculate, please report it: {message}")
    return _KINDS.get(kind, Error)(_as_settings(message))


def _of_file(kind: str, message: str, facts: dict[str, Any], path: str | None) -> FileError:
    import errno as codes

    if kind == "exists":
        error: FileError = ExistsError(codes.EEXIST, message, path)
        message = f"{path} exists; remove it, or leave no_clobber out"
    else:
        errno = facts.get("errno") or getattr(codes, facts.get("reason") or "", None)
        of = MissingFileError if errno == codes.ENOENT else FileError
        error = of(errno, message, path)
    error._sentence = message
    return error


def _as_settings(message: str) -> str:
    """The message with settings for the options of the command line."""

    def setting(found: re.Match[str]) -> str:
        name = found[1].replace("-", "_")
        return name if name in _names() else found[0]

    return re.sub(r"(?<![\w-])--([a-z]+(?:-[a-z]+)*)", setting, message)


@lru_cache(maxsize=None)
def _names() -> frozenset[str]:
    from ._given import facts

    return frozenset(name for call in ("convert", "batch", "trace", "inspect") for name in facts(call))
