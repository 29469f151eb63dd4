"""A log of the first version stays readable: 0.55 s at 1280 samples/s of the default pair.

The expected numbers are those that the first version itself read from it.
"""

from pathlib import Path

import numpy as np
import pytest

import gear_dynamics as gd
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.log import Log
from gear_dynamics.bag.recover import recover
from gear_dynamics.bag.report import find_rig

LOG = Path(__file__).with_name('data') / 'first_format'


def test_samples_events_and_section_are_read():
    samples = gd.read_log(LOG)
    assert len(samples) == 704
    assert samples['mesh_force'].mean() == pytest.approx(2710.614175276323, rel=1e-12)
    assert samples['speed'].mean() == pytest.approx(104.74847070737319, rel=1e-12)
    assert samples['t'][[0, -1]].tolist() == [0.0, pytest.approx(0.5492187514901161, rel=1e-15)]
    events = gd.read_log(LOG, 'gear_pair/events')
    np.testing.assert_array_equal(events['cycle'][:3], [170.5, 171.5, 172.5])
    assert len(events) == len(gd.read_log(LOG, 'gear_pair/poincare')) == 283
    assert len(gd.read_log(LOG, '/diagnostics')) == 240


def test_the_rig_and_the_numbers_of_messages_are_known(tmp_path):
    info = log_info(LOG)
    assert (info.whole, info.messages) == (True, 62)
    assert {'configuration', 'thresholds', 'versions'} <= set(info.configurations[-1])
    with Log(LOG) as log:
        rig = find_rig(log)
    assert (rig.pinion_teeth, rig.gear_teeth, rig.sample_rate) == (34, 59, 1280.0)
    assert recover(LOG, tmp_path / 'copy').messages == 62
