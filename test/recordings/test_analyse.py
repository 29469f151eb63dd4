"""`gd.analyse` on recordings with known answers, and on what goes wrong with real ones."""

import forms
import numpy as np
import pytest

import gear_dynamics as gd

pytest.importorskip('pandas')

RATE = 12800.0
CSV = {
    'sample_rate': RATE,
    'span': 0.1,
    'channels': {'housing': {'column': 'x', 'unit': 'm/s2'}, 'cover': {'column': 'y', 'unit': 'g'}},
}
GEARBOX = {
    'machine': 'gearbox',
    'sample_rate': RATE,
    'channels': {'housing': {'column': 'x', 'unit': 'm/s2'}},
    'shafts': {'input': {'tacho': {'column': 'tacho'}}, 'output': {'driven_by': 'first'}},
    'wheels': {'a': {'shaft': 'input', 'teeth': 20}, 'b': {'shaft': 'output', 'teeth': 50}},
    'meshes': {'first': ['a', 'b']},
}


def gearbox(duration=4.0, drift=0.02, noise=0.3):
    """Return a mesh of 20 teeth at 30 revolutions/s, amplitude 2, with sidebands and a tacho."""
    t = np.arange(int(duration * RATE)) / RATE
    swing = 30 * drift / 2 * duration / (2 * np.pi)
    angle = 30 * t + swing * (1 - np.cos(2 * np.pi * t / duration))
    x = 2 * np.cos(2 * np.pi * 20 * angle) * (1 + 0.3 * np.cos(2 * np.pi * angle))
    x += 0.5 * np.cos(2 * np.pi * 40 * angle)
    x += noise * np.random.default_rng(1).normal(size=len(t))
    return {'x': x, 'tacho': (np.mod(angle, 1) < 0.1) * 5.0}


def changed(machine, **parts):
    return {**machine, **parts}


def test_all_forms_give_the_same_table(tmp_path):
    values = forms.columns()
    expected = gd.analyse(values, changed(CSV))
    forms.write_csv(tmp_path / 'a.csv', ';', ',')
    np.savez(tmp_path / 'a.npz', **values)
    forms.write_mat(tmp_path / 'a.mat')
    forms.write_wav(tmp_path / 'a.wav', 2)
    log = forms.write_mcap(tmp_path)
    of_mat = {'housing': {'column': 'rig.x', 'unit': 'm/s2'}, 'cover': {'column': 'rig.y'}}
    of_mat['cover']['unit'] = 'g'
    of_wav = {'housing': {'column': 1, 'unit': 'm/s2'}, 'cover': {'column': 2, 'unit': 'g'}}
    topic = {'topic': 'machine/samples'}
    of_log = {name: {**each, **topic} for name, each in CSV['channels'].items()}
    for path, channels in (
        (tmp_path / 'a.csv', CSV['channels']),
        (tmp_path / 'a.npz', CSV['channels']),
        (tmp_path / 'a.mat', of_mat),
        (tmp_path / 'a.wav', of_wav),
        (log, of_log),
    ):
        found = gd.analyse(path, changed(CSV, channels=channels))
        numbers = expected.select_dtypes('number').columns
        np.testing.assert_allclose(found[numbers], expected[numbers], rtol=1e-9, atol=1e-12)


def test_levels_in_the_channels_own_unit():
    t = np.arange(int(2 * RATE)) / RATE
    wave = 3.0 + 2.0 * np.sin(2 * np.pi * 100 * t)
    machine = {'sample_rate': RATE, 'channels': {'a': {'column': 'a', 'unit': 'g'}}}
    table = gd.analyse({'a': wave}, machine)
    assert len(table) == 2
    row = table.iloc[0]
    g = 9.80665
    assert row['a/mean'] == pytest.approx(3 * g)
    assert row['a/rms'] == pytest.approx(g * np.sqrt(9 + 2))
    assert row['a/std'] == pytest.approx(g * np.sqrt(2))
    assert row['a/crest_factor'] == pytest.approx(np.sqrt(2), rel=1e-3)
    assert row['a/kurtosis'] == pytest.approx(1.5)
    assert row['a/velocity_rms'] == pytest.approx(g * np.sqrt(2) / (2 * np.pi * 100), rel=1e-3)
    assert table.attrs['units']['a/rms'] == 'm/s2'


