"""The rigs that a page can choose from, and who carries out its commands."""

from __future__ import annotations

from gear_dynamics.web.commands import Command, Controls
from gear_dynamics.web.live_rig import LiveRig


class Hub:
    """Hold the rigs by name.

    Parameters
    ----------
    waiting_for : str
        What the page says while there is no rig, such as 'waiting for gear_pair/samples'.
    fault_kinds : tuple of str
        Faults that the rigs know.
    """

    def __init__(self, waiting_for: str, fault_kinds: tuple[str, ...] = ()) -> None:
        self.waiting_for = waiting_for
        self.fault_kinds = fault_kinds
        self._rigs: dict[str, LiveRig] = {}
        self._controls: dict[str, Controls] = {}

    def add(self, rig: LiveRig, controls: Controls | None = None) -> None:
        """Add a rig, and what carries out commands to it."""
        self._rigs[rig.name] = rig
        if controls is not None:
            self._controls[rig.name] = controls

    @property
    def names(self) -> list[str]:
        """The rigs' names, in the order in which they came."""
        return list(self._rigs)

    def rig(self, name: str) -> LiveRig | None:
        """Return the rig of a name, the first one if there is none of that name, or None."""
        found = self._rigs.get(name)
        return found if found is not None else next(iter(self._rigs.values()), None)

    def carry_out(self, rig: LiveRig, command: Command) -> str:
        """Begin to carry out a command; return why not, in one line, or nothing."""
        controls = self._controls.get(rig.name)
        if controls is None or not rig.controllable:
            return f'{rig.name or "this rig"} takes no commands'
        controls.carry_out(command)
        return ''
