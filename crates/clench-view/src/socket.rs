//! The connection of one browser: it requests the next frame when it has drawn the last, so that a slow one skips
//! frames and delays no other.

use crate::command::Command;
use crate::delta::delta;
use crate::shared::Shared;
use serde_json::{Map, Value, json};
use std::io;
use std::net::TcpStream;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::TrySendError;
use std::time::Duration;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Bytes, Error, Message, WebSocket};

/// The maximum length of a browser's message, bytes.
const MAX_MESSAGE: usize = 16 * 1024;
/// The interval at which an idle connection checks if the server closes.
const POLL_INTERVAL: Duration = Duration::from_millis(500);
/// The time after which a browser that accepts no data is disconnected.
const PATIENCE: Duration = Duration::from_secs(10);

/// A message of a browser: an object whose `do` is its kind.
enum BrowserMessage {
    /// Requests the next frame, or its difference from the last one received.
    Next { changes: bool },
    /// A command for the code that steps the simulation.
    Command(Command),
}

impl BrowserMessage {
    /// Parses a message; `None` if it is invalid.
    fn read(text: &str) -> Option<Self> {
        let mut object: Map<String, Value> = serde_json::from_str(text).ok()?;
        let Value::String(name) = object.remove("do")? else {
            return None;
        };
        if name != "next" {
            return Command::read(name, object).map(BrowserMessage::Command);
        }
        let changes = object.remove("changes").unwrap_or(Value::Bool(false));
        let changes = changes.as_bool().filter(|_| object.is_empty())?;
        Some(BrowserMessage::Next { changes })
    }
}

/// Serves a browser after the handshake, until the browser or the server closes.
///
/// # Errors
/// Returns an error if the connection breaks.
pub(crate) fn serve(stream: TcpStream, shared: &Shared) -> Result<(), Error> {
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(POLL_INTERVAL))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(MAX_MESSAGE))
        .max_frame_size(Some(MAX_MESSAGE));
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
    socket.send(Message::Text(shared.scene.clone()))?;
    let (mut seen, mut sent) = (0, 0);
    // The last frame that this browser received; it may have skipped others.
    let mut last = Bytes::new();
    loop {
        let read = socket.read();
        // A page that asks for frames without a pause never lets a read time out.
        if shared.closing.load(Relaxed) {
            return socket.close(None);
        }
        let message = match read {
            Ok(message) => message,
            Err(Error::Io(error)) if is_timeout(&error) => continue,
            Err(error) => return Err(error),
        };
        match message {
            Message::Text(text) => match BrowserMessage::read(&text) {
                Some(BrowserMessage::Next { changes }) => {
                    let latest = shared.newer_than(seen);
                    if latest.message_count > sent {
                        sent = latest.message_count;
                        socket.send(Message::Text(latest.message))?;
                    }
                    seen = latest.number;
                    let changed = delta(&last, &latest.frame).filter(|_| changes);
                    last = latest.frame;
                    let frame = changed.map_or_else(|| last.clone(), Bytes::from);
                    socket.send(Message::Binary(frame))?;
                }
                Some(BrowserMessage::Command(command)) => match shared.commands.try_send(command) {
                    Ok(()) => {}
                    Err(TrySendError::Full(_)) => {
                        refuse(&mut socket, "the simulation is too busy to take commands")?;
                    }
                    Err(TrySendError::Disconnected(_)) => return socket.close(None),
                },
                None => refuse(&mut socket, "the viewer does not support this command")?,
            },
            Message::Binary(_) => refuse(&mut socket, "the viewer accepts no binary messages")?,
            Message::Close(_) => return Ok(()),
            Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
        }
    }
}

fn refuse(socket: &mut WebSocket<TcpStream>, why: &str) -> Result<(), Error> {
    socket.send(Message::text(json!({ "error": why }).to_string()))
}

/// Returns true if the read timed out.
fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
    )
}
