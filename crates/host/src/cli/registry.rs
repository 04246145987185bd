//! Which registry a command uses.

use std::fs;
use std::path::PathBuf;

use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use rsapien_registry::{CONTENT_HASH_SHORT, Registry, RegistryError};

use super::context::Context;
use super::diagnostics::{Failure, Result};
use crate::data;

/// The option that names a registry.
#[derive(Debug, Clone, Args)]
pub(crate) struct RegistryOptions {
    /// File of the actions; without it the one in this user's data folder, which is made when first needed
    #[arg(long, global = true, value_name = "PATH", env = "RSAPIEN_REGISTRY", hide_env_values = true, value_parser = OsStringValueParser::new().map(PathBuf::from))]
    pub(crate) registry: Option<PathBuf>,
}

impl RegistryOptions {
    /// Opens the registry; a new one knows the seed library.
    pub(crate) fn open(&self, context: &Context) -> Result<Registry> {
        if let Some(path) = self.asked_for(context) {
            return Ok(Registry::open(path)?);
        }
        let path = data::registry_file().ok_or_else(|| {
            Failure::new("this system names no data folder for you")
                .hint("name a file with --registry PATH or RSAPIEN_REGISTRY")
        })?;
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|error| Failure::file("make", folder, &error))?;
        }
        Ok(Registry::open(path)?)
    }

    /// Which file that is, whether it is there or not; none where the system names no data folder.
    pub(crate) fn file(&self, context: &Context) -> Option<PathBuf> {
        self.asked_for(context).cloned().or_else(data::registry_file)
    }

    fn asked_for<'a>(&'a self, context: &'a Context) -> Option<&'a PathBuf> {
        // A variable that is set to nothing is not set.
        let asked_for = self.registry.as_ref().filter(|path| !path.as_os_str().is_empty());
        asked_for.or(context.registry.as_ref())
    }
}

impl From<RegistryError> for Failure {
    fn from(error: RegistryError) -> Self {
        if let RegistryError::Refused(findings) = error {
            // What has no place is told in words: an argument, an option.
            if let [finding] = findings.list.as_slice()
                && finding.span.end == 0
            {
                return Self::new(finding.in_words());
            }
            let action = findings.list.iter().find_map(|finding| finding.action.clone());
            let name = action.map_or("text".to_owned(), |action| format!("{action}.rsa"));
            return Self::findings(findings, &name);
        }
        let failure = Self::from_error(&error);
        match error {
            RegistryError::UnknownAction { .. } => {
                failure.hint("rsapien actions list shows the actions there are")
            }
            RegistryError::IsPrimitive { primitive } => {
                failure.hint(format!("rsapien do {primitive} runs it"))
            }
            RegistryError::UnknownVersion { name, .. } => {
                failure.hint(format!("rsapien actions show {name} --history lists them"))
            }
            RegistryError::Conflicts { ref conflicts } => {
                let short = |hash: &str| hash.get(..CONTENT_HASH_SHORT).unwrap_or(hash).to_owned();
                let lines = conflicts.iter().map(|it| {
                    format!("{}: #{} is here, #{} in the bundle", it.name, short(&it.here), short(&it.theirs))
                });
                let lines = lines.collect::<Vec<_>>().join("\n");
                failure.hint(format!(
                    "{lines}\n--on-conflict keep-mine, take-theirs or rename says what to do"
                ))
            }
            RegistryError::AlreadyExist { .. } => {
                failure.hint("rsapien actions import --replace saves them as new versions; the old ones are kept")
            }
            _ => failure,
        }
    }
}
