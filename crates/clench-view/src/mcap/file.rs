//! MCAP files (<https://mcap.dev/spec>): messages in uncompressed chunks, followed by statistics and an index of the
//! chunks.

use super::record::{Kind, Record};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::mem::take;

/// The first and last bytes of a file.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// The size at which a chunk is written, bytes.
const CHUNK: usize = 1 << 20;
/// The compression of chunks: none.
const COMPRESSION: &str = "";

/// Encodes an entry of a map from channels to numbers.
fn of_channel(id: u16, number: u64) -> Vec<u8> {
    [&id.to_le_bytes()[..], &number.to_le_bytes()].concat()
}

/// Extends the interval of times, which need not be ordered.
fn widen(times: &mut Option<[u64; 2]>, time: u64) {
    let [first, last] = times.get_or_insert([time; 2]);
    (*first, *last) = (time.min(*first), time.max(*last));
}

/// A stream of messages in JSON.
pub(crate) struct Stream {
    pub topic: &'static str,
    pub schema_name: &'static str,
    /// A JSON schema.
    pub schema: Vec<u8>,
}

/// A file under construction. Dropping it finishes it as far as the output allows.
pub(crate) struct McapFile<W: Write> {
    to: W,
    position: u64,
    /// The checksum of the part of the file that is being written.
    checksum: crc32fast::Hasher,
    /// True if nothing may follow: the file is complete, or a write to the output failed.
    ended: bool,
    /// Records that are repeated at the end.
    schemas: Vec<u8>,
    channels: Vec<u8>,
    schema_count: u16,
    /// The message count of each channel.
    counts: Vec<u64>,
    times: Option<[u64; 2]>,
    chunk: Chunk,
    chunk_indexes: Vec<u8>,
    chunk_count: u32,
}

/// Pending messages of the next chunk.
#[derive(Default)]
struct Chunk {
    records: Vec<u8>,
    times: Option<[u64; 2]>,
    /// The times and offsets of the messages of each channel.
    indexes: BTreeMap<u16, Vec<u8>>,
}

