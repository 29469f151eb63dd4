"""The reference equations integrated by SciPy's DOP853 with events of its own.

Every interval between events is an initial value problem of its own, so that no step crosses an
event: mesh events, the ends of tooth deviations and of ramps are known ahead, contact events are
found by `solve_ivp`.
"""

import itertools
import math

import numpy as np
from reference_equations import COLUMNS, Equations
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

LONGEST_STEP = 4e-6
"""[s]; a quarter of a radian of the fastest mode: the dense output of DOP853, on which samples and
contact events are found, is of lower order than its steps."""


class Reference(Equations):
    """A gear pair under commands, from its static deflection at t = 0 on.

    Parameters
    ----------
    pair, speed, torque, ports, drive, strength
        Of `Equations`.
    rtol : float
    """

    def __init__(self, *system, rtol=1e-12, **options):
        super().__init__(*system, **options)
        self.rtol = rtol
        self.events = []  # (t, old contact, new contact, tooth pair, delta_i, delta_i')
        self.cuts = []  # every instant at which an interval ends

    def _boundaries(self, duration):
        """Return every instant up to `duration` that is known ahead to be an event."""
        cuts = {0.0, self.eps - 1, self.l1 / self.pb, self.l1 / self.pb - 1}
        for term in self.ports:
            for edge in getattr(term, 'edges', ()):
                cuts |= {edge / self.pb, edge / self.pb - 1}
        cuts = [cut for cut in cuts if 0 <= cut < 1]
        times = [0.0, duration]
        times += [t for t in self.speed.times + self.torque.times if 0 < t < duration]
        if self.strength is not None:
            times += [t for t in self.strength.times if 0 < t < duration]
        last = self.phase(duration)
        phases = {cycle + cut for cycle in range(math.floor(last) + 1) for cut in cuts}
        for term in self.ports:
            phases |= self._knots(term, times, last, duration)
        for at in phases:
            if 0 < at < last:
                times.append(
                    brentq(lambda t, at=at: self.phase(t) - at, 0, duration,
                           xtol=1e-17, rtol=1e-15)
                )  # fmt: skip
        return sorted(set(times))

    def _knots(self, term, times, last, duration):
        """Return the mesh phases of a table's knots, or add those in time to `times`."""
        if not hasattr(term, 'knots'):
            return set()
        teeth = {'pinion': self.pair.pinion_teeth, 'gear': self.pair.gear_teeth}
        scale = teeth.get(term.argument, 1)
        knots = term.knots * scale
        end = duration if term.argument == 'time' else last
        laps = np.arange(-1, math.ceil(end / (knots[-1] - knots[0])) + 1)
        all_knots = np.add.outer(laps * (knots[-1] - knots[0]), knots[:-1]).ravel().tolist()
        if term.argument != 'time':
            return set(all_knots)
        times += [t for t in all_knots if 0 < t < duration]
        return set()

    def run(self, times, start=None):
        """Return the (n, 12) columns at the given times (after t), and at which to trust them.

        The second array says whether a sample is more than 1e-10 s away from every event.
        """
        y = self.static_state() if start is None else start
        rows = np.full((len(times), len(COLUMNS)), np.nan)
        boundaries = self._boundaries(float(times[-1]) + 1e-9)
        pairs = []
        for begin, end in itertools.pairwise(boundaries):
            before = {pair.number: pair.contact for pair in pairs}
            pairs = self.pairs_at(self.phase((begin + end) / 2))
            self.cuts.append(begin)
            self.near = (begin + end) / 2
            self._follow_commands(begin)
            self._take_contacts(begin, y, pairs, before)
            y = self._interval(begin, end, y, pairs, times, rows)
        away = np.min(np.abs(np.subtract.outer(times, self.cuts)), axis=1) > 1e-10
        return rows, away

    def _take_contacts(self, t, y, pairs, before):
        delta, delta_dot = self.deltas(t, y)
        b, b_dot = self.half_backlash(t)
        self.sharing = len(pairs)
        for pair in pairs:
            *_, e, e_dot = self.pair_terms(pair, t)
            side = delta - e
            pair.contact = int(np.sign(side)) if abs(side) > b else 0
            if pair.number in before and abs(abs(side) - b) < 1e-10 * b:
                pair.contact = before[pair.number]
            elif abs(abs(side) - b) < 1e-10 * b:
                going_in = np.sign(side) * (delta_dot - e_dot) >= b_dot
                pair.contact = int(np.sign(side)) if going_in else 0

    def _contact_events(self, pairs):
        """Return the functions whose zeros end the interval, and what they mean."""
        functions, meanings = [], []
        for pair in pairs:
            flanks = (1, -1) if pair.contact == 0 else (pair.contact,)
            for flank in flanks:

                def crossing(t, y, pair=pair, flank=flank):
                    self.sharing = len(pairs)
                    *_, e, _ = self.pair_terms(pair, t)
                    b = self.half_backlash(t)[0]
                    return (self.deltas(t, y)[0] - e - flank * b) / self.b

                crossing.terminal = True
                crossing.direction = flank if pair.contact == 0 else -flank
                functions.append(crossing)
                meanings.append((pair, flank if pair.contact == 0 else 0))
        return functions, meanings

    def _interval(self, begin, end, y, pairs, times, rows):
        scale = np.array([self.b] * 4 + [self.b / self.rb1] * 2)
        atol = self.rtol * 0.1 * np.concatenate([scale, scale * self.wn, [self.b / self.rb1]])
        while begin < end:
            functions, meanings = self._contact_events(pairs)
            out = solve_ivp(
                lambda t, y: self.slope(t, y, pairs),
                (begin, end),
                y,
                'DOP853',
                rtol=self.rtol,
                atol=atol,
                max_step=LONGEST_STEP,
                dense_output=True,
                events=functions,
            )
            stop = out.t[-1]
            inside = np.flatnonzero((times >= begin) & (times < stop))
            for i in inside:
                rows[i] = self.row(times[i], out.sol(times[i]), pairs)
            y = out.y[:, -1]
            if out.status == 1:
                self.cuts.append(stop)
                self._change_contacts(stop, out, meanings)
            begin = stop
        return y

    def _change_contacts(self, t, out, meanings):
        """Change the contact states; pairs that cross within rounding of each other together.

        `solve_ivp` finds an instant to 1e-15 s or so: at 0.1 m/s, 1e-16 m short of the crossing.
        """
        y = out.y[:, -1]
        delta, delta_dot = self.deltas(t, y)
        b, b_dot = self.half_backlash(t)
        for (pair, after), found in zip(meanings, out.t_events, strict=True):
            *_, e, e_dot = self.pair_terms(pair, t)
            flank = after or pair.contact
            near = abs(delta - e - flank * b) < 1e-8 * b
            approach = np.sign(delta_dot - e_dot - flank * b_dot)
            if len(found) or (near and approach == (flank if after else -flank)):
                number = pair.number
                self.events.append((t, pair.contact, after, number, delta - e, delta_dot - e_dot))
                pair.contact = after
