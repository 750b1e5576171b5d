//! Both ends of the Foxglove WebSocket protocol: against each other, and a client against a server by `tungstenite`'s own sockets.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

use proptest::prelude::*;
use serde_json::{Value as Json, json};
use socam_recording::Channel;
use socam_sources::foxglove::{Connection, Message, Publisher, Said, SampleWriter, Survey, Topics};
use socam_sources::{Chunk, Description, Device, Heard, Row};
use socam_units::Unit;
use tungstenite::Message as Frame;

const STEP_NS: i64 = 10_000_000;

fn chunk(bytes: &[u8], now_ns: i64) -> Chunk<'_> {
    Chunk { bytes, from_ns: now_ns, until_ns: now_ns }
}

fn rows(heard: &[Heard]) -> Vec<&Row> {
    heard.iter().filter_map(|heard| if let Heard::Row(row) = heard { Some(row) } else { None }).collect()
}

/// Exchanges the bytes of both ends until none are left; returns what the client was told.
fn exchange(connection: &mut Connection, publisher: &mut Publisher, now_ns: i64) -> Vec<Said> {
    let mut said = Vec::new();
    loop {
        let mut to_server = Vec::new();
        connection.send(&mut to_server).unwrap();
        publisher.receive(&to_server).unwrap();
        let to_client = std::mem::take(publisher.outgoing());
        if to_client.is_empty() && to_server.is_empty() {
            return said;
        }
        // Frames arrive in pieces.
        for piece in to_client.chunks(33) {
            connection.receive(chunk(piece, now_ns), |_, one| said.push(one));
        }
    }
}

fn messages(said: Vec<Said>) -> Vec<Message> {
    said.into_iter()
        .filter_map(|said| if let Said::Message(message) = said { Some(message) } else { None })
        .collect()
}

#[test]
fn a_recording_is_published_and_recorded_again_with_its_units() {
    let channels = [Channel::new("motor_speed", Unit::RadPerS), Channel::new("torque", Unit::Nm)];
    let writer = SampleWriter::new(&channels, "bench", "1");
    let mut publisher = Publisher::new(&writer);
    let mut connection = Connection::new("127.0.0.1:8765", &["/socam/sample".into()]).unwrap();
    let told = exchange(&mut connection, &mut publisher, 0);
    assert_eq!(told, [Said::Note("the server is bench".into(), false)]);
    assert!(connection.is_subscribed().unwrap() && publisher.wants_samples());
    let start_ns = 1_700_000_000_000_000_000_u64;
    let mut heard = Vec::new();
    let mut device = None;
    for k in 0..400 {
        let values = [0.5 * k as f64, if k == 250 { f64::NAN } else { 0.1 }];
        let unix_ns = start_ns + k as u64 * STEP_NS as u64;
        publisher.sample(unix_ns, &writer.sample(unix_ns, &values));
        publisher.event(unix_ns, &writer.event(unix_ns, "note", "nobody has subscribed"));
        let now_ns = k * STEP_NS + 3_000_000;
        if k < 200 {
            heard.extend(messages(exchange(&mut connection, &mut publisher, now_ns)));
            continue;
        }
        let device = device.get_or_insert_with(|| {
            let connection = std::mem::replace(&mut connection, Connection::after_handshake(&[]));
            let survey = Survey::new(connection, std::mem::take(&mut heard)).unwrap();
            let description = survey.found(false).unwrap().description().unwrap();
            survey.check(&description).unwrap();
            (Topics::new(survey, description), Vec::new())
        });
        let bytes = std::mem::take(publisher.outgoing());
        device.0.receive(chunk(&bytes, now_ns), &mut device.1);
    }
    let (device, heard) = device.unwrap();
    assert_eq!(device.channels(), channels);
    let rows = rows(&heard);
    assert_eq!(rows.len(), 400);
    for (k, row) in rows.iter().enumerate() {
        // Times are those of the samples, to the last digit.
        assert!((row.device_s.unwrap() - 0.01 * k as f64).abs() < 1e-9, "{row:?}");
        assert_eq!(row.values[0], 0.5 * k as f64);
        assert!(row.values[1] == 0.1 || k == 250 && row.values[1].is_nan(), "{row:?}");
    }
}

