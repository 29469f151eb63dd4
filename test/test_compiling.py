import ctypes
import os
import signal
import time

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
