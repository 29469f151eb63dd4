"""ROS parameters of a node, declared from the parameter lists and checked by them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

import rclpy.parameter
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rcl_interfaces.srv import ListParameters
from rclpy.node import Node

from gear_dynamics.parameters.files import known_names, refuse_unknown
from gear_dynamics.parameters.parameter import Parameter, ParameterError, ParameterSet, Value

_Set = TypeVar('_Set', bound=ParameterSet)

Sets = Mapping[type[ParameterSet], ParameterSet]
"""The present or proposed values of a node's lists."""

_ROS_SWITCHES = ('use_sim_time', 'start_type_description_service')


class NodeParameters:
    """The parameter lists of one node, as ROS parameters.

    The node must have been made with `automatically_declare_parameters_from_overrides=True`:
    that is how ROS tells which names the user gave, so that an unknown one can be refused.

    Parameters
    ----------
    node : rclpy.node.Node
    lists : sequence of ParameterSet classes
        What the node takes.
    repeated : mapping, optional
        Last values of those that were given more than once; see `repeated_parameters`.

    Raises
    ------
    ParameterError
        If the user gave an unknown name or a value that is not allowed.
    """

    def __init__(
        self,
        node: Node,
        lists: Sequence[type[ParameterSet]],
        repeated: Mapping[str, Any] | None = None,
    ) -> None:
        self._node = node
        self._lists = tuple(lists)
        self._about = {about.name: about for each in lists for about in each.parameters()}
        self._listeners: list[Callable[[frozenset[str]], None]] = []
        self._checks: list[Callable[[Sets, frozenset[str]], None]] = []
        self._mirroring = False
        names = node.list_parameters([], ListParameters.Request.DEPTH_RECURSIVE).names
        given = {name: node.get_parameter(name).value for name in names}
        given.update({name: v for name, v in (repeated or {}).items() if name in given})
        refuse_unknown([name for name in given if name not in self._about])
        _check_ros_parameters(given)
        self._sets = self._make(given)
        for name in given.keys() - self._about.keys():
            if name in known_names() or name.startswith('fault.'):
                node.undeclare_parameter(name)  # another node's, out of a file for several
        for about in self._about.values():
            self._declare(about)
        node.add_pre_set_parameters_callback(self._convert)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._accept)

    @property
    def sets(self) -> Sets:
        """The present values of all lists."""
        return self._sets

    def get(self, which: type[_Set]) -> _Set:
        """Return the present values of one of the lists."""
        found = self._sets[which]
        assert isinstance(found, which)
        return found

    def on_change(self, listener: Callable[[frozenset[str]], None]) -> None:
        """Have `listener` called with the names that were set, after every live change."""
        self._listeners.append(listener)

    def add_check(self, check: Callable[[Sets, frozenset[str]], None]) -> None:
        """Have `check` called with the lists as they would be and the names that are being set.

        A ParameterError that it raises refuses the change. The present values are checked at once.
        """
        check(self._sets, frozenset(self._about))
        self._checks.append(check)

    def replace(self, values: ParameterSet) -> None:
        """Set a whole list, what cannot change while running too, without telling the listeners."""
        about = [self._node.describe_parameter(each.name) for each in values.parameters()]
        fixed = [each for each in about if each.read_only]
        for each in fixed:
            each.read_only = False
        try:
            self.mirror(values.to_mapping())
        finally:
            for each in fixed:
                each.read_only = True

    def mirror(self, values: Mapping[str, Value]) -> None:
        """Set live parameters to what already holds, without telling the listeners."""
        self._mirroring = True
        try:
            self._node.set_parameters_atomically(
                [rclpy.parameter.Parameter(name, value=value) for name, value in values.items()]
            )
        finally:
            self._mirroring = False

    def _values(self) -> dict[str, Any]:
        return {name: value for each in self._sets.values() for name, value in _items(each)}

    def _make(self, values: Mapping[str, Any]) -> dict[type[ParameterSet], ParameterSet]:
        return {each: each.from_mapping(values) for each in self._lists}

    def _declare(self, about: Parameter) -> None:
        # What the user gave may be an integer or text for a number; the declared one has the type
        # of the list.
        if self._node.has_parameter(about.name):
            self._node.undeclare_parameter(about.name)
        value = self._values()[about.name]
        self._node.declare_parameter(about.name, value, descriptor(about), ignore_override=True)

    def _convert(
        self, parameters: list[rclpy.parameter.Parameter]
    ) -> list[rclpy.parameter.Parameter]:
        # Without this, `ros2 param set NODE speed 100` fails, 100 being an integer.
        return [self._converted(each) for each in parameters]

    def _converted(self, given: rclpy.parameter.Parameter) -> rclpy.parameter.Parameter:
        about = self._about.get(given.name)
        if about is None:
            return given
        try:
            return rclpy.parameter.Parameter(given.name, value=about.check(given.value))
        except ParameterError:
            return given  # refused with the reason in a moment

    def _check(self, parameters: list[rclpy.parameter.Parameter]) -> SetParametersResult:
        try:
            given = {each.name: each.value for each in parameters}
            proposed = self._make({**self._values(), **given})
            for check in () if self._mirroring else self._checks:
                check(proposed, frozenset(given))
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _accept(self, parameters: list[rclpy.parameter.Parameter]) -> None:
        given = {each.name: each.value for each in parameters if each.name in self._about}
        if not given:
            return
        self._sets = self._make({**self._values(), **given})
        for listener in () if self._mirroring else self._listeners:
            listener(frozenset(given))


def _items(values: ParameterSet) -> Iterable[tuple[str, Value]]:
    return values.to_mapping().items()


def _check_ros_parameters(given: Mapping[str, Any]) -> None:
    # rclpy logs a wrong type of these and goes on without them.
    for name in _ROS_SWITCHES:
        if not isinstance(given.get(name, False), bool):
            raise ParameterError(f'{name} is {given[name]!r}: it must be true or false')


def descriptor(about: Parameter) -> ParameterDescriptor:
    """Return what ROS tools show of a parameter: description, unit, range, whether it changes."""
    unit = f' [{about.unit}]' if about.unit else ''
    result = ParameterDescriptor(
        name=about.name,
        description=about.description + unit,
        additional_constraints=about.allowed(),
        read_only=not about.live,
        # A wrong type is refused by the list, which says what is allowed; ROS says less.
        dynamic_typing=True,
    )
    number = isinstance(about.default, int | float) and not isinstance(about.default, bool)
    if number and about.minimum is not None and about.maximum is not None:
        if isinstance(about.default, int):
            low, high = math.ceil(about.minimum), math.floor(about.maximum)
            result.integer_range = [IntegerRange(from_value=low, to_value=high)]
        else:
            low_high = {'from_value': about.minimum, 'to_value': about.maximum}
            result.floating_point_range = [FloatingPointRange(**low_high)]
    return result


def help_text(lists: Sequence[type[ParameterSet]]) -> str:
    """Return the parameter lists as text for `--help`."""
    lines = []
    for about in (about for each in lists for about in each.parameters()):
        live = '; changes while running' if about.live else ''
        default = str(about.default).lower() if isinstance(about.default, bool) else about.default
        lines.append(f'  {about.name} (default {default})')
        lines.append(f'      {about.description}: {about.allowed()}{live}')
    return '\n'.join(lines)
