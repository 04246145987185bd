//! Bringing a robot to where the recorded one was: when the recording began, or in its middle.

use std::collections::VecDeque;

use rsapien_protocol::{
    Address, AimTarget, CameraReport, Mode, MotionReport, Pose, Report, Request, Step,
};

use super::sender::Sender;
use super::{Exchange, Exchanges, ReplayError};

/// How long initialisation, homing, or the way to the pose may take, in ms.
const LIMIT_MS: u64 = 120_000;
const POLL_MS: u64 = 50;
/// How long the step to the recorded pose lasts: in this time every joint travels from end to end.
const POSE_MS: u16 = 2000;

/// How many exchanges are looked at for the first report of each controller.
const LOOKED_AT: usize = 8;

/// What the recorded robot was when the replay begins.
#[derive(Default)]
struct Before {
    motion: Option<MotionReport>,
    camera: Option<CameraReport>,
    sessions: [Option<u8>; 2],
    /// The next number of each session.
    next: [u8; 2],
    settings: Vec<Request>,
    /// The steps that had not ended; the first was under way.
    queue: VecDeque<Step>,
    /// When the first of them began, in ms of the recorded clock.
    begun_ms: u64,
    /// Where the steps that had ended have sent the joints.
    pose: Pose,
}

/// A recording may begin with a robot that was initialised before: then this one is, too. Whether that was
/// needed.
pub(super) fn begin(exchanges: &mut Exchanges, sender: &mut Sender) -> Result<bool, ReplayError> {
    let mut before = Before::default();
    let mut seen = Vec::new();
    for exchange in exchanges.by_ref().take(LOOKED_AT) {
        let exchange = exchange?;
        // Another one than the recorded sessions, which begin later.
        let own = exchange.package.session.wrapping_add(128).max(1);
        match exchange.answer.as_ref().map(|(_, answer)| answer.report) {
            Some(Report::Motion(report)) if before.motion.is_none() => {
                before.motion = Some(report);
                before.sessions[0] = (report.mode != Mode::Fresh).then_some(own);
            }
            Some(Report::Camera(report)) if before.camera.is_none() => {
                before.camera = Some(report);
                before.sessions[1] = (report.mode != Mode::Fresh).then_some(own);
            }
            _ => {}
        }
        seen.push(exchange);
    }
    exchanges.give_back(seen);
    let is_needed = before.sessions.iter().any(Option::is_some);
    if is_needed {
        before.bring_about(sender)?;
        sender.begin_clock_at(None);
    }
    Ok(is_needed)
}

/// Passes over what was recorded before `from_ms`, and brings the robot to where the recorded one was. The next
/// exchange is the first after a step began or the recorded robot was at rest.
pub(super) fn middle(
    exchanges: &mut Exchanges,
    sender: &mut Sender,
    from_ms: u64,
) -> Result<(), ReplayError> {
    let mut before = Before::default();
    let next = loop {
        let Some(exchange) = exchanges.next().transpose()? else {
            return Err(ReplayError::Nothing { from_ms });
        };
        let has_begun_step = !before.queue.is_empty() && before.begun_ms >= from_ms;
        if exchange.time_ms >= from_ms && (has_begun_step || before.is_at_rest()) {
            break exchange;
        }
        before.note(&exchange);
    };
    exchanges.give_back(vec![next]);
    before.bring_about(sender)
}

impl Before {
    fn note(&mut self, exchange: &Exchange) {
        let index = usize::from(exchange.address == Address::Camera);
        let package = &exchange.package;
        let accepted = exchange.answer.as_ref().filter(|(_, answer)| answer.status.is_accepted());
        if let Request::Hello { session, .. } = package.request {
            if self.sessions[index].replace(session) != Some(session) {
                self.next[index] = 1;
            }
        } else if package.request.kind().is_numbered() && accepted.is_some() {
            self.sessions[index] = Some(package.session);
            self.next[index] = package.sequence.wrapping_add(1);
            if matches!(package.request, Request::Configure(_)) {
                self.settings.push(package.request);
            }
        }
        if accepted.is_some() {
            self.note_steps(package.request, exchange.time_ms);
        }
        match exchange.answer.as_ref().map(|(_, answer)| answer.report) {
            Some(Report::Motion(report)) => {
                self.note_ended(&report, exchange.time_ms);
                self.motion = Some(report);
            }
            Some(Report::Camera(report)) => self.camera = Some(report),
            _ => {}
        }
    }