#[test]
fn a_client_without_a_known_subprotocol_is_refused() {
    let writer = SampleWriter::new(&[], "bench", "1");
    let request = "GET / HTTP/1.1\r\nHost: x\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
        Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: chat\r\n\r\n";
    let mut publisher = Publisher::new(&writer);
    let _ = publisher.receive(request.as_bytes());
    let answer = String::from_utf8_lossy(publisher.outgoing()).into_owned();
    assert!(answer.starts_with("HTTP/1.1 400") && !publisher.wants_samples(), "{answer}");
    let mut publisher = Publisher::new(&writer);
    assert!(publisher.receive(&[0xff; 5000]).is_err());
}

/// A message of ROS' JointState.
fn joint_state(k: i64) -> Vec<u8> {
    let mut cdr = vec![0, 1, 0, 0];
    let pad = |cdr: &mut Vec<u8>, to: usize| {
        while !(cdr.len() - 4).is_multiple_of(to) {
            cdr.push(0);
        }
    };
    let text = |cdr: &mut Vec<u8>, text: &str| {
        pad(cdr, 4);
        cdr.extend((text.len() as u32 + 1).to_le_bytes());
        cdr.extend(text.as_bytes());
        cdr.push(0);
    };
    cdr.extend((100_i32 + (k * STEP_NS / 1_000_000_000) as i32).to_le_bytes());
    cdr.extend(((k * STEP_NS % 1_000_000_000) as u32).to_le_bytes());
    text(&mut cdr, "base");
    pad(&mut cdr, 4);
    cdr.extend(1_u32.to_le_bytes());
    text(&mut cdr, "elbow");
    for value in [0.01 * k as f64, 1.0] {
        pad(&mut cdr, 4);
        cdr.extend(1_u32.to_le_bytes());
        pad(&mut cdr, 8);
        cdr.extend(value.to_le_bytes());
    }
    cdr
}

const JOINT_STATE: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n\
    ================================================================================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
    ================================================================================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

/// A server of two topics: joint states of ROS 2 at 100 Hz with a time stamp each, and a motor's current in JSON at 50 Hz without one.
fn serve(listener: &TcpListener, subprotocol: &'static str, count: i64) {
    let (link, _) = listener.accept().unwrap();
    #[expect(clippy::result_large_err, reason = "the type is that of the library's callback")]
    let choose = |_: &_, mut response: tungstenite::handshake::server::Response| {
        response.headers_mut().insert("sec-websocket-protocol", subprotocol.parse().unwrap());
        Ok(response)
    };
    let mut socket = tungstenite::accept_hdr(link, choose).unwrap();
    let channel = |id: u64, topic: &str, encoding: &str, name: &str, schema: &str| json!({ "id": id, "topic": topic, "encoding": encoding, "schemaName": name, "schema": schema });
    let channels = [
        channel(10, "/joint_states", "cdr", "sensor_msgs/msg/JointState", JOINT_STATE),
        channel(11, "/motor", "json", "motor", ""),
        channel(12, "/camera", "cdr", "sensor_msgs/msg/Image", "nothing that can be read {"),
    ];
    for text in
        [json!({ "op": "serverInfo", "name": "bridge" }), json!({ "op": "advertise", "channels": channels })]
    {
        socket.send(Frame::text(text.to_string())).unwrap();
    }
    let mut subscribed: Vec<(u32, u64)> = Vec::new();
    while subscribed.len() < 2 {
        let Ok(Frame::Text(text)) = socket.read() else { return };
        let request: Json = serde_json::from_str(&text).unwrap();
        assert_eq!(request["op"], "subscribe");
        for one in request["subscriptions"].as_array().unwrap() {
            subscribed.push((one["id"].as_u64().unwrap() as u32, one["channelId"].as_u64().unwrap()));
        }
    }
    for k in 0..count {
        for (id, channel) in &subscribed {
            let data = match channel {
                10 => joint_state(k),
                _ if k % 2 == 0 => json!({ "current_A": 0.02 * k as f64, "header": { "stamp": null } })
                    .to_string()
                    .into_bytes(),
                _ => continue,
            };
            let data = if k == 150 { b"{".to_vec() } else { data };
            let time_ns = 5_000_000_000 + k * STEP_NS;
            let head = [&[1][..], &id.to_le_bytes(), &time_ns.to_le_bytes()];
            socket.send(Frame::binary([&head.concat(), &data[..]].concat())).unwrap();
        }
    }
    let _ = socket.close(None);
    while socket.read().is_ok() {}
}

