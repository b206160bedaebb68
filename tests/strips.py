"""Drawn objects before a background, whose outlines are known."""

import numpy as np

from rotrecon.edges.edges import Edges, find_edges

SIZE = 140
MIDDLE = np.array([69.3, 70.8])
LENGTH = 60
REACH_PX = 6.0
WOOD, WALL = (0.35, 0.18, 0.08), (0.25, 0.27, 0.28)
DARK, LIGHT = (0.02, 0.02, 0.03), (0.7, 0.7, 0.65)


def covered(distance_px, blur_px):
    """Share of a blurred pixel inside an edge, at signed distances outside it."""
    edges = np.linspace(-8, 8, 3201)
    bell = np.exp(-0.5 * edges**2)
    return 1 - np.interp(distance_px / blur_px, edges, np.cumsum(bell) / bell.sum())


def encoded(light):
    """Display values of linear light."""
    light = np.clip(light, 0, 1)
    srgb = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-6) ** (1 / 2.4) - 0.055)
    return np.rint(255 * srgb).astype(np.uint8)


def across_of(angle):
    return np.array([-np.sin(angle), np.cos(angle)])


def distances(angle):
    """Signed distance of every pixel from a line through the middle."""
    v, u = np.indices((SIZE, SIZE), dtype=np.float64)
    return (np.stack([u, v], axis=-1) - MIDDLE) @ across_of(angle)


def strip(angle, half_width, inner, outer, blur=0.5):
    """A straight object of one colour before a background of another, in linear light."""
    inside = covered(np.abs(distances(angle)) - half_width, blur)[..., None]
    return inside * np.array(inner) + (1 - inside) * np.array(outer)


def sides_of(angle, half_width, shift=0.0, tilt=0.0):
    """Predicted points and normals of the two sides of a strip, each displaced and turned; and their numbers."""
    along = np.array([np.cos(angle), np.sin(angle)])
    steps = np.arange(LENGTH) - (LENGTH - 1) / 2
    point, normal = [], []
    for sign in (1.0, -1.0):
        turned = along + sign * np.tan(tilt) * across_of(angle)
        point.append(MIDDLE + sign * (half_width + shift) * across_of(angle) + steps[:, None] * turned)
        normal.append(np.tile(sign * across_of(angle), (LENGTH, 1)))
    return np.concatenate(point), np.concatenate(normal), np.repeat([0, 1], LENGTH)


def found_on(image, angle, half_width, shift=0.0, tilt=0.0) -> Edges:
    point, normal, side = sides_of(angle, half_width, shift, tilt)
    return find_edges(image, point, normal, REACH_PX, half_width, side)


def mean_of(edges: Edges, rows) -> float:
    offset, sigma = edges.offset_px[rows], edges.sigma_px[rows]
    seen = np.isfinite(offset)
    return float(np.average(offset[seen], weights=sigma[seen] ** -2))


def texture(seed, grain, colours=3):
    """Smooth noise of standard deviation 1, (SIZE, SIZE, colours)."""
    noise = np.random.default_rng(seed).standard_normal((SIZE, SIZE, colours))
    frequency = np.fft.fftfreq(SIZE)
    low_pass = np.exp(-2 * (np.pi * grain) ** 2 * (frequency[:, None] ** 2 + frequency**2))
    smooth = np.fft.ifft2(np.fft.fft2(noise, axes=(0, 1)) * low_pass[..., None], axes=(0, 1)).real
    return smooth / smooth.std()
