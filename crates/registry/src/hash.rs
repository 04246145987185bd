//! The name of what an action does, the same everywhere.

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

use crate::language::{ActionDraft, Play, Response, Statement, StatementKind, Word, print_action};

/// How many characters of a content hash stand for it where people read it.
pub const CONTENT_HASH_SHORT: usize = 12;

/// The content hash of an action: SHA-256, in hexadecimal, of its canonical text without what is only
/// said of it (name, description, tags, comments, silenced rules), and with the content hashes of the
/// actions it plays in place of their names, as `hash_of` tells them.
pub(crate) fn content_hash(
    draft: &ActionDraft,
    hash_of: &mut impl FnMut(&str) -> String,
) -> String {
    let mut bare = ActionDraft {
        name: Word::new("action"),
        parameters: draft.parameters.clone(),
        body: draft.body.clone(),
        ..ActionDraft::default()
    };
    rename_played(&mut bare.body, &mut |name| hash_of(name));
    hexadecimal(&Sha256::digest(print_action(&bare)))
}

/// Bytes as two hexadecimal digits each.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

/// Gives every action that is played the name that `new_name` tells.
pub(crate) fn rename_played(body: &mut [Statement], new_name: &mut impl FnMut(&str) -> String) {
    for statement in body {
        let play: Option<&mut Play> = match &mut statement.kind {
            StatementKind::Play(play)
            | StatementKind::On { response: Response::Play(play), .. }
            | StatementKind::WaitFor { otherwise: Response::Play(play), .. } => Some(play),
            StatementKind::Repeat { body, .. }
            | StatementKind::Mirror { body }
            | StatementKind::Speed { body, .. } => {
                rename_played(body, new_name);
                None
            }
            StatementKind::Together { tracks } => {
                for track in tracks {
                    rename_played(&mut track.body, new_name);
                }
                None
            }
            _ => None,
        };
        if let Some(play) = play {
            play.action.text = new_name(&play.action.text);
        }
    }
}