/// Takes what arrives at a device or connection, and sends what it wants, until the server closes.
fn pump(mut link: TcpStream, mut step: impl FnMut(&[u8], i64, &mut Vec<u8>) -> bool) {
    link.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
    let (mut bytes, mut arrived, mut outgoing, mut now_ns) = (vec![0; 1 << 14], 0, Vec::new(), 0);
    loop {
        let goes_on = step(&bytes[..arrived], now_ns, &mut outgoing);
        link.write_all(&outgoing).unwrap();
        outgoing.clear();
        if !goes_on {
            return;
        }
        arrived = match link.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => count,
            Err(_) => 0,
        };
        now_ns += 1_000_000;
    }
}

#[test]
fn topics_of_ros_and_of_json_are_put_together() {
    for subprotocol in ["foxglove.websocket.v1", "foxglove.sdk.v1"] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        std::thread::scope(|scope| {
            scope.spawn(|| serve(&listener, subprotocol, 300));
            let mut connection =
                Connection::new(&address, &["/joint_states".into(), "/motor".into()]).unwrap();
            let (mut heard, mut damaged) = (Vec::new(), 0);
            pump(TcpStream::connect(&address).unwrap(), |bytes, now_ns, out| {
                connection.receive(chunk(bytes, now_ns), |_, said| match said {
                    Said::Message(message) => heard.push(message),
                    Said::Damaged(_) => damaged += 1,
                    Said::Note(..) => {}
                });
                connection.send(out).is_ok()
            });
            assert_eq!((heard.len(), damaged), (448, 2));
            let survey = Survey::new(connection, heard).unwrap();
            assert_eq!(survey.rows(), "/joint_states");
            // Only one topic states its time, so that the server's is used.
            let asked = survey.found(false).unwrap();
            assert_eq!(
                asked.unknown,
                ["the unit of `/joint_states/position.elbow`", "the unit of `/joint_states/velocity.elbow`"]
            );
            assert!(
                asked.text.contains("perhaps \"rad/s\"") && asked.text.contains("signal = \"log_time\""),
                "{}",
                asked.text
            );
            let guessed = survey.found(true).unwrap();
            assert!(
                guessed.assumed[0].contains("is in rad, by the convention of ROS"),
                "{:?}",
                guessed.assumed
            );
            let description = guessed.description().unwrap();
            let other = Description::parse(&guessed.text.replace("/motor/", "/engine/")).unwrap();
            assert!(survey.check(&other).unwrap_err().to_string().contains("`/engine/current_A`"));
            let mut device = Topics::new(survey, description);
            let names: Vec<String> = device.channels().iter().map(Channel::column_name).collect();
            assert_eq!(names, ["position_elbow_rad", "velocity_elbow_rad_s", "current_A"]);
            let mut heard = Vec::new();
            device.receive(chunk(&[], 0), &mut heard);
            let rows = rows(&heard);
            assert!(rows.len() > 290, "{}", rows.len());
            for row in &rows {
                // The position is 0.01 a step, the current between its messages interpolated.
                let step = (row.values[0] / 0.01).round();
                assert!((row.device_s.unwrap() - 0.01 * step).abs() < 1e-9, "{row:?}");
                assert!(row.values[2].is_nan() || (row.values[2] - 0.02 * step).abs() < 1e-9, "{row:?}");
            }
            assert!(rows.iter().filter(|row| !row.values[2].is_nan()).count() > 280);
        });
    }
}

