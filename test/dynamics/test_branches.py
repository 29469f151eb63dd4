import numpy as np
import pytest
from dynamics.maps import DelayedLogistic, Henon
from dynamics.oscillators import ERROR, MEAN, ZETA, kahraman_singh

from gear_dynamics import dynamics


def henon_branch(**options):
    orbit = dynamics.periodic_orbit(Henon(0.1), 1, np.array([0.9, 0.2]))
    return dynamics.continuation(Henon, orbit, 0.1, -0.3, 1.0, **options)


def test_fold_of_the_henon_map_is_where_the_closed_form_says():
    """At a = -(1 - b)^2 / 4; beyond it the branch returns on the other root."""
    branch = henon_branch(rising=False)
    assert [each.kind for each in branch.bifurcations] == ['fold']
    (fold,) = branch.bifurcations
    assert fold.at.value == pytest.approx(-(0.7**2) / 4, abs=1e-12)
    assert fold.multiplier == pytest.approx(1, abs=1e-8)
    # It leaves through 0, where the other root is at infinity.
    assert branch.orbits[-1].unstable == 1


def test_flips_of_the_henon_map_are_where_the_closed_form_says():
    """3 (1 - b)^2 / 4, and (5 - 6 b + 5 b^2) / 4 of the doubled orbit."""
    branch = henon_branch(rising=True)
    assert [each.kind for each in branch.bifurcations] == ['flip']
    (flip,) = branch.bifurcations
    assert flip.at.value == pytest.approx(3 * 0.7**2 / 4, abs=1e-10)
    assert flip.multiplier == pytest.approx(-1, abs=1e-8)
    assert branch.end == 'end of the range'
    assert branch.orbits[-1].value == pytest.approx(1.0, abs=1e-12)
    guess, direction = dynamics.doubled_guess(Henon, flip)
    curve = dynamics.Curve(Henon, -0.3, 1.0, 2)
    first = curve.correct(flip.at.value, guess, direction)
    doubled = dynamics.continuation(Henon, first, first.value, -0.3, 1.0)
    assert doubled.period == 2
    assert [each.kind for each in doubled.bifurcations] == ['flip']
    second = doubled.bifurcations[0]
    assert second.at.value == pytest.approx((5 - 6 * 0.3 + 5 * 0.3**2) / 4, abs=1e-10)
    assert second.multiplier == pytest.approx(-1, abs=1e-8)


def test_neimark_sacker_of_the_delayed_logistic_map():
    """At a = 2, where the multipliers of the fixed point 1 - 1 / a are exp(+- i pi / 3)."""
    orbit = dynamics.periodic_orbit(DelayedLogistic(1.8), 1, np.array([0.4, 0.4]))
    branch = dynamics.continuation(DelayedLogistic, orbit, 1.8, 1.5, 2.2)
    assert [each.kind for each in branch.bifurcations] == ['Neimark-Sacker']
    (found,) = branch.bifurcations
    assert found.at.value == pytest.approx(2, abs=1e-9)
    assert found.multiplier == pytest.approx(np.exp(1j * np.pi / 3), abs=1e-8)


def test_what_was_found_is_kept_where_a_branch_must_end():
    branch = henon_branch(rising=True, most=5)
    assert len(branch.orbits) == 5
    assert branch.end == 'enough orbits'


@pytest.mark.slow
def test_frequency_response_of_kahraman_and_singh():
    """Contact is lost where the amplitude without loss is the mean load; the folds of the branch
    with impacts are at 0.7081 and 0.8284 by an independent continuation. Forward motions beside a
    fold go to the other branch or stay."""

    def sequence(point):
        return kahraman_singh(point.value).contact(point.points).sequence

    system = kahraman_singh(0.8)
    start = dynamics.static_state(system.pair, system.speed, system.load_torque)
    orbit = dynamics.periodic_orbit(system, 1, system.scaled(start))
    branch = dynamics.continuation(
        kahraman_singh, orbit, 0.8, 0.69, 0.87, sequence=sequence, largest_step=0.1
    )
    square = np.roots([MEAN**2 - ERROR**2, MEAN**2 * (4 * ZETA**2 - 2), MEAN**2])
    lost = np.sqrt(square.min())
    grazing, upper, lower = branch.bifurcations
    assert [each.kind for each in branch.bifurcations] == ['grazing', 'fold', 'fold']
    assert grazing.at.value == pytest.approx(lost, abs=1e-8)
    assert kahraman_singh(grazing.at.value).contact(grazing.at.points).clearance == pytest.approx(
        0, abs=1e-8
    )
    # To the four digits that are given.
    assert upper.at.value == pytest.approx(0.8284, abs=1e-4)
    assert lower.at.value == pytest.approx(0.7081, abs=1e-4)
    for fold in (upper, lower):
        assert fold.multiplier == pytest.approx(1, abs=1e-8)
    between = [each for each in branch.orbits if each.unstable]
    assert all(lower.at.value < each.value < upper.at.value for each in between)
    for offset, stays in ((1e-3, True), (-1e-3, False)):
        near = kahraman_singh(lower.at.value + offset)
        state = lower.at.points
        for _ in range(150):
            state = near.iterate(state)
        assert (near.contact(state).sequence == 'DG') == stays
