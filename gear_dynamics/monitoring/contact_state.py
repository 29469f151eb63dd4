"""How much of the time the teeth are out of contact, and which flanks they strike."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gear_dynamics.machine.columns import EventKind

IN_CONTACT = 1e-4
"""Fraction of time out of contact below which the teeth count as in contact throughout."""

AT_BACKLASH = 1e-4
"""Distance of delta from the half backlash, as a fraction of it, of the events of sound flanks."""


class ContactState(NamedTuple):
    """The state of contact over a span.

    Attributes
    ----------
    out_of_contact : float
        Fraction of the time in which delta is within the backlash, 0 to 1.
    losses : int
        Times that the drive flanks lost contact.
    back_impacts : int
        Times that the back flanks were struck.
    """

    out_of_contact: float
    losses: int
    back_impacts: int

    @property
    def text(self) -> str:
        """The name of the state (Kahraman and Singh 1990)."""
        if self.back_impacts:
            return 'double-sided impacts: rattle against the back flank'
        if self.out_of_contact > IN_CONTACT or self.losses:
            return 'single-sided impacts: the teeth separate and meet again'
        return 'no impacts: the teeth stay in contact'


def contact_state(delta: np.ndarray, half_backlash: float) -> ContactState:
    """Return the state of contact from samples of delta at equal steps.

    Between two samples delta is taken to be linear, so that the fraction is not rounded to complete
    samples. Losses shorter than a sample step are missed. Deviations of single teeth are neglected.

    Parameters
    ----------
    delta : ndarray, shape (n,), n at least 2
        [m]
    half_backlash : float
        [m]
    """
    if delta.min() > half_backlash:
        return ContactState(0.0, 0, 0)
    before, after = delta[:-1], delta[1:]
    low, high = np.minimum(before, after), np.maximum(before, after)
    inside = np.minimum(high, half_backlash) - np.maximum(low, -half_backlash)
    length = high - low
    level = np.where(np.abs(before) <= half_backlash, 1.0, 0.0)
    share = np.where(length > 0, np.clip(inside, 0, None) / np.where(length > 0, length, 1), level)
    return ContactState(
        float(share.mean()),
        int(np.count_nonzero((before > half_backlash) & (after <= half_backlash))),
        int(np.count_nonzero((before >= -half_backlash) & (after < -half_backlash))),
    )


class SampledContact:
    """`contact_state` of a stream, block by block, with the step from one block to the next."""

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
            found = contact_state(joined, self.half_backlash)
            self._steps += steps
            self._out += found.out_of_contact * steps
            self._losses += found.losses
            self._back_impacts += found.back_impacts

    def take(self) -> ContactState:
        """Return the state over what was added since the last call."""
        result = ContactState(self._out / max(self._steps, 1), self._losses, self._back_impacts)
        self._clear()
        return result


class EventContact:
    """The exact state of contact of a stream of events, span by span.

    Contact is lost at the first event by which a flank lets go and regained at the next by which
    one is met; events of other tooth pairs at the same instant add nothing. Tooth pairs whose flank
    deviates lose contact at another displacement than the half backlash, and are left out: a
    sound pair carries the load on, or lets go itself.
    """

    def __init__(self, half_backlash: float) -> None:
        self.half_backlash = half_backlash
        self._since: float | None = None
        self._known = False

    def take(self, events: np.ndarray, start: float, end: float) -> ContactState:
        """Return the state from `start` to `end` [s], from the events of that time.

        Parameters
        ----------
        events : ndarray
            With the columns of EVENTS, t [s] on the same time scale, in order.
        """
        b = self.half_backlash
        out, losses, back_impacts = 0.0, 0, 0
        if self._since is not None:
            self._since = start
        sound = np.abs(np.abs(events['delta']) - b) <= AT_BACKLASH * b
        for event in events[sound & (events['kind'] != EventKind.SECTION)]:
            t, kind = float(event['t']), int(event['kind'])
            if kind in (EventKind.DRIVE_LOST, EventKind.BACK_LOST):
                if self._since is None:
                    self._since = t
                    losses += kind == EventKind.DRIVE_LOST
            elif self._since is not None or not self._known:
                # Without an event before, the teeth were apart from the start.
                out += t - (start if self._since is None else self._since)
                self._since = None
                back_impacts += kind == EventKind.BACK_REGAINED
            self._known = True
        if self._since is not None:
            out += end - self._since
        return ContactState(out / (end - start), losses, back_impacts)