def test_mesh_lines_stay_sharp_while_the_speed_drifts_with_a_tacho():
    table = gd.analyse(gearbox(), GEARBOX)
    assert len(table) == 4
    np.testing.assert_allclose(table['housing/first_harmonic_1'], 2, rtol=0.01)
    np.testing.assert_allclose(table['housing/first_harmonic_2'], 0.5, rtol=0.02)
    # Two sidebands of 0.3 over the RMS of tones of 2, 0.5 and twice 0.3.
    rms = np.sqrt((4 + 0.25 + 2 * 0.09) / 2)
    np.testing.assert_allclose(table['housing/a_sideband_level_factor'], 0.6 / rms, rtol=0.03)
    mean = 2 * np.pi * 30
    assert table['input/speed'].mean() == pytest.approx(mean, rel=1e-3)
    assert table['output/speed'].mean() == pytest.approx(mean * 0.4, rel=1e-3)
    assert table['input/revolutions'].sum() == pytest.approx(119, abs=1.1)


def test_mesh_lines_stay_sharp_while_the_speed_drifts_without_a_tacho():
    track = {'track': {'channel': 'housing', 'order': 20, 'from_rpm': 1600, 'to_rpm': 2000}}
    shafts = {'input': track, 'output': {'driven_by': 'first'}}
    table = gd.analyse(gearbox(), changed(GEARBOX, shafts=shafts, span='record'))
    assert table['housing/first_harmonic_1'][0] == pytest.approx(2, rel=0.01)
    assert table['input/speed'][0] == pytest.approx(2 * np.pi * 30, rel=2e-4)
    assert not table['input/at_limit'][0]
    assert not table['steady'][0]


def test_a_fixed_speed_is_taken_as_it_is():
    shafts = {'input': {'speed_rpm': 1800}, 'output': {'driven_by': 'first'}}
    table = gd.analyse(gearbox(drift=0.0), changed(GEARBOX, shafts=shafts))
    assert table['housing/first_harmonic_1'][0] == pytest.approx(2, rel=0.01)
    assert table['steady'].all()


def test_spans_are_cut_at_holes_which_are_counted():
    values = gearbox(2.0)
    values['x'][6400:6420] = np.nan
    table = gd.analyse(values, GEARBOX)
    np.testing.assert_allclose(table['duration'], [0.5, 0.5 - 20 / RATE, 1.0], atol=1e-9)
    assert any('20 samples' in note for note in table.attrs['notes'])


def test_a_missing_channel_does_not_stop_the_others():
    channels = {**GEARBOX['channels'], 'cover': {'column': 'z'}}
    table = gd.analyse(gearbox(1.0), changed(GEARBOX, channels=channels))
    assert table['housing/rms'][0] > 1
    assert 'channel cover' in table.attrs['failures']
    assert np.isnan(table['cover/rms'][0])


@pytest.mark.parametrize(
    ('parts', 'words'),
    [
        ({'sample_rate': None}, 'states no sample rate'),
        ({'sample_rate': None, 'time': {'column': 'zero'}}, 'does not rise'),
        ({'channels': {'a': {'column': 'zz'}}}, "no column 'zz'"),
    ],
)
def test_nothing_to_analyse_is_one_line(parts, words):
    values = {**gearbox(1.0), 'zero': np.zeros(int(RATE))}
    with pytest.raises(ValueError, match=words) as caught:
        gd.analyse(values, changed(GEARBOX, **parts))
    assert '\n' not in str(caught.value)


