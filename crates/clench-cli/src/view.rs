//! `clench view`: a model in the browser.

use crate::interrupt::Interrupt;
use crate::message::tell;
use crate::options::ModelArguments;
use crate::simulate::find_keyframe;
use anyhow::Result;
use clap::Args;
use clench::Sim;
use clench_view::{Page, Player, Scene, Server, ServerOptions};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Frames a second.
const RATE: f64 = 60.0;
/// The share of the time between frames that may go into steps.
const STEPPING: f64 = 0.8;

/// Steps the model in real time and shows it in the browser: bodies, contacts, forces, and how the solver does. There one can
/// pause, step, go back, pull bodies, set controls, and change the solver's options.
#[derive(Args)]
#[command(after_help = DETAILS)]
pub struct Arguments {
    /// Do not open a browser; the address is printed in any case
    #[arg(long)]
    no_open: bool,
    /// Port to listen at [default: any that is free]
    #[arg(
        long,
        value_name = "PORT",
        default_value_t = 0,
        hide_default_value = true
    )]
    port: u16,
    /// Address to listen at; another one lets other machines in that know the token
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    host: String,
    /// Stand still at first
    #[arg(long)]
    paused: bool,
    /// Start from this keyframe (name or index)
    #[arg(long, value_name = "K")]
    keyframe: Option<String>,

    #[command(flatten)]
    model: ModelArguments,
}

const DETAILS: &str = "\
On a remote machine: `ssh -L 8000:127.0.0.1:8000 machine` here, `clench view MODEL --no-open --port 8000` there, and open the
printed address here. Ctrl-C ends it.";

/// Shows the model until a signal comes.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let (model, options) = arguments.model.load()?;
    let mut sim = Sim::<f64>::with_options(model.clone(), options)?;
    if let Some(key) = &arguments.keyframe {
        sim.reset_to_keyframe(find_keyframe(&model, key)?)?;
    }
    let page = Page::find(|text| tell(text))?;
    let place = ServerOptions {
        host: arguments.host.clone(),
        port: arguments.port,
    };
    let interrupt = Interrupt::listen()?;
    let server = Server::start(&place, page, &Scene::new(&model))?;
    announce(arguments, &server);
    play(Player::new(sim, arguments.paused), &server, &interrupt);
    Ok(ExitCode::SUCCESS)
}

fn announce(arguments: &Arguments, server: &Server) {
    let url = server.url();
    if !server.is_local() {
        tell("note: other machines can reach the viewer, if they know the token");
    }
    println!("{url}");
    if !arguments.no_open && open::that_detached(&url).is_err() {
        tell("note: no browser could be opened; open the address above");
    }
}

/// Steps and shows, frame by frame, and does what users do.
fn play(mut player: Player, server: &Server, interrupt: &Interrupt) {
    let period = Duration::from_secs_f64(1.0 / RATE);
    let mut last = Instant::now();
    while interrupt.signal().is_none() {
        for command in server.commands() {
            if let Err(why) = player.apply(command) {
                server.tell(&why);
            }
        }
        let now = Instant::now();
        if let Err(error) = player.advance(now - last, period.mul_f64(STEPPING)) {
            server.tell(&format!("paused: {error}"));
        }
        last = now;
        if server.clients() > 0 {
            match player.frame() {
                Ok(frame) => server.publish(frame),
                // One can still go back, or reset.
                Err(error) => server.tell(&format!("nothing to show: {error}")),
            }
        }
        sleep(period.saturating_sub(now.elapsed()));
    }
}
