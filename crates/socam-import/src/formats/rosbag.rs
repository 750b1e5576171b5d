//! Bags of ROS 2 in SQLite (`.db3`): each topic is a group, its messages in CDR by the definitions in the bag, or by those of [`known`] types.

mod known;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use rusqlite::{Connection, OpenFlags, OptionalExtension};
use socam_recording::Warning;

use super::messages::{self, Decoder, Schema, Topic};
use crate::error::{ImportError, Result};
use crate::source::{Source, Wanted};

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let damaged = |error: rusqlite::Error| ImportError::damaged(path, error);
    let bag = open(path)?;
    let has_tables =
        is_table(&bag, "topics").map_err(damaged)? && is_table(&bag, "messages").map_err(damaged)?;
    if !has_tables && is_cut(path).unwrap_or(false) {
        return Err(ImportError::damaged(path, "its header names more pages than there are"));
    }
    if !has_tables {
        let problem = "is an SQLite database and no bag of ROS 2: it has no tables `topics` and `messages`; export its table as .csv";
        return Err(ImportError::file(path, problem));
    }
    let mut notes = Vec::new();
    let mut topics = topics(&bag, &mut notes).map_err(damaged)?;
    let journal = path.with_extension("db3-wal");
    if journal.metadata().is_ok_and(|journal| journal.len() > 0) {
        let what = format!(
            "what `{}` holds is missing; `ros2 bag reindex` or `sqlite3` puts it into the bag",
            journal.display()
        );
        notes.push(Warning::Incomplete { what });
    }
    if let Err(error) = messages(&bag, &mut topics, wanted) {
        let messages: usize = topics.values().map(|topic| topic.rows).sum();
        if messages == 0 {
            return Err(damaged(error));
        }
        notes.push(Warning::Incomplete { what: format!("messages after {messages} are missing ({error})") });
    }
    Ok(messages::finish(topics.into_values(), notes))
}

/// Opens a bag without a change to its folder.
fn open(path: &Path) -> Result<Connection> {
    let name =
        path.to_str().ok_or_else(|| ImportError::file(path, "has a name that is not UTF-8; rename it"))?;
    let name = name.replace('%', "%25").replace('?', "%3f").replace('#', "%23");
    let flags =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let opened = Connection::open_with_flags(format!("file:{name}?immutable=1"), flags).and_then(|bag| {
        // Without this a bag that was cut off is refused as a whole.
        bag.pragma_update(None, "writable_schema", true)?;
        bag.pragma_update(None, "trusted_schema", false)?;
        Ok(bag)
    });
    opened.map_err(|error| ImportError::damaged(path, error))
}

/// Whether a database is shorter than its header says: <https://www.sqlite.org/fileformat.html>, 1.3.
fn is_cut(path: &Path) -> std::io::Result<bool> {
    let mut header = [0; 32];
    let mut file = File::open(path)?;
    file.read_exact(&mut header)?;
    let page_size = match u64::from(u16::from_be_bytes([header[16], header[17]])) {
        1 => 1 << 16,
        size => size,
    };
    let pages = u64::from(u32::from_be_bytes([header[28], header[29], header[30], header[31]]));
    Ok(file.metadata()?.len() < page_size * pages)
}

/// Whether there is a table of this name; views and virtual tables compute what they hold, without end if they like.
fn is_table(bag: &Connection, name: &str) -> rusqlite::Result<bool> {
    let sql = "SELECT sql FROM sqlite_schema WHERE name = ?1 AND type = 'table'";
    let made: Option<String> = bag.query_row(sql, [name], |row| row.get(0)).optional()?;
    Ok(made.is_some_and(|made| made.to_ascii_uppercase().starts_with("CREATE TABLE")))
}

/// Topics by their number, with decoders of their messages.
fn topics(bag: &Connection, notes: &mut Vec<Warning>) -> rusqlite::Result<BTreeMap<i64, Topic>> {
    let has_definitions = is_table(bag, "message_definitions")?;
    let mut statement = bag.prepare("SELECT id, name, type, serialization_format FROM topics NOT INDEXED")?;
    let mut rows = statement.query([])?;
    let mut topics = BTreeMap::new();
    while let Some(row) = rows.next()? {
        let (id, name): (i64, String) = (row.get(0)?, row.get(1)?);
        let (kind, encoding): (String, String) = (row.get(2)?, row.get(3)?);
        let stated = if has_definitions { definition(bag, &kind)? } else { None };
        let schema = stated.or_else(|| known::definition(&kind));
        let decoder = match &schema {
            Some(_) => Decoder::of(&encoding, schema.as_ref()),
            None => Err(format!(
                "the bag has no definition of `{kind}`, as those of ROS 2 before Iron; convert it with `mcap convert` where ROS knows the type"
            )),
        };
        let decoder = decoder.unwrap_or_else(|why| {
            notes.push(Warning::Note(format!("topic `{name}` is left aside: {why}")));
            Decoder::None
        });
        topics.entry(id).or_insert(Topic::new(name, decoder, schema.as_ref()));
    }
    Ok(topics)
}

/// The definition of a type, if the bag has it.
fn definition(bag: &Connection, kind: &str) -> rusqlite::Result<Option<Schema>> {
    let sql = "SELECT encoding, encoded_message_definition FROM message_definitions NOT INDEXED WHERE topic_type = ?1";
    let found = bag.query_row(sql, [kind], |row| {
        let (encoding, data): (String, String) = (row.get(0)?, row.get(1)?);
        Ok(Schema { name: kind.to_owned(), encoding, data: data.into_bytes() })
    });
    Ok(found.optional()?.filter(|schema| !schema.data.is_empty()))
}

fn messages(bag: &Connection, topics: &mut BTreeMap<i64, Topic>, wanted: &Wanted) -> rusqlite::Result<()> {
    let mut statement = bag.prepare("SELECT topic_id, timestamp, data FROM messages NOT INDEXED")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let (topic, time_ns): (i64, i64) = (row.get(0)?, row.get(1)?);
        let Some(topic) = topics.get_mut(&topic).filter(|topic| topic.rows < wanted.most_rows) else {
            continue;
        };
        let time_ns = u64::try_from(time_ns).unwrap_or(0);
        if let Ok(data) = row.get_ref(2)?.as_blob() {
            topic.message(time_ns, time_ns, data, wanted);
        }
    }
    Ok(())
}
