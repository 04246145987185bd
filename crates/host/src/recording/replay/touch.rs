//! Bumpers that were pressed in the world, not by the PC's requests.

use std::sync::PoisonError;

use rsapien_protocol::{BumperMask, MotionReport, Report, SynchronizationPackage};

use super::ReplayError;
use crate::link::virtual_robot::SharedVirtualRobot;

/// A press is given so long before the answer that tells of it, in ms: the controller believes a bumper
/// only after some milliseconds, and what the press ends has ended by then.
const AHEAD_MS: u64 = 40;
/// How long a press lasts that only the count of presses tells of, in ms.
const TAP_MS: u64 = 20;

/// Presses the bumpers of a virtual robot as the recorded answers tell.
pub(super) struct Touch {
    /// None where nobody is to press.
    robot: Option<SharedVirtualRobot>,
    before: Option<MotionReport>,
    count: u64,
    is_missing: bool,
}

impl Touch {
    pub(super) fn new(robot: Option<SharedVirtualRobot>) -> Touch {
        Touch { robot, before: None, count: 0, is_missing: false }
    }

    /// How often a bumper was pressed or released.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Whether the recording tells of presses that were not given.
    pub(super) fn is_missing(&self) -> bool {
        self.is_missing
    }

    /// Does what has to be done before the request at `due_ms`, so that it can be answered like this.
    pub(super) fn follow(
        &mut self,
        answer: &SynchronizationPackage,
        due_ms: u64,
        mut wait_until: impl FnMut(u64) -> Result<(), ReplayError>,
    ) -> Result<(), ReplayError> {
        let Report::Motion(report) = answer.report else { return Ok(()) };
        let Some(before) = self.before.replace(report) else { return Ok(()) };
        let changed = before.bumpers.bits() ^ report.bumpers.bits();
        let mut taps = Vec::new();
        for index in 0..BumperMask::COUNT {
            let is_same = changed >> index & 1 == 0;
            if is_same && before.presses[index] != report.presses[index] {
                taps.push(index);
            }
        }
        // A reset begins the counts again.
        if (changed == 0 && taps.is_empty()) || before.boot != report.boot {
            return Ok(());
        }
        let Some(robot) = &self.robot else {
            self.is_missing = true;
            return Ok(());
        };
        let mut press = |index: usize, held: bool| {
            robot.lock().unwrap_or_else(PoisonError::into_inner).press_bumper(index, held);
            self.count += 1;
        };
        wait_until(due_ms.saturating_sub(AHEAD_MS))?;
        let is_held = |index: usize| report.bumpers.bits() >> index & 1 == 1;
        for index in (0..BumperMask::COUNT).filter(|index| changed >> index & 1 == 1) {
            press(index, is_held(index));
        }
        for index in &taps {
            press(*index, !is_held(*index));
        }
        if !taps.is_empty() {
            wait_until(due_ms.saturating_sub(AHEAD_MS - TAP_MS))?;
            for index in taps {
                press(index, is_held(index));
            }
        }
        Ok(())
    }
}
