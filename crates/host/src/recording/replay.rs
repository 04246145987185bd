//! Recorded requests sent again, and the answers compared with the recorded ones.
//!
//! The packages go out at their recorded times, numbered for a session of their own. Against a virtual
//! robot, bumpers that the recorded answers tell of are pressed, unless the recording is of a virtual
//! robot in the same process, whose world presses them again by itself. On another robot nobody presses
//! them.

mod prepare;
mod sender;
mod touch;

use rsapien_protocol::{Address, Mode, Report, Request, SynchronizationPackage};

use self::sender::Sender;
use self::touch::Touch;
use super::compare::Comparer;
use super::exchange::{Exchange, Exchanges};
use super::{About, Difference, RecordingError, RecordingReader};
use crate::link::virtual_robot::{
    Controllers, Pace, SharedVirtualRobot, VirtualConnector, VirtualOptions, VirtualRobotConfig,
};
use crate::link::{Connect, Link, RealClock};
use crate::{CancelToken, Error};

/// What a change in a state may be earlier or later by where runs are not the same to the millisecond.
pub const TOLERANCE_MS: u64 = 20;

/// Why a replay came to no result.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The robot cannot be reached or made.
    #[error(transparent)]
    Robot(#[from] Error),
    /// The recorded world cannot be made.
    #[error("the world in the recording cannot be made: {why}")]
    World {
        /// What is wrong with it.
        why: String,
    },
    /// There is nothing to compare.
    #[error(
        "there is nothing to compare from {from_ms} ms on: the recording ends before, or before a robot could join in"
    )]
    Nothing {
        /// Where it was to begin, in ms of the recorded clock.
        from_ms: u64,
    },
    /// It was cancelled; motors are off, unless the robot did not answer STOP.
    #[error("cancelled")]
    Cancelled,
}

/// How a recording is played again.
#[derive(Clone, Debug, Default)]
pub struct ReplayOptions {
    /// Compare from this time on, in ms of the recorded clock.
    pub from_ms: u64,
    /// How much earlier or later a change may be, in ms; none for what fits: nothing where the run has to be
    /// the same to the millisecond, [`TOLERANCE_MS`] otherwise.
    pub tolerance_ms: Option<u64>,
    /// Ends it, motors off.
    pub cancel: CancelToken,
}

/// How a replay ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReplayReport {
    /// Packages sent.
    pub packages: u64,
    /// Answers compared.
    pub compared: u64,
    /// Packages that have no answer in the recording, so that there is nothing to compare.
    pub unanswered: u64,
    /// Times that a bumper was pressed or released because the recording tells so.
    pub touches: u64,
    /// Bumpers were pressed in the recording, and nobody presses those of this robot.
    pub is_untouched: bool,
    /// From the first package sent to the last, in ms of the recorded clock.
    pub duration_ms: u64,
    /// What a change may be earlier or later by, in ms; none where every answer has to be the same.
    pub tolerance_ms: Option<u64>,
    /// Where answers differ first; none when all are the same.
    pub difference: Option<Difference>,
}

/// What a recording is played against.
pub struct Target {
    link: Box<dyn Link>,
    baud: u32,
    /// Of a virtual robot, which begins afresh.
    virtual_robot: Option<SharedVirtualRobot>,
    /// It is made as the recorded one was.
    is_same: bool,
    /// Its world presses the bumpers.
    has_recorded_world: bool,
}

impl Target {
    /// A virtual robot, made as the recorded one was where the recording tells how; with these controllers.
    ///
    /// # Errors
    /// [`ReplayError::World`] and [`ReplayError::Robot`].
    pub fn virtual_robot(about: &About, controllers: Controllers) -> Result<Target, ReplayError> {
        let wrong = |why: String| ReplayError::World { why };
        let world = match &about.world {
            Some(json) => rsapien_sim::world::World::from_json(json),
            // What stood around it is not known; bumpers are pressed as they were.
            None => rsapien_sim::world::World::named("empty"),
        };
        let is_model = controllers == Controllers::Model;
        let config = VirtualRobotConfig {
            seed: about.seed.unwrap_or(1),
            world: world.map_err(|error| wrong(error.to_string()))?,
            baud: about.baud,
            controllers,
            ..VirtualRobotConfig::default()
        };
        let robot = VirtualOptions { pace: Pace::Fast, config }.build()?;
        let mut connector = VirtualConnector::new(SharedVirtualRobot::clone(&robot), Pace::Fast);
        Ok(Target {
            link: connector.connect(RealClock::start())?,
            baud: about.baud,
            virtual_robot: Some(robot),
            is_same: is_model && about.is_of_model(),
            has_recorded_world: about.world.is_some(),
        })
    }

    /// A robot behind a link.
    ///
    /// # Errors
    /// Those of the link.
    pub fn robot(connector: &mut dyn Connect, baud: u32) -> Result<Target, ReplayError> {
        let mut link = connector.connect(RealClock::start())?;
        link.flush_input()?;
        let (is_same, has_recorded_world) = (false, false);
        Ok(Target { link, baud, virtual_robot: None, is_same, has_recorded_world })
    }
}

