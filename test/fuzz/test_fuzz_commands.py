"""Any sequence of commands within their ranges."""

import dataclasses

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gear_dynamics.machine.columns import EventKind
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

RATE = 10_000.0
STEPS = st.one_of(
    st.tuples(st.just('advance'), st.integers(0, 300)),
    st.tuples(st.just('speed'), st.one_of(st.just(0.0), st.floats(0.0, 2000.0))),
    st.tuples(st.just('load_torque'), st.floats(-2000.0, 2000.0)),
    st.tuples(st.just('friction_coefficient'), st.floats(0.0, 0.2)),
    st.tuples(st.just('half_backlash'), st.floats(10e-6, 300e-6)),
    st.tuples(st.just('transmission_error_amplitude'), st.floats(0.0, 50e-6)),
)
LIVE = ('friction_coefficient', 'half_backlash', 'transmission_error_amplitude')


@given(steps=st.lists(STEPS, max_size=12), anti_alias=st.booleans())
def test_any_commands_give_finite_samples_and_events_in_order(steps, anti_alias):
    simulator = Simulator(
        GearPair(),
        sample_rate=RATE,
        anti_alias=anti_alias,
        speed_rate_limit=1e5,
        torque_rate_limit=1e6,
    )
    samples, events = [], []
    for name, value in [*steps, ('advance', 200)]:
        if name == 'advance':
            samples.append(simulator.advance(value))
            events.append(simulator.take_events())
        elif name in LIVE:
            simulator.change(pair=dataclasses.replace(simulator.pair, **{name: value}))
        else:
            simulator.command(**{name: value})
    rows, happened = np.concatenate(samples), np.concatenate(events)
    assert all(np.isfinite(rows[name]).all() for name in rows.dtype.names)
    np.testing.assert_allclose(rows['t'], np.arange(len(rows)) / RATE, rtol=0, atol=1e-9)
    assert (np.diff(happened['t']) >= 0).all()
    # The section is passed once in each mesh cycle, however the speed changes.
    cycles = happened['cycle'][happened['kind'] == EventKind.SECTION]
    np.testing.assert_allclose(np.diff(cycles), 1.0, rtol=0, atol=1e-6)
