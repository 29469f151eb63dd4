"""How much of the time the teeth are out of contact, and what they strike."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SHARE_OF_CONTACT = 1e-4
"""Less time out of contact than this counts as contact throughout."""


class Rattle(NamedTuple):
    """The state of contact over a span.

    Attributes
    ----------
    out_of_contact : float
        Share of the time in which delta is within the backlash, 0 to 1.
    losses : int
        Times that the drive flank let go.
    back_impacts : int
        Times that the back flank was struck.
    """

    out_of_contact: float
    losses: int
    back_impacts: int

    @property
    def words(self) -> str:
        """The name of the state (Kahraman and Singh 1990)."""
        if self.back_impacts:
            return 'double-sided impacts: rattle against the back flank'
        if self.out_of_contact > SHARE_OF_CONTACT or self.losses:
            return 'single-sided impacts: the teeth separate and meet again'
        return 'no impacts: the teeth stay in contact'


def rattle(delta: np.ndarray, half_backlash: float) -> Rattle:
    """Return the state of contact from samples of delta at equal steps.

    Between two samples delta is taken to be straight, so that the share is not rounded to whole
    samples. Flank errors of single teeth are left out of account.

    Parameters
    ----------
    delta : ndarray, shape (n,), n at least 2
        [m]
    half_backlash : float
        [m]
    """
    if delta.min() > half_backlash:
        return Rattle(0.0, 0, 0)
    before, after = delta[:-1], delta[1:]
    low, high = np.minimum(before, after), np.maximum(before, after)
    inside = np.minimum(high, half_backlash) - np.maximum(low, -half_backlash)
    length = high - low
    level = np.where(np.abs(before) <= half_backlash, 1.0, 0.0)
    share = np.where(length > 0, np.clip(inside, 0, None) / np.where(length > 0, length, 1), level)
    return Rattle(
        float(share.mean()),
        int(np.count_nonzero((before > half_backlash) & (after <= half_backlash))),
        int(np.count_nonzero((before >= -half_backlash) & (after < -half_backlash))),
    )


class RattleCounter:
    """`rattle` of a stream, block by block; the step from one block to the next counts too."""

    def __init__(self, half_backlash: float) -> None:
        self.half_backlash = half_backlash
        self._last: np.ndarray = np.empty(0)
        self._clear()

    def _clear(self) -> None:
        self._steps = 0
        self._out = 0.0
        self._losses = 0
        self._back_impacts = 0

    def add(self, delta: np.ndarray) -> None:
        """Take the next samples of delta [m]."""
        joined = np.append(self._last, delta)
        self._last = joined[-1:]
        steps = len(joined) - 1
        if steps:
            found = rattle(joined, self.half_backlash)
            self._steps += steps
            self._out += found.out_of_contact * steps
            self._losses += found.losses
            self._back_impacts += found.back_impacts

    def take(self) -> Rattle:
        """Return the state over what was added since the last call."""
        result = Rattle(self._out / max(self._steps, 1), self._losses, self._back_impacts)
        self._clear()
        return result
