"""The index at the end of an MCAP file."""

from __future__ import annotations

import zlib
from collections.abc import Sequence

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    McapRecord,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC


class McapIndex:
    """Collects the content of the summary section, and builds it.

    Attributes
    ----------
    schemas : dict of (str, str, bytes) to Schema
        By name, encoding and definition.
    channels : list of Channel
    metadata : list of MetadataIndex
    counts : dict of int to int
        Messages of each channel.
    start, end : int
        First and last log time [ns]; 0 without messages.
    """

    def __init__(self) -> None:
        self.schemas: dict[tuple[str, str, bytes], Schema] = {}
        self.channels: list[Channel] = []
        self.metadata: list[MetadataIndex] = []
        self.counts: dict[int, int] = {}
        self.start = self.end = 0
        self._chunks: list[ChunkIndex] = []

    def add_chunk(self, chunk: ChunkIndex, counts: dict[int, int]) -> None:
        """Add a chunk that was written, and its number of messages by channel."""
        for channel, count in counts.items():
            self.counts[channel] = self.counts.get(channel, 0) + count
        start = chunk.message_start_time
        self.start = min(self.start, start) if self._chunks else start
        self.end = max(self.end, chunk.message_end_time)
        self._chunks.append(chunk)

    def build(self, offset: int, last: MetadataIndex) -> bytes:
        """Return the end of a file: all records behind the data section, and the magic.

        Parameters
        ----------
        offset : int
            Where the data section ends.
        last : MetadataIndex
            Place of the metadata record that ends it.
        """
        metadata = [*self.metadata, last]
        end = RecordBuilder()
        DataEnd(0).write(end)
        data_end = end.end()
        summary_start = offset + len(data_end)
        builder = RecordBuilder()
        groups: list[tuple[Opcode, Sequence[McapRecord]]] = [
            (Opcode.SCHEMA, list(self.schemas.values())),
            (Opcode.CHANNEL, self.channels),
            (Opcode.STATISTICS, [self._statistics(len(metadata))]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.METADATA_INDEX, metadata),
        ]
        offsets = []
        for opcode, records in groups:
            start = builder.count
            for record in records:
                record.write(builder)
            if records:
                length = builder.count - start
                offsets.append(SummaryOffset(opcode, summary_start + start, length))
        offsets_start = summary_start + builder.count
        for record in offsets:
            record.write(builder)
        summary = builder.end()
        Footer(summary_start, offsets_start, 0).write(builder)
        footer = builder.end()
        # The CRC covers the footer up to itself.
        crc = zlib.crc32(footer[:-4], zlib.crc32(summary))
        Footer(summary_start, offsets_start, crc).write(builder)
        return data_end + summary + builder.end() + MCAP0_MAGIC

    def _statistics(self, metadata: int) -> Statistics:
        return Statistics(
            attachment_count=0,
            channel_count=len(self.channels),
            channel_message_counts=self.counts,
            chunk_count=len(self._chunks),
            message_count=sum(self.counts.values()),
            message_end_time=self.end,
            message_start_time=self.start,
            metadata_count=metadata,
            schema_count=len(self.schemas),
        )
