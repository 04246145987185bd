//! Action packages: what the PC asks a controller for.

use crate::frame::{self, ACTION_CONTENT_LENGTH, ActionBytes, action as at};
use crate::{Address, BumperMask, Direction, HeaderByte, Joint, Kind, Pose, Status, Step};

/// A direction for the camera, as it stands on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct AimTarget {
    /// Right of straight ahead, in 0.01 degree, -9000..=9000.
    pub pan_centideg: i16,
    /// Above straight ahead, in 0.01 degree, -4500..=4500.
    pub tilt_centideg: i16,
    /// Speed of both axes in degrees per second; 0: as fast as the head can.
    pub speed_deg_per_s: u16,
}

impl AimTarget {
    /// The largest pan either way, in 0.01 degree.
    pub const PAN_CENTIDEG_MAX: i16 = 9000;
    /// The largest tilt either way, in 0.01 degree.
    pub const TILT_CENTIDEG_MAX: i16 = 4500;

    /// Whether both angles are in range.
    pub const fn is_in_range(self) -> bool {
        self.pan_centideg.unsigned_abs() <= Self::PAN_CENTIDEG_MAX as u16
            && self.tilt_centideg.unsigned_abs() <= Self::TILT_CENTIDEG_MAX as u16
    }
}

/// A parameter that CONFIGURE sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Silence after which motion ends, in ms: 100..=10000, or 0 for never.
    DeadMan {
        /// The time in ms.
        timeout_ms: u16,
    },
    /// The time that a joint takes from one end stop to the other, in ms: 100..=10000.
    TravelTime {
        /// Which joint.
        joint: Joint,
        /// The time in ms.
        full_travel_ms: u16,
    },
}

impl Parameter {
    /// The dead-man time at reset, in ms.
    pub const DEAD_MAN_MS_DEFAULT: u16 = 500;
    /// The range of the dead-man time in ms, but for 0.
    pub const DEAD_MAN_MS: core::ops::RangeInclusive<u16> = 100..=10_000;
    /// The range of a travel time in ms.
    pub const TRAVEL_MS: core::ops::RangeInclusive<u16> = 100..=10_000;

    /// Whether the value is in range.
    pub fn is_in_range(self) -> bool {
        match self {
            Parameter::DeadMan { timeout_ms } => {
                timeout_ms == 0 || Self::DEAD_MAN_MS.contains(&timeout_ms)
            }
            Parameter::TravelTime { full_travel_ms, .. } => {
                Self::TRAVEL_MS.contains(&full_travel_ms)
            }
        }
    }
}

/// A request with its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Request {
    /// Opens a session under the number proposed.
    Hello {
        /// Lowest protocol version the PC speaks.
        lowest_version: u8,
        /// Highest protocol version the PC speaks; not below the lowest.
        highest_version: u8,
        /// The session proposed; not 0.
        session: u8,
    },
    /// Interrogation of the state, and the heartbeat.
    State,
    /// All motors off, queue emptied.
    Stop,
    /// Interrogation of the counters.
    Counters,
    /// Robot initialisation.
    Init,
    /// Queues a step.
    Step(Step),
    /// Sets a parameter.
    Configure(Parameter),
    /// Sends the camera to a direction.
    Aim(AimTarget),
    /// Drives both camera axes to zero.
    Home,
}

impl Request {
    /// The kind of the request.
    pub const fn kind(&self) -> Kind {
        match self {
            Request::Hello { .. } => Kind::Hello,
            Request::State => Kind::State,
            Request::Stop => Kind::Stop,
            Request::Counters => Kind::Counters,
            Request::Init => Kind::Init,
            Request::Step(_) => Kind::Step,
            Request::Configure(_) => Kind::Configure,
            Request::Aim(_) => Kind::Aim,
            Request::Home => Kind::Home,
        }
    }

    /// Whether a controller accepts the arguments; if not, it answers [`Status::BadArgument`].
    pub fn is_valid(&self) -> bool {
        match self {
            Request::Hello { lowest_version, highest_version, session } => {
                *session != 0 && lowest_version <= highest_version
            }
            Request::Step(step) => step.duration_ms != 0,
            Request::Configure(parameter) => parameter.is_in_range(),
            Request::Aim(target) => target.is_in_range(),
            Request::State | Request::Stop | Request::Counters | Request::Init | Request::Home => {
                true
            }
        }
    }
}

/// An action package, fully understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ActionPackage {
    /// The session it belongs to.
    pub session: u8,
    /// Its number in the session; echoed, and checked for numbered kinds.
    pub sequence: u8,
    /// What is asked for.
    pub request: Request,
}

impl ActionPackage {
    /// The line bytes of the package, addressed to `address`.
    pub fn encode(&self, address: Address) -> ActionBytes {
        let header = HeaderByte { direction: Direction::ToRobot, address };
        frame::encode(header, &self.content())
    }

