from gear_dynamics.monitoring.gaps import Order, StampCheck

BLOCK_NS = 10_000_000  # 512 samples at 51 200 Hz


def fed(count=3):
    check = StampCheck(51200.0)
    orders = [check.check(7 + k * BLOCK_NS, 512) for k in range(count)]
    assert orders == [Order.FIRST, *[Order.NEXT] * (count - 1)]
    return check


def test_a_missing_block_is_a_gap_of_its_samples():
    check = fed()
    assert check.check(7 + 4 * BLOCK_NS, 512) is Order.GAP
    assert check.missing == 512
    assert check.check(7 + 5 * BLOCK_NS, 512) is Order.NEXT


def test_a_single_missing_sample_is_a_gap():
    check = fed()
    assert check.check(7 + 3 * BLOCK_NS + 19531, 512) is Order.GAP
    assert check.missing == 1


def test_rounding_to_nanoseconds_is_no_gap():
    # 44 100 samples/s: no block is a whole number of nanoseconds
    check = StampCheck(44100.0)
    for k in range(10000):
        order = check.check(round(k * 512 * 1e9 / 44100), 512)
        assert order is (Order.NEXT if k else Order.FIRST)


def test_a_repeated_block_is_not_used_and_changes_nothing():
    check = fed()
    assert check.check(7 + 2 * BLOCK_NS, 512) is Order.BACK
    assert check.check(7 + 3 * BLOCK_NS, 512) is Order.NEXT


def test_a_stream_played_again_is_taken_up_after_a_second():
    check = fed()
    orders = [check.check(-(10**12) + k * BLOCK_NS, 512) for k in range(110)]
    assert orders[:99] == [Order.BACK] * 99
    assert Order.RESTART in orders
    start = orders.index(Order.RESTART)
    assert set(orders[start + 1 :]) == {Order.NEXT}
