//! The subcommands, one a file.

mod actions;
mod bench_detect;
mod completions;
mod config;
mod demo;
mod detect;
mod do_primitives;
mod doctor;
mod eval;
mod init;
mod log;
mod look;
mod man;
mod play;
mod ports;
mod record;
mod replay;
mod sim;
mod snapshot;
mod state;
mod stop;
mod teach;
mod top;
mod watch;

use std::io::Write;

use clap::Subcommand;

use super::context::Context;
use super::diagnostics::Result;
use super::exit::Status;

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(demo::Cmd),
    Ports(ports::Cmd),
    Doctor(doctor::Cmd),
    State(state::Cmd),
    Top(top::Cmd),
    Init(init::Cmd),
    Stop(stop::Cmd),
    Do(do_primitives::Cmd),
    Play(play::Cmd),
    Actions(actions::Cmd),
    Teach(teach::Cmd),
    Look(look::Cmd),
    Snapshot(snapshot::Cmd),
    Detect(detect::Cmd),
    Eval(eval::Cmd),
    BenchDetect(bench_detect::Cmd),
    Watch(watch::Cmd),
    Record(Box<record::Cmd>),
    Log(log::Cmd),
    Replay(replay::Cmd),
    Sim(sim::Cmd),
    Config(config::Cmd),
    Completions(completions::Cmd),
    Man(man::Cmd),
}

impl Command {
    /// Whether it stops the motors, which nothing is to keep it from.
    pub(crate) fn is_stop(&self) -> bool {
        matches!(self, Self::Stop(_))
    }

    /// Does it.
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        match self {
            Self::Demo(cmd) => cmd.run(context, out),
            Self::Ports(cmd) => cmd.run(context, out),
            Self::Doctor(cmd) => cmd.run(context, out),
            Self::State(cmd) => cmd.run(context, out),
            Self::Top(cmd) => cmd.run(context, out),
            Self::Init(cmd) => cmd.run(context, out),
            Self::Stop(cmd) => cmd.run(context, out),
            Self::Do(cmd) => cmd.run(context, out),
            Self::Play(cmd) => cmd.run(context, out),
            Self::Actions(cmd) => cmd.run(context, out),
            Self::Teach(cmd) => cmd.run(context, out),
            Self::Look(cmd) => cmd.run(context, out),
            Self::Snapshot(cmd) => cmd.run(context, out),
            Self::Detect(cmd) => cmd.run(context, out),
            Self::Eval(cmd) => cmd.run(context, out),
            Self::BenchDetect(cmd) => cmd.run(context, out),
            Self::Watch(cmd) => cmd.run(context, out),
            Self::Record(cmd) => cmd.run(context, out),
            Self::Log(cmd) => cmd.run(context, out),
            Self::Replay(cmd) => cmd.run(context, out),
            Self::Sim(cmd) => cmd.run(context, out),
            Self::Config(cmd) => cmd.run(context, out),
            Self::Completions(cmd) => cmd.run(context, out),
            Self::Man(cmd) => cmd.run(context, out),
        }
    }
}
