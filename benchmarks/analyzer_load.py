"""What the analyzer costs: CPU share of the process, latency of its results, and the naive way.

    python benchmarks/analyzer_load.py [SECONDS]

Three parts, over SECONDS (60) of the default stream each:
1. the engine alone in this process: CPU seconds a second of stream, time a block takes;
2. the same spectra and averages the naive way: the whole window transformed at every block;
3. sim and analyzer as processes: CPU share of the analyzer, and the time from the arrival of the
   block that completes a result to the arrival of the result, at a third process (this one).
CPU seconds count whatever else runs; a busy machine makes them larger by its shared caches and
hyper-threads, and latency by waiting for a core: the load average is printed beside them.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.monitoring.monitor import Monitor, warm_up
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings, SimSettings
from gear_dynamics.signal.spectrum import amplitude_spectrum
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.simulator import Simulator
from gear_dynamics.wire.tables import columns_as_float32, decode_table

ROOT = Path(__file__).resolve().parents[1]
BLOCK = 512
RATE = 51200.0
RESULTS = ('spectrum', 'order_spectrum', 'envelope_spectrum', 'mesh_force', 'regime')

Stream = list[tuple[int, np.ndarray, np.ndarray]]


def stream(seconds: float) -> Stream:
    """Stamp, samples and events of the default pair, block by block."""
    simulator = Simulator(GearPair(), sample_rate=RATE, speed=104.72, load_torque=150.0)
    made = []
    for index in range(int(seconds * RATE) // BLOCK):
        start = index * BLOCK / RATE
        rows = columns_as_float32(simulator.advance(BLOCK), start)
        events = simulator.take_events()
        events['t'] -= start
        made.append((round(start * 1e9), rows, events))
    return made


def percentiles(seconds: list[float]) -> str:
    p50, p99, top = np.percentile(np.array(seconds) * 1e3, [50, 99, 100])
    return f'p50 {p50:.2f} ms, p99 {p99:.2f} ms, max {top:.1f} ms'


def engine(blocks: Stream) -> float:
    """Print and return the CPU seconds that the engine takes for a second of stream."""
    monitor = Monitor(AnalyzerSettings(), Thresholds.from_yaml(ROOT / 'config' / 'thresholds.yaml'))
    monitor.configure(Rig.from_text(configuration_text(GearPair(), SimSettings())))
    warm_up()
    taken = []
    begin = time.process_time()
    for stamp, rows, events in blocks:
        start = time.perf_counter()
        monitor.add_block(stamp, rows)
        monitor.add_events(stamp, events)
        taken.append(time.perf_counter() - start)
    cpu = (time.process_time() - begin) / (len(blocks) * BLOCK / RATE)
    print(f'engine: {cpu:.3f} CPU s per stream s; a block takes {percentiles(taken)}')
    return cpu


def naive(blocks: Stream) -> float:
    """Print and return the same for averaged spectra of the whole window at every block.

    Only the two spectra: that is less than what the engine does.
    """
    settings = AnalyzerSettings()
    length = settings.spectrum_length
    window = length + (settings.spectrum_averages - 1) * length // 2
    orders = round(settings.order_revolutions * 60 / 1000 * RATE)
    order_window = orders + (settings.spectrum_averages - 1) * orders // 2
    kept = np.zeros((order_window, len(CHANNELS)))
    begin = time.process_time()
    for _, rows, _ in blocks:
        kept = np.concatenate([kept[BLOCK:], np.column_stack([rows[name] for name in CHANNELS])])
        amplitude_spectrum(kept[-window:], RATE, length=length)
        amplitude_spectrum(kept, RATE, length=orders)
    cpu = (time.process_time() - begin) / (len(blocks) * BLOCK / RATE)
    print(f'naive: {cpu:.3f} CPU s per stream s for spectrum and order spectrum alone')
    return cpu


def cpu_seconds(process: subprocess.Popen) -> float:
    fields = Path(f'/proc/{process.pid}/stat').read_text().rsplit(')', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def memory(process: subprocess.Popen) -> float:
    """Return the resident memory [MB]."""
    pages = int(Path(f'/proc/{process.pid}/statm').read_text().split()[1])
    return pages * os.sysconf('SC_PAGE_SIZE') / 1e6


class Ear:
    """Notes when samples and results arrive.

    Attributes
    ----------
    ends : list of tuple
        Stamp of the end of each block [ns], and when it came [s].
    latencies : dict of list
        By result, the time since the block that completed it came [s].
    """

    def __init__(self) -> None:
        import rclpy
        from diagnostic_msgs.msg import DiagnosticArray
        from sensor_msgs.msg import PointCloud2

        rclpy.init(args=[])
        self.node = rclpy.create_node('ear')
        self.ends: list[tuple[int, float]] = []
        self.latencies: dict[str, list[float]] = {name: [] for name in RESULTS}
        subscribe = self.node.create_subscription
        subscribe(PointCloud2, 'gear_pair/samples', self.on_block, 1000, raw=True)
        subscribe(DiagnosticArray, 'gear_pair/condition', self.on_condition, 1000)

    def on_block(self, data: bytes) -> None:
        """Note when a block came."""
        now = time.monotonic()
        table = decode_table(data)
        self.ends.append((table.stamp_ns + round(len(table.rows) * 1e9 / RATE), now))
        del self.ends[:-2000]

    def on_condition(self, message: Any) -> None:
        """Note the delay of each result by the status that states its span."""
        now = time.monotonic()
        for status in message.status:
            subject = status.name.rpartition(': ')[2]
            if subject not in self.latencies:
                continue
            values = {each.key: each.value for each in status.values}
            end = float(values['duration']) * 1e9 + message.header.stamp.sec * 10**9
            end += message.header.stamp.nanosec
            completing = [came for last, came in self.ends if last >= end - 1e5]
            if completing:
                self.latencies[subject].append(now - completing[0])


def processes(seconds: float) -> None:
    """Print CPU share and latency of the analyzer as a process, logging included."""
    import rclpy

    ear = Ear()
    with tempfile.TemporaryDirectory() as folder:
        run = [sys.executable, '-m']
        settings = ['-p', f'log_directory:={folder}', '-p', 'log_free_floor:=1e6']
        sim = subprocess.Popen([*run, 'gear_dynamics.nodes.sim'])
        analyzer = subprocess.Popen([*run, 'gear_dynamics.nodes.analyzer', '--ros-args', *settings])
        try:
            listen(ear, lambda: bool(ear.latencies['spectrum']), 300)
            listen(ear, lambda: False, 5)
            for each in ear.latencies.values():
                each.clear()
            cpu, begin, before = cpu_seconds(analyzer), time.monotonic(), memory(analyzer)
            listen(ear, lambda: False, seconds)
            share = (cpu_seconds(analyzer) - cpu) / (time.monotonic() - begin)
            print(f'analyzer: {100 * share:.1f} % of one core, log included')
            print(f'memory: {before:.0f} MB, {memory(analyzer):.0f} MB {seconds:g} s later')
            for name, each in ear.latencies.items():
                if each:
                    print(f'{name}: {percentiles(each)} after its last block')
        finally:
            for process in (analyzer, sim):
                process.terminate()
                process.wait()
    rclpy.shutdown()


def listen(ear: Ear, done: Callable[[], bool], seconds: float) -> None:
    import rclpy

    end = time.monotonic() + seconds
    while time.monotonic() < end and not done():
        rclpy.spin_once(ear.node, timeout_sec=0.1)


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    print(f'load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores')
    blocks = stream(seconds)
    cheap = engine(blocks)
    costly = naive(blocks[:100])
    print(f'naive over engine: {costly / cheap:.0f}')
    processes(seconds)
    print(f'load average {os.getloadavg()[0]:.1f}')


if __name__ == '__main__':
    main()
