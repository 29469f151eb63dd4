"""Indicators of recordings as features of a scikit-learn pipeline.

Usage: python classify.py MACHINE_FILE HEALTHY_FOLDER FAULTY_FOLDER
"""

import sys
from pathlib import Path

import numpy as np
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.ensemble import RandomForestClassifier
from sklearn.impute import SimpleImputer
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline

import gear_dynamics as gd


class Indicators(TransformerMixin, BaseEstimator):
    """Turns recordings (paths, arrays, mappings) into rows of indicators.

    Parameters
    ----------
    machine : path, mapping or gd.Machine
        Its `span: record` makes one row of each recording.
    """

    def __init__(self, machine):
        self.machine = machine

    def fit(self, recordings, y=None):
        """Remember the indicators of the first recording, so that all rows have the same."""
        first = gd.analyse(recordings[0], self.machine)
        columns = first.select_dtypes('number').columns
        self.columns_ = [name for name in columns if '/' in name]
        return self

    def transform(self, recordings):
        """Return the median of each indicator over the spans, shape (recordings, indicators)."""
        tables = (gd.analyse(each, self.machine)[self.columns_] for each in recordings)
        return np.array([table.median() for table in tables])

    def get_feature_names_out(self, input_features=None):
        """Return the names of the indicators."""
        return np.array(self.columns_)


def main(machine, healthy, faulty):
    """Print how well a forest tells faulty recordings from healthy ones."""
    folders = sorted(Path(healthy).iterdir()), sorted(Path(faulty).iterdir())
    recordings = [str(path) for folder in folders for path in folder]
    labels = np.repeat([0, 1], [len(folder) for folder in folders])
    features = Indicators(machine).fit(recordings).transform(recordings)
    forest = make_pipeline(SimpleImputer(keep_empty_features=True), RandomForestClassifier())
    print(cross_val_score(forest, features, labels, cv=3))


if __name__ == '__main__':
    main(*sys.argv[1:])