def test_two_statements_of_the_rate_that_differ_are_refused(tmp_path):
    forms.write_wav(tmp_path / 'a.wav', 2)
    machine = {'sample_rate': 25600.0, 'channels': {'a': {'column': 1}}}
    with pytest.raises(ValueError, match=r'12800 Hz by the file and 25600 Hz'):
        gd.analyse(tmp_path / 'a.wav', machine)


def test_the_rate_from_a_time_column_is_its_mean_step():
    t = np.round(np.arange(2560) / 25600, 6)  # steps of 39 and 40 us
    values = {'h': t * 0 + 9, 's': np.floor(t), 'us': t * 1e6, 'a': np.sin(t)}
    machine = {
        'time': {'columns': ['h', 's', 'us'], 'units': ['h', 's', 'us']},
        'channels': {'a': {'column': 'a'}},
    }
    table = gd.analyse(values, machine)
    assert table['duration'][0] == pytest.approx(0.1, rel=2e-5)


def test_no_unit_is_assumed():
    machine = {'sample_rate': RATE, 'channels': {'a': {'column': 'x'}}}
    table = gd.analyse(gearbox(1.0), machine)
    assert table.attrs['units']['a/rms'] == 'unknown'
    assert 'a/velocity_rms' not in table


def test_clipping_is_measured_and_marked():
    values = gearbox(1.0)
    values['x'] = np.clip(values['x'], -1.5, 1.5)
    table = gd.analyse(values, GEARBOX)
    share = np.mean(np.abs(values['x']) == 1.5)
    assert table['housing/clipped'][0] == pytest.approx(share, rel=0.01)
    assert 'clipped' in table['notes'][0]
    assert gd.analyse(gearbox(1.0), GEARBOX)['housing/clipped'][0] == 0


@pytest.mark.parametrize('bits', [4, 8, 16])
def test_coarse_samples_are_not_clipped(bits):
    values = {'x': np.round(gearbox(1.0)['x'] / 4 * 2 ** (bits - 1))}
    machine = {'sample_rate': RATE, 'channels': {'a': {'column': 'x', 'unit': 'counts'}}}
    assert gd.analyse(values, machine)['a/clipped'][0] == 0


def test_a_span_too_short_for_orders_says_what_is_needed():
    table = gd.analyse(gearbox(1.0), changed(GEARBOX, span=0.25))
    assert np.isnan(table['housing/first_harmonic_1']).all()
    assert 'orders need 10, that is 0.3' in table['notes'][0]


def test_a_tacho_that_stops_leaves_the_rest_without_orders():
    values = gearbox(3.0)
    values['tacho'][int(1.6 * RATE) :] = 0
    table = gd.analyse(values, GEARBOX)
    assert np.isfinite(table['housing/first_harmonic_1'][0])
    assert 'gives pulses from' in table['notes'][1]
    assert np.isnan(table['housing/first_harmonic_1'][2])
    assert 'silent' in table['notes'][2]
    assert np.isfinite(table['housing/rms']).all()


def test_channels_of_different_rates_and_a_file_each(tmp_path):
    t = np.arange(int(2 * RATE)) / RATE
    np.savez(tmp_path / 'fast.npz', data=np.sin(2 * np.pi * 500 * t))
    np.savez(tmp_path / 'slow.npz', data=20 + 0 * t[:20])
    machine = {
        'files': 'channels',
        'channels': {
            'vibration': {'file': 'fast*', 'unit': 'm/s2', 'sample_rate': RATE},
            'temperature': {'file': 'slow*', 'unit': 'degC', 'sample_rate': 10},
        },
    }
    table = gd.analyse([tmp_path / 'fast.npz', tmp_path / 'slow.npz'], machine)
    assert len(table) == 2
    np.testing.assert_allclose(table['temperature/mean'], 20)
    np.testing.assert_allclose(table['vibration/std'], np.sqrt(0.5))


def test_files_that_are_one_recording_end_to_end(tmp_path):
    whole = forms.columns()['x']
    np.savez(tmp_path / '1.npz', x=whole[:1000], y=whole[:1000])
    np.savez(tmp_path / '2.npz', x=whole[1000:], y=whole[1000:])
    joined = gd.analyse([tmp_path / '1.npz', tmp_path / '2.npz'], CSV)
    expected = gd.analyse({'x': whole, 'y': whole}, CSV)
    np.testing.assert_array_equal(joined['housing/rms'], expected['housing/rms'])


