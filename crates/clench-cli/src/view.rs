//! `clench view`: a model in the browser.

use crate::interrupt::Interrupt;
use crate::limits::MemoryArguments;
use crate::message::print_message;
use crate::options::ModelArguments;
use crate::simulate::StartArguments;
use anyhow::{Context, Result};
use clap::Args;
use clench::{Batch, BatchOptions, Sim};
use clench_view::{Page, Player, Scene, Server, ServerOptions, Stepped};
use std::env;
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The number of frames per second.
const RATE: f64 = 60.0;
/// The initial maximum number of environments side by side.
const AT_FIRST: usize = 16;
/// The share of the frame interval that steps may take.
const STEPPING: f64 = 0.8;

/// Steps the model in real time and shows it in the browser: bodies, contacts, forces, and statistics of the solver. In
/// the browser you can pause, step, go back, pull bodies, set controls, and change the solver's options.
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(crate) struct Arguments {
    /// Do not open a browser; the address is printed in any case
    #[arg(long)]
    no_open: bool,
    /// Port to listen on [default: any free port]
    #[arg(
        long,
        value_name = "PORT",
        default_value_t = 0,
        hide_default_value = true
    )]
    port: u16,
    /// Address to listen on; a non-local address admits other machines that know the token
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    host: String,
    /// Start paused
    #[arg(long)]
    paused: bool,
    /// Show N environments: one of them, or up to 64 side by side; --noise or --states makes them differ
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    envs: Option<u32>,

    #[command(flatten)]
    start: StartArguments,

    #[command(flatten)]
    memory: MemoryArguments,

    // Last, because its help heading applies to all following arguments.
    #[command(flatten)]
    model: ModelArguments,
}

/// The environment variable for the token: other users of the machine could read it on the command line.
const TOKEN: &str = "CLENCH_VIEW_TOKEN";

const DETAILS: &str = "\
The address contains a random token, which is required for access. If the environment variable CLENCH_VIEW_TOKEN sets the token
(16 to 128 letters, digits, - and _), an open page reconnects to a viewer that is restarted on the same --port.
To view a remote machine, run `ssh -L 8000:127.0.0.1:8000 machine` here and `clench view MODEL --no-open --port 8000` there, and
open the printed address here. Ctrl-C ends the viewer.";

/// Shows the model until a signal arrives.
pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let (model, options) = arguments.model.load()?;
    let limit = arguments.memory.limit();
    let envs = arguments.envs.unwrap_or(1) as usize;
    let starts = arguments.start.starts(&model, envs, limit)?;
    if arguments.envs.is_none() {
        let mut sim = Sim::<f64>::with_options(Arc::clone(&model), options)?;
        starts.start(&mut sim)?;
        return show(arguments, sim, starts.keyframe);
    }
    let options = BatchOptions {
        options,
        ..BatchOptions::default()
    };
    let mut batch = Batch::<f64>::with_options(Arc::clone(&model), envs, options)?;
    starts.start_all(&mut batch)?;
    show(arguments, batch, starts.keyframe)
}

/// Steps and shows a simulation or a batch, which starts at a keyframe or not, until a signal arrives.
fn show<V: Stepped>(arguments: &Arguments, viewed: V, keyframe: Option<usize>) -> Result<ExitCode> {
    let page = Page::find(|text| print_message(text))?;
    let options = ServerOptions {
        host: arguments.host.clone(),
        port: arguments.port,
        token: env::var(TOKEN).ok(),
    };
    let scene = Scene::new(viewed.model()).of_envs(viewed.envs());
    let interrupt = Interrupt::listen()?;
    let server = Server::start(&options, page, &scene)?;
    announce(arguments, &server)?;
    let mut player = Player::new(viewed, arguments.paused);
    player.interaction().start = keyframe;
    player.interaction().selection.count = player.viewed().envs().min(AT_FIRST);
    play(player, &server, &interrupt);
    Ok(ExitCode::SUCCESS)
}

fn announce(arguments: &Arguments, server: &Server) -> Result<()> {
    let url = server.url();
    if !server.is_local() {
        print_message("note: other machines can reach the viewer, if they know the token");
    }
    writeln!(io::stdout(), "{url}").context("standard output")?;
    if !arguments.no_open && open::that_detached(&url).is_err() {
        print_message("note: no browser could be opened; open the address above");
    }
    Ok(())
}

/// Steps and publishes frame by frame, and executes the commands of users.
fn play<V: Stepped>(mut player: Player<V>, server: &Server, interrupt: &Interrupt) {
    let period = Duration::from_secs_f64(1.0 / RATE);
    let mut last = Instant::now();
    while interrupt.signal().is_none() {
        for command in server.commands() {
            // Each command may take many steps.
            if interrupt.signal().is_some() {
                return;
            }
            if let Err(why) = player.apply(command) {
                server.notify(&why);
            }
        }
        let now = Instant::now();
        if let Err(error) = player.advance(now - last, period.mul_f64(STEPPING)) {
            server.notify(&format!("paused: {error}"));
        }
        last = now;
        if server.clients() > 0 {
            match player.frame() {
                Ok(frame) => server.publish(frame),
                // Users can still rewind or reset.
                Err(error) => server.notify(&format!("the state cannot be shown: {error}")),
            }
        }
        sleep(period.saturating_sub(now.elapsed()));
    }
}
