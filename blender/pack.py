# SPDX-License-Identifier: MIT
"""Puts the extension and its wheels into one zip, the same bytes for the same contents.

usage: pack.py OUTPUT.zip WHEEL..."""

import re
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
#: Not part of what is installed.
TOOLS = {"pack.py"}
#: Blender's name for the system of a wheel.
PLATFORMS = (
    (r"manylinux.*_x86_64|linux_x86_64", "linux-x64"),
    (r"manylinux.*_aarch64|linux_aarch64", "linux-arm64"),
    (r"macosx_.*_arm64", "macos-arm64"),
    (r"macosx_.*_x86_64", "macos-x64"),
    (r"win_amd64", "windows-x64"),
    (r"win_arm64", "windows-arm64"),
)


def platforms_of(wheel):
    """The systems of a wheel, by the tag in its name; one for two kinds of Mac has both."""
    tag = wheel.stem.split("-")[-1]
    if "macosx" in tag and tag.endswith("universal2"):
        return ["macos-arm64", "macos-x64"]
    found = [platform for pattern, platform in PLATFORMS if re.search(pattern, tag)]
    if not found:
        sys.exit(f"{wheel.name}: Blender has no platform for \"{tag}\"; known are wheels for Linux, macOS and Windows")
    return found


def manifest(wheels):
    """The manifest with what depends on the build, and the version of the crate."""
    text = (HERE / "blender_manifest.toml").read_text()
    version = re.search(r'^version = "(.*)"', (HERE.parent / "Cargo.toml").read_text(), re.MULTILINE).group(1)
    text = re.sub(r'^version = ".*"', f'version = "{version}"', text, flags=re.MULTILINE)
    platforms = sorted({platform for wheel in wheels for platform in platforms_of(wheel)})
    quoted = lambda names: ", ".join(f'"{name}"' for name in names)
    lines = f"platforms = [{quoted(platforms)}]\nwheels = [{quoted(f'./wheels/{wheel.name}' for wheel in wheels)}]\n"
    return text.replace("\n[permissions]", f"\n{lines}\n[permissions]")


def main(output, *wheels):
    wheels = sorted(Path(wheel) for wheel in wheels)
    files = {path.name: path.read_bytes() for path in HERE.glob("*.py") if path.name not in TOOLS}
    files["blender_manifest.toml"] = manifest(wheels).encode()
    files["LICENSE"] = (HERE.parent / "LICENSE-MIT").read_bytes()
    files.update((f"wheels/{wheel.name}", wheel.read_bytes()) for wheel in wheels)
    output = Path(output)
    # Whole or not at all.
    with tempfile.NamedTemporaryFile(dir=output.parent, delete=False) as unfinished:
        with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in sorted(files.items()):
                entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
                entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
                archive.writestr(entry, content)
    Path(unfinished.name).chmod(0o644)
    Path(unfinished.name).replace(output)
    print(f"{output}: {output.stat().st_size / 1e6:.1f} MB, {', '.join(wheel.name for wheel in wheels)}")


if __name__ == "__main__":
    main(*sys.argv[1:])
