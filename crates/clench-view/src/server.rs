//! Listens, lets browsers in, and hands each the newest frame.

use crate::command::Command;
use crate::handshake::accept_key;
use crate::http::{self, CROWDED, Request};
use crate::shared::{HEARTBEAT, News, Shared};
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

/// The most connections at a time.
pub(crate) const MAX_CLIENTS: usize = 64;
/// The most commands that wait.
const MAX_COMMANDS: usize = 1024;

/// Where a server listens.
#[derive(Clone, Debug)]
pub struct ServerOptions {
    /// Name or address; only 127.0.0.1, where this is not changed, keeps other machines out.
    pub host: String,
    /// Port; 0 for any that is free.
    pub port: u16,
    /// What the address must tell; a random one is made if none is given. One that stays the same lets pages find a server again
    /// that was started anew.
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

/// Characters of a token that is given.
const TOKEN_LENGTHS: RangeInclusive<usize> = 16..=128;

/// The token that is given, if others could not guess it and it fits into an address; else a random one.
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

/// A server that cannot start.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The port is taken, or may not be used; the host is none of this machine's.
    #[error("cannot listen at {host}, port {port}: {error}")]
    Listen {
        /// As asked for.
        host: String,
        /// As asked for.
        port: u16,
        /// What the system says.
        error: io::Error,
    },
    /// A token that others could guess, or that does not fit into an address.
    #[error("the viewer's token must have 16 to 128 letters, digits, - and _")]
    Token,
    /// The system gives no random numbers, or no threads.
    #[error("the viewer cannot start: {0}")]
    System(String),
}

/// A page, served to browsers as long as this lives.
pub struct Server {
    shared: Arc<Shared>,
    commands: Mutex<Receiver<Command>>,
    address: SocketAddr,
    listener: Option<JoinHandle<()>>,
    /// The process that the threads are of.
    process: u32,
}

impl Server {
    /// Listens.
    ///
    /// # Errors
    /// A place where one cannot listen; a token that is none; a system without random numbers.
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
            news: Mutex::new(News {
                number: 0,
                frame: Bytes::new(),
                said: 0,
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

    /// Where browsers find it, with the token.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip([127, 0, 0, 1].into());
        }
        format!("http://{address}/?token={}", self.shared.token)
    }

    /// Whether it listens to this machine alone.
    pub fn is_local(&self) -> bool {
        !self.shared.anywhere
    }

    /// How many connections there are.
    pub fn clients(&self) -> usize {
        self.shared.clients.load(Relaxed)
    }

    /// Shows a frame to all browsers, as soon as each is ready for one.
    pub fn publish(&self, frame: Vec<u8>) {
        let mut news = self.shared.news();
        news.number += 1;
        news.frame = frame.into();
        drop(news);
        self.shared.changed.notify_all();
    }

    /// Tells all browsers something, such as why a simulation has stopped.
    pub fn tell(&self, text: &str) {
        let mut news = self.shared.news();
        news.said += 1;
        news.message = json!({ "error": text }).to_string().into();
    }

    /// What users have done since this was last called.
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
        // After a fork the child has no thread to wait for, and the server is its parent's.
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
        // One that is gone already is nobody's loss.
        let Ok(mut stream) = stream else { continue };
        if shared.clients.fetch_add(1, Relaxed) >= MAX_CLIENTS {
            shared.clients.fetch_sub(1, Relaxed);
            let _ = stream.set_write_timeout(Some(HEARTBEAT));
            let _ = http::send_refusal(&mut stream, &CROWDED);
            continue;
        }
        let guest = Guest(Arc::clone(shared));
        // Without a thread to serve it the guest is dropped, and its place is free again.
        let _ = thread::Builder::new()
            .name("clench-view client".to_owned())
            .spawn(move || guest.serve(stream));
    }
}

/// A connection that counts.
struct Guest(Arc<Shared>);

impl Drop for Guest {
    fn drop(&mut self) {
        self.0.clients.fetch_sub(1, Relaxed);
    }
}

impl Guest {
    /// Serves it to its end. A connection that breaks is over; nobody needs to know.
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
