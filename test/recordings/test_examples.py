"""The examples that analyse recordings run."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / 'examples'
MACHINE = """\
sample_rate: 12800
files: series
channels: {a: {column: 1, unit: m/s2}}
"""


def example(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f'{name}.py')
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def recordings(tmp_path):
    """Write recordings whose level rises from hour to hour; return their folder."""
    folder = tmp_path / 'recordings'
    folder.mkdir()
    for hour in range(6):
        noise = (1 + hour) * np.random.default_rng(hour).normal(size=6400)
        np.savetxt(folder / f'rig_2024-05-01_{hour + 10}-00-00.csv', noise)
    (tmp_path / 'machine.yaml').write_text(MACHINE)
    return folder


def test_trend(recordings, tmp_path):
    pytest.importorskip('pandas')
    figure = tmp_path / 'trend.png'
    table = example('trend').trend(recordings, tmp_path / 'machine.yaml', 'a/rms', figure)
    np.testing.assert_array_equal(table['t'], np.arange(6) * 3600)
    np.testing.assert_allclose(table['a/rms'], np.arange(1, 7), rtol=0.05)
    assert figure.stat().st_size > 1000


def test_indicators_as_features(recordings, tmp_path):
    pytest.importorskip('pandas')
    pytest.importorskip('sklearn')
    files = sorted(recordings.iterdir())
    indicators = example('classify').Indicators(tmp_path / 'machine.yaml').fit(files)
    features = indicators.transform(files)
    assert features.shape == (6, len(indicators.get_feature_names_out()))
    rms = list(indicators.get_feature_names_out()).index('a/rms')
    np.testing.assert_allclose(features[:, rms], np.arange(1, 7), rtol=0.05)
