//! A Foxglove WebSocket server of a running recording, in a thread of its own that never delays it.

use std::net::SocketAddr;
use std::str::FromStr;

/// Address of a server: `HOST:PORT` of this computer, or a port of its loopback.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ServeAddress(pub(crate) SocketAddr);

impl FromStr for ServeAddress {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let whole = if text.contains(':') { text.to_owned() } else { format!("127.0.0.1:{text}") };
        let named = whole.strip_prefix("localhost:").map(|port| format!("127.0.0.1:{port}"));
        let address = named.unwrap_or(whole).parse();
        address
            .map(Self)
            .map_err(|_| "expected an address of this computer and a port, as in 127.0.0.1:8765".into())
    }
}

#[cfg(not(feature = "foxglove"))]
pub(crate) use absent::Serve;
#[cfg(feature = "foxglove")]
pub(crate) use thread::Serve;

#[cfg(feature = "foxglove")]
mod thread;

/// A program without the protocol.
#[cfg(not(feature = "foxglove"))]
mod absent {
    use socam_recording::{Channel, Event, SampleRow};

    use super::ServeAddress;

    /// No server.
    pub(crate) enum Serve {}

    impl Serve {
        pub(crate) fn start(_: ServeAddress, _: &[Channel], _: &str) -> anyhow::Result<Self> {
            anyhow::bail!("--serve: this program was built without `foxglove`, which publishes a recording")
        }

        pub(crate) fn begin(&mut self, _: u64) {
            match *self {}
        }

        pub(crate) fn take(&mut self, _: &[SampleRow<'_>]) {
            match *self {}
        }

        pub(crate) fn event(&mut self, _: &Event) {
            match *self {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ServeAddress;

    #[test]
    fn a_port_alone_is_one_of_loopback() {
        let address = |text: &str| text.parse::<ServeAddress>().map(|address| address.0.to_string());
        assert_eq!(address("8765"), Ok("127.0.0.1:8765".into()));
        assert_eq!(address("localhost:8765"), Ok("127.0.0.1:8765".into()));
        assert_eq!(address("0.0.0.0:1"), Ok("0.0.0.0:1".into()));
        assert!(address("bench:8765").is_err() && address("127.0.0.1:x").is_err());
    }
}