def test_a_folder_of_recordings_is_a_trend(tmp_path):
    for minute, level in ((30, 2.0), (10, 1.0), (20, 3.0)):
        path = tmp_path / f'rig_2024-05-01_12-{minute}-00.csv'
        np.savetxt(path, level * forms.columns()['x'])
    machine = {
        'sample_rate': RATE,
        'files': 'series',
        'channels': {'a': {'column': 1, 'unit': 'm/s2'}},
    }
    table = gd.analyse(tmp_path, machine)
    np.testing.assert_array_equal(table['t'], [0, 600, 1200])
    np.testing.assert_allclose(table['a/rms'] / table['a/rms'][0], [1, 3, 2])


def test_machines_and_recordings_of_a_wrong_kind_are_refused():
    with pytest.raises(ValueError, match='of type int is not known'):
        gd.analyse(3, GEARBOX)
    with pytest.raises(ValueError, match='no recording is given'):
        gd.analyse([], GEARBOX)
    with pytest.raises(ValueError, match='cannot be read'):
        gd.analyse({}, 'nowhere.yaml')


def test_constants_that_contradict_the_machine_file_are_said():
    # FTF of 14.8375 Hz is 1 - FTF of this bearing at 25 Hz; the others fit.
    constants = {'bearing.BPFO': 81.125, 'BPFI': 118.875, 'BSF': 63.91, 'FTF': 14.8375, 'rpm': 1600}
    machine = {
        'sample_rate': RATE,
        'channels': {'a': {'column': 'a', 'unit': 'g'}},
        'shafts': {'shaft': {'speed_rpm': 1500}},
        'bearings': {
            'b': {
                'shaft': 'shaft', 'elements': 8, 'element_diameter': 0.235, 'pitch_diameter': 1.245
            }
        },
    }  # fmt: skip
    noise = np.random.default_rng(1).normal(size=int(RATE))
    notes = gd.analyse({'a': noise, **constants}, machine).attrs['notes']
    assert len(notes) == 2
    assert 'FTF' in notes[0]
    assert '10.14 Hz' in notes[0]
    assert 'rpm of the recording is 1600' in notes[1]


def test_lines_that_nothing_explains_are_listed():
    from gear_dynamics.monitoring.spans.unexplained import unexplained_lines
    from gear_dynamics.recordings.analyse import analyse_recordings, as_machine

    values = gearbox(4.0, drift=0.0)
    values['x'] += np.sin(2 * np.pi * 1234.5 * np.arange(len(values['x'])) / RATE)
    analysis = analyse_recordings(values, as_machine({**GEARBOX, 'span': 'record'}))
    lines = unexplained_lines(analysis.summary, 'housing')
    assert [line.frequency for line in lines] == pytest.approx([1234.5], abs=0.3)
    assert lines[0].amplitude == pytest.approx(1, rel=0.2)


def test_a_wav_without_full_scale_says_so(tmp_path):
    forms.write_wav(tmp_path / 'a.wav', 2)
    machine = {'channels': {'a': {'column': 1, 'unit': 'm/s2'}}}
    assert 'full scale' in gd.analyse(tmp_path / 'a.wav', machine).attrs['notes'][0]
    machine['channels']['a']['full_scale'] = 100.0
    table = gd.analyse(tmp_path / 'a.wav', machine)
    assert table.attrs['notes'] == []
    assert table['a/peak'][0] > 90


def test_a_run_of_the_simulator_is_a_recording():
    run = gd.simulate(gd.GearPair(), duration=0.7, sample_rate=25600.0)
    machine = {
        'sample_rate': 25600.0,
        'channels': {'force': {'column': 'mesh_force', 'unit': 'N'}},
        'shafts': {'pinion': {'angle': {'column': 'pinion_angle', 'unit': 'rad'}}},
    }
    table = gd.analyse(run, machine)
    assert table['pinion/speed'][0] == pytest.approx(104.72, rel=1e-3)
    np.testing.assert_allclose(table['force/mean'][0], run['mesh_force'].mean(), rtol=1e-3)


