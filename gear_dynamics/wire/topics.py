"""Every topic of the package, once: what nodes publish, the analyzer logs and the docs list."""

from __future__ import annotations

import dataclasses

import numpy as np

from gear_dynamics.machine.columns import ABOUT_SAMPLES, CHANNEL_UNITS, CHANNELS, EVENTS

TABLE_TYPE = 'sensor_msgs/msg/PointCloud2'
TEXT_TYPE = 'std_msgs/msg/String'
NUMBER_TYPE = 'std_msgs/msg/Float64'
STATUS_TYPE = 'diagnostic_msgs/msg/DiagnosticArray'
ACCEL_TYPE = 'geometry_msgs/msg/AccelStamped'
WRENCH_TYPE = 'geometry_msgs/msg/WrenchStamped'

FRAME = 'line_of_action'
"""frame_id of everything that has a direction: y along the line of action, x across it."""


@dataclasses.dataclass(frozen=True)
class Qos:
    """Quality of service of a publisher; the policies have the names that rosbag2 gives them."""

    depth: int = 10
    reliability: str = 'reliable'
    durability: str = 'volatile'
    history: str = 'keep_last'

    def words(self) -> str:
        """Return the policies in the words of the documentation."""
        kept = 'keep all' if self.history == 'keep_all' else f'keep last {self.depth}'
        latched = ', transient local' if self.durability == 'transient_local' else ''
        return f'{self.reliability.replace("_", " ")}, {kept}{latched}'


@dataclasses.dataclass(frozen=True)
class Column:
    """A column of a table: name, NumPy type, unit, meaning."""

    name: str
    type: str
    unit: str
    about: str


@dataclasses.dataclass(frozen=True, eq=False)
class Topic:
    """A topic; one object each, compared by identity.

    Attributes
    ----------
    name : str
        Relative names are below the namespace of the rig.
    type_name : str
        As 'sensor_msgs/msg/PointCloud2'.
    publisher : str
        Name of the node that publishes it; '' where any program may.
    about : str
        What it carries, in one line.
    rate : str
        How often, in words.
    qos : Qos
        How it is published.
    logged : bool
        Whether the analyzer writes it into its log.
    columns : tuple of Column
        Of a table; empty for other messages.
    xy : tuple of two str or None
        Columns of `samples` that a vector topic has as its x and y; None is 0.
    """

    name: str
    type_name: str
    publisher: str
    about: str
    rate: str
    qos: Qos = Qos()
    logged: bool = True
    columns: tuple[Column, ...] = ()
    xy: tuple[str | None, str | None] = (None, None)


_STREAM = Qos(depth=100)
_LATCHED = Qos(depth=1, durability='transient_local')
_FACTOR_0 = 'one a block; with keep all at real-time factor 0'

_ABOUT_EVENTS = {
    't': ('s', 'time since header.stamp'),
    'kind': (
        '',
        '0 the section phase was passed; 1, 2 the drive flank lost, regained contact; 3, 4 the '
        'back flank did',
    ),
    'tooth_pair': ('', 'number of the pair in the order of engagement, modulo the hunting period'),
    'delta': ('m', 'exact value at the event'),
    'delta_dot': ('m/s', 'exact value at the event'),
    'cycle': ('cycles', 'mesh phase since the start of the run'),
}


def _columns(types: dict[str, str], about: dict[str, tuple[str, str]]) -> tuple[Column, ...]:
    return tuple(Column(name, types[name], *about[name]) for name in types)


_DURATION = Column('duration', 'float32', 's', 'span of the table, the same in every row')


def _spectrum(axis: str, unit: str, about: str) -> tuple[Column, ...]:
    lines = (
        Column(name, 'float32', CHANNEL_UNITS[name], f'amplitude of `{name}`') for name in CHANNELS
    )
    return (Column(axis, 'float32', unit, about), *lines, _DURATION)


