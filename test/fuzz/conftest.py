"""How often: a few examples in the tests, FUZZ_EXAMPLES of each kind in `make fuzz`."""

import os
import resource
import sys

import pytest

hypothesis = pytest.importorskip('hypothesis')

LONG = os.environ.get('FUZZ_EXAMPLES')
MEMORY = 1 << 30
"""How much more memory than at its beginning a fuzz test may take [bytes]."""

hypothesis.settings.register_profile(
    'short',
    max_examples=25,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(hypothesis.HealthCheck),
)
hypothesis.settings.register_profile(
    'long',
    parent=hypothesis.settings.get_profile('short'),
    max_examples=int(LONG or 1),
    derandomize=False,
    deadline=5000,  # ms for one input: nothing may hang
    print_blob=True,
)
hypothesis.settings.load_profile('long' if LONG else 'short')


def peak():
    """Return the most memory that this process has had [bytes]."""
    unit = 1 if sys.platform == 'darwin' else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


@pytest.fixture(autouse=True)
def bounded_memory():
    """Refuse a test that takes much memory, whatever it was given."""
    before = peak()
    yield
    assert peak() - before < MEMORY
