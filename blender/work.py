# SPDX-License-Identifier: MIT
"""Estimates one mesh after the other, on a thread of its own or at once, until it is done or cancelled."""

import threading

from .estimate import Cancelled


class Work:
    """jobs: what `collect` gave. Nothing here touches Blender, so that a user can go on while it runs."""

    def __init__(self, jobs, settings):
        self.jobs, self.settings = jobs, settings
        #: How much is done, 0 to 1.
        self.share = 0.0
        #: What ended the work early; `Cancelled` where the user did.
        self.error = None
        self._stop = threading.Event()
        self._thread = None

    def start(self):
        """Begins on a thread of its own."""
        self._thread = threading.Thread(target=self.run, daemon=True)
        self._thread.start()

    def is_running(self):
        return self._thread is not None and self._thread.is_alive()

    def cancel(self):
        """Has the work end soon; nothing of it is used then."""
        self._stop.set()

    def is_cancelled(self):
        return self._stop.is_set()

    def wait(self):
        """Until the thread has ended."""
        if self._thread is not None:
            self._thread.join()

    def run(self):
        """Does it."""
        try:
            for number, job in enumerate(self.jobs):
                self._check()
                job.run(self.settings, lambda stage, done, total: self._tell(number, done, total))
            self._check()
        except BaseException as error:  # told by whoever waits
            self.error = error

    def _tell(self, number, done, total):
        self._check()
        self.share = (number + done / max(total, 1)) / len(self.jobs)

    def _check(self):
        if self._stop.is_set():
            raise Cancelled
