#!/usr/bin/env python3
"""Do values depend on how a scan was meshed, and how far off are they on scans with known curvature?

    python3 -m venv ~/.cache/osculate/peers
    ~/.cache/osculate/peers/bin/pip install numpy scipy libigl pymeshlab
    cargo build --release
    ~/.cache/osculate/peers/bin/python benches/scan_stability.py --bin target/release/osculate bunny.obj dragon.ply

Every scan given is compared with copies of itself, beside libigl's `principal_curvature` (radius 5):
  noise 0.02, 0.1   Gaussian noise of that many mean edges on every coordinate
  half              half the faces, by MeshLab's quadric edge collapse
  retriangulated    a fifth of the edges flipped, vertices moved in their tangent plane by a tenth of an edge
For every face of the copy and the original's face of nearest barycentre (with noise, the same face): the rank
correlation (Spearman) of the mean curvature, and the median change of k_max in percent of the original's 90th
percentile of |k_max|. Means over the seeds. "behind": worse than libigl. "short": under a rank correlation of
0.99 (half: 0.95), or a change over 3 % (half: no limit, since its edges are longer).

Then synthetic scans, whose curvature is known: `osculate synth --scan-noise`, beside libigl and MeshLab's
scale-dependent quadrics at 3 mean edges and at its default scale. Median and 95th percentile over all faces of
the error of k_max or k_min, whichever is worse, in percent of the larger of the two in magnitude (at least a
hundredth of the mesh's largest). "behind": worse than any of the three in either figure.

Copies and the other libraries' values are kept in --cache. Exit code 1 while any line is behind or short.
"""

import argparse
import hashlib
import json
import sys
from pathlib import Path

import numpy as np
from scipy.stats import spearmanr

from scans import copies, estimates, mesh

COPIES = {
    "noise 0.02": lambda points, faces, seed: copies.noisy(points, faces, 0.02, seed),
    "noise 0.1": lambda points, faces, seed: copies.noisy(points, faces, 0.1, seed),
    "half": lambda points, faces, seed: copies.halved(points, faces),
    "retriangulated": copies.retriangulated,
}
# No poles: MeshLab's scale-dependent quadrics do not come to an end at the slivers there.
SHAPES = ["torus", "wave", "saddle", "monkey-saddle"]
SCAN_NOISE = [0.02, 0.05, 0.1]
MESHLAB_SCALES = {"MeshLab 3 edges": 3, "MeshLab default": None}


def main():
    arguments = parse()
    seeds = range(arguments.seeds)
    lines = []
    if arguments.scans:
        print(f"{'scan':22} {'copy':15} {'rank correlation':>18} {'libigl':>8} {'change %':>10} {'libigl':>8} "
              f"{'no value':>9}")
    for scan in arguments.scans:
        lines += stability(arguments, scan, seeds)
    if not arguments.no_synthetic:
        peers = ["libigl", *MESHLAB_SCALES]
        print(f"\n{'synthetic scan':22} {'noise':>6} {'median / p95 %':>16} " + " ".join(f"{p:>16}" for p in peers))
        for shape in SHAPES:
            lines += synthetic(arguments, shape, seeds)
    if arguments.json:
        arguments.json.write_text(json.dumps(lines, indent=1) + "\n")
    sys.exit(1 if any(line["verdict"] for line in lines) else 0)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scans", nargs="*", type=Path, metavar="SCAN", help="a mesh that MeshLab reads")
    parser.add_argument("--bin", required=True, type=Path, help="the osculate program")
    parser.add_argument("--options", default="", help="options for every `osculate annotate`")
    parser.add_argument("--seeds", type=int, default=5, help="copies of each random kind (default 5)")
    parser.add_argument("--faces", type=int, default=10_000, help="faces of a synthetic scan (default 10000)")
    parser.add_argument("--no-synthetic", action="store_true", help="only the scans given")
    cache = Path.home() / ".cache/osculate/scan_stability"
    parser.add_argument("--cache", type=Path, default=cache,
                        help="folder for copies and the other libraries' values (default %(default)s)")
    parser.add_argument("--json", type=Path, help="also write the lines to this file")
    arguments = parser.parse_args()
    for path in [arguments.bin, *arguments.scans]:
        if not path.is_file():
            parser.error(f"{path} is not a file")
    arguments.cache.mkdir(parents=True, exist_ok=True)
    return arguments