/// Plays a recording again; `on_package` is told number and recorded time of each package.
///
/// From the middle on: a virtual robot is given all that came before, so that its state is the recorded
/// one. A robot behind a link is initialised and brought to the recorded pose, and the replay begins at the
/// next begin of a step, with the steps that the recorded robot had in its queue, or when that one was at rest.
///
/// # Errors
/// [`ReplayError`].
pub fn replay(
    reader: RecordingReader,
    target: Target,
    options: &ReplayOptions,
    on_package: impl FnMut(u64, u64),
) -> Result<ReplayReport, ReplayError> {
    let is_same = target.is_same && reader.about().is_fast;
    let is_virtual = target.virtual_robot.is_some();
    let mut run = Player {
        exchanges: Exchanges::new(reader),
        touch: Touch::new(target.virtual_robot.filter(|_| !target.has_recorded_world)),
        sender: Sender::new(target.link, target.baud, is_virtual, options.cancel.clone()),
        is_virtual,
        is_same,
    };
    let played = run.play(options, on_package);
    if !is_virtual {
        // Also when something went wrong on the way.
        run.sender.rest();
    }
    played
}

/// A replay under way.
struct Player {
    exchanges: Exchanges,
    touch: Touch,
    sender: Sender,
    is_virtual: bool,
    is_same: bool,
}

impl Player {
    fn play(
        &mut self,
        options: &ReplayOptions,
        mut on_package: impl FnMut(u64, u64),
    ) -> Result<ReplayReport, ReplayError> {
        let tolerance_ms = self.begin(options)?;
        let mut comparer = Comparer::new(tolerance_ms);
        let mut report = ReplayReport { tolerance_ms, ..ReplayReport::default() };
        let (mut begun_ms, mut last_ms) = (None, None);
        while let Some(exchange) = self.exchanges.next().transpose()? {
            on_package(exchange.number, exchange.time_ms);
            let now = self.send(&exchange)?;
            report.packages += 1;
            let mut is_compared = exchange.time_ms >= options.from_ms;
            if is_compared {
                report.unanswered += u64::from(exchange.answer.is_none());
                let begun_ms = *begun_ms.get_or_insert(exchange.time_ms);
                report.duration_ms = exchange.time_ms.saturating_sub(begun_ms);
            }
            // Where a robot stands before it is initialised, and how long that takes from there, is its own affair.
            is_compared &= self.is_virtual || !is_before_initialised(&exchange);
            if comparer.push(&exchange, now.as_ref(), is_compared) {
                last_ms = None;
                break;
            }
            last_ms = exchange.answer.map(|(time_ms, _)| time_ms).or(last_ms);
        }
        if let (Some(tolerance_ms), Some(last_ms)) = (tolerance_ms, last_ms) {
            self.look_beyond(last_ms + tolerance_ms, &mut comparer)?;
        }
        (report.difference, report.compared) = comparer.finish();
        report.touches = self.touch.count();
        report.is_untouched = self.touch.is_missing() && !self.is_virtual;
        if begun_ms.is_none() {
            return Err(ReplayError::Nothing { from_ms: options.from_ms });
        }
        Ok(report)
    }

    /// Brings the robot to where the recorded one was; the tolerance that fits then.
    fn begin(&mut self, options: &ReplayOptions) -> Result<Option<u64>, ReplayError> {
        let (exchanges, sender) = (&mut self.exchanges, &mut self.sender);
        let is_brought = if !self.is_virtual && options.from_ms > 0 {
            prepare::middle(exchanges, sender, options.from_ms)?;
            true
        } else {
            prepare::begin(exchanges, sender)?
        };
        Ok(match options.tolerance_ms {
            Some(0) => None,
            None if self.is_same && !is_brought => None,
            other => Some(other.unwrap_or(TOLERANCE_MS)),
        })
    }

    /// Sends a recorded package at its time; the new answer, if one comes.
    fn send(&mut self, exchange: &Exchange) -> Result<Option<SynchronizationPackage>, ReplayError> {
        let sender = &mut self.sender;
        let recorded = exchange.answer.as_ref().and_then(|(_, answer)| mode_of(answer));
        if !self.is_virtual
            && recorded.is_some_and(|mode| mode != Mode::Initialising)
            && sender.mode(exchange.address) == Some(Mode::Initialising)
        {
            prepare::until_rest(sender, exchange.address)?;
            sender.begin_clock_at(Some(exchange.time_ms));
        }
        let due_ms = sender.due_ms(exchange.time_ms);
        if exchange.address == Address::Motion
            && let Some((_, answer)) = &exchange.answer
        {
            self.touch.follow(answer, due_ms, |until_ms| sender.wait_until(until_ms))?;
        }
        sender.wait_until(due_ms)?;
        sender.send(exchange)
    }

    /// Asks for the states at a time beyond the end of the recording.
    fn look_beyond(&mut self, time_ms: u64, comparer: &mut Comparer) -> Result<(), ReplayError> {
        let due_ms = self.sender.due_ms(time_ms);
        self.sender.wait_until(due_ms)?;
        for address in Address::ALL {
            if let Some(now) = self.sender.ask(address, Request::State)? {
                comparer.push_beyond(address, time_ms, &now);
            }
        }
        Ok(())
    }
}

/// Whether the recorded controller was not initialised yet.
fn is_before_initialised(exchange: &Exchange) -> bool {
    let mode = exchange.answer.as_ref().and_then(|(_, answer)| mode_of(answer));
    matches!(mode, Some(Mode::Fresh | Mode::Initialising))
}

/// The mode that an answer tells of, if it does.
fn mode_of(answer: &SynchronizationPackage) -> Option<Mode> {
    match answer.report {
        Report::Motion(report) => Some(report.mode),
        Report::Camera(report) => Some(report.mode),
        _ => None,
    }
}
