//! `rsapien man`: the manual pages.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory};
use clap_mangen::Man;
use directories::BaseDirs;

use crate::cli::Arguments;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::install;

/// Write the manual pages, one for each command, or install them for you
///
/// Without an option the page of rsapien itself is printed.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien man --install                   then: man rsapien-play
  rsapien man --dir pages
  rsapien man | man -l -")]
pub(crate) struct Cmd {
    /// Write all pages to this folder
    #[arg(long, value_name = "FOLDER", conflicts_with = "install")]
    dir: Option<PathBuf>,

    /// Put all pages where man finds them
    #[arg(long)]
    install: bool,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let mut command = Arguments::command();
        command.build();
        let folder = match (self.dir, self.install) {
            (Some(folder), _) => folder,
            (None, true) => {
                BaseDirs::new().ok_or_else(install::no_home)?.data_dir().join("man/man1")
            }
            (None, false) => {
                out.write_all(&page(&command)?)?;
                return Ok(Status::Done);
            }
        };
        let mut written = Vec::new();
        write_pages(&folder, &command, "rsapien", &mut written)?;
        let answer = serde_json::json!({"folder": folder, "pages": written});
        let text = format!("wrote {} pages to {}", written.len(), folder.display());
        context.style.answer(out, &answer, text)?;
        Ok(Status::Done)
    }
}

/// Writes the page of a command and those below it; `name` is that of the page.
fn write_pages(
    folder: &Path,
    command: &clap::Command,
    name: &str,
    written: &mut Vec<String>,
) -> Result<()> {
    let page = page(&command.clone().display_name(name.to_owned()))?;
    install::write(&folder.join(format!("{name}.1")), &page)?;
    written.push(name.to_owned());
    let below = command.get_subcommands().filter(|below| below.get_name() != "help");
    for below in below {
        write_pages(folder, below, &format!("{name}-{}", below.get_name()), written)?;
    }
    Ok(())
}

fn page(command: &clap::Command) -> Result<Vec<u8>> {
    let mut page = Vec::new();
    Man::new(command.clone())
        .render(&mut page)
        .map_err(|error| Failure::new(format!("cannot write the manual page: {error}")))?;
    Ok(page)
}
