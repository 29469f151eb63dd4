import numpy as np
import pytest

from gear_dynamics.machine.columns import EVENTS, EventKind
from gear_dynamics.monitoring.contact_state import EventContact

B = 150e-6
LOST, REGAINED = EventKind.DRIVE_LOST, EventKind.DRIVE_REGAINED
BACK_LOST, BACK_REGAINED = EventKind.BACK_LOST, EventKind.BACK_REGAINED


def events(*rows):
    """Events of (t, kind), or (t, kind, delta)."""
    made = np.zeros(len(rows), EVENTS)
    for row, (t, kind, *delta) in zip(made, rows, strict=True):
        back = kind in (BACK_LOST, BACK_REGAINED)
        row['t'], row['kind'] = t, kind
        row['delta'] = delta[0] if delta else -B if back else B
    return made


def test_both_pairs_in_mesh_lose_contact_once():
    found = EventContact(B).take(
        events((0.1, LOST), (0.1, LOST), (0.3, REGAINED), (0.3, REGAINED)), 0.0, 1.0
    )
    assert found == pytest.approx((0.2, 1, 0))


def test_back_impacts_are_counted_and_back_contact_is_contact():
    found = EventContact(B).take(
        events((0.1, LOST), (0.2, BACK_REGAINED), (0.5, BACK_LOST), (0.6, REGAINED)), 0.0, 1.0
    )
    assert found == pytest.approx((0.2, 1, 1))


def test_a_loss_that_lasts_over_the_end_of_a_span_counts_in_both():
    contact = EventContact(B)
    assert contact.take(events((0.9, LOST)), 0.0, 1.0) == pytest.approx((0.1, 1, 0))
    assert contact.take(events(), 1.0, 2.0) == pytest.approx((1.0, 0, 0))
    assert contact.take(events((2.5, REGAINED)), 2.0, 3.0) == pytest.approx((0.5, 0, 0))
    assert contact.take(events(), 3.0, 4.0) == pytest.approx((0.0, 0, 0))


def test_a_record_that_begins_out_of_contact():
    found = EventContact(B).take(events((0.25, REGAINED)), 0.0, 1.0)
    assert found == pytest.approx((0.25, 0, 0))


def test_a_pair_whose_flank_deviates_does_not_count():
    found = EventContact(B).take(
        events((0.1, LOST, B + 1e-5), (0.2, LOST), (0.3, REGAINED)), 0.0, 1.0
    )
    assert found == pytest.approx((0.1, 1, 0))