impl<W: Write> McapFile<W> {
    /// Creates a file of these streams; the index of a stream in the list is its channel number.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub(crate) fn new(to: W, library: &str, streams: &[Stream]) -> io::Result<Self> {
        const PROFILE: &str = "";
        const NO_METADATA: &[u8] = &[];
        let (mut schemas, mut channels) = (Vec::new(), Vec::new());
        let mut stored: Vec<(&str, &[u8])> = Vec::new();
        for (channel, stream) in (0..).zip(streams) {
            let schema = (stream.schema_name, &stream.schema[..]);
            // Schema numbers start at 1: 0 means no schema.
            let index = stored.iter().position(|&other| other == schema);
            let index = index.unwrap_or_else(|| {
                let record = Record::new(Kind::Schema).u16(stored.len() as u16 + 1);
                let record = record.text(schema.0).text("jsonschema").bytes(schema.1);
                schemas.extend(record.end());
                stored.push(schema);
                stored.len() - 1
            });
            let record = Record::new(Kind::Channel)
                .u16(channel)
                .u16(index as u16 + 1);
            let record = record.text(stream.topic).text("json").bytes(NO_METADATA);
            channels.extend(record.end());
        }
        let chunk = Chunk {
            records: [&schemas[..], &channels].concat(),
            ..Chunk::default()
        };
        let mut file = McapFile {
            to,
            position: 0,
            checksum: crc32fast::Hasher::new(),
            ended: false,
            schemas,
            channels,
            schema_count: stored.len() as u16,
            counts: vec![0; streams.len()],
            times: None,
            chunk,
            chunk_indexes: Vec::new(),
            chunk_count: 0,
        };
        file.write_bytes(MAGIC)?;
        let header = Record::new(Kind::Header).text(PROFILE).text(library);
        file.write_bytes(&header.end())?;
        Ok(file)
    }

    fn write_bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.ended {
            return Err(io::Error::other("nothing can follow in this file"));
        }
        self.position += bytes.len() as u64;
        self.checksum.update(bytes);
        let written = self.to.write_all(bytes);
        self.ended |= written.is_err();
        written
    }

    /// Adds a message; `time` is in nanoseconds.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub(crate) fn message(
        &mut self,
        channel: u16,
        sequence: u32,
        time: u64,
        data: &[u8],
    ) -> io::Result<()> {
        let index = self.chunk.indexes.entry(channel).or_default();
        index.extend(time.to_le_bytes());
        index.extend((self.chunk.records.len() as u64).to_le_bytes());
        let record = Record::new(Kind::Message).u16(channel).u32(sequence);
        let record = record.times([time; 2]).raw(data);
        self.chunk.records.extend(record.end());
        widen(&mut self.chunk.times, time);
        widen(&mut self.times, time);
        self.counts[usize::from(channel)] += 1;
        match self.chunk.records.len() < CHUNK {
            true => Ok(()),
            false => self.write_chunk(),
        }
    }

    /// Writes the pending messages and their index.
    fn write_chunk(&mut self) -> io::Result<()> {
        let Chunk {
            records,
            times,
            indexes,
        } = take(&mut self.chunk);
        if records.is_empty() {
            return Ok(());
        }
        let times = times.unwrap_or_default();
        let (start, length) = (self.position, records.len() as u64);
        let chunk = Record::new(Kind::Chunk).times(times).u64(length);
        let chunk = chunk.u32(crc32fast::hash(&records)).text(COMPRESSION);
        self.write_bytes(&chunk.u64(length).raw(&records).end())?;
        let end = self.position;
        let mut offsets = Vec::new();
        for (channel, index) in indexes {
            offsets.extend(of_channel(channel, self.position));
            let record = Record::new(Kind::MessageIndex).u16(channel);
            self.write_bytes(&record.bytes(&index).end())?;
        }
        let index = Record::new(Kind::ChunkIndex).times(times);
        let index = index.u64(start).u64(end - start).bytes(&offsets);
        let index = index.u64(self.position - end).text(COMPRESSION);
        let index = index.u64(length).u64(length).end();
        self.chunk_indexes.extend(index);
        self.chunk_count += 1;
        Ok(())
    }

    /// Writes all pending messages and flushes the output, so that they can be read.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub(crate) fn flush(&mut self) -> io::Result<()> {
        self.write_chunk()?;
        self.to.flush()
    }

    fn statistics(&self) -> Vec<u8> {
        const ATTACHMENTS: u32 = 0;
        const METADATA: u32 = 0;
        let counts = (0..).zip(&self.counts).filter(|(_, count)| **count > 0);
        let counts = counts.flat_map(|(channel, &count)| of_channel(channel, count));
        let record = Record::new(Kind::Statistics)
            .u64(self.counts.iter().sum())
            .u16(self.schema_count)
            .u32(self.counts.len() as u32);
        let record = record.u32(ATTACHMENTS).u32(METADATA).u32(self.chunk_count);
        let record = record.times(self.times.unwrap_or_default());
        record.bytes(&Vec::from_iter(counts)).end()
    }

    /// Writes the pending messages, the statistics and the index. No message can follow.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub(crate) fn finish(&mut self) -> io::Result<()> {
        if self.ended {
            return Ok(());
        }
        self.write_chunk()?;
        let checksum = take(&mut self.checksum).finalize();
        self.write_bytes(&Record::new(Kind::DataEnd).u32(checksum).end())?;
        // The second part of the file, with its own checksum, is the index of the first.
        self.checksum.reset();
        let start = self.position;
        let groups = [
            (Kind::Schema, take(&mut self.schemas)),
            (Kind::Channel, take(&mut self.channels)),
            (Kind::Statistics, self.statistics()),
            (Kind::ChunkIndex, take(&mut self.chunk_indexes)),
        ];
        let mut offsets = Vec::new();
        for (kind, records) in groups {
            let offset = Record::new(Kind::SummaryOffset).raw(&[kind as u8]);
            let offset = offset.u64(self.position).u64(records.len() as u64);
            offsets.extend(offset.end());
            self.write_bytes(&records)?;
        }
        let offsets_start = self.position;
        self.write_bytes(&offsets)?;
        let footer = Record::new(Kind::Footer).u64(start).u64(offsets_start);
        let mut footer = footer.u32(0).end();
        // The checksum covers all bytes before it.
        let checksum_at = footer.len() - size_of::<u32>();
        self.checksum.update(&footer[..checksum_at]);
        let checksum = take(&mut self.checksum).finalize();
        footer[checksum_at..].copy_from_slice(&checksum.to_le_bytes());
        self.write_bytes(&footer)?;
        self.write_bytes(MAGIC)?;
        self.ended = true;
        self.to.flush()
    }
}

impl<W: Write> Drop for McapFile<W> {
    fn drop(&mut self) {
        // Nothing can receive an error here.
        let _ = self.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::mcap::records::Record as Found;
    use ::mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
    use ::mcap::{Summary, parse_record};

    fn streams() -> Vec<Stream> {
        let stream = |topic, schema_name, schema: &str| Stream {
            topic,
            schema_name,
            schema: schema.as_bytes().to_vec(),
        };
        vec![
            stream("/a", "one", "{}"),
            stream("/b", "two", "{\"type\": \"object\"}"),
            stream("/c", "one", "{}"),
        ]
    }

    /// Writes a message of `size` bytes on each of the first two channels at each of these times.
    fn write(times: &[u64], size: usize) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut file = McapFile::new(&mut bytes, "test", &streams()).unwrap();
        for (sequence, &time) in (0..).zip(times) {
            for channel in 0..2 {
                let message = vec![channel as u8; size];
                file.message(channel, sequence, time, &message).unwrap();
            }
        }
        file.finish().unwrap();
        assert!(file.message(0, 0, 0, &vec![0; CHUNK]).is_err());
        drop(file);
        bytes
    }

