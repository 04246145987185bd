//! The camera controller: positions the pan/tilt head.

use std::sync::Arc;

use rsapien_protocol::{Address, AimTarget, CameraReport, Kind, Mode, Report, Request};

use super::{Controller, Held, feedback};
use crate::robot::Inner;
use crate::{Error, Interruption};

/// How long homing may take, in ms: the whole way both ways at a slow degree a second and a half.
const HOME_LIMIT_MS: u64 = 120_000;
/// How long the head is behind what the controller tells, in ms: a servo is told its angle by a pulse every 20 ms, which
/// takes 2.4 ms, and the way since the pulse before takes another 20.
const SERVO_LAG_MS: u64 = 45;

/// Positions the camera. See [`Robot::camera`](crate::Robot::camera).
///
/// Pan is the angle right of straight ahead, -90 to 90 degrees; tilt is the angle above it, -45 to
/// 45 degrees.
pub struct CameraController {
    held: Held,
}

feedback!(CameraController);

impl CameraController {
    pub(crate) fn take(inner: &Arc<Inner>) -> Result<CameraController, Error> {
        Ok(CameraController { held: Held::take_with_session(inner, Controller::Camera)? })
    }

    /// Drives both axes to zero and waits until they are there. Aiming comes after it.
    ///
    /// # Errors
    /// [`Error::Refused`], [`Error::Interrupted`], [`Error::TimeLimit`] and those of the line.
    pub fn home(&self) -> Result<CameraReport, Error> {
        let report = self.request(Request::Home)?;
        self.wait_until_still(Kind::Home, report, HOME_LIMIT_MS)
    }

    /// Sends the camera to a direction, and does not wait until it is there. Angles are rounded to
    /// 0.01 degree; `speed_deg_per_s` 0 is as fast as the head can.
    ///
    /// # Errors
    /// [`Error::OutOfRange`]; [`Error::Refused`] before [`home`](CameraController::home).
    pub fn aim(
        &self,
        pan_deg: f64,
        tilt_deg: f64,
        speed_deg_per_s: u16,
    ) -> Result<CameraReport, Error> {
        self.request(Request::Aim(aim_target(pan_deg, tilt_deg, speed_deg_per_s)?))
    }

    /// Waits until the camera stands still, at most `limit_ms`.
    ///
    /// # Errors
    /// [`Error::Interrupted`] by STOP, a hold or a reset; [`Error::TimeLimit`]; those of the line.
    pub fn wait_until_reached(&self, limit_ms: u64) -> Result<CameraReport, Error> {
        let report = self.report()?;
        self.wait_until_still(Kind::Aim, report, limit_ms)
    }

    /// Sends the camera to a direction and waits until it is there.
    ///
    /// # Errors
    /// As [`aim`](CameraController::aim) and
    /// [`wait_until_reached`](CameraController::wait_until_reached).
    pub fn look(
        &self,
        pan_deg: f64,
        tilt_deg: f64,
        speed_deg_per_s: u16,
    ) -> Result<CameraReport, Error> {
        let report = self.aim(pan_deg, tilt_deg, speed_deg_per_s)?;
        // The axes' longest ways at the speed asked for, twice over; 1 degree a second at least.
        let limit_ms = 2 * 180_000 / u64::from(speed_deg_per_s.max(1)).min(30) + 2_000;
        self.wait_until_still(Kind::Aim, report, limit_ms)
    }

    /// Stops both axes.
    ///
    /// # Errors
    /// [`Error::NoAnswer`] and others of the line.
    pub fn stop(&self) -> Result<(), Error> {
        self.request(Request::Stop).map(|_| ())
    }

    fn report(&self) -> Result<CameraReport, Error> {
        self.request(Request::State)
    }

    fn request(&self, request: Request) -> Result<CameraReport, Error> {
        let kind = request.kind();
        let answer = self.held.inner.line.request(Address::Camera, request)?;
        match answer.accepted()?.report {
            Report::Camera(report) => Ok(report),
            _ => Err(Error::BadReport { address: Address::Camera, kind }),
        }
    }

    fn wait_until_still(
        &self,
        kind: Kind,
        first: CameraReport,
        limit_ms: u64,
    ) -> Result<CameraReport, Error> {
        const POLL_MS: u64 = 20;
        let until_ms = self.now_ms().saturating_add(limit_ms);
        let mut report = first;
        loop {
            let interrupted = |by| Err(Error::Interrupted { kind, by });
            match report.mode {
                _ if report.boot != first.boot => {
                    return interrupted(Interruption::Reset(report.cause));
                }
                Mode::Idle => {
                    self.sleep_ms(SERVO_LAG_MS)?;
                    return Ok(report);
                }
                Mode::Initialising | Mode::Executing => {}
                Mode::Stopped => return interrupted(Interruption::Stop),
                Mode::Held => return interrupted(Interruption::DeadMan),
                Mode::Fresh => return interrupted(Interruption::Reset(report.cause)),
            }
            if self.now_ms() >= until_ms {
                return Err(Error::TimeLimit { what: "the camera's movement", limit_ms });
            }
            self.sleep_ms(POLL_MS)?;
            report = self.report()?;
        }
    }
}

/// The direction as it stands on the line: the one place where degrees become 0.01 degree.
fn aim_target(pan_deg: f64, tilt_deg: f64, speed_deg_per_s: u16) -> Result<AimTarget, Error> {
    let pan = centideg(pan_deg, AimTarget::PAN_CENTIDEG_MAX);
    let tilt = centideg(tilt_deg, AimTarget::TILT_CENTIDEG_MAX);
    let out_of_range =
        |what, value: f64, range| Error::OutOfRange { what, value: value.to_string(), range };
    Ok(AimTarget {
        pan_centideg: pan.ok_or_else(|| out_of_range("pan", pan_deg, "-90 to 90 degrees"))?,
        tilt_centideg: tilt.ok_or_else(|| out_of_range("tilt", tilt_deg, "-45 to 45 degrees"))?,
        speed_deg_per_s,
    })
}

fn centideg(deg: f64, centideg_max: i16) -> Option<i16> {
    let rounded = (deg * 100.0).round();
    let is_in_range = rounded.abs() <= f64::from(centideg_max);
    // In range, so the cast is exact; NaN is not in range.
    #[allow(clippy::cast_possible_truncation)]
    is_in_range.then_some(rounded as i16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_on_the_line_comes_back_from_degrees() {
        for centidegrees in -AimTarget::PAN_CENTIDEG_MAX..=AimTarget::PAN_CENTIDEG_MAX {
            let target = aim_target(f64::from(centidegrees) / 100.0, 0.0, 0).unwrap();
            assert_eq!(target.pan_centideg, centidegrees);
        }
    }

    #[test]
    fn directions_out_of_range_are_refused_with_the_range() {
        for (pan, tilt, part) in [
            (90.01, 0.0, "pan 90.01 is out of range: -90 to 90"),
            (f64::NAN, 0.0, "pan NaN"),
            (0.0, f64::NEG_INFINITY, "tilt -inf"),
            (0.0, -45.006, "tilt -45.006"),
        ] {
            let message = aim_target(pan, tilt, 0).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}
