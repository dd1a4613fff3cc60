"""Many files on a Ray cluster, or on all cores of one machine: ``pip install osculate[ray]``.

    import osculate.ray

    records = osculate.ray.annotate_dataset("s3://scans/raw", "s3://scans/annotated", format="glb", resume=True)
    records.filter(expr="status == 'failed'").show()

Ray Data schedules the work; what is done to each file is what ``osculate batch`` does, with the same settings, names
of outputs, log and rule for going on, so that either goes on where the other has stopped.
"""

from __future__ import annotations

from ..errors import MissingPackageError

try:
    import pyarrow as _pyarrow  # noqa: F401
    import ray.data as _data  # noqa: F401
except ImportError as _error:
    raise MissingPackageError(f"osculate.ray needs Ray Data ({_error}): pip install 'osculate[ray]'") from _error

from ._dataset import annotate_dataset

__all__ = ["annotate_dataset"]
