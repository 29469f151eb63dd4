"""A minimal sensor: noise on the channels, and a pulse a revolution."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.parameters.parameter import ParameterError, refuse_unknown_name

TACHO = 'tacho'
"""Name of the column with the pulses."""

PULSE = 0.1
"""Share of a revolution for which the pulse lasts, from pinion angle 0 on."""


def noise_densities(text: str) -> dict[str, float]:
    """Return the noise of each channel from a text such as 'pinion_ay 0.01, mesh_force 2'.

    Raises
    ------
    ParameterError
        If a channel is unknown, or its density is no number from 0 up.
    """
    densities = {}
    for part in text.split(',') if text.strip() else []:
        name, _, number = part.strip().partition(' ')
        try:
            refuse_unknown_name(name, CHANNELS)
            density = float(number)
        except ParameterError:
            raise ParameterError(
                f'noise_density has {name!r}: the channels are {", ".join(CHANNELS)}'
            ) from None
        except ValueError:
            density = -1.0
        if not (math.isfinite(density) and density >= 0):
            raise ParameterError(
                f'noise_density has {part.strip()!r}: each part between commas must be a channel '
                'and its density, 0 or more'
            )
        densities[name] = density
    return densities


class Sensor:
    """Adds white Gaussian noise to samples, the same one for the same seed.

    Parameters
    ----------
    noise_density : str
        Channels with their one-sided amplitude densities [unit / sqrt(Hz)]; see `noise_densities`.
    seed : int
    sample_rate : float
        [Hz]; the noise reaches up to half of it.

    Raises
    ------
    ParameterError
        If the text is malformed.
    """

    def __init__(self, noise_density: str, seed: int, sample_rate: float) -> None:
        root = math.sqrt(sample_rate / 2)
        self._deviations = {
            name: density * root
            for name, density in noise_densities(noise_density).items()
            if density > 0
        }
        self._random = np.random.default_rng(seed)

    def measured(self, samples: np.ndarray) -> np.ndarray:
        """Return the samples as measured, an array of SAMPLES; the same one without noise."""
        if not self._deviations:
            return samples
        noisy = samples.copy()
        for name, deviation in self._deviations.items():
            noisy[name] += deviation * self._random.standard_normal(len(samples))
        return noisy


def tacho_pulses(samples: np.ndarray) -> np.ndarray:
    """Return 1 for the first tenth of each revolution of the pinion, and 0 for the rest."""
    return np.where(samples['pinion_angle'] < 2 * np.pi * PULSE, 1.0, 0.0)
