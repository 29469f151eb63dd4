"""One short recording of three channels, written in every form that can be read."""

import json
import struct
import wave

import numpy as np
from scipy import io

try:
    import pyarrow
except ImportError:  # missing, or made for another NumPy
    pyarrow = None

RATE = 12800.0
COUNT = 3000


def columns():
    """Return two channels and a tacho: whole multiples of 2**-7, which all forms hold exactly."""
    random = np.random.default_rng(5)
    x, y = random.integers(-120, 120, (2, COUNT)) / 128
    return {'x': x, 'y': y, 'tacho': (np.arange(COUNT) % 128 < 10) / 2}


def write_csv(path, separator=',', decimal='.', header=True, units=False, bom=False):
    table = np.column_stack(list(columns().values()))
    lines = [separator.join(f'{v:.7f}' for v in row).replace('.', decimal) for row in table]
    above = [separator.join(columns())] if header else []
    above += [separator.join(['m/s2', 'g', 'V'])] if units else []
    text = '\n'.join([*above, *lines]) + '\n'
    path.write_text(text, encoding='utf-8-sig' if bom else 'utf-8')


def write_wav(path, width):
    table = np.column_stack(list(columns().values()))
    if width == 1:
        data = (np.round(table * 128) + 128).astype(np.uint8).tobytes()
    elif width == 3:
        wide = np.round(table * 2**23).astype('<i4')
        data = wide.view(np.uint8).reshape(-1, 4)[:, :3].tobytes()
    else:
        data = np.round(table * 2 ** (8 * width - 1)).astype(f'<i{width}').tobytes()
    with wave.open(str(path), 'wb') as file:
        file.setnchannels(3)
        file.setsampwidth(width)
        file.setframerate(int(RATE))
        file.writeframes(data)


def write_float_wav(path):
    data = np.column_stack(list(columns().values())).astype('<f4').tobytes()
    form = struct.pack('<HHIIHH', 3, 3, int(RATE), int(RATE) * 12, 12, 32)
    body = b'WAVEfmt ' + struct.pack('<I', 16) + form + b'data' + struct.pack('<I', len(data))
    path.write_bytes(b'RIFF' + struct.pack('<I', len(body) + len(data)) + body + data)


def write_mat(path):
    values = columns()
    io.savemat(
        path,
        {
            'rig': {'x': values['x'][:, np.newaxis], 'y': values['y'][np.newaxis], 'sr': RATE},
            'tacho_1': (values['tacho'] * 2).astype(np.int16),
        },
    )


def write_hdf5(path):
    import h5py

    with h5py.File(path, 'w') as file:
        for name, values in columns().items():
            file[f'run1/{name}'] = values
        file['run1'].attrs['sample_rate'] = RATE


def write_tdms(path):
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as writer:
        writer.write_segment(
            [
                ChannelObject('rig', name, values, {'wf_increment': 1 / RATE})
                for name, values in columns().items()
            ]
        )


def write_uff(path):
    import pyuff

    for number, (name, values) in enumerate(columns().items(), 1):
        data = {
            'type': 58,
            'func_type': 1,
            **{'rsp_node': number, 'rsp_dir': 1, 'ref_node': 1, 'ref_dir': 1},
            **{'rsp_ent_name': 'rig', 'ref_ent_name': 'rig', 'id1': name, 'binary': 0},
            **{'data': values, 'x': np.arange(COUNT) / RATE, 'abscissa_spacing': 1},
            **{'abscissa_spec_data_type': 17, 'ordinate_spec_data_type': 12},
            'orddenom_spec_data_type': 0,
        }
        pyuff.UFF(str(path)).write_sets(data, mode='add')


def write_parquet(path):
    import pyarrow as pa
    from pyarrow import parquet

    parquet.write_table(pa.table(columns()), path)


def write_parquet_rows(path):
    import pyarrow as pa
    from pyarrow import parquet

    values = columns()
    table = pa.table(
        {
            'channel': list(values),
            'signal': [v.tolist() for v in values.values()],
            'fs': [RATE] * 3,
        }
    )
    parquet.write_table(table, path)


def write_mcap(directory):
    """Write a log; return its folder."""
    from gear_dynamics.bag.metadata import OfferedQos
    from gear_dynamics.bag.writer import LogWriter
    from gear_dynamics.wire.messages import message_class, serialize
    from gear_dynamics.wire.tables import TABLE_TYPE, encode_table
    from gear_dynamics.wire.topics import NUMBER_TYPE

    values = columns()
    rows = np.empty(COUNT, [(name, '<f4') for name in ('t', *values)])
    for name, column in values.items():
        rows[name] = column
    with LogWriter(directory, {'parameters': json.dumps({})}) as writer:
        for first in range(0, COUNT, 500):
            part = rows[first : first + 500].copy()
            part['t'] = np.arange(500) / RATE
            stamp = 10**18 + round(first * 1e9 / RATE)
            data = encode_table(part, stamp, 'housing')
            writer.write('/machine/samples', TABLE_TYPE, data, stamp, stamp, OfferedQos())
            data = serialize(message_class(NUMBER_TYPE)(25.0 + first))
            writer.write('/machine/speed', NUMBER_TYPE, data, stamp, stamp, OfferedQos())
    return next(path for path in directory.iterdir() if path.is_dir())
