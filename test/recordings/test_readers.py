"""The same recording in all forms gives the same columns."""

import forms
import numpy as np
import pytest
from scipy import io

from gear_dynamics.machine.recording_form import Rows
from gear_dynamics.recordings.open import open_table
from gear_dynamics.recordings.table import RecordingError

NEEDS_PYARROW = pytest.mark.skipif(forms.pyarrow is None, reason='pyarrow is not there')
ROWS = Rows('channel', 'signal', 'fs')


def read(table, names, topic=None):
    resolved = [table.resolve(name, topic) for name in names]
    opened = table.open(resolved)
    return [np.concatenate(list(opened[name])) for name in resolved]


def check(table, names=('x', 'y', 'tacho'), rate=forms.RATE, topic=None, scale=1.0):
    found = read(table, names, topic)
    for values, expected in zip(found, forms.columns().values(), strict=True):
        np.testing.assert_array_equal(values, expected)
    if rate is not None:
        column = table.resolve(names[0], topic)
        assert table.rate(column) == pytest.approx(rate, rel=1e-6)


@pytest.mark.parametrize('separator', [',', ';', '\t', '|', ' '])
@pytest.mark.parametrize('decimal', ['.', ','])
@pytest.mark.parametrize('header', [True, False])
def test_text_with_any_separator(tmp_path, separator, decimal, header):
    if separator == decimal:
        pytest.skip('this cannot be told apart')
    path = tmp_path / 'a.csv'
    forms.write_csv(path, separator, decimal, header)
    check(open_table(path), ('x', 'y', 'tacho') if header else (1, 2, 3), rate=None)


def test_text_with_units_and_a_mark_of_the_byte_order(tmp_path):
    path = tmp_path / 'a.csv'
    forms.write_csv(path, units=True, bom=True)
    table = open_table(path)
    check(table, rate=None)
    assert [table.unit(name) for name in ('x', 'y', 'tacho')] == ['m/s2', 'g', 'V']


def test_text_with_remarks_constants_and_holes(tmp_path):
    path = tmp_path / 'a.txt'
    path.write_text(
        'Rig: 3\nSample rate: 2000\n# a remark\n"t [s]";"acc [g]"\n'
        '0,0;1,5\n0,5;bad\n1,0;\n1,5;4,5\n'
    )
    table = open_table(path)
    assert table.rate('acc [g]') == 2000.0
    assert table.unit('acc [g]') == 'g'
    t, acc = read(table, ['t', 'acc'])
    np.testing.assert_array_equal(t, [0, 0.5, 1, 1.5])
    np.testing.assert_array_equal(acc, [1.5, np.nan, np.nan, 4.5])


def test_text_in_utf_16(tmp_path):
    path = tmp_path / 'a.csv'
    path.write_text('a\tb\n1\t2\n3\t4\n', encoding='utf-16')
    np.testing.assert_array_equal(read(open_table(path), ['b']), [[2, 4]])


def test_a_file_without_an_ending_is_text(tmp_path):
    path = tmp_path / '2004.02.12.10.32.39'
    path.write_text('-0.1\t0.2\n0.3\t0.4\n')
    np.testing.assert_array_equal(read(open_table(path), [2]), [[0.2, 0.4]])


@pytest.mark.parametrize('width', [1, 2, 3, 4])
def test_wav_of_integers(tmp_path, width):
    path = tmp_path / 'a.wav'
    forms.write_wav(path, width)
    check(open_table(path), (1, 2, 3))


def test_wav_of_floats(tmp_path):
    path = tmp_path / 'a.wav'
    forms.write_float_wav(path)
    check(open_table(path), (1, 2, 3))


def test_a_wav_that_is_cut_short_is_read_to_its_end(tmp_path):
    path = tmp_path / 'a.wav'
    forms.write_wav(path, 2)
    path.write_bytes(path.read_bytes()[:-3000])
    table = open_table(path)
    assert len(read(table, [1])[0]) == forms.COUNT - 500
    assert '3000 bytes are missing' in table.notes['']


def test_matlab_structs_by_path(tmp_path):
    path = tmp_path / 'a.mat'
    forms.write_mat(path)
    table = open_table(path)
    x, y, tacho = read(table, ['rig.x', '*.y', 'tacho_?'])
    expected = forms.columns()
    np.testing.assert_array_equal(x, expected['x'])
    np.testing.assert_array_equal(y, expected['y'])
    np.testing.assert_array_equal(tacho, expected['tacho'] * 2)
    assert table.rate('rig.x') == forms.RATE
    assert table.constants == {'rig.sr': forms.RATE}


