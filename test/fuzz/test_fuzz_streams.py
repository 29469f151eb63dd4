"""Streams that no sound rig sends: the monitor counts and drops them, and goes on."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from monitoring.streams import BLOCK, RIG, blocks, rotation, samples

from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings

SOUND = list(blocks(samples(rotation(0.3))))
NAMES = SOUND[0][1].dtype.names
VALUES = st.sampled_from(
    (0.0, -1.0, 1e-42, 1e-30, 1e6, 1e10, 1e30, 3e38, -3e38, np.nan, np.inf, -np.inf)
)


CHANGE = st.tuples(
    st.sampled_from(('one', 'all', 'ramp', 'scale', 'stamp', 'cut', 'double')),
    st.integers(0, len(SOUND) - 1),
    st.sampled_from(NAMES),
    VALUES,
    st.integers(-(10**12), 10**12),
)


def changed(changes):
    """Return the sound stream with columns, stamps and lengths of some blocks changed."""
    stream = [(stamp, rows.copy()) for stamp, rows in SOUND]
    for kind, place, name, value, number in changes:
        stamp, rows = stream[place]
        later = [after for _, after in stream[place:]]
        if kind == 'one' and len(rows):
            rows[name][number % len(rows)] = value
        elif kind == 'all':
            for each in later:
                each[name] = value
        elif kind == 'ramp':
            for i, each in enumerate(later):
                each[name] = value * (i + np.arange(len(each)) / BLOCK)
        elif kind == 'scale':
            for each in later:
                each[name] = each[name] * value
        elif kind == 'stamp':
            stream[place:] = [(stamp + number, rows) for stamp, rows in stream[place:]]
        elif kind == 'cut':
            stream[place] = stamp, rows[: number % (len(rows) + 1)]
        elif kind == 'double':
            stream.insert(place, stream[place])
    return stream


@pytest.mark.filterwarnings('error::RuntimeWarning')
@given(changes=st.lists(CHANGE, min_size=1, max_size=4))
def test_hostile_blocks_do_not_end_the_monitor(changes):
    with np.errstate(all='ignore'):
        stream = changed(changes)
    monitor = Monitor(AnalyzerSettings(), Thresholds({}))
    monitor.configure(RIG)
    for stamp, rows in stream:
        monitor.add_block(stamp, rows)
    # What came does not spoil what comes: after a gap, no block of the sound stream is dropped.
    dropped = sum(monitor.health.dropped.values())
    for stamp, rows in SOUND:
        monitor.add_block(stamp + 10**13, rows)
    assert sum(monitor.health.dropped.values()) == dropped
    assert monitor.health.failed == {}, monitor.health.last_failure