    /// Reads all records outside of chunks and validates their checksums.
    fn records(bytes: &[u8]) -> Vec<Found<'static>> {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_check_finishes_after_end_magic(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true);
        let (mut reader, mut rest) = (LinearReader::new_with_options(options), bytes);
        let mut records = Vec::new();
        while let Some(event) = reader.next_event() {
            match event.expect("it is MCAP") {
                LinearReadEvent::ReadRequest(count) => {
                    let read = io::Read::read(&mut rest, reader.insert(count)).unwrap();
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => {
                    records.push(parse_record(opcode, data).unwrap().into_owned());
                }
            }
        }
        records
    }

    #[test]
    fn others_find_every_message_by_its_index() {
        let times = [3, 1, 2, 9, 5];
        for (size, chunks) in [(10, 1), (CHUNK / 3, 4), (CHUNK, 10)] {
            let bytes = write(&times, size);
            let summary = Summary::read(&bytes).unwrap().expect("it has a summary");
            assert_eq!((summary.schemas.len(), summary.channels.len()), (2, 3));
            assert_eq!(summary.channels[&2].topic, "/c");
            let schema = summary.channels[&2].schema.as_ref().unwrap();
            assert_eq!((&schema.name[..], &schema.data[..]), ("one", &b"{}"[..]));
            let stats = summary.stats.as_ref().unwrap();
            assert_eq!((stats.message_count, stats.chunk_count), (10, chunks));
            assert_eq!((stats.schema_count, stats.channel_count), (2, 3));
            assert_eq!((stats.message_start_time, stats.message_end_time), (1, 9));
            assert_eq!(
                stats.channel_message_counts,
                BTreeMap::from([(0, 5), (1, 5)])
            );
            let mut found = Vec::new();
            for index in &summary.chunk_indexes {
                for (channel, entries) in summary.read_message_indexes(&bytes, index).unwrap() {
                    for entry in entries {
                        let message = summary.seek_message(&bytes, index, &entry).unwrap();
                        assert_eq!(message.channel, channel);
                        assert_eq!(message.log_time, entry.log_time);
                        assert_eq!(message.data, vec![channel.id as u8; size]);
                        let within = index.message_start_time..=index.message_end_time;
                        assert!(within.contains(&entry.log_time));
                        found.push((message.sequence, channel.id, entry.log_time));
                    }
                }
            }
            found.sort();
            let written = (0..)
                .zip(times)
                .flat_map(|(k, time)| [(k, 0, time), (k, 1, time)]);
            assert_eq!(found, Vec::from_iter(written));
        }
    }

    #[test]
    fn checksums_and_offsets_are_right() {
        for times in [&[][..], &[7], &[1, 2, 3]] {
            let bytes = write(times, CHUNK / 2);
            let mut at_end = false;
            let mut offsets = Vec::new();
            for record in records(&bytes) {
                match record {
                    Found::DataEnd(end) => {
                        at_end = true;
                        assert_ne!(end.data_section_crc, 0);
                    }
                    Found::Chunk { header, data } => {
                        assert!(!at_end);
                        assert_eq!(header.uncompressed_crc, crc32fast::hash(&data));
                    }
                    Found::SummaryOffset(offset) => offsets.push(offset),
                    Found::Footer(footer) => assert_ne!(footer.summary_crc, 0),
                    _ => {}
                }
            }
            assert_eq!(offsets.len(), 4);
            for offset in offsets {
                let group = &bytes[offset.group_start as usize..][..offset.group_length as usize];
                let mut rest = group;
                while let [kind, length @ ..] = rest {
                    assert_eq!(*kind, offset.group_opcode);
                    let (length, content) = length.split_first_chunk::<8>().unwrap();
                    rest = &content[u64::from_le_bytes(*length) as usize..];
                }
            }
        }
    }

    #[test]
    fn a_dropped_file_is_finished() {
        let mut bytes = Vec::new();
        let mut file = McapFile::new(&mut bytes, "test", &streams()).unwrap();
        file.message(1, 0, 5, b"{}").unwrap();
        drop(file);
        let summary = Summary::read(&bytes).unwrap().expect("it has a summary");
        assert_eq!(summary.stats.unwrap().message_count, 1);
    }
}
