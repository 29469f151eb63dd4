"""The faults of the `sim` node: from its parameters, and told on gear_pair/label."""

from __future__ import annotations

from rclpy.node import Node

from gear_dynamics.model.faults import Fault, SpeedAndLoad
from gear_dynamics.model.faults.collection import fault_ports
from gear_dynamics.model.faults.label import Label
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.nodes.parameters import Sets
from gear_dynamics.nodes.topics import publisher
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.faults import PREFIX, FaultSettings, read_faults
from gear_dynamics.simulation.pair_file import read_pair
from gear_dynamics.wire.labels import label_bytes
from gear_dynamics.wire.topics import LABEL

PAIR_NAMES = frozenset(about.name for about in GearPair.parameters())
"""A change of the pair, such as of its backlash, may leave no room for a fault."""


def concerns_faults(name: str) -> bool:
    """Return whether a parameter says what is wrong with the machine."""
    return name == 'faults' or name.startswith(PREFIX)


def faults_of(sets: Sets) -> tuple[Fault, ...]:
    """Return the faults that the parameters name, by themselves and by a file.

    Raises
    ------
    ParameterError
        If the file cannot be read, or has anything but faults.
    """
    single, settings = sets[FaultSettings], sets[SimSettings]
    assert isinstance(single, FaultSettings)
    assert isinstance(settings, SimSettings)
    listed = read_faults(settings.faults) if settings.faults else []
    return (*single.faults(), *listed)


def refuse_unfit(sets: Sets, names: frozenset[str], node: str) -> None:
    """Refuse faults that do not fit the pair, and a file that has no pair.

    Parameters
    ----------
    sets : mapping
        The parameter lists as they would be.
    names : frozenset of str
        The parameters that are being set.
    node : str
        Full name of the node.

    Raises
    ------
    ParameterError
        In one line.
    """
    pair, settings = sets[GearPair], sets[SimSettings]
    assert isinstance(pair, GearPair)
    assert isinstance(settings, SimSettings)
    if 'pair_file' in names and settings.pair_file:
        pair = read_pair(settings.pair_file, node).pair
    elif not any(concerns_faults(name) or name in PAIR_NAMES for name in names):
        return
    fault_ports(pair, faults_of(sets), SpeedAndLoad(settings.speed, settings.load_torque))


class LabelTopic:
    """Publishes the ground truth at every change, and once a second of model time.

    Parameters
    ----------
    node : rclpy.node.Node
    rate : float
        Samples per second [Hz].
    """

    def __init__(self, node: Node, rate: float) -> None:
        self._publisher = publisher(node, LABEL)
        self._rig = f'{node.get_namespace()}/{LABEL.name}'.lstrip('/').rsplit('/', 1)[0]
        self._rate = rate
        self._last = 0
        self._told: tuple[Label, ...] | None = None

    def publish(self, labels: tuple[Label, ...], sample: int, stamp_ns: int) -> None:
        """Publish the labels if they changed or a second has passed.

        Parameters
        ----------
        labels : tuple of Label
        sample : int
            Next sample of the run.
        stamp_ns : int
            Its time [ns].
        """
        if labels == self._told and self._last <= sample < self._last + self._rate:
            return
        self._told, self._last = labels, sample
        values = [each.values() for each in labels]
        self._publisher.publish(label_bytes(values, stamp_ns, self._rig))
