use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::channel;
use std::time::Duration;

use super::*;

/// A client that subscribes to samples and events.
fn subscribe(address: &str) -> TcpStream {
    let mut link = TcpStream::connect(address).unwrap();
    let request = format!(
        "GET / HTTP/1.1\r\nHost: {address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n"
    );
    link.write_all(request.as_bytes()).unwrap();
    let mut answer = [0; 12];
    link.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 101");
    let text = r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":2}]}"#;
    // A frame with a mask of zeros.
    link.write_all(&[&[0x81, 0x80 | text.len() as u8, 0, 0, 0, 0], text.as_bytes()].concat()).unwrap();
    link.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
    link
}

#[test]
fn the_last_alarms_of_a_run_are_recorded_and_published() {
    let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let serve = Serve::start(address.parse().unwrap(), &[], "test").unwrap();
    let (alarms, events) = channel();
    let interrupt = Interrupt::default();
    let mut terminal = Terminal {
        interrupt: &interrupt,
        progress: ProgressBar::hidden(),
        watch: Some(LiveWatch::ending_with(events)),
        serve: Some(serve),
    };
    let mut client = subscribe(&address);
    let (mut published, mut buffer) = (String::new(), [0; 4096]);
    // The server says nowhere when a subscription counts: alarms end the run until one arrives.
    for number in 0..500 {
        let event =
            Event { device_time_ns: 0, kind: "alarm".into(), text: format!("the shaft rubs, {number}") };
        alarms.send(event.clone()).unwrap();
        assert_eq!(terminal.last_alarms(), [event]);
        if let Ok(count) = client.read(&mut buffer) {
            published += &String::from_utf8_lossy(&buffer[..count]);
        }
        if published.contains("the shaft rubs") {
            return;
        }
    }
    panic!("no alarm was published: {published}");
}