    /// The content of the package.
    pub fn content(&self) -> [u8; ACTION_CONTENT_LENGTH] {
        let mut content = [0; ACTION_CONTENT_LENGTH];
        content[at::SESSION] = self.session;
        content[at::SEQUENCE] = self.sequence;
        content[at::KIND] = self.request.kind().byte();
        match self.request {
            Request::Hello { lowest_version, highest_version, session } => {
                content[at::HELLO_LOWEST] = lowest_version;
                content[at::HELLO_HIGHEST] = highest_version;
                content[at::HELLO_SESSION] = session;
            }
            Request::Step(step) => {
                frame::put_word(&mut content, at::STEP_POSE, step.pose.word());
                frame::put_word(&mut content, at::STEP_DURATION, step.duration_ms);
                content[at::STEP_FLAGS] = u8::from(step.replace);
                content[at::STEP_BUMPERS] = step.ending_bumpers.bits();
            }
            Request::Configure(parameter) => {
                let (number, value) = match parameter {
                    Parameter::DeadMan { timeout_ms } => (0, timeout_ms),
                    Parameter::TravelTime { joint, full_travel_ms } => {
                        (joint.index() + 1, full_travel_ms)
                    }
                };
                content[at::CONFIGURE_PARAMETER] = number;
                frame::put_word(&mut content, at::CONFIGURE_VALUE, value);
            }
            Request::Aim(target) => {
                frame::put_word(&mut content, at::AIM_PAN, target.pan_centideg.cast_unsigned());
                frame::put_word(&mut content, at::AIM_TILT, target.tilt_centideg.cast_unsigned());
                frame::put_word(&mut content, at::AIM_SPEED, target.speed_deg_per_s);
            }
            Request::State | Request::Stop | Request::Counters | Request::Init | Request::Home => {}
        }
        content
    }

    /// The package of a content.
    ///
    /// # Errors
    /// [`Status::UnknownKind`] or [`Status::BadArgument`], as a controller would answer.
    pub fn parse(content: &[u8; ACTION_CONTENT_LENGTH]) -> Result<ActionPackage, Status> {
        let view = ActionView::new(content);
        let kind = view.kind().ok_or(Status::UnknownKind)?;
        let request = view.request(kind)?;
        Ok(ActionPackage { session: view.session(), sequence: view.sequence(), request })
    }
}

/// A thin view of an action package's content, for a controller that has to answer even what it
/// does not understand. No accessor can fail or panic but [`request`](ActionView::request).
#[derive(Clone, Copy, Debug)]
pub struct ActionView<'content> {
    content: &'content [u8; ACTION_CONTENT_LENGTH],
}

impl<'content> ActionView<'content> {
    /// A view of `content`.
    pub const fn new(content: &'content [u8; ACTION_CONTENT_LENGTH]) -> ActionView<'content> {
        ActionView { content }
    }

    /// The session named.
    pub const fn session(self) -> u8 {
        self.content[at::SESSION]
    }

    /// The sequence number.
    pub const fn sequence(self) -> u8 {
        self.content[at::SEQUENCE]
    }

    /// The byte of the kind, known or not.
    pub const fn kind_byte(self) -> u8 {
        self.content[at::KIND]
    }

    /// The kind, if known.
    pub const fn kind(self) -> Option<Kind> {
        Kind::from_byte(self.content[at::KIND])
    }

    /// The arguments read as those of `kind`.
    ///
    /// # Errors
    /// [`Status::BadArgument`] when one is out of its range or an unused byte is not zero.
    pub fn request(self, kind: Kind) -> Result<Request, Status> {
        let content = self.content;
        let (request, end) = match kind {
            Kind::Hello => {
                let hello = Request::Hello {
                    lowest_version: content[at::HELLO_LOWEST],
                    highest_version: content[at::HELLO_HIGHEST],
                    session: content[at::HELLO_SESSION],
                };
                (hello, at::HELLO_END)
            }
            Kind::State => (Request::State, at::ARGUMENTS),
            Kind::Stop => (Request::Stop, at::ARGUMENTS),
            Kind::Counters => (Request::Counters, at::ARGUMENTS),
            Kind::Init => (Request::Init, at::ARGUMENTS),
            Kind::Home => (Request::Home, at::ARGUMENTS),
            Kind::Step => (Request::Step(self.step()?), at::STEP_END),
            Kind::Configure => (Request::Configure(self.parameter()?), at::CONFIGURE_END),
            Kind::Aim => {
                let target = AimTarget {
                    pan_centideg: frame::word(content, at::AIM_PAN).cast_signed(),
                    tilt_centideg: frame::word(content, at::AIM_TILT).cast_signed(),
                    speed_deg_per_s: frame::word(content, at::AIM_SPEED),
                };
                (Request::Aim(target), at::AIM_END)
            }
        };
        let unused_are_zero = content.iter().skip(end).all(|byte| *byte == 0);
        if unused_are_zero && request.is_valid() { Ok(request) } else { Err(Status::BadArgument) }
    }

    fn step(self) -> Result<Step, Status> {
        let pose = Pose::from_word(frame::word(self.content, at::STEP_POSE));
        let flags = self.content[at::STEP_FLAGS];
        let bumpers = BumperMask::from_bits(self.content[at::STEP_BUMPERS]);
        match (pose, bumpers, flags) {
            (Ok(pose), Some(ending_bumpers), 0 | 1) => Ok(Step {
                pose,
                duration_ms: frame::word(self.content, at::STEP_DURATION),
                replace: flags == 1,
                ending_bumpers,
            }),
            _ => Err(Status::BadArgument),
        }
    }

    fn parameter(self) -> Result<Parameter, Status> {
        let value = frame::word(self.content, at::CONFIGURE_VALUE);
        match self.content[at::CONFIGURE_PARAMETER] {
            0 => Ok(Parameter::DeadMan { timeout_ms: value }),
            number => Joint::from_index(number - 1)
                .map(|joint| Parameter::TravelTime { joint, full_travel_ms: value })
                .ok_or(Status::BadArgument),
        }
    }
}
