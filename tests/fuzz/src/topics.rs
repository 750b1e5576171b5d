//! Both ends of the Foxglove WebSocket protocol.

use std::path::Path;

use serde_json::json;
use socam_recording::Channel;
use socam_sources::foxglove::{Connection, Publisher, Said, SampleWriter, Survey, Topics};
use socam_sources::{Chunk, Device, Heard};
use socam_units::Unit;

use crate::Input;

/// What a server sends after the handshake. Says whether a row comes out of it.
pub(crate) fn server(input: Input<'_>) -> bool {
    let mut connection = Connection::after_handshake(&["/a".to_owned(), "/b".to_owned()]);
    let mut messages = Vec::new();
    for (index, bytes) in input.bytes.chunks(100).enumerate() {
        let now_ns = index as i64 * 10_000_000;
        let chunk = Chunk { bytes, from_ns: now_ns, until_ns: now_ns };
        connection.receive(chunk, |_, said| {
            if let Said::Message(message) = said {
                messages.push(message);
            }
        });
        let _ = (connection.send(&mut Vec::new()), connection.is_subscribed(), connection.missing());
    }
    let Ok(survey) = Survey::new(connection, messages) else { return false };
    let Ok(found) = survey.found(true) else { return false };
    let Ok(description) = found.description() else { return false };
    if survey.check(&description).is_err() {
        return false;
    }
    let mut topics = Topics::new(survey, description);
    let mut heard = Vec::new();
    topics.receive(Chunk { bytes: &[], from_ns: 0, until_ns: 0 }, &mut heard);
    let rows = heard.iter().filter_map(|one| if let Heard::Row(row) = one { Some(row) } else { None });
    rows.inspect(|row| assert_eq!(row.values.len(), topics.channels().len(), "values of a row")).count() > 0
}

/// What a client sends. Says whether it is given samples then.
pub(crate) fn client(input: Input<'_>) -> bool {
    let writer = SampleWriter::new(&[Channel::new("speed", Unit::RadPerS)], "fuzzed", "1");
    let mut publisher = Publisher::new(&writer);
    for bytes in input.bytes.chunks(100) {
        if publisher.receive(bytes).is_err() {
            return false;
        }
    }
    publisher.sample(1, &writer.sample(1, &[0.5]));
    publisher.wants_samples()
}

/// A frame of a WebSocket; one of a client is masked, here by zeros.
fn frame(kind: u8, payload: &[u8], is_masked: bool) -> Vec<u8> {
    let mask: &[u8] = if is_masked { &[0; 4] } else { &[] };
    let flag = if is_masked { 0x80 } else { 0 };
    let length = match u8::try_from(payload.len()) {
        Ok(length @ 0..126) => vec![flag | length],
        _ => [&[flag | 126][..], &(payload.len() as u16).to_be_bytes()].concat(),
    };
    [&[0x80 | kind][..], &length, mask, payload].concat()
}

pub(crate) fn server_seeds(_: &Path) -> Vec<Vec<u8>> {
    let info = json!({ "op": "serverInfo", "name": "seed", "capabilities": [] });
    let ros = "builtin_interfaces/Time stamp\nfloat64 speed\nfloat64[] torque\n\
        ================================================================================\n\
        MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
    let channel = |id: u64, topic: &str, encoding: &str, language: &str, schema: &str| json!({ "id": id, "topic": topic, "encoding": encoding, "schemaName": "x/msg/Y", "schemaEncoding": language, "schema": schema });
    let channels = [channel(1, "/a", "json", "jsonschema", "{}"), channel(2, "/b", "cdr", "ros2msg", ros)];
    let advertise = json!({ "op": "advertise", "channels": channels });
    let mut bytes =
        [frame(1, info.to_string().as_bytes(), false), frame(1, advertise.to_string().as_bytes(), false)]
            .concat();
    for k in 0..40_u64 {
        let head = |id: u32| [&[1][..], &id.to_le_bytes(), &(k * 10_000_000).to_le_bytes()].concat();
        let text = json!({ "speed_rad_s": 0.5 * k as f64, "stamp": { "sec": 0, "nsec": k * 10_000_000 } });
        bytes.extend(frame(2, &[head(0), text.to_string().into_bytes()].concat(), false));
        let mut cdr = vec![0, 1, 0, 0, 0, 0, 0, 0];
        cdr.extend((k as u32 * 10_000_000).to_le_bytes());
        cdr.extend((k as f64).to_le_bytes());
        cdr.extend([1, 0, 0, 0, 0, 0, 0, 0]);
        cdr.extend(0.25_f64.to_le_bytes());
        bytes.extend(frame(2, &[head(1), cdr].concat(), false));
    }
    vec![bytes]
}

pub(crate) fn client_seeds(_: &Path) -> Vec<Vec<u8>> {
    let hello = "GET / HTTP/1.1\r\nHost: x\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
        Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n";
    // The request is whole at the end of a piece of 100 bytes, as one is that waits for its answer.
    let padding = 100 - (hello.len() + "X: \r\n".len()) % 100;
    let hello = hello.replace("\r\n\r\n", &format!("\r\nX: {}\r\n\r\n", "x".repeat(padding)));
    let subscribe = json!({ "op": "subscribe", "subscriptions": [{ "id": 7, "channelId": 1 }, { "id": 8, "channelId": 2 }] });
    let leave = json!({ "op": "unsubscribe", "subscriptionIds": [8] });
    let frames = [subscribe, leave].map(|text| frame(1, text.to_string().as_bytes(), true));
    vec![[hello.into_bytes(), frames.concat()].concat()]
}
