"""One run at a time in a folder of an object store, which knows no locks.

A run keeps an object there that it writes anew every few seconds. Who finds one looks whether it changes: then its run
is alive. No clocks are compared. Two runs that start within the same second may both look and see nothing; each then
reads back what it wrote, and the one that finds the other's leaves.
"""

from __future__ import annotations

import json
import logging
import os
import posixpath
import socket
import threading
import time
import uuid

from ..errors import BusyError
from ._store import Store

LEASE = "osculate-batch.lease"
# Seconds between two writings; how long one is given to come; and how long a put may take to be seen by another run.
_BEAT, _PATIENCE, _SETTLE = 10.0, 25.0, 1.0
_logger = logging.getLogger("osculate.ray")


class Lease:
    """A folder's lease, held until ``close``."""

    def __init__(self, store: Store, folder: str) -> None:
        """Takes the lease.

        Raises:
            BusyError: While another run has it.
        """
        self._store, self._path = store, posixpath.join(folder, LEASE)
        self._run, self._beats = uuid.uuid4().hex, 0
        self._over = threading.Event()
        self._lost = False
        where = store.uri(folder)
        found = self._read()
        if found is not None:
            _logger.warning("%s: waiting %.0f s to see whether another run is writing there", where, _PATIENCE)
            end = time.monotonic() + _PATIENCE
            while time.monotonic() < end and self._read() == found:
                time.sleep(1.0)
            if self._read() not in (found, None):
                raise BusyError(where, "another run is writing to this folder; wait for it to end")
        self._write()
        time.sleep(_SETTLE)
        if not self._is_ours():
            raise BusyError(where, "another run has just begun to write to this folder; wait for it to end")
        self._where = where
        self._thread = threading.Thread(target=self._beat, daemon=True)
        self._thread.start()

    def check(self) -> None:
        """Whether it is still ours.

        Raises:
            BusyError: When another run took this one for dead, after a long sleep of the machine, say.
        """
        if self._lost:
            raise BusyError(self._where, "another run has taken this folder over; this one ends")

    def close(self) -> None:
        """Gives it back."""
        self._over.set()
        self._thread.join()
        if not self._lost:
            self._store.remove(self._path)

    def _beat(self) -> None:
        while not self._over.wait(_BEAT):
            try:
                if not self._is_ours():
                    self._lost = True
                    return
                self._write()
            except Exception as error:  # of a file system, of which each has its own kinds
                _logger.warning("%s: %s", self._where, error)

    def _write(self) -> None:
        self._beats += 1
        who = {"run": self._run, "beats": self._beats, "host": socket.gethostname(), "process": os.getpid()}
        self._store.put(self._path, json.dumps(who).encode())

    def _read(self) -> bytes | None:
        try:
            return self._store.read(self._path)
        except FileNotFoundError:
            return None

    def _is_ours(self) -> bool:
        found = self._read()
        # One that is gone was nobody's to take; the next beat puts it back.
        return found is None or self._run.encode() in found
