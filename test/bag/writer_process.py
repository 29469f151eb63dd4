"""A writer under load, to be killed: writes blocks at full rate and says what it handed in.

Arguments: directory, compression, blocks a second, threads that compute in Python meanwhile. A
line with number and time of each block goes to standard output before the block is handed in.
"""

import itertools
import sys
import threading
import time
from pathlib import Path

import numpy as np

from gear_dynamics.bag.writer import LogWriter
from gear_dynamics.wire.tables import SAMPLES_FLOAT32, TABLE_TYPE, encode_table


def compute():
    """Hold Python's lock for as long as it lets a thread."""
    while True:
        sum(range(10_000))


def main():
    directory, compression, rate = Path(sys.argv[1]), sys.argv[2], float(sys.argv[3])
    rows = np.random.default_rng(1).normal(size=(512, 13)).astype(np.float32)
    rows = rows.view(SAMPLES_FLOAT32).reshape(-1)
    writer = LogWriter(directory, {}, compression=compression, free_floor=0.0)
    for _ in range(int(sys.argv[4])):
        threading.Thread(target=compute, daemon=True).start()
    start = time.monotonic()
    for number in itertools.count():
        time.sleep(max(start + number / rate - time.monotonic(), 0.0))
        data = encode_table(rows, number, 'line_of_action')
        print(number, time.monotonic(), flush=True)
        writer.write('/gear_pair/samples', TABLE_TYPE, data, time.time_ns(), number)


if __name__ == '__main__':
    main()
