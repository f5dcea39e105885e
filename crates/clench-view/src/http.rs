//! Requests of browsers: checks token and origin. The subset of HTTP/1.1 that a page and a WebSocket need.
//!
//! A page on the web may try to reach a viewer on its reader's machine. It does not know the token. In addition, a
//! request is refused before the token is checked if the browser reports that it comes from another page (`Origin`), or
//! under a name that is not this machine's (`Host`, after DNS rebinding).

use std::io::{self, Read, Write};
use std::net::{IpAddr, Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// The maximum length of the head of a request, bytes.
const MAX_HEAD: usize = 16 * 1024;
/// The maximum number of header fields of a request.
const MAX_FIELDS: usize = 64;
/// The time limit for the head of a request.
const PATIENCE: Duration = Duration::from_secs(5);
/// The time that a refused client has to send the rest of its request.
const LINGER: Duration = Duration::from_millis(100);

/// The content of a valid request.
#[derive(Debug, PartialEq)]
pub(crate) enum Request {
    /// The page.
    Page,
    /// A WebSocket, with the key of its handshake.
    Socket(String),
}

/// A refused request: the status and the text of the reply.
#[derive(Debug, PartialEq)]
pub(crate) struct Refusal(pub &'static str, pub &'static str);

const BAD: Refusal = Refusal(
    "400 Bad Request",
    "The viewer does not support this request.",
);
const FOREIGN: Refusal = Refusal(
    "403 Forbidden",
    "The viewer answers only its own page, at an address of the machine that it runs on.",
);
const NO_TOKEN: Refusal = Refusal(
    "403 Forbidden",
    "The token is wrong: open the whole address that the program printed. Each start creates a new token.",
);
const UNKNOWN: Refusal = Refusal("404 Not Found", "There is nothing here.");
const METHOD: Refusal = Refusal("405 Method Not Allowed", "Only GET is allowed.");
/// The reply to a client above the maximum number.
pub(crate) const CROWDED: Refusal = Refusal(
    "503 Service Unavailable",
    "Too many pages are connected to this viewer.",
);

/// Reads and validates the head of a request.
///
/// # Errors
/// Returns an error if the connection breaks or is too slow; the inner result is an error if the request is refused.
pub(crate) fn read_request(
    stream: &mut TcpStream,
    token: &str,
    anywhere: bool,
) -> io::Result<Result<Request, Refusal>> {
    let deadline = Instant::now() + PATIENCE;
    let mut head = Vec::new();
    let mut piece = [0; 2048];
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        if head.len() > MAX_HEAD {
            return Ok(Err(BAD));
        }
        let remaining = deadline.saturating_duration_since(Instant::now());
        if remaining.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(remaining))?;
        match stream.read(&mut piece)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            count => head.extend(&piece[..count]),
        }
    }
    Ok(parse(&head, token, anywhere))
}

fn parse(head: &[u8], token: &str, anywhere: bool) -> Result<Request, Refusal> {
    let mut fields = [httparse::EMPTY_HEADER; MAX_FIELDS];
    let mut request = httparse::Request::new(&mut fields);
    match request.parse(head) {
        Ok(status) if status.is_complete() => {}
        _ => return Err(BAD),
    }
    let field = |name: &str| {
        let mut found = (request.headers.iter()).filter(|f| f.name.eq_ignore_ascii_case(name));
        let first = found.next()?;
        // A duplicated field is ambiguous.
        let text = std::str::from_utf8(first.value).ok()?.trim();
        found.next().is_none().then_some(text)
    };
    if request.method != Some("GET") {
        return Err(METHOD);
    }
    let host = field("host").ok_or(BAD)?;
    if !is_ours(host, anywhere) {
        return Err(FOREIGN);
    }
    let same = |origin: &str| {
        ["http://", "https://"]
            .iter()
            .any(|s| origin.strip_prefix(s) == Some(host))
    };
    if request
        .headers
        .iter()
        .any(|f| f.name.eq_ignore_ascii_case("origin"))
        && !field("origin").is_some_and(same)
    {
        return Err(FOREIGN);
    }
    let target = request.path.ok_or(BAD)?;
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    if !matches!(path, "/" | "/socket") {
        return Err(UNKNOWN);
    }
    let sent = query
        .split('&')
        .find_map(|part| part.strip_prefix("token="));
    if !sent.is_some_and(|sent| same_token(sent, token)) {
        return Err(NO_TOKEN);
    }
    if path == "/" {
        return Ok(Request::Page);
    }
    let upgrades = field("upgrade").is_some_and(|to| to.eq_ignore_ascii_case("websocket"));
    match field("sec-websocket-key") {
        Some(key) if upgrades && field("sec-websocket-version") == Some("13") => {
            Ok(Request::Socket(key.to_owned()))
        }
        _ => Err(BAD),
    }
}

