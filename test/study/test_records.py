import numpy as np
import pytest

from gear_dynamics.study import records
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import friction_chaos
from gear_dynamics.study.tasks import Runner


def test_a_record_in_stretches_goes_on_where_each_ends(monkeypatch):
    """At mu = 0.05 the motion has period 4, whatever the stretches; and the sum rule holds."""
    monkeypatch.setattr(records, 'STRETCH', 2 * 150)
    operation = friction_chaos().with_value('friction_coefficient', 0.05)
    states = scattered_states(operation, 2)
    (found,) = records.records([operation], [states], 2000, 400, Runner(), '')
    sections = found['sections']
    assert sections.shape == (2, 400, 2)
    assert sections[:, 4:] == pytest.approx(sections[:, :-4], abs=1e-3)
    assert np.abs(sections[:, 1] - sections[:, 0]).max() > 0.01
    assert found['growth'].sum(axis=2) == pytest.approx(found['divergence'], rel=1e-6)
    assert found['nearby'].shape == (2, 200)
