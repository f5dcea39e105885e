//! One browser's connection: it asks for the next frame when it has drawn the last, so that a slow one misses frames and delays
//! nobody.

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

/// The longest message of a browser, bytes.
const MAX_MESSAGE: usize = 16 * 1024;
/// How often a connection without messages looks whether the server goes.
const LOOK: Duration = Duration::from_millis(500);
/// A browser that takes nothing for so long is given up.
const PATIENCE: Duration = Duration::from_secs(10);

/// What a browser sends: an object whose `do` says what it asks.
enum Said {
    /// The next frame, or what has changed in it since the last one that came.
    Next { changes: bool },
    /// To be done by whoever steps the simulation.
    Command(Command),
}

impl Said {
    /// None where it is no object of either kind.
    fn read(text: &str) -> Option<Self> {
        let mut object: Map<String, Value> = serde_json::from_str(text).ok()?;
        let Value::String(name) = object.remove("do")? else {
            return None;
        };
        if name != "next" {
            return Command::read(name, object).map(Said::Command);
        }
        let changes = object.remove("changes").unwrap_or(Value::Bool(false));
        let changes = changes.as_bool().filter(|_| object.is_empty())?;
        Some(Said::Next { changes })
    }
}

/// Serves a browser after the handshake, until one of both goes.
///
/// # Errors
/// A connection that breaks.
pub(crate) fn serve(stream: TcpStream, shared: &Shared) -> Result<(), Error> {
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(LOOK))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(MAX_MESSAGE))
        .max_frame_size(Some(MAX_MESSAGE));
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
    socket.send(Message::Text(shared.scene.clone()))?;
    let (mut seen, mut told) = (0, 0);
    // What this browser has got last, whatever it missed before.
    let mut last = Bytes::new();
    loop {
        let message = match socket.read() {
            Ok(message) => message,
            Err(Error::Io(error)) if is_pause(&error) => {
                if shared.closing.load(Relaxed) {
                    return socket.close(None);
                }
                continue;
            }
            Err(error) => return Err(error),
        };
        match message {
            Message::Text(text) => match Said::read(&text) {
                Some(Said::Next { changes }) => {
                    let news = shared.newer_than(seen);
                    if news.said > told {
                        told = news.said;
                        socket.send(Message::Text(news.message))?;
                    }
                    seen = news.number;
                    let changed = delta(&last, &news.frame).filter(|_| changes);
                    last = news.frame;
                    let frame = changed.map_or_else(|| last.clone(), Bytes::from);
                    socket.send(Message::Binary(frame))?;
                }
                Some(Said::Command(command)) => match shared.commands.try_send(command) {
                    Ok(()) => {}
                    Err(TrySendError::Full(_)) => {
                        refuse(&mut socket, "the simulation is too busy to take commands")?;
                    }
                    Err(TrySendError::Disconnected(_)) => return socket.close(None),
                },
                None => refuse(&mut socket, "this is no command that the viewer knows")?,
            },
            Message::Binary(_) => refuse(&mut socket, "the viewer takes no binary messages")?,
            Message::Close(_) => return Ok(()),
            Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
        }
    }
}

fn refuse(socket: &mut WebSocket<TcpStream>, why: &str) -> Result<(), Error> {
    socket.send(Message::text(json!({ "error": why }).to_string()))
}

/// Nothing came in time.
fn is_pause(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
    )
}
