//! One browser's connection: it asks for the next frame when it has drawn the last, so that a slow one misses frames and delays
//! nobody.

use crate::command::Command;
use crate::delta::delta;
use crate::shared::Shared;
use serde::Deserialize;
use serde_json::json;
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

/// What a browser asks of its connection.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
enum Request {
    /// For the next frame, or for what has changed in it since the last one that came.
    Next {
        #[serde(default)]
        changes: bool,
    },
}

/// What a browser sends.
#[derive(Deserialize)]
#[serde(untagged)]
enum Said {
    Request(Request),
    Command(Command),
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
            Message::Text(text) => match serde_json::from_str(&text) {
                Ok(Said::Request(Request::Next { changes })) => {
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
                Ok(Said::Command(command)) => match shared.commands.try_send(command) {
                    Ok(()) => {}
                    Err(TrySendError::Full(_)) => {
                        refuse(&mut socket, "the simulation is too busy to take commands")?;
                    }
                    Err(TrySendError::Disconnected(_)) => return socket.close(None),
                },
                Err(_) => refuse(&mut socket, "this is no command that the viewer knows")?,
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
