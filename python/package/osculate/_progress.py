"""Progress by callback or as bars."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Optional, Union

from .errors import MissingPackageError, UsageTypeError

Callback = Callable[[str, int, int], object]
#: None for silence, True for bars of tqdm, or a callable: it is given the stage ("read", "estimate", "write", "trace" or
#: "cut"), how much of it is done and how much there is (bytes when reading and writing, faces when estimating and
#: cutting, traces), in the thread that made the call, some 20 times a second and at the end of each stage. What it
#: raises cancels the work and is raised by the call.
Progress = Union[None, bool, Callback]


@contextmanager
def reporting(progress: Progress) -> Iterator[Optional[Callback]]:
    """What the native half is to call."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        bars = _Bars()
        try:
            yield bars
        finally:
            bars.close()
    elif callable(progress):
        yield progress
    else:
        raise UsageTypeError(f"progress must be True, None or a callable, not {progress!r}")


_UNITS = {"read": "B", "estimate": " faces", "write": "B", "trace": " traces", "cut": " faces"}


class _Bars:
    """A bar for each stage."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError as error:
            raise MissingPackageError("progress=True shows bars of tqdm: pip install tqdm") from error
        self._tqdm: Any = tqdm
        self._bar: Any = None
        self._stage = ""

    def __call__(self, stage: str, done: int, total: int) -> None:
        if stage != self._stage:
            self.close()
            self._bar = self._tqdm(total=total, desc=stage, unit=_UNITS[stage], unit_scale=True)
            self._stage = stage
        self._bar.total = total
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None
