"""Mesh phase from the shaft angles, and signals resampled by it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gear_dynamics.signal.arguments import real_array, whole_number
from gear_dynamics.signal.interpolation import HALF_WIDTH, interpolate_rows
from gear_dynamics.signal.spectrum import amplitude_spectrum


def mesh_phase(
    pinion_angle: npt.ArrayLike,
    gear_angle: npt.ArrayLike,
    pinion_teeth: int,
    gear_teeth: int,
    pinion_weight: float = 1.0,
    *,
    axis: int = 0,
) -> np.ndarray:
    """Return the unwrapped mesh phase in cycles, rising where the wheels turn forward.

    Parameters
    ----------
    pinion_angle, gear_angle : array_like, of one shape
        Shaft angles [rad], wrapped or not, moving by less than half a turn a sample.
    pinion_teeth, gear_teeth : int
    pinion_weight : float
        Weight of the pinion's angle against the gear's. With the share of the inertia,
        `pinion_inertia_share`, the torsional vibration of the pair cancels and the rotation of
        the rigid pair remains, with the slow twist of the drive: nothing in steady motion.
    axis : int
        Axis of the samples.

    Raises
    ------
    ValueError
        If the angles differ in shape, or one is not finite.
    """
    pinion = _turned(pinion_angle, 'pinion_angle', axis) * pinion_teeth
    if pinion_weight == 1:
        return np.moveaxis(pinion, 0, axis)
    gear = _turned(gear_angle, 'gear_angle', axis) * gear_teeth
    if gear.shape != pinion.shape:
        raise ValueError(
            f'gear_angle has {gear.size} values: it must have the shape of pinion_angle'
        )
    # Whole turns are lost in the angles; both wheels pass the same phase of the mesh.
    gear -= np.round(gear[0] - pinion[0])
    return np.moveaxis(pinion_weight * pinion + (1 - pinion_weight) * gear, 0, axis)


def _turned(angle: npt.ArrayLike, name: str, axis: int) -> np.ndarray:
    """Return how far a shaft has turned, in turns."""
    values = real_array(angle, name, axis).astype(float, copy=False)
    return np.unwrap(values, axis=0) / (2 * np.pi)


def pinion_inertia_share(
    pinion_inertia: float, gear_inertia: float, pinion_teeth: int, gear_teeth: int
) -> float:
    """Return I1 / (I1 + I2 (z1 / z2)^2), the pinion's share of the inertia seen at its shaft."""
    reduced = gear_inertia * (pinion_teeth / gear_teeth) ** 2
    return pinion_inertia / (pinion_inertia + reduced)


def resample_by_phase(
    x: npt.ArrayLike, phase: npt.ArrayLike, points: int, *, axis: int = 0
) -> tuple[int, np.ndarray]:
    """Return x at equal steps of the phase, `points` a cycle.

    The instants are interpolated linearly in the phase; a steady acceleration a [cycles/s2] makes
    an error of at most a / (8 rate^2) cycles. x is interpolated as a band-limited signal, which is
    accurate for content below 0.4 of the sample rate. There is no low-pass filter: with fewer
    points than samples in a cycle, content above points / 2 orders is aliased. The 16 samples at
    either end give no points.

    Parameters
    ----------
    x : array_like
        More than 32 samples along `axis`.
    phase : array_like, shape (n,)
        In cycles, rising.
    points : int
        Points in a cycle.
    axis : int
        Axis of the samples.

    Returns
    -------
    first : int
        The first point is at phase first / points.
    values : ndarray
        Of the shape of x, with the points along `axis`.

    Raises
    ------
    ValueError
        If the phase does not rise everywhere, its length is not that of x, or a value is not
        finite.
    """
    x, phase = real_array(x, axis=axis), real_array(phase, 'phase')
    points = whole_number(points, 'points')
    if phase.shape != x.shape[:1]:
        raise ValueError(f'phase has the shape {phase.shape}: it must be {x.shape[:1]}, as x has')
    if not np.all(np.diff(phase) > 0):
        raise ValueError('the phase does not rise at every sample: the shaft must turn forward')
    if len(phase) <= 2 * HALF_WIDTH:
        raise ValueError(f'{len(phase)} samples are too few: more than {2 * HALF_WIDTH} are needed')
    first = int(np.ceil(phase[HALF_WIDTH] * points))
    ticks = np.arange(first, int(np.floor(phase[-1 - HALF_WIDTH] * points)) + 1)
    positions = np.interp(ticks / points, phase, np.arange(len(phase)))
    # Rounding may place the first or last point just outside.
    positions = np.clip(positions, HALF_WIDTH - 1, len(x) - 1 - HALF_WIDTH)
    values = interpolate_rows(x.reshape(len(x), -1), positions)
    return first, np.moveaxis(values.reshape((-1, *x.shape[1:])), 0, axis)


def order_spectrum(
    x: npt.ArrayLike,
    phase: npt.ArrayLike,
    teeth: int,
    *,
    points: int = 128,
    revolutions: int = 8,
    window: str = 'hann',
    overlap: float = 0.5,
    scale: str = 'peak',
    axis: int = 0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the amplitude spectrum over orders of the wheel with `teeth` teeth.

    Parameters
    ----------
    x : array_like
    phase : array_like, shape (n,)
        Mesh phase in cycles, rising.
    teeth : int
        Mesh cycles in a revolution of the wheel.
    points : int
        Points in a mesh cycle.
    revolutions : int
        Length of a segment; lines are 1 / revolutions orders apart.
    window, overlap, scale
        As `amplitude_spectrum` takes them.
    axis : int
        Axis of the samples.

    Returns
    -------
    order : ndarray
        Events in a revolution.
    amplitude : ndarray
        Of the shape of x, with one line an order along `axis`.
    """
    _, values = resample_by_phase(x, phase, points, axis=axis)
    return amplitude_spectrum(
        values,
        points * teeth,
        window=window,
        length=points * teeth * revolutions,
        overlap=overlap,
        scale=scale,
        axis=axis,
    )
