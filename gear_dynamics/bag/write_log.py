"""A simulated run as an MCAP log: `gd.write_log`."""

from __future__ import annotations

import dataclasses
import math
import os
import time
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from gear_dynamics.bag.bag_writer import BagWriter
from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.chunk_builder import COMPRESSIONS
from gear_dynamics.bag.metadata import LoggedTopic, OfferedQos, published_topic
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.run import Run
from gear_dynamics.versions import versions
from gear_dynamics.wire import topics
from gear_dynamics.wire.labels import label_bytes
from gear_dynamics.wire.messages import message_class, serialize
from gear_dynamics.wire.tables import columns_as_float32, encode_table

SECOND = 1_000_000_000
"""Nanoseconds in a second."""

LATEST = 1 << 31
"""Seconds since 1970 that a stamp can hold."""


def write_log(
    run: Run, folder: str | os.PathLike[str], start: float | None = None, compression: str = 'zstd'
) -> Path:
    """Write a run as the analyzer would log its stream: configuration, labels, samples and events.

    `gd.read_log`, `replay`, `gear-dynamics log` and every reader of ROS 2 bags take it.

    Parameters
    ----------
    run : Run
        As `gd.simulate` returns it.
    folder : path
        Bag folder; it is made and must not exist.
    start : float, optional
        Time of the first sample [s since 1970], now by default. With a fixed time the same run
        gives the same bytes.
    compression : str
        'none', 'lz4' or 'zstd'.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    LogError
        If the folder exists, or an argument cannot be used.
    OSError
        If the log cannot be written.
    """
    folder = Path(folder)
    if not isinstance(run, Run):
        raise LogError(f'run is a {type(run).__name__}: it must be what gd.simulate returns')
    if not len(run):
        raise LogError('run has no samples: there is nothing to log')
    if compression not in COMPRESSIONS:
        allowed = ', '.join(COMPRESSIONS)
        raise LogError(f'compression is {compression!r}: it must be one of {allowed}')
    seconds = time.time() if start is None else float(start)
    if not 0 <= seconds + len(run) / run.settings.sample_rate < LATEST:
        raise LogError(f'start is {start!r}: it must be from 0 to {LATEST} s since 1970')
    settings = _sim_settings(run)
    try:
        bag = BagWriter(folder, compression)
    except FileExistsError:
        raise LogError(f'{folder} exists: choose another folder') from None
    origin = round(seconds * SECOND)
    text = configuration_text(run.pair, settings)
    about = {'configuration': text, 'versions': yaml.safe_dump(versions(), sort_keys=False)}
    bag.configure(about, origin)
    message = serialize(message_class(topics.TEXT_TYPE)(text))
    bag.write(_logged(topics.CONFIGURATION), message, origin, origin)
    _write_blocks(bag, run, settings, origin)
    bag.finish()
    return folder


def _write_blocks(bag: BagWriter, run: Run, settings: SimSettings, origin: int) -> None:
    samples_topic, events_topic = _logged(topics.SAMPLES), _logged(topics.EVENTS_TOPIC)
    begins = np.arange(0, len(run), settings.block_size)
    # Events belong to the block that they are in; the first and the last take what is beside.
    labels = [label.values() for label in run.labels]
    told = -1
    bounds = np.searchsorted(run.events['t'], run.samples['t'][begins[1:]]).tolist()
    for begin, first, last in zip(
        begins.tolist(), [0, *bounds], [*bounds, len(run.events)], strict=True
    ):
        samples = run.samples[begin : begin + settings.block_size]
        events = run.events[first:last].copy()
        events['t'] -= samples['t'][0]
        rows = columns_as_float32(samples, samples['t'][0])
        stamp = origin + round(begin / settings.sample_rate * SECOND)
        arrival = origin + round((begin + len(samples)) / settings.sample_rate * SECOND)
        second = int(begin / settings.sample_rate)
        if second > told:
            told = second
            message = label_bytes(labels, stamp, topics.LABEL.name.rsplit('/', 1)[0])
            bag.write(_logged(topics.LABEL), message, stamp, stamp)
        for topic, table in ((samples_topic, rows), (events_topic, events)):
            bag.write(topic, encode_table(table, stamp, topics.FRAME), arrival, stamp)


def _sim_settings(run: Run) -> SimSettings:
    """Return the settings with which a sim would stream the run."""
    rate = run.settings.sample_rate
    monitor_rate = rate / math.ceil(rate / SimSettings.monitor_rate)
    values: dict[str, Any] = {**run.settings.to_mapping(), 'monitor_rate': monitor_rate}
    return SimSettings(**values)


def _logged(topic: topics.Topic) -> LoggedTopic:
    qos = OfferedQos(**dataclasses.asdict(topic.qos))
    return published_topic(f'/{topic.name}', topic.type_name, qos)
