//! Systems without Unix sockets: nobody opens a desk, and nobody finds one.

use std::path::Path;

use rsapien_registry::CompiledAction;

use crate::{
    Admission, Claim, Error, Holder, LinkAddress, PlayOptions, PlayReport, Policy, Robot, Stage,
};

/// Plays actions of other programs, where the system has a way to hand them in.
pub enum Desk {}

impl Desk {
    /// None: this system has none.
    ///
    /// # Errors
    /// Never.
    pub fn open(_robot: &Robot, _stage: &Stage) -> Result<Option<Desk>, Error> {
        Ok(None)
    }
}

/// A robot whose line another program holds.
#[derive(Debug)]
pub enum Guest {}

impl Guest {
    /// None: this system has no desks.
    ///
    /// # Errors
    /// Never.
    pub fn find(
        _address: &LinkAddress,
        _baud: u32,
        _lock_folder: &Path,
        _program: &str,
    ) -> Result<Option<Guest>, Error> {
        Ok(None)
    }

    /// The link, as its address is written.
    pub fn link_name(&self) -> &str {
        match *self {}
    }

    /// Who holds the line.
    pub fn holder(&self) -> &Holder {
        match *self {}
    }

    /// What is being played on the robot, and what waits behind it.
    ///
    /// # Errors
    /// Never.
    pub fn claims(&mut self) -> Result<(Vec<Claim>, Vec<Claim>), Error> {
        match *self {}
    }

    /// Has `action` played.
    ///
    /// # Errors
    /// Never.
    pub fn play(
        &mut self,
        _action: &CompiledAction,
        _policy: Policy,
        _options: &mut PlayOptions<'_>,
        _on_admission: &mut dyn FnMut(&Admission),
    ) -> Result<PlayReport, Error> {
        match *self {}
    }
}
