//! `rsapien teach`: an action made by moving the robot.

mod draw;
mod model;

use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_protocol::BumperMask;
use rsapien_registry::check::{self, check_text};
use rsapien_registry::{ImportPolicy, NoActions, Registry};

use self::model::{Checked, Teach};
use super::actions::save::save_text;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::output::Screen;
use crate::cli::registry::RegistryOptions;
use crate::cli::robot::{self, PaceOptions};
use crate::cli::screen::{self, parts::Palette};

/// Make an action by moving the robot: nudge joints with keys, mark steps with Enter or a bumper
///
/// A screen shows the joints and the action as it grows. Left and right send the chosen joint one position further, and the
/// robot moves at once; Enter, or a press of a hand bumper, marks the step: what was moved since the last mark starts
/// together, and lasts as long as it really took, to the next 50 ms, at least until the joints can have arrived. w checks
/// the action, tries it on the virtual body and saves it. Nothing that was taught is lost: what is not saved is kept in a
/// file NAME.rsa.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien teach greet --link virtual
  rsapien teach greet --mark-with left-hand
  rsapien actions add --file greet.rsa    saves what was kept in a file")]
pub(crate) struct Cmd {
    /// Name of the action
    #[arg(value_name = "NAME")]
    name: String,

    /// Bumpers whose press marks a step; without it, either hand
    #[arg(long, value_name = "BUMPER", value_parser = bumper)]
    mark_with: Vec<usize>,

    /// Save it as a new version, if there is an action of this name already
    #[arg(long)]
    replace: bool,

    #[command(flatten)]
    registry: RegistryOptions,
}

/// Left and right hand.
const HANDS: [usize; 2] = [4, 5];

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let instead = "write the action as a text: rsapien actions edit, or docs/actions.md";
        screen::check(context, "rsapien teach", instead)?;
        let mut registry = self.registry.open(context)?;
        self.check_name(&registry)?;
        let open = robot::open(context, "teach", PaceOptions::default())?;
        drop(open.ready_motion(context, out)?);
        let marks = if self.mark_with.is_empty() { &HANDS[..] } else { &self.mark_with };
        let bits = marks.iter().fold(0, |bits, index| bits | (1 << index));
        let palette = Palette { is_colored: context.style.output == Screen::Color };
        let (shown, taught) = {
            let check = |text: &str| checked(&registry, text, &self.name);
            let marks = BumperMask::from_low_bits(bits);
            let mut teach = Teach::new(&self.name, marks, &check, palette);
            (screen::run(&open, &registry, &mut teach), teach.taught())
        };
        drop(open);
        let Some((text, is_to_be_saved)) = taught else {
            shown?;
            context.style.remark(out, "nothing was taught")?;
            return Ok(Status::Refused);
        };
        let saved = shown.and_then(|()| {
            if !is_to_be_saved {
                return Ok(None);
            }
            let policy = if self.replace { ImportPolicy::Replace } else { ImportPolicy::Refuse };
            let file_name = format!("{}.rsa", self.name);
            save_text(context, &mut registry, &text, &file_name, policy).map(Some)
        });
        match saved {
            Ok(Some(report)) => {
                let what = if report.added.is_empty() { "new version of" } else { "added" };
                context.style.remark(out, format!("{what} {}", self.name))?;
                Ok(Status::Done)
            }
            unsaved => {
                let path = keep(&self.name, &text)?;
                let path = path.display();
                let told = format!(
                    "what was taught is in {path}; rsapien actions add --file {path} saves it"
                );
                if let Err(failure) = unsaved {
                    return Err(failure.hint(told));
                }
                context.style.remark(out, told)?;
                Ok(Status::Refused)
            }
        }
    }

    /// Refuses a name under which nothing could be saved, before anything is taught.
    fn check_name(&self, registry: &Registry) -> Result<()> {
        let name = &self.name;
        let checked = check_text(&format!("action {name} {{ do tilt-mid }}"), &NoActions);
        let finding = checked.findings.errors().next();
        if let Some(finding) = finding {
            return Err(Failure::new(finding.in_words()));
        }
        if !self.replace && registry.list()?.iter().any(|known| known.name == *name) {
            return Err(Failure::new(format!("there is an action {name} already"))
                .hint("--replace saves a new version of it; the old one is kept"));
        }
        Ok(())
    }
}

/// What the checker says of a text, in lines.
fn checked(registry: &Registry, text: &str, name: &str) -> Checked {
    match registry.check_text(text) {
        Ok(checked) => Checked {
            lines: check::render(&checked.findings, &format!("{name}.rsa"), false)
                .lines()
                .map(str::to_owned)
                .collect(),
            has_errors: checked.findings.has_errors(),
            compiled: checked.actions.into_iter().last().and_then(|action| action.compiled),
        },
        Err(error) => Checked { lines: vec![error.to_string()], has_errors: true, compiled: None },
    }
}

/// Writes a text to a file of its own in the working folder.
fn keep(name: &str, text: &str) -> Result<PathBuf> {
    for number in 1..=1000 {
        let path = if number == 1 { format!("{name}.rsa") } else { format!("{name}-{number}.rsa") };
        let path = PathBuf::from(path);
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(mut file) => {
                file.write_all(text.as_bytes())
                    .map_err(|error| Failure::file("write", &path, &error))?;
                return Ok(path);
            }
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => {
                // The last way that is left.
                return Err(Failure::file("write", &path, &error).hint(text.to_owned()));
            }
        }
    }
    Err(Failure::new(format!("{name}.rsa and a thousand more are there already"))
        .hint(text.to_owned()))
}

/// The bumper of a name.
fn bumper(text: &str) -> std::result::Result<usize, String> {
    let names = BumperMask::NAMES;
    let found = names.iter().position(|name| *name == text);
    found.ok_or_else(|| format!("expected one of {}", names.join(", ")))
}
