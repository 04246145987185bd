//! `rsapien actions add`.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_registry::{ActionDraft, ActionStep, ImportPolicy, Registry, RegistryError};

use super::text;
use super::transfer::tell_import;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;

/// Add a new action, from steps on the command line or from a TOML text
///
/// A step is PRIMITIVE[+PRIMITIVE...][:MS][*TIMES] with names or numbers of the paper's Table 1, which run together for
/// MS milliseconds (1000 when not given); or pause:MS; or ACTION[*TIMES]. The TOML text is what `show` prints.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions add greet right-arm-up+tilt-left:600 pause:200 wave*2 stand --tag show
  rsapien actions add --file greet.toml
  rsapien actions show wave | sed s/wave/my-wave/ | rsapien actions add --file -")]
pub(super) struct Cmd {
    /// Name of the action: lower-case letters, digits and hyphens
    #[arg(value_name = "NAME", required_unless_present = "file")]
    name: Option<String>,

    /// Its steps in their order
    #[arg(value_name = "STEP", required_unless_present = "file")]
    steps: Vec<String>,

    /// What it does, for people
    #[arg(long, value_name = "TEXT", default_value = "", conflicts_with = "file")]
    description: String,

    /// A word to find it by; may be given several times
    #[arg(long = "tag", value_name = "TAG", conflicts_with = "file")]
    tags: Vec<String>,

    /// Read the action or actions from a TOML file; `-` is the standard input
    #[arg(short, long, value_name = "FILE", conflicts_with_all = ["name", "steps"])]
    file: Option<PathBuf>,
}

impl Cmd {
    pub(super) fn run(
        self,
        context: &Context,
        mut registry: Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        if let Some(file) = &self.file {
            let report = registry.import_toml(&text::read(file)?, ImportPolicy::Refuse)?;
            return tell_import(context, out, &report);
        }
        let name = self.name.unwrap_or_default();
        match registry.get(&name) {
            Ok(_) => {
                return Err(Failure::new(format!("there is an action {name:?} already")).hint(
                    format!("change it with rsapien actions edit {name}, or choose another name"),
                ));
            }
            Err(RegistryError::UnknownAction { .. } | RegistryError::IsPrimitive { .. }) => {}
            Err(other) => return Err(other.into()),
        }
        let steps: Vec<ActionStep> = (1..)
            .zip(&self.steps)
            .map(|(number, step)| {
                ActionStep::parse_short(step)
                    .map_err(|problem| Failure::new(format!("step {number} ({step}): {problem}")))
            })
            .collect::<Result<_>>()?;
        let draft = ActionDraft { name, description: self.description, tags: self.tags, steps };
        let version = registry.save(&draft)?;
        let answer = serde_json::json!({"name": draft.name, "version": version});
        context.style.answer(out, &answer, format_args!("added {}", draft.name))?;
        Ok(Status::Done)
    }
}
