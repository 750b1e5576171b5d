//! The thread of the server: it takes rows out of a queue, and gives them to all clients without waiting for any.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use anyhow::Context;
use socam_recording::{Channel, Event, SampleRow};
use socam_sources::foxglove::{Publisher, SampleWriter};

use super::ServeAddress;
use crate::output;

/// Batches that wait for the thread: some seconds of a board's stream.
const WAITING_BATCHES: usize = 1024;
/// Bytes that wait for a client, beyond which samples are left out for it.
const WAITING_BYTES: usize = 1 << 20;
/// Most clients at a time.
const MOST_CLIENTS: usize = 16;
/// Longest time without a look at the clients.
const LOOK_EVERY: Duration = Duration::from_millis(10);
/// Longest time for which clients are given what waits for them at the end.
const LINGER: Duration = Duration::from_millis(500);

/// What is published.
enum Batch {
    /// Time of day of the recording's time 0, ns since 1970.
    Start(u64),
    /// Times since the start, ns, and values by channel, one sample after the other.
    Samples(Vec<i64>, Vec<f64>),
    Event(Event),
}

/// A server of a running recording.
pub(crate) struct Serve {
    /// `None` once the run has ended.
    batches: Option<SyncSender<Batch>>,
    thread: Option<JoinHandle<Totals>>,
    /// Samples that the thread was too slow for.
    left_out: usize,
}

/// What was published.
#[derive(Debug, Default, Clone, Copy)]
struct Totals {
    clients: usize,
    /// Samples that clients were too slow for, one for each client.
    left_out: u64,
}

impl Serve {
    /// Listens at an address, and publishes samples of these channels.
    ///
    /// # Errors
    /// When the address is not one of this computer, or is taken.
    pub(crate) fn start(address: ServeAddress, channels: &[Channel], name: &str) -> anyhow::Result<Self> {
        let listener = TcpListener::bind(address.0);
        let listener = listener.with_context(|| {
            format!("cannot serve at {}; expected an address of this computer and a free port", address.0)
        })?;
        listener.set_nonblocking(true)?;
        let local = listener.local_addr()?;
        output::say(format_args!("serving: ws://{local}, as a Foxglove WebSocket"));
        if !local.ip().is_loopback() {
            output::warn(format_args!(
                "whoever reaches {local} can read the samples; nobody can command anything there"
            ));
        }
        let writer = SampleWriter::new(channels, name, &std::process::id().to_string());
        let width = channels.len().max(1);
        let (batches, incoming) = sync_channel(WAITING_BATCHES);
        let thread = thread::Builder::new().name("serve".into());
        let thread = thread.spawn(move || Server::new(listener, writer, width).run(&incoming))?;
        Ok(Self { batches: Some(batches), thread: Some(thread), left_out: 0 })
    }

    /// Sets the time of day of the recording's time 0, ns since 1970.
    pub(crate) fn begin(&mut self, start_unix_ns: u64) {
        self.put(Batch::Start(start_unix_ns), 0);
    }

    /// Hands samples over, without waiting.
    pub(crate) fn take(&mut self, rows: &[SampleRow<'_>]) {
        let times = rows.iter().map(|row| row.device_time_ns).collect();
        let values = rows.iter().flat_map(|row| row.values).copied().collect();
        self.put(Batch::Samples(times, values), rows.len());
    }

    /// Hands an event over, without waiting.
    pub(crate) fn event(&mut self, event: &Event) {
        self.put(Batch::Event(event.clone()), 0);
    }

    fn put(&mut self, batch: Batch, samples: usize) {
        // A thread that has ended receives nothing.
        if let Some(batches) = &self.batches
            && let Err(TrySendError::Full(_)) = batches.try_send(batch)
        {
            self.left_out += samples;
        }
    }

    /// Ends the server, and says what clients did not get.
    fn finish(&mut self) {
        self.batches = None;
        let Some(Ok(totals)) = self.thread.take().map(JoinHandle::join) else { return };
        if self.left_out > 0 {
            output::warn(format_args!(
                "the server was too slow for {} samples, which were recorded but published to nobody",
                self.left_out
            ));
        }
        if totals.left_out > 0 {
            output::warn(format_args!(
                "of {} clients of the server some were too slow: {} samples were left out for them, and recorded",
                totals.clients, totals.left_out
            ));
        }
    }
}

impl Drop for Serve {
    fn drop(&mut self) {
        self.finish();
    }
}

/// A client with its link.
struct Client {
    address: SocketAddr,
    link: TcpStream,
    publisher: Publisher,
    left_out: u64,
    /// Whether it has been told that samples are left out for it.
    is_warned: bool,
}

struct Server {
    listener: TcpListener,
    writer: SampleWriter,
    width: usize,
    start_unix_ns: u64,
    clients: Vec<Client>,
    totals: Totals,
    buffer: Vec<u8>,
}

impl Server {
    fn new(listener: TcpListener, writer: SampleWriter, width: usize) -> Self {
        Self {
            listener,
            writer,
            width,
            start_unix_ns: 0,
            clients: Vec::new(),
            totals: Totals::default(),
            buffer: vec![0; 1 << 14],
        }
    }

