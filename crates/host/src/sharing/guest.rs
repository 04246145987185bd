//! The guest's end: hands an action to the program that holds the line.

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use rsapien_protocol::Joint;
use rsapien_registry::CompiledAction;

use super::desk::is_time_out;
use super::socket_path;
use super::wire::{Action, Ask, ClaimTold, Lines, Play, Told, VERSION, admission, line};
use crate::{
    Admission, Claim, Error, Holder, LineLock, LinkAddress, Outcome, PlayOptions, PlayReport,
    Policy, list_ports, robot,
};

/// How often a guest looks whether its caller wants something.
const LOOK: Duration = Duration::from_millis(20);

/// A robot whose line another program of this user holds.
#[derive(Debug)]
pub struct Guest {
    link: String,
    holder: Holder,
    program: String,
    stream: UnixStream,
    lines: Lines,
}

impl std::fmt::Debug for Lines {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Lines")
    }
}

impl Guest {
    /// Goes to the desk of the program that holds the line at `address`, as `program`. None where nobody holds it
    /// or its holder has no desk; for [`LinkAddress::Auto`], also where more than one line is held.
    ///
    /// # Errors
    /// As [`list_ports`], for `auto`.
    pub fn find(
        address: &LinkAddress,
        baud: u32,
        lock_folder: &Path,
        program: &str,
    ) -> Result<Option<Guest>, Error> {
        let addresses = match address {
            LinkAddress::Virtual => Vec::new(),
            LinkAddress::Auto => {
                list_ports()?.into_iter().map(|port| LinkAddress::Serial(port.path)).collect()
            }
            other => vec![other.clone()],
        };
        let found = addresses.into_iter().filter_map(|address| {
            let connector = robot::connector(&address, baud).ok()?;
            let key = connector.lock_key()?;
            let holder = LineLock::holder(lock_folder, &key)?;
            let stream = UnixStream::connect(socket_path(lock_folder, &key)?).ok()?;
            stream.set_read_timeout(Some(LOOK)).ok()?;
            let (program, link) = (program.to_owned(), connector.name());
            Some(Guest { link, holder, program, stream, lines: Lines::default() })
        });
        let mut found: Vec<Guest> = found.collect();
        Ok(if found.len() == 1 { found.pop() } else { None })
    }

    /// The link, as its address is written.
    pub fn link_name(&self) -> &str {
        &self.link
    }

    /// Who holds the line.
    pub fn holder(&self) -> &Holder {
        &self.holder
    }

    /// What is being played on the robot, and what waits behind it.
    ///
    /// # Errors
    /// [`Error::HolderGone`].
    pub fn claims(&mut self) -> Result<(Vec<Claim>, Vec<Claim>), Error> {
        self.ask(&Ask::Claims)?;
        loop {
            if let Some(Told::Claims { playing, waiting }) = self.hear()? {
                return Ok((ClaimTold::claims(playing), ClaimTold::claims(waiting)));
            }
        }
    }

    /// Has `action` played, as [`Stage::play`](crate::Stage::play) plays it; so are its arguments.
    ///
    /// # Errors
    /// [`Error::Claimed`]; [`Error::HolderRefused`] with what the holder said; [`Error::HolderGone`] before it was
    /// admitted. A holder that goes later makes the outcome unknown.
    pub fn play(
        &mut self,
        action: &CompiledAction,
        policy: Policy,
        options: &mut PlayOptions<'_>,
        on_admission: &mut dyn FnMut(&Admission),
    ) -> Result<PlayReport, Error> {
        self.ask(&Ask::Play(Box::new(Play {
            version: VERSION,
            program: self.program.clone(),
            pid: std::process::id(),
            policy: policy.name().to_owned(),
            from_label: options.from_label.clone(),
            wait_for_rest: options.wait_for_rest,
            action: Action::of(action),
        })))?;
        let mut is_admitted = false;
        let mut is_cancelled = false;
        let mut is_paused = false;
        loop {
            // A request that does not arrive is found out when the answer does not.
            if options.cancel.is_cancelled() && !is_cancelled {
                is_cancelled = true;
                let _ = self.ask(&Ask::Cancel);
            }
            let wants_pause = options.pause.as_ref().is_some_and(crate::PauseSwitch::is_paused);
            if wants_pause != is_paused {
                is_paused = wants_pause;
                let _ = self.ask(if is_paused { &Ask::Pause } else { &Ask::Resume });
            }
            let told = match self.hear() {
                Ok(Some(told)) => told,
                Ok(None) => continue,
                Err(error) if is_admitted => {
                    let mut report = PlayReport::unplayed(
                        &action.name,
                        action.steps.len(),
                        crate::Interruption::LinkLost,
                    );
                    report.outcome = Outcome::Unknown { why: error.to_string() };
                    return Ok(report);
                }
                Err(error) => return Err(error),
            };
            match told {
                Told::Admitted { how, claims } => {
                    is_admitted = true;
                    if let Some(admission) = admission(&how, claims) {
                        on_admission(&admission);
                    }
                }
                Told::Progress(progress) => {
                    if let Some(on_progress) = options.on_progress.as_mut() {
                        on_progress(&progress.progress());
                    }
                }
                Told::Report(report) => return Ok(report.report()),
                Told::Claimed { action, by, joints } => {
                    let joints = joints.into_iter().filter_map(Joint::from_index);
                    let (by, joints) = (ClaimTold::claims(by), joints.map(Joint::name).collect());
                    return Err(Error::Claimed { action, by, joints });
                }
                Told::Failed { text, is_refusal } => {
                    return Err(Error::HolderRefused { text, is_refusal });
                }
                Told::Claims { .. } => {}
            }
        }
    }

    fn gone(&self) -> Error {
        Error::HolderGone { by: self.holder.clone() }
    }

    fn ask(&mut self, ask: &Ask) -> Result<(), Error> {
        self.stream.write_all(&line(ask)).map_err(|_| self.gone())
    }

    /// What is told next; none when nothing is for a while.
    fn hear(&mut self) -> Result<Option<Told>, Error> {
        if let Some(line) = self.lines.next() {
            return serde_json::from_slice(&line).map(Some).map_err(|_| self.gone());
        }
        let mut buffer = [0; 4096];
        match self.stream.read(&mut buffer) {
            Ok(count @ 1..) if self.lines.take(buffer.get(..count).unwrap_or_default()) => Ok(None),
            Err(error) if is_time_out(&error) => Ok(None),
            Ok(_) | Err(_) => Err(self.gone()),
        }
    }
}