SAMPLES = Topic(
    'gear_pair/samples',
    TABLE_TYPE,
    'gear_sim',
    'the full-rate stream, one block a message',
    _FACTOR_0,
    _STREAM,
    columns=_columns(dict.fromkeys(ABOUT_SAMPLES, 'float32'), ABOUT_SAMPLES),
)
EVENTS_TOPIC = Topic(
    'gear_pair/events',
    TABLE_TYPE,
    'gear_sim',
    'contact lost and regained, exact section states',
    _FACTOR_0,
    _STREAM,
    columns=_columns({name: str(EVENTS[name]) for name in EVENTS.names or ()}, _ABOUT_EVENTS),
)
CONFIGURATION = Topic(
    'gear_pair/configuration',
    TEXT_TYPE,
    'gear_sim',
    'every parameter and derived quantity as YAML; kept for late listeners',
    'at the start and after every change, at most ten a second',
    _LATCHED,
)
LABEL = Topic(
    'gear_pair/label',
    STATUS_TYPE,
    'gear_sim',
    'ground truth of the faults: one status each, with fault, wheel, tooth, severity and orders; '
    'kept for late listeners',
    'at every change, and once a second of model time',
    _LATCHED,
)
VECTORS = tuple(
    Topic(name, type_name, 'gear_sim', about, '`monitor_rate`', _STREAM, logged=False, xy=xy)
    for name, type_name, about, xy in (
        (
            'gear_pair/pinion/acceleration',
            ACCEL_TYPE,
            'acceleration of the pinion, low-passed',
            ('pinion_ax', 'pinion_ay'),
        ),
        (
            'gear_pair/gear/acceleration',
            ACCEL_TYPE,
            'acceleration of the gear, low-passed',
            ('gear_ax', 'gear_ay'),
        ),
        (
            'gear_pair/mesh_force',
            WRENCH_TYPE,
            'normal force on the pinion, low-passed',
            (None, 'mesh_force'),
        ),
        (
            'gear_pair/friction_force',
            WRENCH_TYPE,
            'friction force on the pinion, low-passed',
            ('friction_force', None),
        ),
    )
)
JOINT_STATES = Topic(
    'gear_pair/joint_states',
    'sensor_msgs/msg/JointState',
    'gear_sim',
    'angle, speed and torque of both shafts',
    '50 Hz of model time',
    logged=False,
)
SPEED_COMMAND = Topic(
    'gear_pair/cmd/speed', NUMBER_TYPE, '', 'commanded pinion speed [rad/s], 0 to 5000', ''
)
TORQUE_COMMAND = Topic(
    'gear_pair/cmd/torque', NUMBER_TYPE, '', 'commanded load torque [N m], -5000 to 5000', ''
)
SPECTRUM = Topic(
    'gear_pair/spectrum',
    TABLE_TYPE,
    'gear_analyzer',
    'one-sided amplitude of every channel',
    'one an average',
    columns=_spectrum('frequency', 'Hz', 'frequency of the line'),
)
ENVELOPE_SPECTRUM = Topic(
    'gear_pair/envelope_spectrum',
    TABLE_TYPE,
    'gear_analyzer',
    'one-sided amplitude of the envelope of every channel',
    'one a record of `statistics_duration`',
    columns=_spectrum('frequency', 'Hz', 'frequency of the line'),
)
ORDER_SPECTRUM = Topic(
    'gear_pair/order_spectrum',
    TABLE_TYPE,
    'gear_analyzer',
    'one-sided amplitude over orders of the pinion',
    'one an average',
    columns=_spectrum('order', '', 'lines per pinion revolution'),
)
POINCARE = Topic(
    'gear_pair/poincare',
    TABLE_TYPE,
    'gear_analyzer',
    'points of the Poincaré section',
    'one a message of `events`',
    columns=(
        Column('x', 'float32', '', '`delta` / half_backlash'),
        Column('y', 'float32', '', '`delta_dot` / (half_backlash wn)'),
        Column('z', 'float32', '', '0, for viewers of point clouds'),
        Column('cycle', 'float64', 'cycles', 'mesh phase since the start of the run'),
        _DURATION,
    ),
)
CONDITION = Topic(
    'gear_pair/condition',
    STATUS_TYPE,
    'gear_analyzer',
    'condition indicators, with levels by threshold',
    'as indicators are complete',
)
INDICATOR = Topic(
    'gear_pair/indicators/CHANNEL/NAME',
    NUMBER_TYPE,
    'gear_analyzer',
    'single indicators as numbers, those that the parameter `indicators` lists',
    'with `condition`',
    logged=False,
)
DIAGNOSTICS = Topic('/diagnostics', STATUS_TYPE, '', 'health of every node of the package', '1 Hz')
CLOCK = Topic(
    '/clock',
    'rosgraph_msgs/msg/Clock',
    '',
    'time of the stream, for `use_sim_time`',
    'one a block, if `publish_clock`',
    logged=False,
)

TABLES = (SPECTRUM, ENVELOPE_SPECTRUM, ORDER_SPECTRUM, POINCARE)
"""The tables of the analyzer."""

TOPICS = tuple(
    dict.fromkeys(
        topic
        for defined in list(globals().values())
        for topic in (defined if isinstance(defined, tuple) else [defined])
        if isinstance(topic, Topic)
    )
)
"""All topics, as they are defined above: the order of the documentation."""


def with_duration(rows: np.ndarray, duration: float) -> np.ndarray:
    """Return a table of the analyzer with its span [s] in a last column `duration`."""
    wide = np.empty(len(rows), [*rows.dtype.descr, (_DURATION.name, _DURATION.type)])
    for name in rows.dtype.names or ():
        wide[name] = rows[name]
    wide[_DURATION.name] = duration
    return wide
