import ctypes
import gc
import importlib.util
import os
import signal
import sys
import threading
import time

import numba
import pytest

from gear_dynamics import compiling


def test_a_signal_within_a_callback_of_the_compiler_ends_it_too(capfd):
    @ctypes.CFUNCTYPE(None)
    def callback():
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.1)

    def compiler():
        callback()
        raise RuntimeError('no compiled object yet')

    def long_compiler():
        callback()
        time.sleep(10)
        pytest.fail('the compiler went on')

    with pytest.raises(compiling.Interrupted), compiling.interruptible():
        compiler()
    with pytest.raises(compiling.Interrupted), compiling.interruptible():
        long_compiler()
    with pytest.raises(compiling.Interrupted), compiling.interruptible():
        callback()
    assert capfd.readouterr().err == ''


def test_what_a_signal_left_half_made_is_not_reported_when_it_is_freed_later(capfd, monkeypatch):
    monkeypatch.setattr(sys, 'unraisablehook', sys.__unraisablehook__)

    class HalfMade:
        def __init__(self):
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(10)
            self.handle = 1

        def __del__(self):
            del self.handle

    # The traceback keeps the object until the block is left.
    with pytest.raises(compiling.Interrupted) as held, compiling.interruptible():
        HalfMade()
    del held
    gc.collect()
    assert capfd.readouterr().err == ''


def cached_function(path):
    """Return a function of a module as a program that starts anew would: not yet in memory."""
    spec = importlib.util.spec_from_file_location('numbers', path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.successor


def test_only_what_is_not_in_the_cache_is_announced(tmp_path, monkeypatch):
    path = tmp_path / 'numbers.py'
    path.write_text(
        'import numba\n\n@numba.njit(cache=True)\ndef successor(x):\n    return x + 1\n'
    )
    monkeypatch.setattr(compiling, 'LONG', 0.0)
    for hits in (0, 1):
        lines, said = [], threading.Event()

        def say(line, lines=lines, said=said):
            lines.append(line)
            said.set()

        function = cached_function(path)
        with compiling.announced('numbers', say):
            assert function(1) == 2
            # With the cache this must come to nothing, however long the program goes on.
            assert said.wait(0.5 if hits else 60) == (not hits)
        assert sum(function.stats.cache_hits.values()) == hits
        expected = 'compiling numbers for this machine; only a first start takes this long'
        assert lines == ([] if hits else [expected])


def test_compilation_that_ends_soon_is_not_announced(monkeypatch):
    monkeypatch.setattr(compiling, 'LONG', 600.0)
    lines = []
    with compiling.announced('numbers', lines.append):
        numba.njit(lambda x: x + 1)(1)
    assert lines == []
