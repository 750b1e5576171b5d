//! `record` as a client and as a server of Foxglove WebSocket: as processes, over loopback.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use socam_recording::Dataset;
use socam_tests::{Ending, path, record, socam_host};

/// An address of loopback that is free now.
fn free() -> String {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string()
}

/// A recorder that publishes, killed when the test ends.
struct Publishing(Child);

impl Publishing {
    /// Starts it, and waits until it publishes.
    fn start(device: &str, log: &str, address: &str, more: &[&str]) -> Self {
        let mut command = socam_host();
        command.args(["record", "-o", log, "--device", device, "--serve", address, "--json"]).args(more);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let begin = Instant::now();
        while TcpStream::connect(address).is_err() {
            assert!(begin.elapsed() < Duration::from_secs(30), "it does not publish");
            std::thread::sleep(Duration::from_millis(20));
        }
        Self(child)
    }

    /// What it says at its own end.
    fn ended(&mut self) -> (Value, String) {
        assert_eq!(self.0.wait().unwrap().code(), Some(0));
        let (mut out, mut errors) = (String::new(), String::new());
        self.0.stdout.take().unwrap().read_to_string(&mut out).unwrap();
        self.0.stderr.take().unwrap().read_to_string(&mut errors).unwrap();
        (serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out} {errors}")), errors)
    }
}

impl Drop for Publishing {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Hands on the number of a line at even times, until told to end or the other end is gone.
fn send(is_over: &AtomicBool, step: Duration, mut line: impl FnMut(u32) -> std::io::Result<()>) {
    let begin = Instant::now();
    for k in 0.. {
        std::thread::sleep((begin + step * k).saturating_duration_since(Instant::now()));
        if is_over.load(Ordering::Relaxed) || line(k).is_err() {
            return;
        }
    }
}

/// A recording of lines of text is published, recorded by a second recorder and given to a client that never reads: the first one loses
/// nothing, and the second one has the same samples.
#[test]
fn a_running_recording_is_published_to_fast_and_slow_clients() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (path(&folder, "first.mcap"), path(&folder, "second.mcap"));
    let (device, address) = (TcpListener::bind("127.0.0.1:0").unwrap(), free());
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let _ending = Ending(&is_over);
        let name = format!("text+tcp:{}", device.local_addr().unwrap());
        // 60 columns at 1 kHz are 1.5 MB/s as JSON.
        let more: String = (0..58).map(|column| format!(",c{column}_V:0.12345678912345{column}")).collect();
        let (over, device) = (&is_over, &device);
        scope.spawn(move || {
            let (mut link, _) = device.accept().unwrap();
            send(over, Duration::from_millis(1), |k| {
                link.write_all(format!("t_us:{},speed_rad_s:{k}{more}\n", 1000 * u64::from(k)).as_bytes())
            });
        });
        let mut publishing = Publishing::start(&name, &first, &address, &["--duration", "10s"]);
        let _slow = subscribe(&address);
        // The second and a half that the first one listened to before are published at once.
        std::thread::sleep(Duration::from_secs(1));
        let ran = record(&format!("foxglove:{address}?topics=/socam/sample"), &second, &["--duration", "3s"]);
        let copy = ran.document();
        assert_eq!((&copy["end"], &copy["damaged"]), (&"finished".into(), &0.into()), "{ran:?}");
        let (original, errors) = publishing.ended();
        assert_eq!((&original["end"], &original["lost"]), (&"finished".into(), &0.into()), "{errors}");
        assert!(errors.contains(&format!("serving: ws://{address}")), "{errors}");
        assert!(errors.contains("is too slow: samples are left out for it, and recorded"), "{errors}");
        // The copy has every sample of its 3 s, at its time by the device's own clock.
        assert!((2990..=3000).contains(&copy["samples"].as_u64().unwrap()), "{ran:?}");
    });
    let [first, second] =
        [&first, &second].map(|log| Dataset::open(log).unwrap().load(&["speed", "c7"]).unwrap());
    let speeds = second.columns[0].values();
    let offset = speeds[0] - first.columns[0].values()[0];
    for (time_s, speed) in second.time_s.iter().zip(speeds) {
        assert!((speed - speeds[0] - 1e3 * time_s).abs() < 1e-6 && offset >= 0.0, "{time_s} {speed}");
    }
    assert!(second.columns[1].values().iter().all(|value| *value == first.columns[1].values()[0]));
}

/// A client that subscribes to the samples, and then reads nothing.
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
    let text = json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 1 }] }).to_string();
    // A frame with a mask of zeros.
    link.write_all(&[&[0x81, 0x80 | text.len() as u8, 0, 0, 0, 0], text.as_bytes()].concat()).unwrap();
    link
}

