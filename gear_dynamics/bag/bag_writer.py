"""A bag folder that is written at once, without the limits of a live log."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from gear_dynamics.bag.folder import LogLimits
from gear_dynamics.bag.mcap_file import McapFile
from gear_dynamics.bag.metadata import FileSummary, LoggedTopic, write_metadata


class BagWriter:
    """Writes messages into the files of a new bag folder, split at the size of a live log.

    Parameters
    ----------
    folder : Path
        Made; must not exist.
    compression : str
        'none', 'lz4' or 'zstd', applied per chunk.
    profile : str
        Of the files; 'ros2' for what ROS 2 is to play.

    Raises
    ------
    FileExistsError
        If the folder exists.
    OSError
        If it cannot be made; so do all methods if the disk refuses.
    """

    def __init__(self, folder: Path, compression: str, profile: str = 'ros2') -> None:
        self._folder = folder
        self._compression = compression
        self._profile = profile
        self._files: list[FileSummary] = []
        self._configurations: list[dict[str, str]] = []
        self._file: McapFile | None = None
        self.messages = 0
        folder.mkdir(parents=True)

    def configure(self, configuration: Mapping[str, str], log_time: int) -> None:
        """Take a configuration that holds from `log_time` [ns] on; every file repeats all."""
        record = {**configuration, 'log_time': str(log_time)}
        if record not in self._configurations:
            self._configurations.append(record)

    def write(
        self, topic: LoggedTopic, data: bytes, log_time: int, publish_time: int, sequence: int = 0
    ) -> None:
        """Append a message; times in ns."""
        file = self._file or self._open()
        file.write(topic, data, log_time, publish_time, sequence)
        self.messages += 1
        if file.size >= LogLimits.split_size:
            self._finish_file(file)

    def finish(self) -> None:
        """Close the last file, and write metadata.yaml."""
        self._finish_file(self._file or self._open())
        write_metadata(self._folder, self._files)

    def _open(self) -> McapFile:
        name = f'{self._folder.name}_{len(self._files)}.mcap'
        self._file = file = McapFile(self._folder / name, self._compression, self._profile)
        for record in self._configurations:
            file.write_configuration(record, int(record['log_time']))
        return file

    def _finish_file(self, file: McapFile) -> None:
        self._files.append(file.finish())
        self._file = None
