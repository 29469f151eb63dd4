"""What the benchmarks take from the package is still there."""

import numpy as np
import pytest
from ros_support import ROOT

from gear_dynamics import study


def test_parameters_of_the_reduced_equations(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / 'benchmarks'))
    from reduced_equations import numbers

    point = study.friction_chaos()
    p, d = numbers(point), point.pair.derived
    assert p.shape == (20,)
    assert np.isfinite(p).all()
    by_mass = d.pinion_base_radius**2 / d.pinion_inertia + d.gear_base_radius**2 / d.gear_inertia
    assert p[6] == pytest.approx(1 / by_mass)
    assert p[16] == pytest.approx(d.pinion_base_radius / d.pinion_inertia)
