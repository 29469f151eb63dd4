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
