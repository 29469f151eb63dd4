import numpy as np
import pytest

from gear_dynamics import study

CHAOS = study.friction_chaos()


def test_frequency_ratio_that_was_asked_for_is_kept_when_wn_changes():
    """In whatever order; wn follows from the inertias alone here."""
    first = CHAOS.with_value('w', 1.0).with_value('pinion_inertia', 4e-4)
    last = CHAOS.with_value('pinion_inertia', 4e-4).with_value('w', 1.0)
    assert first == last
    assert first.pair.derived.wn != pytest.approx(CHAOS.pair.derived.wn, rel=0.1)
    mesh_frequency = first.pair.pinion_teeth * first.speed
    assert mesh_frequency / first.pair.derived.wn == pytest.approx(1.0, rel=1e-12)


def test_speed_is_kept_where_it_was_given_last():
    swept = CHAOS.with_value('w', 1.0).with_value('speed', 2000.0)
    assert swept.with_value('pinion_inertia', 4e-4).speed == 2000.0
    assert CHAOS.with_value('pinion_inertia', 4e-4).speed == CHAOS.speed


def test_default_pair_meshes_566_7_times_a_second_at_1000_rpm():
    """34 teeth; 0.105 of wn (5386 Hz)."""
    operation = study.default_operating_point()
    assert operation.speed == pytest.approx(1000 * 2 * np.pi / 60, rel=1e-5)
    frequency = operation.pair.derived.wn / operation.cycle
    assert f'{frequency:.1f}' == '566.7'
    assert f'{operation.frequency_ratio:.3f}' == '0.105'
