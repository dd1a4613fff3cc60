"""Is `confidence` calibrated? Prints and draws the error of faces by deciles of their confidence.

calibration.py [--program PROGRAM] [-o PICTURE.png]

Meshes are those of `osculate synth`, with its exact curvature. The error of a face is that of k_max or
k_min, whichever is worse, relative to the larger of them in magnitude (at least a hundredth of the
largest on the mesh). Every bin holds a tenth of a group's faces; a mesh's faces count as much as those of
another. Needs numpy, and matplotlib for the picture (without -o there is none).
"""
import numpy as np

from synthetic import measure, options

SHAPES = {
    "torus": ["torus", "--jitter", "0.3"],
    "wave": ["wave", "--jitter", "0.3"],
    "ellipsoid": ["ellipsoid", "--jitter", "0.3", "--size", "2,3,4.4"],
    "fillet-box": ["fillet-box", "--fillet", "0.5"],
}
NOISE = {"clean": "0", "noise 0.01": "0.01", "noise 0.1": "0.1"}
FACES = "10000"


def estimated(program, shape, noise):
    """Confidence and relative error of every estimated face of one mesh."""
    confidence, error = measure(program, [*SHAPES[shape], "--faces", FACES, "--noise", NOISE[noise]])
    known = np.isfinite(error)
    return confidence[known], error[known]


def deciles(confidence, error):
    """Of ten bins of equal size: mean confidence, median and 95th percentile of the error in percent.

    In the order of the file where confidences are equal.
    """
    order = np.argsort(confidence, kind="stable")
    return np.array([[confidence[bin].mean(), *(100 * np.percentile(error[bin], [50, 95]))]
                     for bin in np.array_split(order, 10)])


def draw(groups, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, len(groups), figsize=(9, 2.9), sharey=True, constrained_layout=True)
    for axis, (name, bins) in zip(axes, groups.items()):
        decile = np.arange(1, 11)
        axis.plot(decile, np.maximum(bins[:, 1], 1e-7), "o-", markersize=3, label="median")
        axis.plot(decile, np.maximum(bins[:, 2], 1e-7), "s-", markersize=3, label="95th percentile")
        axis.set(yscale="log", title=name, xlabel="decile of confidence", xticks=[1, 5, 10])
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("error, % of |k|")
    axes[0].legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=90, metadata={"Software": None})


def main():
    given = options(__doc__)
    found = {(shape, noise): estimated(given.program, shape, noise) for noise in NOISE for shape in SHAPES}
    groups = {"all": list(found)}
    groups |= {noise: [key for key in found if key[1] == noise] for noise in NOISE}
    single = {f"{shape}, {noise}": [(shape, noise)] for shape, noise in found}
    result = {}
    for name, keys in (groups | single).items():
        bins = deciles(*(np.concatenate([found[key][i] for key in keys]) for i in (0, 1)))
        result[name] = bins
        print(f"{name}: mean confidence, median and 95th percentile of the error in %")
        for decile, (confidence, median, p95) in enumerate(bins, 1):
            print(f"  {decile:2} {confidence:8.5f} {median:9.3g} {p95:9.3g}")
    if given.output:
        draw({name: result[name] for name in groups}, given.output)


if __name__ == "__main__":
    main()
