//! The server rejects unauthorized clients, tolerates bad input, and serves many at once.

use clench::{Sim, load_str};
use clench_view::{Command, Page, Player, Scene, ServeError, Server, ServerOptions};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tungstenite::protocol::Role;
use tungstenite::{Message, WebSocket};

const BALL: &str = "<mujoco><worldbody><geom type='plane' size='1 1 1'/>
    <body name='ball' pos='0 0 0.099'><freejoint/><geom size='0.1' mass='2'/></body></worldbody></mujoco>";

fn player() -> Player<Sim<f64>> {
    let model = Arc::new(load_str(BALL).unwrap());
    Player::new(Sim::new(model).unwrap(), true)
}

/// Returns a page with a slot for data.
pub(crate) fn page() -> Page {
    let place = "<script id=\"recording\" type=\"application/json\"></script>";
    Page::of(format!("<html><body>the page{place}</body></html>")).unwrap()
}

fn server(player: &Player<Sim<f64>>) -> Server {
    Server::start(
        &ServerOptions::default(),
        page(),
        &Scene::new(player.viewed().model()),
    )
    .unwrap()
}

/// Returns the address and token of a server.
fn place(server: &Server) -> (String, String) {
    let url = server.url();
    let (address, token) = url.split_once("/?token=").unwrap();
    (
        address.strip_prefix("http://").unwrap().to_owned(),
        token.to_owned(),
    )
}

fn request(address: &str, target: &str, fields: &str) -> (TcpStream, String) {
    let mut stream = TcpStream::connect(address).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(20)))
        .unwrap();
    let head = format!("GET {target} HTTP/1.1\r\nHost: {address}\r\n{fields}\r\n");
    stream.write_all(head.as_bytes()).unwrap();
    let mut reply = Vec::new();
    let mut byte = [0];
    while !reply.ends_with(b"\r\n\r\n") && stream.read(&mut byte).unwrap_or(0) == 1 {
        reply.push(byte[0]);
    }
    (stream, String::from_utf8(reply).unwrap())
}

pub(crate) fn connect(server: &Server) -> WebSocket<TcpStream> {
    let (address, token) = place(server);
    let fields = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    let (stream, reply) = request(&address, &format!("/socket?token={token}"), fields);
    // The answer to this key is the example of RFC 6455, section 1.3.
    assert!(
        reply.starts_with("HTTP/1.1 101") && reply.contains("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="),
        "{reply}"
    );
    WebSocket::from_raw_socket(stream, Role::Client, None)
}

fn text(socket: &mut WebSocket<TcpStream>) -> String {
    loop {
        if let Message::Text(text) = socket.read().unwrap() {
            return text.to_string();
        }
    }
}

pub(crate) fn say(socket: &mut WebSocket<TcpStream>, text: &str) {
    socket.send(Message::text(text)).unwrap();
}

