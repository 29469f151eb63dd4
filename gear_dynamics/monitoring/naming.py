"""Which faults are named: those found again and again, until they are no longer found."""

from __future__ import annotations

import collections
import dataclasses
from collections.abc import Sequence

from gear_dynamics.monitoring.task import Bin, Condition

CLEARED = 5
"""Results in a row without a fault, in operating bins in which it had been found, after which it is
no longer named: no fault of a wheel heals from one result to the next."""

NEAR = 3
"""Teeth down to which a finding is of a fault that is named: where it excites a resonance, its
vibration is greatest some teeth later."""

CLEARLY = 2
"""Times by which another tooth must have been found more often to be told in place of the first."""

MOST_FAULTS = 20
"""Faults of one subject that are followed; of more the one found longest ago is forgotten."""


@dataclasses.dataclass
class Followed:
    """A fault that was found at least once.

    Attributes
    ----------
    condition : Condition
        As it was found last; its place is that most often found.
    first_ns : int
        Start of the first span with it [ns].
    named : bool
    """

    condition: Condition
    first_ns: int
    recent: collections.deque[bool]
    places: collections.Counter[int | None]
    named: bool = False
    misses: dict[Bin, int] = dataclasses.field(default_factory=dict)

    def matches(self, other: Condition) -> bool:
        """Return whether another finding is of this fault: of the same tooth or its neighbour."""
        if other.indicator != self.condition.indicator or other.kind != self.condition.kind:
            return False
        mine, its = self.condition.tooth, other.tooth
        if mine is None or its is None:
            return mine is its
        apart = abs(mine - its)
        return min(apart, other.teeth - apart) <= (NEAR if self.named else 1)

    def place(self, tooth: int | None) -> int | None:
        """Count a place; return the one to tell: the first, or one much more frequent."""
        self.places[tooth] += 1
        most = max(self.places, key=lambda place: self.places[place])
        told = self.condition.tooth
        clear = self.places[most] > CLEARLY * self.places[told]
        return most if clear or not self.named else told


class Naming:
    """Names the faults that `raised` of the last `of` results have found.

    A fault stays named until CLEARED results in a row do not find it. Only results in operating
    bins in which it was found count: at another speed it may not show.

    Parameters
    ----------
    raised, of : int
    """

    def __init__(self, raised: int, of: int) -> None:
        self._raised, self._of = raised, of
        self._followed: dict[str, list[Followed]] = {}

    def forget(self) -> None:
        """Forget all faults."""
        self._followed.clear()

    def update(
        self, subject: str, bin_: Bin, found: Sequence[Condition], start_ns: int
    ) -> list[Followed]:
        """Take what a judged result found; return the faults followed, the named ones first."""
        followed = self._followed.setdefault(subject, [])
        left = list(found)
        for fault in list(followed):
            match = next((each for each in left if fault.matches(each)), None)
            if match is not None:
                left.remove(match)
            self._count(fault, match, bin_)
            if not (fault.named or any(fault.recent)):
                followed.remove(fault)
        for condition in left[:MOST_FAULTS]:
            fault = Followed(
                condition, start_ns, collections.deque(maxlen=self._of), collections.Counter()
            )
            self._count(fault, condition, bin_)
            followed.append(fault)
        del followed[:-MOST_FAULTS]
        return sorted(followed, key=lambda fault: not fault.named)

    def follows(self, subject: str) -> bool:
        """Return whether any fault of a subject was found lately."""
        return bool(self._followed.get(subject))

    def named(self, subject: str) -> list[Followed]:
        """Return the faults of a subject that are named."""
        return [fault for fault in self._followed.get(subject, ()) if fault.named]

    def _count(self, fault: Followed, found: Condition | None, bin_: Bin) -> None:
        if found is None:
            if not fault.named:
                fault.recent.append(False)
            elif bin_ in fault.misses:
                fault.misses[bin_] += 1
                if fault.misses[bin_] >= CLEARED:
                    fault.named = False
                    fault.recent.clear()
            return
        fault.recent.append(True)
        fault.misses[bin_] = 0
        fault.condition = found._replace(tooth=fault.place(found.tooth))
        fault.named = fault.named or sum(fault.recent) >= self._raised
