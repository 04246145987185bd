//! Bundles: one file with actions, all that they play, what was found of them, and their pictures.
//!
//! ```text
//!   NAME.rsapien (a zip file)
//!   ├── manifest.json        what is in it: names, content hashes, checksums
//!   ├── actions/NAME.rsa     the texts, word for word
//!   ├── checks/NAME.json     warnings, and how the motion went on the virtual body
//!   └── pictures/NAME.svg    the timelines
//! ```

mod plan;
mod read;

use std::collections::BTreeSet;
use std::io::{Seek, Write};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::{Registry, Trials, write};
use crate::action::Action;
use crate::compiled::CompiledAction;
use crate::error::RegistryError;
use crate::expand::CompileOptions;

pub use plan::{BundlePlan, BundlePolicy, Conflict};
pub use read::Bundle;

/// What a manifest says that it is.
const FORMAT: &str = "rsapien-bundle";
/// The newest form of bundles that this program knows.
const FORMAT_VERSION: u32 = 1;

/// What a bundle says of itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    format: String,
    format_version: u32,
    /// The version of the program that wrote it.
    pub program_version: String,
    /// The actions in it: those asked for first, then what they play.
    pub actions: Vec<BundledAction>,
}

/// An action in a bundle.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BundledAction {
    /// Its name.
    pub name: String,
    /// What it does, for people.
    pub description: String,
    /// Words to find it by.
    pub tags: Vec<String>,
    /// The name of its content, with that of all it plays.
    pub content_hash: String,
    /// SHA-256 of its text, in hexadecimal.
    pub text_sha256: String,
}

/// What is kept of a check.
#[derive(Serialize)]
struct Check<'a> {
    warnings: &'a [String],
    trial: Option<serde_json::Value>,
}

impl Registry {
    /// Writes a bundle of the actions of `names` and all that they play to `out`; `picture` draws each.
    ///
    /// # Errors
    /// As of [`Registry::get`]; [`RegistryError::Bundle`] when it cannot be written.
    pub fn export_bundle(
        &self,
        names: &[&str],
        out: impl Write + Seek,
        picture: impl Fn(&Action, &CompiledAction) -> String,
    ) -> Result<Manifest, RegistryError> {
        let actions = self.export(names, true)?;
        let mut bundled = Vec::with_capacity(actions.len());
        for action in &actions {
            bundled.push(BundledAction {
                name: action.name.clone(),
                description: action.description.clone(),
                tags: action.tags.clone(),
                content_hash: self.summary(&action.name)?.content_hash,
                text_sha256: sha256(&action.text),
            });
        }
        let manifest = Manifest {
            format: FORMAT.to_owned(),
            format_version: FORMAT_VERSION,
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            actions: bundled,
        };
        let mut files = vec![("manifest.json".to_owned(), json(&manifest)?)];
        for action in &actions {
            let name = &action.name;
            let compiled = self.compile(name, &CompileOptions::default())?;
            let trial = action.trial.as_deref().and_then(|trial| serde_json::from_str(trial).ok());
            let check = Check { warnings: &action.warnings, trial };
            files.push((format!("actions/{name}.rsa"), format!("{}\n", action.text)));
            files.push((format!("checks/{name}.json"), json(&check)?));
            files.push((format!("pictures/{name}.svg"), picture(action, &compiled)));
        }
        write_files(out, &files).map_err(|error| broken(&error))?;
        Ok(manifest)
    }

    /// What an import of `bundle` would do now.
    ///
    /// # Errors
    /// The database's, naming the path.
    pub fn plan_bundle(
        &self,
        bundle: &Bundle,
        policy: BundlePolicy,
    ) -> Result<BundlePlan, RegistryError> {
        let transaction = self.begin_read()?;
        plan::plan(&transaction, &self.place, bundle, policy)
    }

    /// Imports a bundle, all or nothing. `trials` are kept with the actions they belong to, by the names
    /// that the plan gives them.
    ///
    /// # Errors
    /// [`RegistryError::Conflicts`] with [`BundlePolicy::Refuse`]; as of [`Registry::import_text`].
    pub fn import_bundle(
        &mut self,
        bundle: &Bundle,
        policy: BundlePolicy,
        trials: &Trials,
    ) -> Result<BundlePlan, RegistryError> {
        let transaction = self.begin_write()?;
        let plan = plan::plan(&transaction, &self.place, bundle, policy)?;
        if policy == BundlePolicy::Refuse && !plan.conflicts.is_empty() {
            return Err(RegistryError::Conflicts { conflicts: plan.conflicts });
        }
        let replace = super::ImportPolicy::Replace;
        write::import(&transaction, &self.place, &plan.text, replace, trials)?;
        self.commit(transaction)?;
        Ok(plan)
    }
}

fn write_files(out: impl Write + Seek, files: &[(String, String)]) -> zip::result::ZipResult<()> {
    let mut zip = ZipWriter::new(out);
    // Without times, so that the same actions make the same file.
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let mut seen = BTreeSet::new();
    for (name, content) in files {
        if seen.insert(name) {
            zip.start_file(name.as_str(), options)?;
            zip.write_all(content.as_bytes())?;
        }
    }
    zip.finish().map(|_| ())
}

fn json(value: &impl Serialize) -> Result<String, RegistryError> {
    serde_json::to_string_pretty(value).map(|text| text + "\n").map_err(|error| broken(&error))
}

/// SHA-256 in hexadecimal.
fn sha256(text: &str) -> String {
    crate::hash::hexadecimal(&Sha256::digest(text))
}

fn broken(reason: &impl ToString) -> RegistryError {
    RegistryError::Bundle { reason: reason.to_string() }
}
