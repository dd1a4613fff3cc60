"""Annotates all meshes of a folder on Ray: on the cluster that it is submitted to, or on all cores of this machine.

usage: cluster.py INPUTS OUT [--keep-extension] [NAME=VALUE...]      settings of `osculate batch`, such as unit=mm

    python cluster.py scans annotated unit=mm

On a cluster, with the wheel that `pip wheel ./python` made beside this file (docs/pipelines.md):

    ray job submit --address http://HEAD:8265 --working-dir . \\
        --runtime-env-json '{"pip": ["${RAY_RUNTIME_ENV_CREATE_WORKING_DIR}/WHEEL"]}' \\
        -- python cluster.py s3://scans/raw s3://scans/annotated
"""

import argparse
import logging
import sys

import osculate.ray

parser = argparse.ArgumentParser()
parser.add_argument("inputs")
parser.add_argument("out")
parser.add_argument("--keep-extension", action="store_true")
parser.add_argument("settings", nargs="*")
given = parser.parse_args()
logging.basicConfig(level=logging.INFO, format="%(message)s")

settings = dict(setting.split("=", 1) for setting in given.settings)
records = osculate.ray.annotate_dataset(
    given.inputs, given.out, resume=True, keep_extension=given.keep_extension, **settings
)
failed = [row["message"] for row in records.iter_rows() if row["status"] == "failed"]
for message in failed:
    print(message)
sys.exit(1 if failed else 0)
