//! `rsapien actions add`.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_registry::check::check_name;
use rsapien_registry::language::Word;
use rsapien_registry::{
    ActionDraft, ImportPolicy, Registry, RegistryError, Statement, print_action,
};

use super::save;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;

/// Add a new action, from steps on the command line or from a text
///
/// A step is PRIMITIVE[+PRIMITIVE...][:MS][*TIMES] with names or numbers of the paper's Table 1, which run together for
/// MS milliseconds (1000 when not given); or pause:MS; or ACTION[*TIMES]. The text is in the action language (docs/actions.md).
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions add greet right-arm-up+tilt-left:600 pause:200 wave*2 stand --tag show
  rsapien actions add --file greet.rsa
  rsapien actions export wave | sed s/wave/my-wave/ | rsapien actions add --file -")]
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

    /// Read the action or actions from a file; `-` is the standard input
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
            return save::save(context, &mut registry, out, file, ImportPolicy::Refuse);
        }
        let name = self.name.unwrap_or_default();
        if let Some(finding) = check_name(&name) {
            return Err(Failure::new(finding.in_words()));
        }
        match registry.get(&name) {
            Ok(_) => {
                return Err(Failure::new(format!("there is an action {name:?} already")).hint(
                    format!("change it with rsapien actions edit {name}, or choose another name"),
                ));
            }
            Err(RegistryError::UnknownAction { .. } | RegistryError::IsPrimitive { .. }) => {}
            Err(other) => return Err(other.into()),
        }
        let body: Vec<Statement> = (1..)
            .zip(&self.steps)
            .map(|(number, step)| {
                Statement::parse_short(step).map_err(|finding| {
                    let message = format!("step {number} ({step}): {}", finding.message);
                    Failure::new(message).hint(finding.help.as_deref().unwrap_or_default())
                })
            })
            .collect::<Result<_>>()?;
        let draft = ActionDraft {
            description: self.description,
            tags: self.tags.into_iter().map(Word::new).collect(),
            ..ActionDraft::new(name, body)
        };
        let text = print_action(&draft);
        let name = &draft.name.text;
        let file_name = format!("{name}.rsa");
        save::save_text(context, &mut registry, &text, &file_name, ImportPolicy::Refuse)?;
        let version = registry.get(name)?.version;
        let answer = serde_json::json!({"name": name, "version": version});
        context.style.answer(out, &answer, format_args!("added {name}"))?;
        Ok(Status::Done)
    }
}
