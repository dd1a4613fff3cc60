# SPDX-License-Identifier: MIT
"""Colour scales: which value has which colour. The rules and colours are those of the program."""

import numpy as np

from . import store, wheel
from .quantities import BY_TOKEN, CLASSES, NOT_ESTIMATED
from .estimate import Refused

#: Stops of a colour ramp: Blender takes 32 at most, and an odd number has one for the middle of a range.
_STOPS = 31
_ROBUST = 0.95


class Scale:
    """quantity, name of the map, lowest and highest value, palette (256 x 3, sRGB, 0 to 1)."""

    def __init__(self, token, colormap, bounds, meshes):
        self.quantity = BY_TOKEN[token]
        self.is_classes = token == "class"
        values = [_estimated(mesh, self.quantity) for mesh in meshes]
        if self.is_classes:
            self.low, self.high, name = -0.5, len(CLASSES) - 1.5, "classes"
        else:
            self.low, self.high = bounds or _automatic(self.quantity, np.concatenate(values))
            name = colormap or ("blue-red" if self.quantity.is_signed else "viridis")
        if not self.low < self.high:
            raise Refused(f"The range {self.low:g} to {self.high:g} is empty or reversed; give the lower value first.")
        try:
            self.palette = wheel.osculate().palette(name) / 255
        except ValueError as error:
            raise Refused(str(error)) from error
        self.colormap = name

    def stops(self):
        """Places, 0 to 1, and colours in linear light of a ramp; that of classes is constant between them."""
        if self.is_classes:
            codes = np.arange(len(CLASSES) - 1)
            return codes / len(codes), _linear(self.palette[255 * codes // len(codes) + 25])
        places = np.linspace(0, 1, _STOPS)
        return places, _linear(self.palette[np.rint(254 * places).astype(int)])

    @property
    def none(self):
        """The colour of faces without estimate, in linear light."""
        return _linear(self.palette[255])

    def colors(self, mesh):
        """The colour of each face, sRGB."""
        values, known = store.get(mesh, self.quantity.attribute), _known(mesh)
        share = np.clip((values.astype(float) - self.low) / (self.high - self.low), 0, 1)
        index = np.where(known, np.rint(254 * share), 255).astype(int)
        return self.palette[index]


def _linear(color):
    return np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)


def _known(mesh):
    classes = store.get(mesh, BY_TOKEN["class"].attribute)
    return np.ones(len(mesh.polygons), bool) if classes is None else classes != NOT_ESTIMATED


def _estimated(mesh, quantity):
    values = store.get(mesh, quantity.attribute)
    attribute = mesh.attributes.get(quantity.attribute)
    if values is None or attribute.domain != "FACE":
        raise Refused(
            f"\"{mesh.name}\" has no {quantity.label.lower()} on its faces; annotate it first, with \"{quantity.token}\" "
            "among the attributes.")
    return values[_known(mesh)]


def _automatic(quantity, values):
    """-1 to 1 for the shape index; otherwise up to the 95th percentile of the magnitudes, on both sides of zero for
    a signed quantity. Where that is zero the largest; where all are zero, 1."""
    if quantity.token == "shape_index":
        return -1.0, 1.0
    magnitudes = np.abs(values[np.isfinite(values)])
    reach = 1.0
    if len(magnitudes):
        at = int(np.floor((len(magnitudes) - 1) * _ROBUST + 0.5))
        reach = float(np.partition(magnitudes, at)[at]) or float(magnitudes.max()) or 1.0
    return (-reach if quantity.is_signed else 0.0), reach
