"""Draws the median error of `auto` and `osculating` against resolution, noise, aspect and radius.

error.py [--program PROGRAM] [-o PICTURE.png]

Prints every point. Meshes are irregular ones of `osculate synth` (`--jitter 0.3`), with its exact curvature.
The error of a face is that of k_max or k_min, whichever is worse, relative to the larger of them in
magnitude (at least a hundredth of the largest on the mesh). Needs numpy, and matplotlib for the picture.
"""
import numpy as np

from synthetic import measure, options

ESTIMATORS = ("auto", "osculating")
TORUS = ["torus", "--faces", "10000"]


def median(program, synth, annotate):
    """Median error in percent; a face without an estimate counts as infinitely wrong."""
    _, error = measure(program, [*synth, "--jitter", "0.3"], annotate)
    return 100 * np.median(np.where(np.isfinite(error), error, np.inf))


def sweeps():
    """Panels: their title, the axis, whether it is logarithmic, and lines of (name, [(x, synth, annotate)])."""
    sizes = (300, 1000, 3000, 10000, 30000)
    yield "resolution", "faces", True, [
        (shape, [(n, [shape, "--faces", str(n)], []) for n in sizes]) for shape in ("wave", "monkey-saddle")]
    noises = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3)
    yield "noise, torus", "noise, mean edges", True, [
        ("torus", [(x, [*TORUS, "--noise", str(x)], []) for x in noises])]
    yield "aspect, torus", "length by width of the cells", True, [
        ("torus", [(x, [*TORUS, "--aspect", str(x)], []) for x in (1, 2, 5, 10, 20)])]
    yield "radius, torus with noise 0.1", "--radius-factor", False, [
        ("torus", [(x, [*TORUS, "--noise", "0.1"], ["--radius-factor", str(x)]) for x in (1.5, 2, 3, 4, 6, 8)])]


def draw(panels, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, len(panels), figsize=(12, 3), constrained_layout=True)
    for axis, (title, label, logarithmic, lines) in zip(axes, panels):
        for (name, estimator), points in lines.items():
            x, y = zip(*points)
            style = {"auto": "C0", "osculating": "C1"}[estimator] + {"monkey-saddle": "s--"}.get(name, "o-")
            whose = f"{estimator}, {name}" if title == "resolution" else estimator
            axis.plot(x, y, style, markersize=3, label=whose)
        axis.set(yscale="log", title=title, xlabel=label, xscale="log" if logarithmic else "linear")
        axis.grid(alpha=0.3)
        axis.legend(frameon=False, fontsize=7)
    axes[0].set_ylabel("median error, % of |k|")
    figure.savefig(path, dpi=90, metadata={"Software": None})


def main():
    given = options(__doc__)
    panels = []
    for title, label, logarithmic, lines in sweeps():
        found = {}
        for name, points in lines:
            for estimator in ESTIMATORS:
                found[name, estimator] = [
                    (x, median(given.program, synth, [*annotate, "--estimator", estimator]))
                    for x, synth, annotate in points]
                print(f"{title}: {name}, {estimator}: " + ", ".join(f"{x:g}: {y:.3g} %" for x, y in found[name, estimator]))
        panels.append((title, label, logarithmic, found))
    if given.output:
        draw(panels, given.output)


if __name__ == "__main__":
    main()
