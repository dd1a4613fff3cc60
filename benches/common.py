"""What the measuring scripts share: the program built for release, timed runs, and tables in docs/performance.md."""
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "performance.md"


def program():
    """The program: $OSCULATE, or built for release."""
    if "OSCULATE" in os.environ:
        return Path(os.environ["OSCULATE"]).resolve()
    subprocess.run(["cargo", "build", "--release", "--quiet", "--bin", "osculate"], cwd=ROOT, check=True, stdout=sys.stderr)
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "osculate"


def anonymous_kilobytes(pid):
    """Memory of a process that is not that of a file: the kernel's own count."""
    try:
        for line in Path(f"/proc/{pid}/status").read_text().splitlines():
            if line.startswith("RssAnon:"):
                return int(line.split()[1])
    except OSError:
        pass
    return 0


def run(command, **more):
    """Runs a command to its end: wall-clock seconds, seconds of all processors, megabytes at its peak, of
    them anonymous ones (looked at every 2 ms), and what it prints."""
    output = tempfile.TemporaryFile()
    start = time.perf_counter()
    process = subprocess.Popen([str(part) for part in command], stdout=output, **more)
    peak, done = [0], threading.Event()

    def watch():
        while not done.wait(0.002):
            peak[0] = max(peak[0], anonymous_kilobytes(process.pid))

    watcher = threading.Thread(target=watch)
    watcher.start()
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    done.set()
    watcher.join()
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 3):
        raise RuntimeError(f"{command[0]} ended with {process.returncode}")
    output.seek(0)
    return {"wall": wall, "cpu": usage.ru_utime + usage.ru_stime, "peak": usage.ru_maxrss / 1024,
            "anonymous": peak[0] / 1024, "output": output.read().decode()}


def annotate(command, output):
    """What `run` tells of `osculate annotate` with its output, without statistics, which are worked out only for those who
    ask; and the seconds of its stages from a second run that asks. The output is new each time, as all others write
    theirs: file systems take time to replace one safely."""
    output.unlink(missing_ok=True)
    result = run([*command, "-o", output])
    output.unlink()
    with tempfile.TemporaryDirectory() as folder:
        stats = Path(folder) / "stats.json"
        run([*command, "-o", output, "--stats", stats])
        result["seconds"] = json.loads(stats.read_text())["seconds"]
    return result


def median(values):
    values = sorted(values)
    return values[len(values) // 2]


def machine():
    """The processor, for people."""
    model = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    return f"{model.group(1) if model else 'unknown processor'}, {os.cpu_count()} cores"


def write(script, heading, text, path=PAGE):
    """Replaces a script's part of docs/performance.md or another page, or adds it under a heading."""
    begin, end = f"<!-- {script} -->", f"<!-- end of {script} -->"
    page = path.read_text()
    if begin not in page:
        page = f"{page.rstrip()}\n\n## {heading}\n\n{begin}\n{end}\n"
    part = f"{begin}\n{text.strip()}\n{end}"
    path.write_text(re.sub(f"{re.escape(begin)}.*?{re.escape(end)}", lambda _: part, page, flags=re.S))
    print(text)


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)
