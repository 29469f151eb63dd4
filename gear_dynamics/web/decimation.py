"""Decimation for the screen: no peak is lost, however many samples fall on one pixel."""

from __future__ import annotations

import numpy as np


def extremes(values: np.ndarray, pixels: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the positions and values that draw a line of at most 2 points a pixel.

    Each pixel keeps its least and its greatest value, so that a peak of one sample stays visible.

    Parameters
    ----------
    values : (n,) array
    pixels : int
        Width of the drawing.

    Returns
    -------
    positions : (m,) float64 array
        In samples from the first; m is n where the samples are few, else 2 * pixels.
    values : (m,) array
    """
    n = len(values)
    if n <= 2 * pixels:
        return np.arange(n, dtype=np.float64), values
    edges = np.arange(pixels + 1) * n // pixels
    low = np.minimum.reduceat(values, edges[:-1])
    high = np.maximum.reduceat(values, edges[:-1])
    # Least and greatest value of a pixel, in the order in which a rising line meets them.
    drawn = np.column_stack([low, high]).ravel()
    places = np.repeat((edges[:-1] + edges[1:] - 1) / 2, 2)
    return places, drawn