/// Returns true if a `Host` names this machine: a loopback address or name, or any numeric address if the server
/// accepts other machines.
fn is_ours(host: &str, anywhere: bool) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
        _ => host,
    };
    let number = name.trim_start_matches('[').trim_end_matches(']');
    match number.parse::<IpAddr>() {
        Ok(address) => anywhere || address.is_loopback(),
        Err(_) => name.eq_ignore_ascii_case("localhost"),
    }
}

/// Compares in a time that does not depend on the first difference.
fn same_token(sent: &str, token: &str) -> bool {
    let differing = sent.bytes().zip(token.bytes()).map(|(a, b)| a ^ b);
    sent.len() == token.len() && differing.fold(0, |all, bits| all | bits) == 0
}

/// Sends the page.
///
/// # Errors
/// Returns an error if the connection breaks.
pub(crate) fn send_page(stream: &mut TcpStream, html: &str) -> io::Result<()> {
    send(stream, "200 OK", "text/html; charset=utf-8", html)
}

/// Sends the reason of a refusal, and reads what the client still sends. A connection that is closed with unread data
/// is reset, and the client may lose the reply.
///
/// # Errors
/// Returns an error if the connection breaks.
pub(crate) fn send_refusal(
    stream: &mut TcpStream,
    Refusal(status, text): &Refusal,
) -> io::Result<()> {
    send(stream, status, "text/plain; charset=utf-8", text)?;
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(LINGER))?;
    // A client that sends nothing, or more than this, is not waited for.
    let _ = stream.read(&mut [0; MAX_HEAD]);
    Ok(())
}

fn send(stream: &mut TcpStream, status: &str, kind: &str, body: &str) -> io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
         Referrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\nContent-Security-Policy: default-src 'none'; \
         script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self'\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body.as_bytes())?;
    stream.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOKEN: &str = "0123456789abcdef";

    fn respond(line: &str, fields: &str) -> Result<Request, Refusal> {
        let head = format!("{line} HTTP/1.1\r\n{fields}\r\n");
        parse(head.as_bytes(), TOKEN, false)
    }

    fn page(fields: &str) -> Result<Request, Refusal> {
        respond(&format!("GET /?token={TOKEN}"), fields)
    }

    #[test]
    fn the_page_is_for_this_machine_alone() {
        for host in ["127.0.0.1:8000", "localhost:9", "LOCALHOST", "[::1]:80"] {
            assert_eq!(
                page(&format!("Host: {host}\r\n")),
                Ok(Request::Page),
                "{host}"
            );
        }
        for host in [
            "evil.example",
            "evil.example:8000",
            "192.168.0.9:8000",
            "localhost.evil.example",
        ] {
            assert_eq!(page(&format!("Host: {host}\r\n")), Err(FOREIGN), "{host}");
        }
        assert_eq!(page(""), Err(BAD));
        assert_eq!(page("Host: localhost\r\nHost: evil.example\r\n"), Err(BAD));
    }

    #[test]
    fn other_pages_are_refused() {
        let from = |origin: &str| page(&format!("Host: localhost:80\r\nOrigin: {origin}\r\n"));
        assert_eq!(from("http://localhost:80"), Ok(Request::Page));
        for origin in [
            "http://evil.example",
            "null",
            "http://localhost:81",
            "localhost:80",
            "http://localhost:80.evil.example",
        ] {
            assert_eq!(from(origin), Err(FOREIGN), "{origin}");
        }
    }

    #[test]
    fn access_requires_the_token() {
        let host = "Host: localhost\r\n";
        for target in [
            "/",
            "/?token=",
            "/?token=0123456789abcdeg",
            "/?token=0123456789abcdef0",
            "/socket?x=1",
        ] {
            assert_eq!(
                respond(&format!("GET {target}"), host),
                Err(NO_TOKEN),
                "{target}"
            );
        }
        assert_eq!(respond("GET /etc/passwd", host), Err(UNKNOWN));
        assert_eq!(respond(&format!("POST /?token={TOKEN}"), host), Err(METHOD));
    }

    #[test]
    fn a_socket_needs_its_handshake() {
        let socket = format!("GET /socket?token={TOKEN}");
        let whole = "Host: localhost\r\nUpgrade: WebSocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: abc\r\n";
        assert_eq!(respond(&socket, whole), Ok(Request::Socket("abc".into())));
        assert_eq!(respond(&socket, "Host: localhost\r\n"), Err(BAD));
    }
}
