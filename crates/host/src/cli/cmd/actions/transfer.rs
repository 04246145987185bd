//! `rsapien actions import` and `export`.

use std::fs;
use std::io::{BufReader, Cursor, Read, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use rsapien_registry::{Bundle, BundlePlan, BundlePolicy, ImportPolicy, Registry};

use super::save;
use super::show::picture;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;

/// Import the actions of files, or of a bundle
///
/// All of a file or none. An action that exists with other content is refused unless --replace or --on-conflict says
/// what to do; nothing is lost either way, since older versions are kept.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions import dances.rsa
  rsapien actions import --replace dances.rsa
  rsapien actions import dances.rsapien --on-conflict rename")]
pub(super) struct Import {
    /// Files in the action language; `-` is the standard input
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,

    /// Save actions that exist with other content as new versions
    #[arg(long)]
    replace: bool,

    /// What is done with actions of a bundle that are here already and do something else
    #[arg(long, value_enum, value_name = "WHAT", default_value_t = OnConflict::Refuse, conflicts_with = "replace")]
    on_conflict: OnConflict,
}

/// What is done with a conflict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OnConflict {
    /// Nothing is imported
    Refuse,
    /// The one that is here stays
    KeepMine,
    /// The bundle's becomes a new version
    TakeTheirs,
    /// The bundle's gets another name
    Rename,
}

/// Export actions as text
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions export > all.rsa
  rsapien actions export dance --with-played --out dance.rsa
  rsapien actions export dance --bundle dance.rsapien")]
pub(super) struct Export {
    /// Names of the actions; all when none is given
    #[arg(value_name = "ACTION")]
    names: Vec<String>,

    /// Also whatever they play, so that another registry can import the text
    #[arg(long, requires = "names")]
    with_played: bool,

    /// Write to this file instead of the standard output
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Write one file with the actions, what they play, what was found of them, and their pictures
    #[arg(long, value_name = "FILE", requires = "names", conflicts_with_all = ["with_played", "out"])]
    bundle: Option<PathBuf>,
}

impl Import {
    pub(super) fn run(
        self,
        context: &Context,
        mut registry: Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let policy = if self.replace { ImportPolicy::Replace } else { ImportPolicy::Refuse };
        for file in &self.files {
            if is_bundle(file)? {
                self.import_bundle(context, &mut registry, out, file)?;
                continue;
            }
            save::save(context, &mut registry, out, file, policy)?;
        }
        Ok(Status::Done)
    }
}

impl Import {
    fn import_bundle(
        &self,
        context: &Context,
        registry: &mut Registry,
        out: &mut impl Write,
        file: &Path,
    ) -> Result<()> {
        let policy = match (self.replace, self.on_conflict) {
            (true, _) | (_, OnConflict::TakeTheirs) => BundlePolicy::TakeTheirs,
            (_, OnConflict::Refuse) => BundlePolicy::Refuse,
            (_, OnConflict::KeepMine) => BundlePolicy::KeepMine,
            (_, OnConflict::Rename) => BundlePolicy::RenameTheirs,
        };
        let opened = fs::File::open(file).map_err(|error| Failure::file("read", file, &error))?;
        let bundle = Bundle::read(BufReader::new(opened))?;
        // What a bundle says of its trials is its writer's word; each is tried here.
        let planned = registry.plan_bundle(&bundle, policy)?;
        let trials = save::try_text(context, registry, &planned.text, &file.display().to_string())?;
        let plan = registry.import_bundle(&bundle, policy, &trials)?;
        context.style.answer(out, &plan, in_words(&plan, policy))
    }
}

/// Whether a file is a bundle: it begins as every zip file does.
fn is_bundle(file: &Path) -> Result<bool> {
    if file == Path::new("-") {
        return Ok(false);
    }
    let failed = |error| Failure::file("read", file, &error);
    let mut beginning = Vec::new();
    fs::File::open(file).map_err(failed)?.take(2).read_to_end(&mut beginning).map_err(failed)?;
    Ok(beginning == b"PK")
}

/// What an import of a bundle did.
fn in_words(plan: &BundlePlan, policy: BundlePolicy) -> String {
    let conflicts: Vec<String> = plan.conflicts.iter().map(|it| it.name.clone()).collect();
    let what = match policy {
        BundlePolicy::KeepMine => "kept mine of",
        BundlePolicy::TakeTheirs => "new version of",
        BundlePolicy::Refuse | BundlePolicy::RenameTheirs => "here already",
    };
    let parts = [("added", &plan.added), ("unchanged", &plan.unchanged), (what, &conflicts)];
    let mut lines: Vec<String> = parts
        .iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(what, names)| format!("{what} {}", names.join(", ")))
        .collect();
    lines.extend(plan.renamed.iter().map(|(from, to)| format!("{from} is called {to} here")));
    lines.extend(plan.plays_mine.iter().map(|(name, played)| {
        format!("{name} plays mine of {} instead of the bundle's", played.join(", "))
    }));
    lines.join("\n")
}

impl Export {
    pub(super) fn run(
        self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        if let Some(path) = &self.bundle {
            return self.export_bundle(context, registry, out, path);
        }
        let text = if self.names.is_empty() {
            registry.export_all_text()?
        } else {
            let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
            registry.export_text(&names, self.with_played)?
        };
        match &self.out {
            Some(path) => {
                fs::write(path, text).map_err(|error| Failure::file("write", path, &error))?;
                let answer = serde_json::json!({"file": path});
                context.style.answer(out, &answer, format_args!("wrote {}", path.display()))?;
            }
            None if context.style.json => {
                context.style.answer(out, &serde_json::json!({"text": text}), "")?;
            }
            None => out.write_all(text.as_bytes())?,
        }
        Ok(Status::Done)
    }
}

impl Export {
    fn export_bundle(
        &self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
        path: &Path,
    ) -> Result<Status> {
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        // Whole in memory first: a name that is unknown leaves no half file behind.
        let mut bytes = Cursor::new(Vec::new());
        let manifest = registry.export_bundle(&names, &mut bytes, picture)?;
        fs::write(path, bytes.into_inner())
            .map_err(|error| Failure::file("write", path, &error))?;
        let count = manifest.actions.len();
        let what = if count == 1 { "1 action".to_owned() } else { format!("{count} actions") };
        let text = format!("wrote {} with {what}", path.display());
        context.style.answer(out, &manifest, text)?;
        Ok(Status::Done)
    }
}
