"""Damaged messages, and tables of any columns."""

import io

import numpy as np
from bag import bag_support
from fuzz.damage import check_refusal, damaged_bytes
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from gear_dynamics.wire.messages import MessageError, deserialize, header_stamp
from gear_dynamics.wire.tables import TABLE_TYPE, TableError, decode_table, encode_table

PUBLISHED = bag_support.messages(2)
TABLES = [each.data for each in PUBLISHED if each.type_name == TABLE_TYPE]
OTHERS = [(each.type_name, each.data) for each in PUBLISHED]

NAMES = st.text(st.characters(codec='ascii', categories=('L', 'N')), min_size=1, max_size=20)
COLUMNS = st.lists(
    st.tuples(NAMES, st.sampled_from(('<f4', '<f8', '<u4', '<u1', '<i2'))),
    min_size=1,
    max_size=20,
    unique_by=lambda column: column[0],
)


@given(data=damaged_bytes(TABLES))
def test_a_damaged_table_is_read_or_refused_in_one_line(data):
    try:
        table = decode_table(data)
    except TableError as error:
        check_refusal(error)
    else:
        assert table.rows.nbytes <= len(data)


@given(data=damaged_bytes([data for _, data in OTHERS]), kind=st.sampled_from(OTHERS))
def test_a_damaged_message_is_read_or_refused_in_one_line(data, kind):
    try:
        deserialize(data, kind[0])
        header_stamp(data, kind[0])
    except MessageError as error:
        check_refusal(error)


@given(columns=COLUMNS, stamp=st.integers(0, 2**31 * 10**9 - 1), draw=st.data())
def test_any_table_comes_back_as_it_was(columns, stamp, draw):
    dtype = np.dtype([(name, kind) for name, kind in columns])
    rows = draw.draw(arrays.arrays(dtype, st.integers(0, 50)))
    table = decode_table(encode_table(rows, stamp, 'line_of_action'))
    assert table.stamp_ns == stamp
    assert table.rows.dtype.names == dtype.names
    assert saved(table.rows.astype(dtype)) == saved(rows)


def saved(rows):
    """Return the values as bytes, NaN and all."""
    stream = io.BytesIO()
    for name in rows.dtype.names:
        stream.write(np.ascontiguousarray(rows[name]).tobytes())
    return stream.getvalue()
