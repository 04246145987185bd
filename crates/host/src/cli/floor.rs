//! Where `play` and `do` play: on a robot of their own, or on that of a program which holds the line.

use std::io::Write;
use std::time::Duration;

use clap::{Args, ValueEnum};
use rsapien_registry::CompiledAction;

use super::context::Context;
use super::diagnostics::{Failure, Result};
use super::output::json_line;
use super::robot::{self, OpenRobot, PaceOptions};
use super::signal::Interrupt;
use crate::sharing::{Desk, Guest};
use crate::{Admission, CancelToken, Claim, PlayOptions, PlayReport, Policy, Stage, Terms, data};

/// Options of the commands that play.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct PolicyOptions {
    /// What happens when the robot is already playing something, for this program or another
    #[arg(long, value_name = "POLICY", value_enum, default_value_t)]
    policy: PolicyWord,

    /// With --json: tell how far it is, too, in a line whenever that changes
    #[arg(long)]
    pub(crate) progress: bool,
}

/// A policy as a word of the command line.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum PolicyWord {
    /// Nothing: the action is refused
    #[default]
    Refuse,
    /// It waits until what is played has ended
    Queue,
    /// What is played ends, motors off, and it begins
    Replace,
    /// It is played beside the other if no joint is in both; otherwise it is refused
    Merge,
}

impl From<PolicyOptions> for Policy {
    fn from(options: PolicyOptions) -> Policy {
        match options.policy {
            PolicyWord::Refuse => Policy::Refuse,
            PolicyWord::Queue => Policy::Queue,
            PolicyWord::Replace => Policy::Replace,
            PolicyWord::Merge => Policy::Merge,
        }
    }
}

/// Where an action is played.
pub(crate) enum Floor {
    /// This program holds the line, and plays for others too.
    Own { open: Box<OpenRobot>, stage: Stage, desk: Option<Desk> },
    /// Another program holds it.
    Guest { guest: Box<Guest>, interrupt: Interrupt, cancel: CancelToken },
}

impl Floor {
    /// The robot, ready to move; or a place as guest at the program that holds its line.
    pub(crate) fn take(
        context: &Context,
        out: &mut impl Write,
        command: &str,
        pace: PaceOptions,
    ) -> Result<Floor> {
        let address = robot::address(context)?;
        // Of what goes over another program's line, nothing can be recorded here.
        if let (Some(folder), None) = (data::lock_folder(), &context.recording) {
            let program = format!("rsapien {command}");
            if let Some(guest) = Guest::find(&address, context.baud, &folder, &program)? {
                let interrupt = Interrupt::install()?;
                let cancel = CancelToken::new();
                let token = cancel.clone();
                interrupt.stop_first(move || {
                    token.cancel();
                    true
                });
                return Ok(Floor::Guest { guest: Box::new(guest), interrupt, cancel });
            }
        }
        let open = robot::open_at(context, &address, command, pace)?;
        let motion = open.ready_motion(context, out)?;
        let stage = Stage::new(motion)?;
        // What is recorded is to be what was asked for, and nothing beside it.
        let desk = match context.recording {
            Some(_) => None,
            None => Desk::open(&open.robot, &stage)?,
        };
        Ok(Floor::Own { open: Box::new(open), stage, desk })
    }

    pub(crate) fn own(&self) -> Option<&OpenRobot> {
        match self {
            Floor::Own { open, .. } => Some(open),
            Floor::Guest { .. } => None,
        }
    }

    pub(crate) fn interrupt(&self) -> Interrupt {
        match self {
            Floor::Own { open, .. } => open.interrupt,
            Floor::Guest { interrupt, .. } => *interrupt,
        }
    }

    pub(crate) fn cancel(&self) -> &CancelToken {
        match self {
            Floor::Own { open, .. } => &open.cancel,
            Floor::Guest { cancel, .. } => cancel,
        }
    }

    /// What stops what is played here, from another thread.
    pub(crate) fn stopper(&self) -> Box<dyn Fn() + Send> {
        match self {
            Floor::Own { open, .. } => {
                let stop = open.robot.stop_handle();
                Box::new(move || {
                    // Without an answer, the dead-man is left to stop it.
                    let _ = stop.stop();
                })
            }
            Floor::Guest { cancel, .. } => {
                let cancel = cancel.clone();
                Box::new(move || cancel.cancel())
            }
        }
    }

    /// Plays `action`; tells `on_admission` what becomes of it first.
    pub(crate) fn play(
        &mut self,
        action: &CompiledAction,
        policy: Policy,
        options: &mut PlayOptions<'_>,
        on_admission: &mut dyn FnMut(&Admission),
    ) -> Result<PlayReport> {
        let interrupt = self.interrupt();
        let played = match self {
            Floor::Own { stage, .. } => {
                let terms = Terms { policy, guest: None };
                stage.play(action, &terms, options, on_admission)
            }
            Floor::Guest { guest, .. } => guest.play(action, policy, options, on_admission),
        };
        match played {
            Err(_) if interrupt.is_raised() => Err(Failure::interrupted()),
            played => Ok(played?),
        }
    }

    /// Stays until everything has ended that guests play over this line.
    pub(crate) fn wait_for_guests(&self, context: &Context, out: &mut impl Write) -> Result<()> {
        let Floor::Own { open, stage, desk: Some(_) } = self else { return Ok(()) };
        let mut told: Vec<Claim> = Vec::new();
        loop {
            let (playing, waiting) = stage.claims();
            let claims: Vec<Claim> = playing.into_iter().chain(waiting).collect();
            if claims.is_empty() {
                return Ok(());
            }
            if let Some(new) = claims.iter().find(|claim| !told.contains(claim)) {
                let text = format!("the line stays open for {new}; Ctrl-C ends it");
                context.style.remark(out, text)?;
                told.push(new.clone());
            }
            open.interrupt.wait(Duration::from_millis(50))?;
        }
    }
}

/// Tells what becomes of an action where there are others.
pub(crate) fn tell(
    context: &Context,
    out: &mut impl Write,
    name: &str,
    admission: &Admission,
    has_waited: bool,
) -> Result<()> {
    let (word, claims): (&str, &[Claim]) = match admission {
        Admission::Begins if !has_waited => return Ok(()),
        Admission::Begins => ("begins", &[]),
        Admission::Waits { behind } => ("waits", behind),
        Admission::Replaces { ended } => ("replaces", ended),
        Admission::Beside { others } => ("beside", others),
    };
    if !context.style.json {
        return context.style.remark(out, format!("{name}: {admission}"));
    }
    let claims: Vec<serde_json::Value> = claims
        .iter()
        .map(|claim| {
            let joints = claim.common(claim).into_iter().map(rsapien_protocol::Joint::name);
            serde_json::json!({
                "action": claim.action,
                "program": claim.program,
                "pid": claim.pid,
                "joints": joints.collect::<Vec<_>>(),
            })
        })
        .collect();
    json_line(out, &serde_json::json!({ "admission": word, "action": name, "claims": claims }))
}