    /// Publishes what comes out of the queue, until it is closed.
    fn run(mut self, incoming: &Receiver<Batch>) -> Totals {
        loop {
            match incoming.recv_timeout(LOOK_EVERY) {
                Ok(batch) => {
                    self.publish(&batch);
                    // Clients are looked at once for all that waits.
                    incoming.try_iter().take(WAITING_BATCHES).for_each(|batch| self.publish(&batch));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            self.accept();
            self.exchange();
        }
        let until = Instant::now() + LINGER;
        while self.clients.iter_mut().any(|client| !client.publisher.outgoing().is_empty())
            && Instant::now() < until
        {
            thread::sleep(Duration::from_millis(1));
            self.exchange();
        }
        self.clients.drain(..).for_each(|client| self.totals.left_out += client.left_out);
        self.totals
    }

    fn accept(&mut self) {
        while let Ok((link, address)) = self.listener.accept() {
            // A client too many is closed by dropping its link.
            if self.clients.len() < MOST_CLIENTS && link.set_nonblocking(true).is_ok() {
                // Small messages are sent at once.
                let _ = link.set_nodelay(true);
                self.totals.clients += 1;
                let publisher = Publisher::new(&self.writer);
                self.clients.push(Client { address, link, publisher, left_out: 0, is_warned: false });
            }
        }
    }

    fn publish(&mut self, batch: &Batch) {
        match batch {
            Batch::Start(start_unix_ns) => self.start_unix_ns = *start_unix_ns,
            Batch::Event(event) => {
                let unix_ns = self.start_unix_ns.saturating_add_signed(event.device_time_ns);
                let json = self.writer.event(unix_ns, &event.kind, &event.text);
                self.clients.iter_mut().for_each(|client| client.publisher.event(unix_ns, &json));
            }
            Batch::Samples(times, values) => {
                if !self.clients.iter().any(|client| client.publisher.wants_samples()) {
                    return;
                }
                for (time_ns, values) in times.iter().zip(values.chunks_exact(self.width)) {
                    let unix_ns = self.start_unix_ns.saturating_add_signed(*time_ns);
                    let json = self.writer.sample(unix_ns, values);
                    self.clients.iter_mut().for_each(|client| client.sample(unix_ns, &json));
                }
            }
        }
    }

    /// Reads what clients ask for and sends what waits for them; those that are gone are forgotten.
    fn exchange(&mut self) {
        let (buffer, totals) = (&mut self.buffer, &mut self.totals);
        self.clients.retain_mut(|client| {
            let is_there = client.exchange(buffer);
            if !is_there {
                totals.left_out += client.left_out;
            }
            is_there
        });
    }
}

impl Client {
    fn sample(&mut self, unix_ns: u64, json: &str) {
        if !self.publisher.wants_samples() {
            return;
        }
        if self.publisher.outgoing().len() < WAITING_BYTES {
            self.publisher.sample(unix_ns, json);
            return;
        }
        self.left_out += 1;
        if !std::mem::replace(&mut self.is_warned, true) {
            self.publisher
                .warn("this client is too slow: samples are left out for it; the recording has them");
            output::warn(format_args!(
                "{} is too slow: samples are left out for it, and recorded",
                self.address
            ));
        }
    }

    /// Whether the client is still there.
    fn exchange(&mut self, buffer: &mut [u8]) -> bool {
        loop {
            match self.link.read(buffer) {
                Ok(0) => return false,
                Ok(count) => {
                    if self.publisher.receive(&buffer[..count]).is_err() {
                        // A refusal is sent as far as it goes at once.
                        let _ = self.link.write(self.publisher.outgoing());
                        return false;
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return false,
            }
        }
        let outgoing = self.publisher.outgoing();
        let mut sent = 0;
        while sent < outgoing.len() {
            match self.link.write(&outgoing[sent..]) {
                Ok(0) => return false,
                Ok(count) => sent += count,
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return false,
            }
        }
        outgoing.drain(..sent);
        true
    }
}
