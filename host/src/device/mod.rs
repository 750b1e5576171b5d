//! The host's side of the link to a board: in this process, over TCP, over a serial line.
//!
//! All three are a [`Stream`] of bytes. A [`Session`] exchanges messages over it, and [`run::record`] runs a profile and records it.
//! [`source`] are devices of other protocols, which are listened to or asked; a drive among them may follow a profile.

pub(crate) mod front_end;
mod in_process;
pub(crate) mod run;
pub(crate) mod session;
pub(crate) mod source;
mod stream;
pub(crate) mod token;

use std::io::Write;
use std::str::FromStr;

use anyhow::anyhow;
use socam_sim::Setup;

pub(crate) use in_process::{InProcess, Pace};
pub(crate) use session::Session;
pub(crate) use stream::is_board;
use stream::{Stream, find_board, open_serial, open_tcp};
use token::Token;

/// How many samples a recording lacks, in words.
pub(crate) fn lost_words(lost: u64) -> String {
    if lost == 0 { "none lost".into() } else { format!("{lost} lost") }
}

/// Location of a board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Device {
    /// A virtual board in this process.
    Sim,
    /// The board on USB, known by its product's name.
    Usb,
    /// A serial line, USB included.
    Serial(String),
    /// A board behind TCP: `HOST:PORT`, and the token that it asks for.
    Tcp(String, Option<Token>),
}

impl Device {
    /// The device with the token that a board behind TCP may ask for.
    pub(crate) fn with_token(self, token: Option<Token>) -> Self {
        match self {
            Self::Tcp(address, _) => Self::Tcp(address, token),
            other => other,
        }
    }
}

impl FromStr for Device {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "sim" => Ok(Self::Sim),
            None if text == "serial" => Ok(Self::Usb),
            Some(("serial", path)) if !path.is_empty() => Ok(Self::Serial(path.into())),
            Some(("tcp", address)) if address.contains(':') => Ok(Self::Tcp(address.into(), None)),
            _ => Err("expected sim, serial (the board on USB), serial:PATH or tcp:HOST:PORT".into()),
        }
    }
}

impl std::fmt::Display for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Sim => f.write_str("sim"),
            Self::Usb => f.write_str("serial"),
            Self::Serial(path) => write!(f, "serial:{path}"),
            Self::Tcp(address, _) => write!(f, "tcp:{address}"),
        }
    }
}

/// Opens the link and asks the board's identity. `bench` is the bench of the virtual board of [`Device::Sim`].
pub(crate) fn open(device: &Device, bench: Option<(Setup, Pace)>) -> anyhow::Result<Session> {
    let is_patient = matches!(bench, Some((_, Pace::Fast)));
    let stream: Box<dyn Stream> = match (device, bench) {
        (Device::Sim, Some((setup, pace))) => Box::new(InProcess::start(setup, pace)?),
        (Device::Sim, None) => return Err(anyhow!("a virtual board needs a bench")),
        (Device::Usb, _) => Box::new(open_serial(&find_board(&serialport::available_ports()?)?)?),
        (Device::Serial(path), _) => Box::new(open_serial(path)?),
        (Device::Tcp(address, token), _) => {
            let mut stream = open_tcp(address)?;
            if let Some(token) = token {
                stream.write_all(token.line().as_bytes())?;
            }
            Box::new(stream)
        }
    };
    Session::open(stream, device.to_string(), is_patient)
}

#[cfg(test)]
mod tests;
