//! The part of the timer routine that moves one joint: dead reckoning by travel time.
//!
//! A position is the time in ms that the motor takes to it from the end stop of
//! [`Position::First`]: 0 there, `T / 2` at the middle, the full travel time `T` at the end stop
//! of [`Position::Last`]. All divisions are by powers of two and round down.
//!
//! ```text
//!                                  remaining = 0 (First, Last: on the end stop by now;
//!             sent somewhere       Middle without a switch, or with its switch closed)
//!   Resting ─────────────────► Travelling ──────────────────────────────────────► Resting, reached
//!    ▲ │  ▲                        │ arm, remaining = 0 at the reckoned middle,
//!    │ │  │ switch closes          ▼ switch open
//!    │ │  ├─────────────────── Searching       goes on for T / 8
//!    │ │  │                        │ remaining = 0
//!    │ │  │ switch closes          ▼
//!    │ │  └─────────────────── SearchingBack   turns, goes T / 4
//!    │ │                           │ remaining = 0
//!    │ │                           └─────────────────────────────────────────────► Resting, not reached
//!    │ │ INIT        remaining = T + T / 8
//!    │ └──────► Homing ── remaining = 0: position = 0, sent to the middle ──► Travelling
//!    └── all off, from any state: reached nothing, the reckoned position stays
//! ```
//!
//! * Sent to an end stop the motor overruns by `T / 8`, so that the joint surely stands there,
//!   and the position is exact again.
//! * A joint sent where it has arrived, or where it is already going, goes on as it is.
//! * When the sense turns, both outputs are off until the next tick ([`DEAD_TIME_MS`]), even when
//!   the motor had arrived just before; that time is not reckoned.

use rsapien_protocol::Position;

/// Ticks for which both direction outputs of a motor are off when its sense turns.
pub const DEAD_TIME_MS: u8 = 1;

/// How far beyond an end stop a motor runs, and how far beyond its reckoned middle an arm
/// searches for its switch, for a full travel time of `full_travel_ms`.
pub const fn overrun_ms(full_travel_ms: u16) -> u16 {
    full_travel_ms / 8
}

/// The two direction outputs of a motor. Both on cannot be said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum MotorOutput {
    /// Both off: the safe state.
    #[default]
    Off = 0,
    /// Drives the joint towards its first position: up, in, left, front.
    TowardsFirst = 1,
    /// Drives the joint towards its last position: down, open, right, back.
    TowardsLast = 2,
}

impl MotorOutput {
    const fn turned(self) -> MotorOutput {
        match self {
            MotorOutput::Off => MotorOutput::Off,
            MotorOutput::TowardsFirst => MotorOutput::TowardsLast,
            MotorOutput::TowardsLast => MotorOutput::TowardsFirst,
        }
    }
}

/// What a joint is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum JointState {
    /// Motor off.
    Resting = 0,
    /// INIT drives it to its first end stop from wherever it is.
    Homing = 1,
    /// On its way to a position.
    Travelling = 2,
    /// An arm beyond its reckoned middle whose switch has not closed.
    Searching = 3,
    /// An arm that turned because its switch had not closed.
    SearchingBack = 4,
}

/// One motor and what is reckoned of its joint.
#[derive(Clone, Debug)]
pub(crate) struct JointDrive {
    pub(crate) state: JointState,
    /// The sense commanded; `Off` exactly when resting.
    pub(crate) motor: MotorOutput,
    /// Ticks that both outputs stay off still.
    dead_time_ms: u8,
    /// The sense that was on the pins last; `Off` when neither was for a whole tick.
    last_driven: MotorOutput,
    pub(crate) target: Position,
    /// Where it rests, if it arrived there.
    pub(crate) reached: Option<Position>,
    pub(crate) full_travel_ms: u16,
    pub(crate) position_ms: u16,
    /// Ticks until the movement under way ends.
    pub(crate) remaining_ms: u16,
}

impl JointDrive {
    pub(crate) const fn new(full_travel_ms: u16) -> JointDrive {
        JointDrive {
            state: JointState::Resting,
            motor: MotorOutput::Off,
            dead_time_ms: 0,
            last_driven: MotorOutput::Off,
            target: Position::First,
            reached: None,
            full_travel_ms,
            position_ms: 0,
            remaining_ms: 0,
        }
    }

    pub(crate) const fn middle_ms(&self) -> u16 {
        self.full_travel_ms / 2
    }

    const fn overrun_ms(&self) -> u16 {
        overrun_ms(self.full_travel_ms)
    }

    /// The outputs as they stand on the pins.
    pub(crate) const fn output(&self) -> MotorOutput {
        if self.dead_time_ms == 0 { self.motor } else { MotorOutput::Off }
    }

    pub(crate) const fn is_resting(&self) -> bool {
        matches!(self.state, JointState::Resting)
    }

    /// Motor off where the joint is.
    pub(crate) fn stop(&mut self) {
        self.state = JointState::Resting;
        self.motor = MotorOutput::Off;
        self.dead_time_ms = 0;
    }

