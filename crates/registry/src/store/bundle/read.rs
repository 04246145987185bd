//! Reading a bundle from somewhere: nothing in it is believed.

use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::sync::Arc;

use zip::ZipArchive;

use super::{FORMAT, FORMAT_VERSION, Manifest, broken, sha256};
use crate::check::check_name;
use crate::error::RegistryError;
use crate::hash::content_hash;
use crate::language::{ActionDraft, parse_text};

/// The most actions of a bundle.
const ACTIONS_MAX: usize = 10_000;
/// The longest text of an action, and the longest manifest, in bytes.
const TEXT_BYTES_MAX: u64 = 1 << 20;
const MANIFEST_BYTES_MAX: u64 = 16 << 20;

/// A bundle that was read and found whole.
#[derive(Clone, Debug)]
pub struct Bundle {
    /// What it says of itself.
    pub manifest: Manifest,
    /// The texts of its actions, by name.
    pub(super) texts: BTreeMap<String, String>,
    pub(super) drafts: BTreeMap<String, Arc<ActionDraft>>,
}

impl Bundle {
    /// Reads a bundle and verifies it: every text is there, bears its name, has its checksum, and does what
    /// its content hash says.
    ///
    /// # Errors
    /// [`RegistryError::Bundle`] with what is wrong and where.
    pub fn read(reader: impl Read + Seek) -> Result<Bundle, RegistryError> {
        let mut zip = ZipArchive::new(reader)
            .map_err(|error| broken(&format!("it is no bundle: {error}")))?;
        let manifest = entry(&mut zip, "manifest.json", MANIFEST_BYTES_MAX)?;
        let manifest: Manifest = serde_json::from_str(&manifest)
            .map_err(|error| broken(&format!("manifest.json: {error}")))?;
        if manifest.format != FORMAT {
            return Err(broken(&"manifest.json is that of something else"));
        }
        if manifest.format_version > FORMAT_VERSION {
            return Err(broken(&format!(
                "its form is {}, and this program knows forms up to {FORMAT_VERSION}: update it",
                manifest.format_version
            )));
        }
        if manifest.actions.len() > ACTIONS_MAX {
            return Err(broken(&format!("it has more than {ACTIONS_MAX} actions")));
        }
        let mut bundle = Bundle { manifest, texts: BTreeMap::new(), drafts: BTreeMap::new() };
        for action in bundle.manifest.actions.clone() {
            let name = action.name;
            // Also what keeps a path from leading elsewhere.
            if let Some(finding) = check_name(&name) {
                return Err(broken(&format!("manifest.json: {}", finding.message)));
            }
            let file = format!("actions/{name}.rsa");
            let text = entry(&mut zip, &file, TEXT_BYTES_MAX)?;
            let text = text.strip_suffix('\n').unwrap_or(&text);
            if sha256(text) != action.text_sha256 {
                return Err(broken(&format!(
                    "{file} is not what the manifest says: it was changed"
                )));
            }
            let parsed = parse_text(text);
            match parsed.actions.as_slice() {
                [one] if parsed.findings.is_empty() && one.draft.name.text == name => {
                    bundle.drafts.insert(name.clone(), Arc::new(one.draft.clone()));
                }
                _ => return Err(broken(&format!("{file} does not hold the action {name}"))),
            }
            bundle.texts.insert(name, text.to_owned());
        }
        bundle.verify_hashes()?;
        Ok(bundle)
    }

    fn verify_hashes(&self) -> Result<(), RegistryError> {
        let mut known = BTreeMap::new();
        for action in &self.manifest.actions {
            let hash = self.content_hash(&action.name, &mut known, 0)?;
            if hash != action.content_hash {
                let name = &action.name;
                return Err(broken(&format!(
                    "the action {name} does not do what its content hash says"
                )));
            }
        }
        Ok(())
    }

    fn content_hash(
        &self,
        name: &str,
        known: &mut BTreeMap<String, String>,
        depth: usize,
    ) -> Result<String, RegistryError> {
        if let Some(hash) = known.get(name) {
            return Ok(hash.clone());
        }
        if depth > crate::expand::NESTING_MAX {
            return Err(broken(&format!("the action {name} plays itself")));
        }
        let draft = self
            .drafts
            .get(name)
            .ok_or_else(|| broken(&format!("the action {name} is played, and missing")))?;
        let mut failure = None;
        let hash = content_hash(draft, &mut |played| {
            self.content_hash(played, known, depth + 1).unwrap_or_else(|error| {
                failure = Some(error);
                String::new()
            })
        });
        if let Some(error) = failure {
            return Err(error);
        }
        known.insert(name.to_owned(), hash.clone());
        Ok(hash)
    }
}

/// A file of the archive as text, at most so long.
fn entry<R: Read + Seek>(
    zip: &mut ZipArchive<R>,
    name: &str,
    bytes_max: u64,
) -> Result<String, RegistryError> {
    let failed = |error: &dyn std::fmt::Display| broken(&format!("{name}: {error}"));
    let file = zip.by_name(name).map_err(|error| failed(&error))?;
    let mut text = String::new();
    // What the archive says of its size is not believed either.
    file.take(bytes_max + 1).read_to_string(&mut text).map_err(|error| failed(&error))?;
    if text.len() as u64 > bytes_max {
        return Err(failed(&format!("it is longer than {bytes_max} bytes")));
    }
    Ok(text)
}
