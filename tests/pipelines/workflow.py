"""Runs the shell steps of the workflow as GitHub does, in a repository made for it, twice.

usage: workflow.py WORKFLOW PROGRAM FIXTURES FOLDER
"""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import yaml

workflow, program, fixtures, folder = sys.argv[1], *map(Path, sys.argv[2:])
job = yaml.safe_load(Path(workflow).read_text())["jobs"]["annotate"]
meshes = folder / "meshes"
(meshes / "sub").mkdir(parents=True)
for name, of in {"a b.stl": "suzanne.stl", "worn.stl": "fillet_degenerate.stl", "sub/head.ply": "suzanne.ply"}.items():
    shutil.copy(fixtures / of, meshes / name)
# The program comes from the cache, as in every run but the first: it need not be built.
programs = folder / ".git" / "programs"
summary = folder / ".git" / "summary.md"
environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "GITHUB_STEP_SUMMARY": str(summary)}
for kind in ("AUTHOR", "COMMITTER"):
    environment |= {f"GIT_{kind}_NAME": "A", f"GIT_{kind}_EMAIL": "a@b.c", f"GIT_{kind}_DATE": "2024-05-06T07:08:09Z"}


def git(*arguments):
    subprocess.run(
        ["git", "-c", "init.defaultBranch=main", *arguments],
        cwd=folder,
        check=True,
        env=environment,
        stdout=subprocess.DEVNULL,
    )


def run():
    """The shell steps, of whatever went before: the exit codes by name, and what the last one said."""
    summary.unlink(missing_ok=True)
    codes = {}
    for step in job["steps"]:
        if "run" not in step or "cache-hit" in step.get("if", ""):
            continue
        if any(codes.values()) and step.get("if") != "always()":
            continue
        assert "${{" not in step["run"], "an expression that only GitHub fills in"
        codes[step["name"]] = subprocess.run(
            ["bash", "-e", "-c", step["run"]], cwd=folder, env=environment, stderr=subprocess.PIPE
        ).returncode
    return codes, summary.read_text()


def records():
    lines = (folder / "annotated/osculate-batch.jsonl").read_text().splitlines()
    return [json.loads(line) for line in lines]


git("init", "-q")
programs.mkdir()
(programs / "osculate").symlink_to(program)
git("add", ".")
git("commit", "-qm", "Meshes")
codes, said = run()
assert codes and not any(codes.values()), codes
assert [record["output"] for record in records() if record["status"] == "done"] and len(records()) == 3
assert re.search(r"\| meshes/worn.stl \| defects \| \d+ \| .*faces without area", said) and "a b.stl" not in said, said
assert (folder / "annotated/a b.stl.glb").stat().st_size > 0

# A new checkout has new times; the annotated files come from the cache as they were.
for path in meshes.rglob("*.*"):
    os.utime(path)
(meshes / "broken.obj").write_text("v 0 0\n")
git("add", ".")
git("commit", "-qm", "One that is no mesh")
codes, said = run()
assert codes["Annotate"] == 1, "the job does not fail"
assert [record["input"] for record in records()[3:]] == ["meshes/broken.obj"], "what was done is done again"
assert "| meshes/broken.obj | failed |  |" in said and "worn.stl" in said, said
print(f"{len(codes)} steps, twice: 3 files and then 1")