#[test]
fn what_cannot_be_recorded_is_said_in_one_sentence() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let refusal = |topics: &[&str]| {
        std::thread::scope(|scope| {
            scope.spawn(|| serve(&listener, "foxglove.sdk.v1", 1));
            let topics: Vec<String> = topics.iter().map(|topic| (*topic).to_owned()).collect();
            let mut connection = Connection::new(&address, &topics).unwrap();
            let mut found = None;
            pump(TcpStream::connect(&address).unwrap(), |bytes, now_ns, out| {
                connection.receive(chunk(bytes, now_ns), |_, _| {});
                let sent = connection.send(out);
                if bytes.is_empty() && now_ns > 5_000_000 {
                    let choice = if topics.is_empty() {
                        connection.choose().err()
                    } else {
                        connection.is_subscribed().err()
                    };
                    found = Some(choice.map_or_else(|| connection.missing(), |error| error.to_string()));
                }
                found.is_none() && sent.is_ok()
            });
            found.unwrap()
        })
    };
    assert!(refusal(&["/joints"]).starts_with(
        "it has no topic `/joints`; it has `/joint_states` (sensor_msgs/msg/JointState in cdr)"
    ));
    assert!(refusal(&[]).starts_with("name the topics to record, as in ?topics=/joint_states; it has "));
    let camera = refusal(&["/camera"]);
    assert!(camera.contains("the topic `/camera` cannot be recorded: its schema"), "{camera}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Damaged frames of either end, cut anywhere, make no panic and no row of another width.
    #[test]
    fn damaged_frames_are_survived(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in any::<prop::sample::Index>(),
        is_server in any::<bool>(),
    ) {
        let channels = [Channel::new("speed", Unit::RadPerS)];
        let writer = SampleWriter::new(&channels, "bench", "1");
        let mut publisher = Publisher::new(&writer);
        let topics = ["/socam/sample".to_owned()];
        let mut client = Connection::new("127.0.0.1:8765", &topics).unwrap();
        let mut hello = Vec::new();
        client.send(&mut hello).unwrap();
        publisher.receive(&hello).unwrap();
        client.receive(chunk(&std::mem::take(publisher.outgoing()), 0), |_, _| {});
        let mut subscribe = Vec::new();
        client.send(&mut subscribe).unwrap();
        publisher.receive(&subscribe).unwrap();
        for k in 0..20 {
            publisher.sample(k, &writer.sample(k, &[0.5]));
        }
        // What the client sent, or what it gets to read next.
        let mut bytes = if is_server { subscribe } else { std::mem::take(publisher.outgoing()) };
        for (index, change) in changes {
            let at = index.index(bytes.len());
            bytes[at] ^= change;
        }
        bytes.truncate(cut.index(bytes.len()) + 1);
        if is_server {
            let _ = publisher.receive(&bytes);
            publisher.sample(30, &writer.sample(30, &[f64::NAN]));
            return Ok(());
        }
        let mut heard = Vec::new();
        client.receive(chunk(&bytes, 0), |_, said| heard.push(said));
        let _ = client.send(&mut Vec::new());
        let Ok(survey) = Survey::new(client, messages(heard)) else { return Ok(()) };
        let Ok(description) = survey.found(true).and_then(|found| found.description()) else { return Ok(()) };
        let mut device = Topics::new(survey, description);
        let mut heard = Vec::new();
        device.receive(chunk(&[], 0), &mut heard);
        for row in rows(&heard) {
            prop_assert_eq!(row.values.len(), device.channels().len());
        }
    }
}