    fn note_steps(&mut self, request: Request, time_ms: u64) {
        match request {
            Request::Step(step) => {
                if step.replace {
                    self.queue.clear();
                }
                if self.queue.is_empty() {
                    self.begun_ms = time_ms;
                }
                self.queue.push_back(Step { replace: false, ..step });
            }
            Request::Init => {
                self.queue.clear();
                self.pose = Pose::MIDDLE;
            }
            Request::Stop => self.queue.clear(),
            _ => {}
        }
    }

    fn note_ended(&mut self, report: &MotionReport, time_ms: u64) {
        let before = self.motion.map_or(report.steps_ended, |before| before.steps_ended);
        match report.mode {
            Mode::Executing | Mode::Idle => {}
            // Steps wait for the end of it.
            Mode::Initialising => self.begun_ms = time_ms,
            Mode::Fresh | Mode::Stopped | Mode::Held => self.queue.clear(),
        }
        for _ in 0..report.steps_ended.wrapping_sub(before) {
            let Some(step) = self.queue.pop_front() else { break };
            self.begun_ms += u64::from(step.duration_ms);
            for primitive in step.pose.primitives() {
                self.pose = self.pose.with(primitive.joint(), Some(primitive.position()));
            }
        }
    }

    fn is_at_rest(&self) -> bool {
        let is_moving = |mode| matches!(mode, Mode::Initialising | Mode::Executing);
        let legs = self.motion.is_none_or(|it| !is_moving(it.mode) && it.motors == 0);
        legs && self.camera.is_none_or(|it| !is_moving(it.mode))
    }

    fn bring_about(&self, sender: &mut Sender) -> Result<(), ReplayError> {
        for (address, session) in Address::ALL.into_iter().zip(self.sessions) {
            if let Some(session) = session {
                sender.open(address, session)?;
            }
        }
        if let (Some(report), Some(_)) = (self.motion, self.sessions[0]) {
            for setting in &self.settings {
                sender.ask(Address::Motion, *setting)?;
            }
            if report.mode != Mode::Fresh {
                sender.ask(Address::Motion, Request::Init)?;
                until_rest(sender, Address::Motion)?;
                let pose = if self.queue.is_empty() { report.pose_reached } else { self.pose };
                if pose != Pose::MIDDLE && !pose.is_empty() {
                    let step = Step::new(pose, POSE_MS);
                    sender.ask(Address::Motion, Request::Step(step))?;
                    until_rest(sender, Address::Motion)?;
                }
            }
            if report.mode == Mode::Stopped {
                sender.ask(Address::Motion, Request::Stop)?;
            }
        }
        if let (Some(report), Some(_)) = (self.camera, self.sessions[1])
            && report.mode != Mode::Fresh
        {
            sender.ask(Address::Camera, Request::Home)?;
            until_rest(sender, Address::Camera)?;
            sender.ask(
                Address::Camera,
                Request::Aim(AimTarget {
                    pan_centideg: report.pan_target_centideg,
                    tilt_centideg: report.tilt_target_centideg,
                    speed_deg_per_s: 0,
                }),
            )?;
            until_rest(sender, Address::Camera)?;
        }
        if !self.queue.is_empty() {
            sender.begin_clock_at(Some(self.begun_ms));
            for step in &self.queue {
                sender.ask(Address::Motion, Request::Step(*step))?;
            }
        }
        for (address, next) in Address::ALL.into_iter().zip(self.next) {
            sender.go_on(address, next);
        }
        Ok(())
    }
}

/// Asks the controller for its state until it rests.
pub(super) fn until_rest(sender: &mut Sender, address: Address) -> Result<(), ReplayError> {
    let limit_ms = sender.now_ms() + LIMIT_MS;
    while sender.now_ms() < limit_ms {
        sender.wait_until(sender.now_ms() + POLL_MS)?;
        let Some(answer) = sender.ask(address, Request::State)? else { break };
        let (mode, is_moving) = match answer.report {
            Report::Motion(report) => (report.mode, report.motors != 0),
            Report::Camera(report) => {
                (report.mode, report.axes.pan_moving || report.axes.tilt_moving)
            }
            _ => break,
        };
        if !matches!(mode, Mode::Initialising | Mode::Executing) && !is_moving {
            return Ok(());
        }
    }
    Err(ReplayError::Robot(crate::Error::TimeLimit {
        what: "the way to the recorded pose",
        limit_ms: LIMIT_MS,
    }))
}