fn wait_for(what: impl Fn() -> bool) -> bool {
    let deadline = Instant::now() + Duration::from_secs(20);
    while Instant::now() < deadline {
        if what() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    false
}

#[test]
fn the_page_requires_the_token() {
    let server = server(&player());
    let (address, token) = place(&server);
    assert!(server.is_local() && token.len() == 32);
    let (mut stream, reply) = request(&address, &format!("/?token={token}"), "");
    assert!(reply.starts_with("HTTP/1.1 200"), "{reply}");
    let mut page = String::new();
    stream.read_to_string(&mut page).unwrap();
    assert!(page.starts_with("<html><body>the page"), "{page}");

    for (target, fields) in [
        ("/".to_owned(), ""),
        (format!("/?token={}", "0".repeat(32)), ""),
        (
            format!("/?token={token}"),
            "Origin: http://evil.example\r\n",
        ),
        ("/socket?token=".to_owned(), ""),
    ] {
        let (_, reply) = request(&address, &target, fields);
        assert!(
            reply.starts_with("HTTP/1.1 403"),
            "{target} {fields}: {reply}"
        );
    }
    assert_ne!(place(&self::server(&player())).1, token);
}

#[test]
fn frames_are_sent_on_request() {
    let mut player = player();
    let server = server(&player);
    server.publish(player.frame().unwrap());
    let mut socket = connect(&server);
    let scene = text(&mut socket);
    assert!(scene.contains("\"ball\"") && scene.contains("\"sections\""));
    say(&mut socket, r#"{"do": "next"}"#);
    let frame = socket.read().unwrap().into_data();
    assert_eq!(&frame[..4], b"CLNF");
    assert_eq!(frame.as_ref(), player.frame().unwrap());
    // Then the changes, for clients that request them.
    say(&mut socket, r#"{"do": "next", "changes": true}"#);
    let nothing = socket.read().unwrap().into_data();
    assert_eq!(&nothing[..4], b"CLND");
    assert!(nothing.len() < frame.len());
    say(&mut socket, r#"{"do": "next"}"#);
    assert_eq!(socket.read().unwrap().into_data(), frame);
}

#[test]
fn messages_that_make_no_sense_are_answered_and_change_nothing() {
    let player = player();
    let server = server(&player);
    let mut socket = connect(&server);
    text(&mut socket);
    for nonsense in [
        "",
        "{",
        "[]",
        "{\"do\": \"fly\"}",
        "{\"do\": \"step\"}",
        "{\"do\": \"step\", \"count\": -1}",
        "{\"do\": \"next\", \"more\": 1}",
        "{\"do\": \"reset\", \"more\": 1}",
    ] {
        say(&mut socket, nonsense);
        assert!(text(&mut socket).contains("error"), "{nonsense}");
    }
    socket.send(Message::binary(vec![0; 100])).unwrap();
    assert!(text(&mut socket).contains("no binary"));
    assert_eq!(server.commands(), []);
    // A message that is too long closes only its own connection.
    let _ = socket.send(Message::text("x".repeat(100_000)));
    assert!(wait_for(|| server.clients() == 0));
    text(&mut connect(&server));
}

#[test]
fn commands_that_the_model_cannot_follow_are_refused() {
    let mut player = player();
    let zeros = [0.0; 3];
    for command in [
        Command::Step { count: 0 },
        Command::Step { count: 1_000_000 },
        Command::Keyframe { index: 0 },
        Command::Speed { factor: f64::NAN },
        Command::Control {
            index: 0,
            value: 0.0,
        },
        Command::Position {
            index: 0,
            value: 0.0,
        },
        Command::Equality { index: 0, on: true },
        Command::Drag {
            body: 2,
            point: zeros,
            target: zeros,
        },
        Command::Drag {
            body: 1,
            point: [f64::INFINITY; 3],
            target: zeros,
        },
        Command::Rewind { seconds: -1.0 },
        Command::Moment { time: f64::NAN },
        Command::Turn {
            body: 1,
            target: [0.0; 4],
        },
        Command::Options {
            elliptic: None,
            iterations: Some(usize::MAX),
            tolerance: None,
            noslip_iterations: None,
        },
        Command::Options {
            elliptic: None,
            iterations: None,
            tolerance: Some(-1.0),
            noslip_iterations: None,
        },
    ] {
        assert!(player.apply(command.clone()).is_err(), "{command:?}");
    }
    assert_eq!(player.viewed().state.time, 0.0);
}

#[test]
fn a_spring_pulls_the_body_to_the_pointer() {
    let mut player = player();
    let target = [0.0, 0.0, 1.0];
    let drag = |target| Command::Drag {
        body: 1,
        point: [0.0; 3],
        target,
    };
    player.apply(drag([5.0, 0.0, 1.0])).unwrap();
    player.apply(drag(target)).unwrap();
    for _ in 0..4 {
        player.apply(Command::Step { count: 1000 }).unwrap();
    }
    // It hangs below the target by g over the spring's rate of 100 per second squared.
    let height = player.viewed().state.qpos[2];
    assert!((height - (1.0 - 9.81 / 100.0)).abs() < 1e-6, "{height}");
    player.apply(Command::Release {}).unwrap();
    assert!(player.viewed().state.xfrc_applied[1].linear.to_array() == [0.0; 3]);
    player.apply(Command::Step { count: 100 }).unwrap();
    assert!(player.viewed().state.qvel[2] < -1.0);
}

#[test]
fn a_user_can_go_back_and_the_motion_repeats() {
    let mut player = player();
    player.apply(Command::Step { count: 300 }).unwrap();
    let (time, qpos) = (
        player.viewed().state.time,
        player.viewed().state.qpos.clone(),
    );
    player.apply(Command::Step { count: 200 }).unwrap();
    player.apply(Command::Rewind { seconds: 0.4 }).unwrap();
    let back = player.viewed().state.time;
    assert!(back <= time + 1e-9 && time - back < 0.02, "{back}");
    let steps = ((time - back) / 0.002).round() as u32;
    if steps > 0 {
        player.apply(Command::Step { count: steps }).unwrap();
    }
    assert_eq!(player.viewed().state.qpos, qpos);
}

#[test]
fn a_user_can_seek_in_the_past_and_return() {
    let mut player = player();
    player.apply(Command::Step { count: 400 }).unwrap();
    let state = |player: &Player<Sim<f64>>| player.viewed().state.clone();
    let end = state(&player);
    for time in [0.5, 0.1, 0.3] {
        player.apply(Command::Moment { time }).unwrap();
        let found = player.viewed().state.time;
        assert!((found - time).abs() < 0.02, "{found} for {time}");
    }
    player.apply(Command::Moment { time: end.time }).unwrap();
    assert_eq!(state(&player).qpos, end.qpos);
    assert_eq!(state(&player).time, end.time);
    // A new future discards the recorded one.
    player.apply(Command::Moment { time: 0.3 }).unwrap();
    player.apply(Command::Step { count: 1 }).unwrap();
    let time = player.viewed().state.time;
    player.apply(Command::Moment { time: 0.7 }).unwrap();
    assert_eq!(player.viewed().state.time, time);
}

#[test]
fn a_body_is_rotated_to_the_target() {
    let free = "<mujoco><option gravity='0 0 0'/><worldbody><body><freejoint/><geom type='box' size='.1 .2 .3'/></body>
        </worldbody></mujoco>";
    let model = Arc::new(load_str(free).unwrap());
    let mut player = Player::new(Sim::<f64>::new(model).unwrap(), true);
    let target = [0.8, 0.0, 0.6, 0.0];
    player.apply(Command::Turn { body: 1, target }).unwrap();
    for _ in 0..3 {
        player.apply(Command::Step { count: 1000 }).unwrap();
    }
    let found = &player.viewed().state.qpos[3..7];
    let apart = found.iter().zip(target).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-6, "{found:?}");
    player.apply(Command::Release {}).unwrap();
    let applied = player.viewed().state.xfrc_applied[1];
    assert_eq!(applied.angular.to_array(), [0.0; 3]);
}

#[test]
fn a_token_of_ones_own_outlives_the_server_and_one_to_guess_is_refused() {
    let own = |token: &str| ServerOptions {
        token: Some(token.to_owned()),
        ..ServerOptions::default()
    };
    let start = |options: &ServerOptions| {
        let scene = Scene::new(player().viewed().model());
        Server::start(options, page(), &scene)
    };
    let kept = own("one-that-nobody_knows");
    let tokens = [0, 1].map(|_| place(&start(&kept).unwrap()).1);
    assert_eq!(tokens, ["one-that-nobody_knows"; 2]);
    for bad in [
        "short",
        "with spaces in it, many",
        "&amp;&amp;&amp;&amp;&amp;",
    ] {
        assert!(matches!(start(&own(bad)), Err(ServeError::Token)), "{bad}");
    }
}

#[test]
fn simulated_time_follows_real_time() {
    let mut player = player();
    player.apply(Command::Pause { on: false }).unwrap();
    player.apply(Command::Speed { factor: 0.5 }).unwrap();
    let long = Duration::from_secs(60);
    for _ in 0..100 {
        player.advance(Duration::from_millis(20), long).unwrap();
    }
    assert!((player.viewed().state.time - 1.0).abs() < 0.003);
    // Time that exceeds the budget is skipped, so that the page stays responsive.
    let before = player.viewed().state.time;
    player
        .advance(Duration::from_secs(3600), Duration::ZERO)
        .unwrap();
    assert_eq!(player.viewed().state.time, before);
}

#[test]
fn a_stalled_page_does_not_delay_twenty_others() {
    let mut player = player();
    let server = server(&player);
    let stalled = connect(&server);
    let clients = std::thread::scope(|scope| {
        let served: Vec<_> = (0..20)
            .map(|_| {
                scope.spawn(|| {
                    let mut socket = connect(&server);
                    text(&mut socket);
                    for _ in 0..10 {
                        say(&mut socket, r#"{"do": "next"}"#);
                        assert!(socket.read().unwrap().is_binary());
                    }
                })
            })
            .collect();
        while served.iter().any(|thread| !thread.is_finished()) {
            player.apply(Command::Step { count: 1 }).unwrap();
            server.publish(player.frame().unwrap());
            std::thread::sleep(Duration::from_millis(1));
        }
        served.into_iter().all(|thread| thread.join().is_ok())
    });
    assert!(clients);
    drop(stalled);
    assert!(wait_for(|| server.clients() == 0));
}

#[test]
fn too_many_connections_are_turned_away_politely() {
    let server = server(&player());
    let (address, token) = place(&server);
    let crowd: Vec<_> = (0..64)
        .map(|_| TcpStream::connect(&address).unwrap())
        .collect();
    assert!(wait_for(|| server.clients() == 64));
    for _ in 0..20 {
        let (stream, reply) = request(&address, &format!("/?token={token}"), "");
        assert!(reply.starts_with("HTTP/1.1 503"), "{reply}");
        let text = std::io::read_to_string(stream).expect("the connection is not reset");
        assert!(text.starts_with("Too many pages"), "{text}");
    }
    drop(crowd);
    assert!(wait_for(|| server.clients() == 0));
}

#[test]
fn a_port_in_use_is_named() {
    let first = server(&player());
    let port = place(&first).0.rsplit_once(':').unwrap().1.parse().unwrap();
    let options = ServerOptions {
        port,
        ..ServerOptions::default()
    };
    let scene = Scene::new(player().viewed().model());
    let error = Server::start(&options, page(), &scene).err().unwrap();
    assert!(matches!(error, ServeError::Listen { .. }));
    assert!(
        error
            .to_string()
            .contains(&format!("127.0.0.1, port {port}")),
        "{error}"
    );
}

#[test]
fn a_page_that_asks_without_a_pause_learns_that_the_server_closed() {
    let mut player = player();
    let server = server(&player);
    server.publish(player.frame().expect("the pendulum has a frame"));
    let mut socket = connect(&server);
    text(&mut socket);
    say(&mut socket, r#"{"do": "next"}"#);
    drop(server);
    let asked = (0..1000).find(|_| {
        let next = socket.send(Message::text(r#"{"do": "next"}"#));
        next.is_err() || !matches!(socket.read(), Ok(Message::Binary(_)))
    });
    assert!(asked.is_some(), "the closed server still answers");
}

#[test]
fn a_position_that_cannot_be_evaluated_is_not_kept() {
    let model = "<mujoco><worldbody><body><joint axis='0 1 0' stiffness='1e6'/><geom size='0.1' pos='1 0 0'/></body>
        </worldbody></mujoco>";
    let model = Arc::new(load_str(model).expect("the model is valid"));
    let mut player = Player::new(Sim::<f64>::new(model).expect("it can be simulated"), true);
    let far = Command::Position {
        index: 0,
        value: 1e10,
    };
    let refused = player
        .apply(far)
        .expect_err("the acceleration is too large");
    assert!(refused.contains("qacc[0]"), "{refused}");
    assert_eq!(player.viewed().state.qpos[0], 0.0);
    player.frame().expect("the state can still be shown");
}
