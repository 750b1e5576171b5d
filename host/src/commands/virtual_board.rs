//! `virtual-board`: the virtual bench behind TCP, for another process or another machine.

mod door;

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use anyhow::Context;
use socam_job::VirtualBench;
use socam_recording::Calibration;
use socam_sim::{SimError, VirtualBoard};

use super::Outcome;
use crate::device::Pace;
use crate::device::token::TokenArgs;
use crate::interrupt::Interrupt;
use crate::output::{self, WrongArguments};
use door::Door;

/// Serve a virtual board on a simulated bench over TCP
///
/// It behaves like a real board until Ctrl-C. It serves one host at a time, refuses others, and drops one that sends nothing valid for five
/// seconds. On an address that other machines reach it asks for a token, which `record` gives by --token or --token-file: whoever connects
/// may configure, arm and run the board. The token is sent as it is; on a network that is not trusted, use a tunnel.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host virtual-board                                                             in one shell, and in another
  socam-host record --device tcp:127.0.0.1:4711 --profile steps -o run.mcap
  socam-host virtual-board --listen 0.0.0.0:4711 --token-file secret.txt              for other machines")]
pub(crate) struct Args {
    /// Address to listen on; port 0 chooses a free port and prints it
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:4711", value_parser = host_and_port)]
    listen: String,
    /// Run the board as fast as the machine and the host allow
    #[arg(long)]
    fast: bool,
    /// Run the board in real time (the default)
    #[arg(long, conflicts_with = "fast")]
    realtime: bool,
    /// Calibration file of the bench's sensors [default: one that suits the model]
    #[arg(long, value_name = "C.toml")]
    calibration: Option<std::path::PathBuf>,
    /// End when the first host disconnects
    #[arg(long)]
    once: bool,
    #[command(flatten)]
    token: TokenArgs,
    #[command(flatten)]
    bench: VirtualBench,
}

/// Board time per turn.
const TURN: Duration = Duration::from_millis(5);

/// Time of silence of the host after which the board's time stops in fast mode, well before its watchdog trips.
const FAST_LEAD_US: u64 = 200_000;

/// Time without a valid message after which a host is dropped; it sends a heartbeat ten times a second.
const SILENT_WITHIN: Duration = Duration::from_secs(5);

/// Time without a read after which a host counts as disconnected.
const TAKES_WITHIN: Duration = Duration::from_secs(2);

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let calibration = args.calibration.as_deref().map(Calibration::open).transpose()?;
    let setup = args.bench.setup(&args.bench.load()?, calibration)?;
    let token = args.token.read()?;
    let listener = bind(&args.listen, token.is_some())?;
    let address = listener.local_addr()?;
    let door = Door::new(listener, token)?;
    let interrupt = Interrupt::listen();
    interrupt.answer(1);
    output::print(&format!("listening on {address}\n"))?;
    let pace = if args.fast { Pace::Fast } else { Pace::RealTime };
    let served = VirtualBoard::run(&setup, |board| {
        let mut server = Server {
            board,
            pace,
            host: None,
            heard: Instant::now(),
            heard_us: 0,
            outgoing: Vec::new(),
            from: Instant::now(),
        };
        server.serve(&door, args.once, &interrupt)
    });
    served??;
    Ok(Outcome::Done)
}

/// Listens at an address; one that other machines reach needs a token.
fn bind(listen: &str, has_token: bool) -> anyhow::Result<TcpListener> {
    let cannot = || format!("cannot listen at {listen}");
    let places: Vec<_> = listen.to_socket_addrs().with_context(cannot)?.collect();
    if !has_token && places.iter().any(|place| !place.ip().is_loopback()) {
        return Err(WrongArguments(format!(
            "--listen {listen}: other machines reach this address, and whoever connects may run the board: give a token with --token-file \
             or --token, or listen at 127.0.0.1"
        ))
        .into());
    }
    TcpListener::bind(places.as_slice()).with_context(cannot)
}

fn host_and_port(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(text.to_owned()),
        _ => Err("expected HOST:PORT, as in 127.0.0.1:4711, with a port up to 65535".to_owned()),
    }
}

struct Server<'s, 'b> {
    board: &'s mut VirtualBoard<'b>,
    pace: Pace,
    host: Option<TcpStream>,
    /// Time of the host's last valid message.
    heard: Instant,
    /// The board's time of the last message of the host.
    heard_us: u64,
    outgoing: Vec<u8>,
    /// Wall-clock time of the board's time 0.
    from: Instant,
}

impl Server<'_, '_> {
    fn serve(&mut self, door: &Door, once: bool, interrupt: &Interrupt) -> anyhow::Result<()> {
        while interrupt.count() == 0 {
            match door.next(self.host.is_some())? {
                Some(stream) => self.accept(stream)?,
                None if self.host.is_none() => std::thread::sleep(TURN),
                None => {}
            }
            let had_host = self.host.is_some();
            self.hear();
            self.advance()?;
            self.answer();
            if once && had_host && self.host.is_none() {
                break;
            }
        }
        Ok(())
    }

    fn accept(&mut self, stream: TcpStream) -> anyhow::Result<()> {
        // A host that has already disconnected is noticed when it is read.
        let from = stream.peer_addr().map_or_else(|_| "that left".to_owned(), |address| address.to_string());
        output::say(format_args!("host {from} connected"));
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(if self.pace == Pace::Fast {
            Duration::from_millis(1)
        } else {
            TURN
        }))?;
        stream.set_write_timeout(Some(TAKES_WITHIN))?;
        self.host = Some(stream);
        self.heard = Instant::now();
        self.heard_us = self.board.now_us();
        Ok(())
    }

    fn hear(&mut self) {
        let Some(stream) = &mut self.host else { return };
        let mut bytes = [0; 4096];
        match stream.read(&mut bytes) {
            Ok(0) => self.hang_up("hung up"),
            Ok(count) => {
                if self.board.receive(&bytes[..count], &mut self.outgoing) {
                    self.heard = Instant::now();
                    self.heard_us = self.board.now_us();
                }
            }
            Err(error)
                if matches!(
                    error.kind(),
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                ) => {}
            // A host that disconnects while samples are in transit resets the connection.
            Err(error) if error.kind() == ErrorKind::ConnectionReset => self.hang_up("hung up"),
            Err(error) => self.hang_up(&error.to_string()),
        }
        if self.heard.elapsed() > SILENT_WITHIN && self.host.is_some() {
            self.hang_up(&format!("it sent no valid message for {} s", SILENT_WITHIN.as_secs()));
        }
    }

    fn advance(&mut self) -> Result<(), SimError> {
        let now_us = self.board.now_us();
        let until_us = match self.pace {
            Pace::RealTime => u64::try_from(self.from.elapsed().as_micros()).unwrap_or(u64::MAX),
            Pace::Fast
                if self.host.is_none()
                    || now_us < self.heard_us + FAST_LEAD_US
                    || !self.board.state().is_live() =>
            {
                now_us + 4 * TURN.as_micros() as u64
            }
            Pace::Fast => now_us,
        };
        self.board.advance(until_us, &mut self.outgoing)
    }

    fn answer(&mut self) {
        if let Some(stream) = &mut self.host
            && let Err(error) = stream.write_all(&self.outgoing)
        {
            self.hang_up(&error.to_string());
        }
        self.outgoing.clear();
    }

    fn hang_up(&mut self, why: &str) {
        output::say(format_args!("host left: {why}"));
        self.host = None;
    }
}
