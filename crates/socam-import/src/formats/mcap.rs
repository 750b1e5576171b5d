//! MCAP logs of other programs: each topic is a group, each number in its messages a signal.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use socam_recording::{Warning, parse_log_record};

use super::messages::{self, Decoder, Schema, Topic};
use crate::error::{ImportError, Result};
use crate::source::{Source, Wanted};

/// Longest record that is read, bytes.
const LONGEST_RECORD: usize = 1 << 28;

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    let mut log = Log { wanted, schemas: BTreeMap::new(), topics: BTreeMap::new(), notes: Vec::new() };
    let read = log.read(BufReader::with_capacity(1 << 18, file));
    let messages: usize = log.topics.values().map(|topic| topic.rows).sum();
    match read {
        Ok(()) => {}
        Err(problem) if messages > 0 => {
            log.notes.push(Warning::Incomplete {
                what: format!("messages after {messages} are missing ({problem})"),
            });
        }
        Err(problem) => {
            return Err(ImportError::damaged(path, problem));
        }
    }
    Ok(messages::finish(log.topics.into_values(), log.notes))
}

struct Log<'w> {
    wanted: &'w Wanted,
    schemas: BTreeMap<u16, Schema>,
    topics: BTreeMap<u16, Topic>,
    notes: Vec<Warning>,
}

impl Log<'_> {
    fn read(&mut self, mut file: impl Read) -> Result<(), String> {
        let options = LinearReaderOptions::default()
            .with_prevalidate_chunk_crcs(true)
            .with_skip_end_magic(true)
            .with_record_length_limit(LONGEST_RECORD);
        let mut reader = LinearReader::new_with_options(options);
        while let Some(event) = reader.next_event() {
            match event.map_err(|error| error.to_string())? {
                // The reader asks for as many bytes as a damaged length says.
                LinearReadEvent::ReadRequest(need) if need > LONGEST_RECORD => {
                    return Err(format!("a record of {need} bytes is announced"));
                }
                LinearReadEvent::ReadRequest(need) => {
                    let read = file.read(reader.insert(need)).map_err(|error| error.to_string())?;
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => {
                    let record = parse_log_record(opcode, data).ok_or("a record is damaged")?;
                    self.record(record);
                }
            }
        }
        Ok(())
    }

    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Schema { header, data } => {
                let schema = Schema { name: header.name, encoding: header.encoding, data: data.into_owned() };
                self.schemas.insert(header.id, schema);
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id);
                let decoder = Decoder::of(&channel.message_encoding, schema).unwrap_or_else(|why| {
                    self.notes.push(Warning::Note(format!("topic `{}` is left aside: {why}", channel.topic)));
                    Decoder::None
                });
                let topic = Topic::new(channel.topic, decoder, schema);
                self.topics.entry(channel.id).or_insert(topic);
            }
            Record::Message { header, data } => {
                if let Some(topic) = self.topics.get_mut(&header.channel_id)
                    && topic.rows < self.wanted.most_rows
                {
                    topic.message(header.log_time, header.publish_time, &data, self.wanted);
                }
            }
            _ => {}
        }
    }
}