def stability(arguments, scan, seeds):
    """The lines of one scan."""
    name = f"{scan.stem}-{hashlib.sha256(scan.read_bytes()).hexdigest()[:12]}"
    original, theirs, _ = prepared(arguments, name, lambda: mesh.cleaned(*mesh.read(scan)))
    ours = estimates.osculate(arguments.bin, original, arguments.options.split())
    surface = mesh.read(original)
    lines = []
    for kind, make in COPIES.items():
        figures = []
        for seed in [0] if kind == "half" else seeds:
            stem = f"{name}-{kind.replace(' ', '-')}-{seed}"
            same_faces = kind.startswith("noise")
            path, peer, pairs = prepared(
                arguments, stem, lambda: make(*surface, seed), None if same_faces else surface
            )
            copy = estimates.osculate(arguments.bin, path, arguments.options.split())
            figures.append([*agreement(ours, copy, pairs), *agreement(theirs, peer, pairs)])
        rank, change, missing, their_rank, their_change, _ = map(float, np.mean(figures, axis=0))
        verdict = []
        if rank < their_rank or change > their_change:
            verdict.append("behind")
        if rank < (0.95 if kind == "half" else 0.99) or kind != "half" and change > 3:
            verdict.append("short")
        print(
            f"{scan.stem:22} {kind:15} {rank:18.4f} {their_rank:8.4f} {change:10.2f} {their_change:8.2f} "
            f"{missing:9.4f} {' '.join(verdict)}",
            flush=True,
        )
        lines.append({
            "scan": scan.stem, "copy": kind, "seeds": len(figures), "rank_correlation": rank, "change_percent": change,
            "without_value": missing, "libigl": {"rank_correlation": their_rank, "change_percent": their_change},
            "verdict": verdict,
        })
    return lines


def prepared(arguments, stem, make, original=None):
    """A mesh's path, libigl's values for it, and the original's face for each of its faces; made once."""
    path, values = (arguments.cache / f"{stem}{extension}" for extension in (".ply", ".npz"))
    if not values.exists():
        points, faces = make()
        mesh.write(path, points, faces)
        pairs = np.arange(len(faces)) if original is None else copies.nearest(original, (points, faces))
        np.savez_compressed(values, k=estimates.libigl(points, faces), pairs=pairs)
    with np.load(values) as kept:
        return path, kept["k"], kept["pairs"]


def agreement(original, copy, pairs):
    """Rank correlation of the mean curvature, median change of k_max in percent, share of pairs without a value."""
    before, after = (np.asarray(k) for k in (original, copy))
    largest = np.nanpercentile(np.abs(before[0]), 90)
    before = before[:, pairs]
    known = np.isfinite(before).all(axis=0) & np.isfinite(after).all(axis=0)
    rank = spearmanr(before.sum(axis=0)[known], after.sum(axis=0)[known]).statistic
    return rank, 100 * np.median(np.abs(after[0] - before[0])[known]) / largest, 1 - known.mean()


def synthetic(arguments, shape, seeds):
    """The lines of one shape."""
    lines = []
    for noise in SCAN_NOISE:
        ours, theirs = [], {"libigl": [], **{peer: [] for peer in MESHLAB_SCALES}}
        for seed in seeds:
            stem = arguments.cache / f"{shape}-{arguments.faces}-scan-{noise}-{seed}"
            path, truth = stem.with_name(stem.name + ".ply"), stem.with_name(stem.name + ".csv")
            # Made anew every time: `synth` is quick, and may have changed.
            estimates.run(
                arguments.bin, "synth", shape, "--faces", arguments.faces, "--jitter", 0.2, "--scan-noise", noise,
                "--seed", seed, "-o", path, "--exact", truth, "-q",
            )
            exact = estimates.columns(truth, "k_max", "k_min")
            ours.append(errors(estimates.osculate(arguments.bin, path, arguments.options.split()), exact))
            for peer, figures in theirs.items():
                figures.append(errors(peer_values(arguments, path, peer), exact))
        figures = np.mean(ours, axis=0)
        peers = {peer: np.mean(rows, axis=0) for peer, rows in theirs.items()}
        verdict = ["behind"] if any((figures > other).any() for other in peers.values()) else []
        cells = " ".join(f"{f'{median:.3g} / {p95:.3g}':>16}" for median, p95 in [figures, *peers.values()])
        print(f"{shape:22} {noise:6} {cells} {' '.join(verdict)}", flush=True)
        lines.append({
            "synthetic": shape, "scan_noise": noise, "faces": arguments.faces, "seeds": len(ours), **named(figures),
            "peers": {peer: named(pair) for peer, pair in peers.items()}, "verdict": verdict,
        })
    return lines


def named(pair):
    return {"median_percent": float(pair[0]), "p95_percent": float(pair[1])}


def peer_values(arguments, path, peer):
    """Another library's values for a synthetic scan; made once for the same file."""
    stem = f"{hashlib.sha256(path.read_bytes()).hexdigest()[:16]}-{peer.replace(' ', '-')}.npy"
    values = arguments.cache / stem
    if not values.exists():
        surface = mesh.read(path)
        k = estimates.libigl(*surface) if peer == "libigl" else estimates.meshlab(*surface, MESHLAB_SCALES[peer])
        np.save(values, k)
    return np.load(values)


def errors(values, exact):
    """Median and 95th percentile of the error in percent; a face without value is infinitely wrong."""
    size = np.abs(exact).max(axis=0)
    size = np.maximum(size, 0.01 * size.max())
    error = 100 * np.abs(np.asarray(values) - exact).max(axis=0) / size
    error[~np.isfinite(error)] = np.inf
    return np.percentile(error, [50, 95], method="higher")


if __name__ == "__main__":
    main()