def test_matlab_names_that_stand_twice(tmp_path):
    path = tmp_path / 'a.mat'
    with path.open('wb') as stream:
        io.savemat(stream, {'Data1': np.zeros(9)})
        io.savemat(stream, {'Data1': np.arange(9.0)})
    table = open_table(path)
    np.testing.assert_array_equal(read(table, ['Data1'])[0], np.arange(9.0))
    assert 'twice' in table.notes['Data1']


def test_matlab_matrices_cells_and_arrays_of_structs(tmp_path):
    path = tmp_path / 'a.mat'
    cell = np.empty(2, object)
    cell[:] = [np.arange(3.0), np.arange(4.0)]
    runs = np.array([(np.arange(5),), (np.arange(6),)], [('data', object)])
    io.savemat(path, {'m': np.arange(12.0).reshape(6, 2), 'c': cell, 'runs': runs})
    table = open_table(path)
    m, c, r = read(table, ['m[2]', 'c[2]', 'runs[2].data'])
    np.testing.assert_array_equal(m, [1, 3, 5, 7, 9, 11])
    assert (len(c), len(r)) == (4, 6)


def test_numpy_files(tmp_path):
    values = forms.columns()
    np.savez(tmp_path / 'a.npz', **values, fs=forms.RATE, both=np.zeros((9, 2)))
    check(open_table(tmp_path / 'a.npz'))
    np.savez_compressed(tmp_path / 'b.npz', **values, fs=forms.RATE)
    check(open_table(tmp_path / 'b.npz'))
    rows = np.empty(forms.COUNT, [(name, float) for name in values])
    for name, column in values.items():
        rows[name] = column
    np.save(tmp_path / 'a.npy', rows)
    check(open_table(tmp_path / 'a.npy'), rate=None)
    np.save(tmp_path / 'b.npy', np.column_stack(list(values.values())))
    check(open_table(tmp_path / 'b.npy'), (1, 2, 3), rate=None)


@NEEDS_PYARROW
def test_parquet_with_a_column_a_channel(tmp_path):
    forms.write_parquet(tmp_path / 'a.parquet')
    check(open_table(tmp_path / 'a.parquet'), rate=None)


@NEEDS_PYARROW
def test_parquet_with_a_row_a_channel(tmp_path):
    forms.write_parquet_rows(tmp_path / 'a.parquet')
    check(open_table(tmp_path / 'a.parquet', ROWS))


def test_hdf5(tmp_path):
    pytest.importorskip('h5py')
    forms.write_hdf5(tmp_path / 'a.h5')
    check(open_table(tmp_path / 'a.h5'), ('run1.x', '*.y', 'run1.tacho'))


def test_tdms(tmp_path):
    pytest.importorskip('nptdms')
    forms.write_tdms(tmp_path / 'a.tdms')
    check(open_table(tmp_path / 'a.tdms'))


def test_universal_file_format(tmp_path):
    pytest.importorskip('pyuff')
    forms.write_uff(tmp_path / 'a.uff')
    check(open_table(tmp_path / 'a.uff'))


def test_mcap_log(tmp_path):
    table = open_table(forms.write_mcap(tmp_path))
    check(table, topic='machine/samples')
    np.testing.assert_array_equal(
        read(table, ['data'], 'machine/speed'), [25.0 + np.arange(0, 3000, 500)]
    )
    assert table.rate(table.resolve('data', 'machine/speed')) == pytest.approx(forms.RATE / 500)


@pytest.mark.parametrize(
    ('name', 'content', 'words'),
    [
        ('a.csv', b'', 'holds no rows'),
        ('a.csv', b'only words\nand more\n', 'no columns of numbers'),
        ('a.wav', b'RIFF', 'is no WAV file'),
        ('a.wav', b'RIFF\0\0\0\0WAVE', 'is no complete WAV file'),
        ('a.mat', b'nothing', 'cannot be read'),
        ('a.npz', b'nothing', 'cannot be read'),
        ('a.npy', b'nothing', 'cannot be read'),
        ('a.xyz', b'\0\1\2', 'of no known kind'),
    ],
)
def test_files_that_cannot_be_read_are_refused_in_one_line(tmp_path, name, content, words):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=words) as caught:
        open_table(path)
    assert '\n' not in str(caught.value)
    assert name in str(caught.value)


def test_columns_that_are_not_there_are_named(tmp_path):
    path = tmp_path / 'a.csv'
    path.write_text('left_y,right_y\n1,2\n3,4\n')
    table = open_table(path)
    with pytest.raises(RecordingError, match="did you mean 'left_y'"):
        table.resolve('leftt_y')
    with pytest.raises(RecordingError, match='more than one'):
        table.resolve('*_y')
    with pytest.raises(RecordingError, match='no column 3'):
        table.resolve(3)
    with pytest.raises(RecordingError, match='say which'):
        table.resolve(None)
    with pytest.raises(RecordingError, match='does not exist'):
        open_table(tmp_path / 'b.csv')
