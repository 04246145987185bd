//! `rsapien config`: the configuration file.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::cli::config::{KEYS, default_path, example};
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::install;
use crate::cli::output::Table;

/// Show the configuration, or begin a configuration file
///
/// The file says what one does not want to say each time. A flag comes before the environment, the environment before
/// the file, the file before the default.
#[derive(Debug, Args)]
#[command(
    arg_required_else_help = true,
    subcommand_required = true,
    after_help = "\
Examples:
  rsapien config show
  rsapien config init
  rsapien config path"
)]
pub(crate) struct Cmd {
    #[command(subcommand)]
    command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
enum Command {
    /// Tell each value and where it comes from
    #[command(after_help = "Example:\n  rsapien config show")]
    Show,
    /// Tell where the file is, whether it is there or not
    #[command(after_help = "Example:\n  rsapien config path")]
    Path,
    /// Write an example with every key, commented out; never over a file that is there
    #[command(after_help = "Examples:\n  rsapien config init\n  rsapien config init --print")]
    Init(Init),
}

#[derive(Debug, Args)]
struct Init {
    /// Print it instead
    #[arg(long)]
    print: bool,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        match self.command {
            Command::Show => show(context, out)?,
            Command::Path => {
                let path = path(context)?;
                let answer = serde_json::json!({"file": path, "is_there": path.is_file()});
                context.style.answer(out, &answer, path.display())?;
            }
            Command::Init(init) if init.print => write!(out, "{}", example())?,
            Command::Init(_) => {
                let path = path(context)?;
                if path.exists() {
                    return Err(Failure::new(format!("{} is there already", path.display()))
                        .hint("edit it; rsapien config init --print shows an example"));
                }
                install::write(&path, example().as_bytes())?;
                let answer = serde_json::json!({"file": path});
                context.style.answer(out, &answer, format_args!("wrote {}", path.display()))?;
            }
        }
        Ok(Status::Done)
    }
}

fn path(context: &Context) -> Result<PathBuf> {
    context.config_path.clone().or_else(default_path).ok_or_else(|| {
        Failure::new("this system names no configuration folder for you")
            .hint("name a file with --config FILE or RSAPIEN_CONFIG")
    })
}

fn show(context: &Context, out: &mut impl Write) -> Result<()> {
    let mut table = Table::new(&["key", "value", "from"]);
    let mut answer = serde_json::Map::new();
    for (key, default, _) in KEYS {
        let found = context.origins.iter().find(|origin| origin.key == key);
        let (value, from) = found.map_or((default.to_owned(), "the default"), |origin| {
            (origin.value.clone(), origin.from)
        });
        answer.insert(key.to_owned(), serde_json::json!({"value": value, "from": from}));
        table.row([key.to_owned(), value, from.to_owned()]);
    }
    context.style.answer(out, &answer, table)
}