/// A run of the board is published too; whoever records it has its channels.
#[test]
fn a_run_of_the_board_is_published() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (path(&folder, "first.mcap"), path(&folder, "second.mcap"));
    let address = free();
    let more = ["--profile", "multisine", "--duration", "6s", "--realtime"];
    let mut publishing = Publishing::start("sim", &first, &address, &more);
    let ran = record(&format!("foxglove:{address}?topics=/socam/sample"), &second, &["--duration", "2s"]);
    assert_eq!(ran.document()["end"], "finished", "{ran:?}");
    let (original, errors) = publishing.ended();
    assert_eq!((&original["end"], &original["lost"]), (&"finished".into(), &0.into()), "{errors}");
    let [first, second] = [&first, &second].map(|log| Dataset::open(log).unwrap());
    assert_eq!(first.channels(), second.channels());
    assert!(second.rows() > 1900, "{}", second.rows());
}

/// What is no server of the protocol, and what cannot be served, is said in one sentence.
#[test]
fn what_is_no_server_is_refused_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let answers: [(&[u8], &str); 3] = [
        (
            b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n",
            "there is no Foxglove WebSocket server: it answers by the status 404",
        ),
        (b"1,2,3\n1,2,3\n", "there is no Foxglove WebSocket server"),
        (b"", "it does not say that it is a Foxglove WebSocket server"),
    ];
    std::thread::scope(|scope| {
        for (index, (answer, sentence)) in answers.into_iter().enumerate() {
            let log = path(&folder, &format!("{index}.mcap"));
            scope.spawn(move || {
                let listener = TcpListener::bind("127.0.0.1:0").unwrap();
                let device = format!("foxglove:{}", listener.local_addr().unwrap());
                std::thread::scope(|scope| {
                    scope.spawn(|| {
                        let (mut link, _) = listener.accept().unwrap();
                        let _ = link.read(&mut [0; 4096]);
                        let _ = link.write_all(answer);
                        // It stays connected until it is given up.
                        while link.read(&mut [0; 4096]).is_ok_and(|count| count > 0) {}
                    });
                    let ran = record(&device, &log, &[]);
                    assert!(ran.refusal(1).contains(sentence), "{ran:?}");
                    assert!(!Path::new(&log).exists());
                });
            });
        }
    });
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = taken.local_addr().unwrap().to_string();
    let log = path(&folder, "taken.mcap");
    let more = ["--profile", "steps", "--serve", &taken];
    let refused = record("sim", &log, &more);
    let is_said = refused.refusal(1).contains("expected an address of this computer and a free port");
    assert!(is_said && !Path::new(&log).exists(), "{refused:?}");
    let refused = record("foxglove:127.0.0.1:1?topic=/a", &log, &[]);
    assert!(refused.refusal(2).contains("expected ?topics=/joint_states,/drive"), "{refused:?}");
}

/// A server that is killed is waited for ten seconds; what came until then is kept.
#[test]
fn a_server_that_is_killed_leaves_the_samples_until_then() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (path(&folder, "first.mcap"), path(&folder, "second.mcap"));
    let (device, address) = (free(), free());
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let _ending = Ending(&is_over);
        scope.spawn(|| {
            let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
            send(&is_over, Duration::from_millis(2), |k| {
                // Nobody listens at first.
                let _ = sender
                    .send_to(format!("t_us:{},speed_rad_s:{k}", 2000 * u64::from(k)).as_bytes(), &device);
                Ok(())
            });
        });
        let mut publishing = Publishing::start(&format!("udp:{device}"), &first, &address, &[]);
        let log = second.clone();
        let killed = scope.spawn(move || {
            let begin = Instant::now();
            while !Path::new(&log).exists() && begin.elapsed() < Duration::from_secs(20) {
                std::thread::sleep(Duration::from_millis(20));
            }
            std::thread::sleep(Duration::from_secs(1));
            publishing.0.kill().unwrap();
        });
        // The only topic with numbers need not be named; that of events has none.
        let ran = record(&format!("foxglove:{address}?topics=/socam/sample"), &second, &[]);
        killed.join().unwrap();
        let copy = ran.document();
        assert_eq!((ran.code, &copy["end"]), (Some(1), &"link broken".into()), "{ran:?}");
        assert!(copy["samples"].as_u64().unwrap() > 900, "{ran:?}");
        assert!(
            ran.stderr.contains(&format!("the link to foxglove:{address}?topics=/socam/sample broke")),
            "{ran:?}"
        );
    });
    // The killed one has all but its last second.
    assert!(Dataset::open(&first).unwrap().rows() > 500 && Dataset::open(&second).unwrap().rows() > 900);
}
