"""What is remembered of tasks while workers do them, so that one that dies costs no file but the one that killed it.

Ray starts a task anew when its worker dies, as often as that happens. A mark in a small file outlives workers: it
tells a task that was begun before to go on carefully, noting each file before and after. A file in whose midst workers
die again and again is then known, and given up; what was done before it is not done again.
"""

from __future__ import annotations

import json
import posixpath
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from ._store import Store


@dataclass(frozen=True)
class Marks:
    """Where the marks of a run are: on a file system that all workers see."""

    store: Store
    folder: str

    @contextmanager
    def of(self, task: int) -> Iterator[Mark]:
        """The mark of a task, until it is done or ends with an exception."""
        path = posixpath.join(self.folder, f"{task}.json")
        mark = Mark(self.store, path)
        if self.store.find(path) is not None:
            mark.is_careful = True
            noted = json.loads(self.store.read(path))
            mark.starts, mark.done = noted["starts"], noted["done"]
        else:
            mark.save()
        try:
            yield mark
        finally:
            self.store.remove(path)

    def clear(self) -> None:
        """Removes all marks."""
        for file in list(self.store.files(self.folder)):
            self.store.remove(file.path)
        self.store.remove_folder(self.folder)


@dataclass
class Mark:
    """Of one task."""

    store: Store
    path: str
    is_careful: bool = False
    """Whether the task was begun before, and its worker died."""
    starts: dict[str, int] = field(default_factory=dict)
    """How often each output was started on carefully, by their names."""
    done: dict[str, str] = field(default_factory=dict)
    """The records, as JSON, of those that were done carefully."""

    def start(self, output: str) -> None:
        """Notes that a file is started on."""
        if self.is_careful:
            self.starts[output] = self.starts.get(output, 0) + 1
            self.save()

    def finish(self, output: str, record: str) -> None:
        """Notes that a file is done."""
        if self.is_careful:
            self.done[output] = record
            self.save()

    def save(self) -> None:
        self.store.put(self.path, json.dumps({"starts": self.starts, "done": self.done}).encode())