@pytest.mark.parametrize(
    ('shaft', 'values', 'words'),
    [
        ({'tacho': {'column': 's'}}, np.nan, 'the tacho is silent'),
        ({'tacho': {'column': 's'}}, 0.0, 'the tacho is silent'),
        ({'angle': {'column': 's', 'counts': 360}}, 0.0, 'stands still'),
        ({'angle': {'column': 's', 'counts': 360}}, np.nan, 'not finite'),
        ({'speed': {'column': 's'}}, 0.0, 'stops or turns back'),
        ({'track': {'order': 20, 'from_rpm': 3000, 'to_rpm': 3300}}, 0.0, 'no line stands out'),
        ({'track': {'order': 20, 'from_rpm': 9e4, 'to_rpm': 1e5}}, 0.0, 'half of the sample rate'),
        ({}, 0.0, 'nothing tells its speed'),
    ],
)
def test_a_speed_that_cannot_be_found_leaves_the_levels(shaft, values, words):
    recording = {**gearbox(1.0), 's': np.full(int(RATE), values)}
    shafts = {'input': shaft, 'output': {'driven_by': 'first'}}
    table = gd.analyse(recording, changed(GEARBOX, shafts=shafts))
    assert words in table['notes'][0]
    assert np.isfinite(table['housing/rms'][0])
    assert np.isnan(table['housing/first_harmonic_1'][0])


@pytest.mark.parametrize('rpm', [1.0, 60000.0, 1e7])
def test_speeds_that_fit_no_sample_rate_give_no_orders(rpm):
    shafts = {'input': {'speed_rpm': rpm}, 'output': {'driven_by': 'first'}}
    table = gd.analyse(gearbox(1.0), changed(GEARBOX, shafts=shafts))
    assert np.isnan(table['housing/first_harmonic_1'][0])


def test_pulses_of_an_encoder_while_the_speed_rises():
    t = np.arange(2 * 51200) / 51200
    angle = 14 * t + 1.2 * t**2
    recording = {'x': np.cos(2 * np.pi * 20 * angle), 'tacho': np.mod(angle * 512, 1) < 0.5}
    shafts = {
        'input': {'tacho': {'column': 'tacho', 'pulses': 512}},
        'output': {'driven_by': 'first'},
    }
    table = gd.analyse(recording, changed(GEARBOX, shafts=shafts, sample_rate=51200.0))
    np.testing.assert_allclose(table['housing/first_harmonic_1'], 1, rtol=2e-3)
    assert not table['steady'].any()


def test_recordings_of_a_series_begin_their_tacho_anew(tmp_path):
    values = gearbox(1.0, drift=0.0)
    for number in (2, 10):
        np.savez(tmp_path / f'{number}.npz', **values)
    table = gd.analyse(tmp_path, changed(GEARBOX, files='series'))
    assert list(table['file']) == ['2.npz', '10.npz']
    np.testing.assert_array_equal(table['t'], [0, 1])
    np.testing.assert_array_equal(table['input/revolutions'], [28, 28])
    assert 'without pause' in table.attrs['notes'][0]


def test_other_files_of_a_folder_are_passed_over(tmp_path):
    np.savez(tmp_path / 'acc_1.npz', x=gearbox(1.0)['x'])
    np.savez(tmp_path / 'temp_1.npz', x=np.zeros(20))
    channels = {'a': {'file': 'acc*', 'column': 'x', 'unit': 'm/s2'}}
    machine = {'sample_rate': RATE, 'files': 'series', 'channels': channels}
    table = gd.analyse(tmp_path, machine)
    assert list(table['file']) == ['acc_1.npz']
    assert table.attrs['failures'] == {}
