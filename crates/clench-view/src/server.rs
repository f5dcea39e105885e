//! A server that accepts browsers and sends each the latest frame.

use crate::command::Command;
use crate::handshake::accept_key;
use crate::http::{self, CROWDED, Request};
use crate::shared::{HEARTBEAT, Latest, Shared};
use crate::{Page, Scene, socket};
use serde_json::json;
use std::io::{self, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::ops::RangeInclusive;
use std::process;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use tungstenite::{Bytes, Utf8Bytes};

/// The maximum number of connections.
pub(crate) const MAX_CLIENTS: usize = 64;
/// The maximum number of pending commands.
const MAX_COMMANDS: usize = 1024;

/// The address and token of a server.
#[derive(Clone, Debug)]
pub struct ServerOptions {
    /// The name or address; only the default 127.0.0.1 excludes other machines.
    pub host: String,
    /// The port; 0 for any free port.
    pub port: u16,
    /// The token that the URL must contain; `None` for a random one. With a fixed token, pages find a restarted server
    /// again.
    pub token: Option<String>,
}

impl Default for ServerOptions {
    fn default() -> Self {
        ServerOptions {
            host: "127.0.0.1".to_owned(),
            port: 0,
            token: None,
        }
    }
}

/// The valid lengths of a given token.
const TOKEN_LENGTHS: RangeInclusive<usize> = 16..=128;

/// Validates the given token, which must be hard to guess and fit into a URL; otherwise creates a random one.
fn token(given: Option<&str>) -> Result<String, ServeError> {
    if let Some(token) = given {
        let plain = token
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_');
        if !plain || !TOKEN_LENGTHS.contains(&token.len()) {
            return Err(ServeError::Token);
        }
        return Ok(token.to_owned());
    }
    let mut random = [0_u8; 16];
    getrandom::fill(&mut random).map_err(|error| ServeError::System(error.to_string()))?;
    Ok(random.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// An error of starting a server.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The port is in use or not permitted, or the host does not belong to this machine.
    #[error("cannot listen at {host}, port {port}: {error}")]
    Listen {
        /// The requested host.
        host: String,
        /// The requested port.
        port: u16,
        /// The error of the system.
        error: io::Error,
    },
    /// The token is easy to guess, or does not fit into a URL.
    #[error("the viewer's token (CLENCH_VIEW_TOKEN) must have 16 to 128 letters, digits, - and _")]
    Token,
    /// The system provides no random numbers or no threads.
    #[error("the viewer cannot start: {0}")]
    System(String),
}

/// A server of the page; dropping it stops it.
pub struct Server {
    shared: Arc<Shared>,
    commands: Mutex<Receiver<Command>>,
    address: SocketAddr,
    listener: Option<JoinHandle<()>>,
    /// The process that owns the threads.
    process: u32,
}

impl Server {
    /// Starts listening.
    ///
    /// # Errors
    /// Returns an error if the address cannot be used, the token is invalid or the system lacks random numbers or
    /// threads.
    pub fn start(options: &ServerOptions, page: Page, scene: &Scene) -> Result<Self, ServeError> {
        let refused = |error| ServeError::Listen {
            host: options.host.clone(),
            port: options.port,
            error,
        };
        let listener = TcpListener::bind((options.host.as_str(), options.port)).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let token = token(options.token.as_deref())?;
        let (sender, commands) = sync_channel(MAX_COMMANDS);
        let shared = Arc::new(Shared {
            page,
            scene: scene.to_json().into(),
            token,
            anywhere: !address.ip().is_loopback(),
            latest: Mutex::new(Latest {
                number: 0,
                frame: Bytes::new(),
                message_count: 0,
                message: Utf8Bytes::default(),
            }),
            changed: Condvar::new(),
            commands: sender,
            clients: AtomicUsize::new(0),
            closing: AtomicBool::new(false),
        });
        let accepting = Arc::clone(&shared);
        let listener = thread::Builder::new()
            .name("clench-view".to_owned())
            .spawn(move || accept(&listener, &accepting))
            .map_err(|error| ServeError::System(error.to_string()))?;
        Ok(Server {
            shared,
            commands: Mutex::new(commands),
            address,
            listener: Some(listener),
            process: process::id(),
        })
    }

    /// Returns the URL for browsers, with the token.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip([127, 0, 0, 1].into());
        }
        format!("http://{address}/?token={}", self.shared.token)
    }

    /// Returns true if only this machine can connect.
    pub fn is_local(&self) -> bool {
        !self.shared.anywhere
    }

    /// Returns the number of connections.
    pub fn clients(&self) -> usize {
        self.shared.clients.load(Relaxed)
    }

    /// Publishes a frame to all browsers; each receives it when it is ready.
    pub fn publish(&self, frame: Vec<u8>) {
        let mut latest = self.shared.latest();
        latest.number += 1;
        latest.frame = frame.into();
        drop(latest);
        self.shared.changed.notify_all();
    }

    /// Sends a message to all browsers, such as why a simulation has stopped.
    pub fn notify(&self, text: &str) {
        let mut latest = self.shared.latest();
        latest.message_count += 1;
        latest.message = json!({ "error": text }).to_string().into();
    }

    /// Returns the commands since the last call.
    pub fn commands(&self) -> Vec<Command> {
        let commands = self.commands.lock();
        commands
            .unwrap_or_else(PoisonError::into_inner)
            .try_iter()
            .collect()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // After a fork the child has no thread to join, and its parent owns the server.
        if process::id() != self.process {
            return;
        }
        self.shared.closing.store(true, Relaxed);
        self.shared.changed.notify_all();
        // A connection wakes the thread that waits for one.
        let woken = TcpStream::connect_timeout(&self.address, Duration::from_secs(1));
        if let Some(listener) = self.listener.take().filter(|_| woken.is_ok()) {
            let _ = listener.join();
        }
    }
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    for stream in listener.incoming() {
        if shared.closing.load(Relaxed) {
            return;
        }
        // A connection that is closed already is skipped.
        let Ok(mut stream) = stream else { continue };
        if shared.clients.fetch_add(1, Relaxed) >= MAX_CLIENTS {
            shared.clients.fetch_sub(1, Relaxed);
            let _ = stream.set_write_timeout(Some(HEARTBEAT));
            let _ = http::send_refusal(&mut stream, &CROWDED);
            continue;
        }
        let guest = Guest(Arc::clone(shared));
        // If the thread cannot start, the guest is dropped, which releases its slot.
        let _ = thread::Builder::new()
            .name("clench-view client".to_owned())
            .spawn(move || guest.serve(stream));
    }
}

/// A counted connection.
struct Guest(Arc<Shared>);

impl Drop for Guest {
    fn drop(&mut self) {
        self.0.clients.fetch_sub(1, Relaxed);
    }
}

impl Guest {
    /// Serves the connection until it ends. Errors of the connection are ignored.
    fn serve(self, mut stream: TcpStream) {
        let shared = &*self.0;
        let Ok(request) = http::read_request(&mut stream, &shared.token, shared.anywhere) else {
            return;
        };
        let _ = match request {
            Err(refusal) => http::send_refusal(&mut stream, &refusal),
            Ok(Request::Page) => http::send_page(&mut stream, shared.page.html()),
            Ok(Request::Socket(key)) => {
                let accept = accept_key(&key);
                let reply = format!(
                    "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
                     Sec-WebSocket-Accept: {accept}\r\n\r\n"
                );
                if stream.write_all(reply.as_bytes()).is_ok() {
                    let _ = socket::serve(stream, shared);
                }
                Ok(())
            }
        };
    }
}