    /// INIT: to the first end stop from an unknown position, then to the middle.
    pub(crate) fn home(&mut self) {
        self.target = Position::Middle;
        let full_ms = self.full_travel_ms + self.overrun_ms();
        self.start(JointState::Homing, MotorOutput::TowardsFirst, full_ms);
    }

    /// Sends the joint to `target`. `switch_closed` is the mid-arm switch, for a joint that has
    /// one.
    pub(crate) fn send(&mut self, target: Position, switch_closed: Option<bool>) {
        let has_it =
            if self.is_resting() { self.reached == Some(target) } else { self.target == target };
        if has_it {
            return;
        }
        self.target = target;
        self.go(switch_closed);
    }

    /// Takes a new travel time. The position keeps its place between the end stops; a movement
    /// under way ends when it was reckoned to end.
    pub(crate) fn configure(&mut self, full_travel_ms: u16) {
        let scaled = u32::from(self.position_ms) * u32::from(full_travel_ms)
            / u32::from(self.full_travel_ms);
        self.position_ms = u16::try_from(scaled).unwrap_or(full_travel_ms);
        self.full_travel_ms = full_travel_ms;
    }

    /// Timer routine: one ms has passed.
    pub(crate) fn advance(&mut self, switch_closed: Option<bool>) {
        if self.is_resting() {
            self.last_driven = MotorOutput::Off;
            return;
        }
        if self.dead_time_ms > 0 {
            self.dead_time_ms -= 1;
            self.last_driven = self.output();
            return;
        }
        self.position_ms = match self.motor {
            MotorOutput::TowardsLast if self.position_ms < self.full_travel_ms => {
                self.position_ms + 1
            }
            MotorOutput::TowardsFirst => self.position_ms.saturating_sub(1),
            MotorOutput::TowardsLast | MotorOutput::Off => self.position_ms,
        };
        self.remaining_ms = self.remaining_ms.saturating_sub(1);
        if self.remaining_ms == 0 {
            self.movement_ended(switch_closed);
        }
    }

    /// The joint has arrived where it was sent.
    pub(crate) fn arrive(&mut self) {
        self.stop();
        self.reached = Some(self.target);
    }

    /// Reckons the way to the end stop it is going to anew, from the position as it is.
    pub(crate) fn reckon_way_to_end_stop(&mut self) {
        let way_ms = match self.target {
            Position::First => self.position_ms,
            Position::Last => self.full_travel_ms - self.position_ms,
            Position::Middle => return,
        };
        self.remaining_ms = way_ms + self.overrun_ms();
    }

    fn go(&mut self, switch_closed: Option<bool>) {
        match self.target {
            Position::First => {
                self.start(JointState::Travelling, MotorOutput::TowardsFirst, 0);
                self.reckon_way_to_end_stop();
            }
            Position::Last => {
                self.start(JointState::Travelling, MotorOutput::TowardsLast, 0);
                self.reckon_way_to_end_stop();
            }
            Position::Middle => self.go_to_middle(switch_closed),
        }
    }

    fn go_to_middle(&mut self, switch_closed: Option<bool>) {
        let middle_ms = self.middle_ms();
        let way_ms = self.position_ms.abs_diff(middle_ms);
        // A closed switch far from the reckoned middle is stuck: it is not believed.
        let already_there = match switch_closed {
            Some(closed) => closed && way_ms <= self.overrun_ms(),
            None => way_ms == 0,
        };
        if already_there {
            self.arrive();
        } else if way_ms == 0 {
            self.start(JointState::Searching, MotorOutput::TowardsLast, self.overrun_ms());
        } else if self.position_ms < middle_ms {
            self.start(JointState::Travelling, MotorOutput::TowardsLast, way_ms);
        } else {
            self.start(JointState::Travelling, MotorOutput::TowardsFirst, way_ms);
        }
    }

    fn movement_ended(&mut self, switch_closed: Option<bool>) {
        match (self.state, self.target) {
            (JointState::Resting, _) => {}
            (JointState::Homing, _) => {
                self.position_ms = 0;
                self.go(switch_closed);
            }
            (JointState::Travelling, Position::First) => {
                self.position_ms = 0;
                self.arrive();
            }
            (JointState::Travelling, Position::Last) => {
                self.position_ms = self.full_travel_ms;
                self.arrive();
            }
            (JointState::Travelling, Position::Middle) => {
                self.position_ms = self.middle_ms();
                if switch_closed == Some(false) {
                    self.start(JointState::Searching, self.motor, self.overrun_ms());
                } else {
                    self.arrive();
                }
            }
            (JointState::Searching, _) => {
                let turned = self.motor.turned();
                self.start(JointState::SearchingBack, turned, 2 * self.overrun_ms());
            }
            (JointState::SearchingBack, _) => self.stop(),
        }
    }

    fn start(&mut self, state: JointState, sense: MotorOutput, remaining_ms: u16) {
        self.state = state;
        self.motor = sense;
        self.remaining_ms = remaining_ms;
        self.dead_time_ms = if self.last_driven == sense.turned() { DEAD_TIME_MS } else { 0 };
        if self.dead_time_ms == 0 {
            self.last_driven = sense;
        }
        self.reached = None;
    }
}
