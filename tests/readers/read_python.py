"""Reads a log with the Python reader and compares every sample with a CSV export of the same recording.

Usage: read_python.py LOG.mcap EXPECTED.csv
Also checks what `mcap doctor` looks for: magic, checksums, schemas, index, statistics, times in order.
"""

import csv
import sys

from mcap.reader import NonSeekingReader, SeekingReader
from mcap.records import AttachmentIndex, Chunk, DataEnd, Footer, MetadataIndex, Statistics
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory


def samples(reader):
    for schema, channel, message, decoded in reader.iter_decoded_messages(
        topics=["/socam/sample"], log_time_order=False
    ):
        assert schema.name == "socam.Sample" and schema.encoding == "protobuf"
        yield message, decoded


def compare(reader, expected):
    with open(expected, newline="") as file:
        rows = csv.DictReader(file)
        count = 0
        latest = 0
        for (message, sample), row in zip(samples(reader), rows, strict=True):
            assert message.log_time >= latest, "log times run back"
            latest = message.log_time
            time_s = sample.t_s if sample.HasField("t_s") else sample.device_time_ns / 1e9
            assert time_s == float(row.pop("t_s")), (count, time_s)
            for name, cell in row.items():
                value = getattr(sample, name) if sample.HasField(name) else None
                assert value == (float(cell) if cell else None), (count, name, value, cell)
            count += 1
        return count


def doctor(path):
    """What `mcap doctor` complains about, checked on the raw records."""
    with open(path, "rb") as file:
        reader = SeekingReader(file, validate_crcs=True)
        header = reader.get_header()
        assert header.profile == "socam" and header.library.startswith("socam"), header
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.schemas and all(s.data and s.id for s in summary.schemas.values())
        assert all(c.schema_id in summary.schemas for c in summary.channels.values())
        assert len(summary.chunk_indexes) == summary.statistics.chunk_count
        assert len(summary.attachment_indexes) == summary.statistics.attachment_count
        assert len(summary.metadata_indexes) == summary.statistics.metadata_count
        assert all(index.message_index_offsets for index in summary.chunk_indexes)
        for attachment in reader.iter_attachments():
            assert attachment.name
        metadata = [record.name for record in reader.iter_metadata()]
        assert "socam" in metadata and "socam.summary" in metadata, metadata
        latest = 0
        count = 0
        for _, _, message in reader.iter_messages(log_time_order=False):
            assert message.log_time >= latest, "log times run back"
            latest = message.log_time
            count += 1
        assert count == summary.statistics.message_count
        assert latest == summary.statistics.message_end_time
    with open(path, "rb") as file:
        kinds = [type(record) for record in StreamReader(file, emit_chunks=True, validate_crcs=True).records]
    assert kinds.count(Chunk) > 0 and kinds[-1] is Footer and DataEnd in kinds
    assert {Statistics, MetadataIndex} <= set(kinds)
    return kinds.count(AttachmentIndex)


def main():
    path, expected = sys.argv[1:]
    doctor(path)
    counts = []
    for kind in (SeekingReader, NonSeekingReader):
        with open(path, "rb") as file:
            reader = kind(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            counts.append(compare(reader, expected))
    assert counts[0] == counts[1]
    print(f"{counts[0]} samples equal")


main()
