//! A WebSocket without input or output, as client or as server.

use std::io::{self, Read, Write};

use tungstenite::handshake::client::ClientHandshake;
use tungstenite::handshake::server::{ErrorResponse, Request, Response, ServerHandshake, write_response};
use tungstenite::handshake::{HandshakeError, MidHandshake};
use tungstenite::http::HeaderValue;
use tungstenite::http::header::SEC_WEBSOCKET_PROTOCOL;
use tungstenite::protocol::{Role, WebSocket, WebSocketConfig};
use tungstenite::{ClientRequestBuilder, Error, Message};

use super::SUBPROTOCOLS;

/// Longest message, bytes; topics with pictures are not subscribed to.
const LONGEST: usize = 1 << 24;

/// Bytes on their way in and out.
#[derive(Debug, Default)]
struct Pipe {
    incoming: Vec<u8>,
    /// Bytes of `incoming` that were read.
    taken: usize,
    outgoing: Vec<u8>,
}

impl Read for Pipe {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let waiting = &self.incoming[self.taken..];
        if waiting.is_empty() {
            self.incoming.clear();
            self.taken = 0;
            return Err(io::ErrorKind::WouldBlock.into());
        }
        let count = waiting.len().min(buffer.len());
        buffer[..count].copy_from_slice(&waiting[..count]);
        self.taken += count;
        Ok(count)
    }
}

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.outgoing.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Chooses a subprotocol of those that a client offers.
type Choice = fn(&Request, Response) -> Result<Response, ErrorResponse>;

enum Stage {
    Asking(MidHandshake<ClientHandshake<Pipe>>),
    Answering(MidHandshake<ServerHandshake<Pipe, Choice>>),
    Open(Box<WebSocket<Pipe>>),
    Closed(Pipe),
}

/// A WebSocket.
pub(super) struct Socket(Stage);

impl Socket {
    /// A client's end of a connection to `HOST:PORT`.
    pub(super) fn client(address: &str) -> Result<Self, String> {
        let uri = format!("ws://{address}").parse().map_err(|_| format!("`{address}` is no HOST:PORT"))?;
        let request = SUBPROTOCOLS.iter().fold(ClientRequestBuilder::new(uri), |request, subprotocol| {
            request.with_sub_protocol(*subprotocol)
        });
        let request = tungstenite::client::IntoClientRequest::into_client_request(request);
        let request = request.map_err(|error| error.to_string())?;
        let asking = ClientHandshake::start(Pipe::default(), request, Some(config()));
        asked(asking.map_err(|error| error.to_string())?).map(Self)
    }

    /// A client's end whose handshake is done, for tests: that of a real one depends on a random key.
    pub(super) fn after_handshake() -> Self {
        let open = WebSocket::from_raw_socket(Pipe::default(), Role::Client, Some(config()));
        Self(Stage::Open(Box::new(open)))
    }

    /// A server's end.
    pub(super) fn server() -> Self {
        Self(Stage::Answering(ServerHandshake::start(Pipe::default(), choose, Some(config()))))
    }

    /// Whether both ends have agreed on a subprotocol.
    pub(super) fn is_open(&self) -> bool {
        matches!(self.0, Stage::Open(_))
    }

    fn pipe(&mut self) -> &mut Pipe {
        match &mut self.0 {
            Stage::Asking(asking) => asking.get_mut().get_mut(),
            Stage::Answering(answering) => answering.get_mut().get_mut(),
            Stage::Open(open) => open.get_mut(),
            Stage::Closed(pipe) => pipe,
        }
    }

    /// Takes bytes, and returns the messages that end in them, or why there is no connection any more.
    pub(super) fn receive(&mut self, bytes: &[u8]) -> Result<Vec<Message>, String> {
        self.pipe().incoming.extend_from_slice(bytes);
        let stage = std::mem::replace(&mut self.0, Stage::Closed(Pipe::default()));
        self.0 = match stage {
            Stage::Asking(asking) => asked(asking)?,
            Stage::Answering(answering) => match answering.handshake() {
                Ok(open) => Stage::Open(Box::new(open)),
                Err(HandshakeError::Interrupted(answering)) => Stage::Answering(answering),
                Err(HandshakeError::Failure(error)) => {
                    // The refusal is lost with the stream, and written once more.
                    if let Error::Http(response) = &error {
                        let _ = write_response(self.outgoing(), response);
                    }
                    return Err(words(&error));
                }
            },
            other => other,
        };
        let mut messages = Vec::new();
        let Stage::Open(open) = &mut self.0 else { return Ok(messages) };
        loop {
            match open.read() {
                Ok(message) => messages.push(message),
                Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => break,
                // The link ends with it, which may be opened again.
                Err(Error::ConnectionClosed | Error::AlreadyClosed) => break,
                // What came before the defect is still to be used; the next call says it once more.
                Err(_) if !messages.is_empty() => break,
                Err(error) => return Err(words(&error)),
            }
        }
        // Answers to pings; a pipe takes all bytes.
        let _ = open.flush();
        Ok(messages)
    }

    /// Queues a message; without a connection it is dropped.
    pub(super) fn send(&mut self, message: Message) {
        if let Stage::Open(open) = &mut self.0 {
            let _ = open.send(message);
        }
    }

    /// Bytes that wait to be sent.
    pub(super) fn outgoing(&mut self) -> &mut Vec<u8> {
        &mut self.pipe().outgoing
    }
}

fn config() -> WebSocketConfig {
    // Whole frames are buffered in the pipe, so that the buffers within are small.
    let sizes = WebSocketConfig::default().max_message_size(Some(LONGEST)).max_frame_size(Some(LONGEST));
    sizes.read_buffer_size(1 << 14).write_buffer_size(0)
}

/// The stage after a step of a client's handshake.
fn asked(asking: MidHandshake<ClientHandshake<Pipe>>) -> Result<Stage, String> {
    match asking.handshake() {
        Ok((open, _)) => Ok(Stage::Open(Box::new(open))),
        Err(HandshakeError::Interrupted(asking)) => Ok(Stage::Asking(asking)),
        Err(HandshakeError::Failure(error)) => Err(words(&error)),
    }
}

#[expect(clippy::result_large_err, reason = "the type is that of the library's callback")]
fn choose(request: &Request, mut response: Response) -> Result<Response, ErrorResponse> {
    let offered = || {
        let headers = request.headers().get_all(SEC_WEBSOCKET_PROTOCOL).iter();
        headers.flat_map(|header| header.to_str().unwrap_or_default().split(',')).map(str::trim)
    };
    match SUBPROTOCOLS.iter().find(|known| offered().any(|name| name == **known)) {
        Some(subprotocol) => {
            response.headers_mut().insert(SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static(subprotocol));
            Ok(response)
        }
        None => {
            let mut refusal =
                ErrorResponse::new(Some(format!("expected one of: {}", SUBPROTOCOLS.join(", "))));
            *refusal.status_mut() = tungstenite::http::StatusCode::BAD_REQUEST;
            Err(refusal)
        }
    }
}

/// Why there is no connection, in words.
fn words(error: &Error) -> String {
    match error {
        Error::Http(response) => format!("it answers by the status {} of HTTP", response.status()),
        other => other.to_string(),
    }
}
