//! Requests of the control channel, and what they do.

use rsapien_protocol::Direction;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::names::{ArmName, BumperName, ControllerName, JointName};
use crate::body::{Contact, Drain, HIGHEST_MV};
use crate::line::LineFaults;
use crate::robot::{NotWithFirmware, VirtualRobot};

/// The farthest the clock is moved by one request, in ms: an hour.
const ADVANCE_MS_MAX: u64 = 3_600_000;
/// The farthest from the start that the robot is put down, in metres.
const PLACE_M_MAX: f64 = 1000.0;

/// Whether the cable is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CableEnd {
    /// Out: bytes get lost both ways.
    Pulled,
    /// In.
    Plugged,
}

/// A way of bytes on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineDirection {
    /// From the PC to the controllers.
    ToRobot,
    /// From the controllers to the PC.
    ToPc,
    /// Both.
    Both,
}

/// What is done with the power switch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PowerSwitch {
    /// Switched off and left off.
    Off,
    /// Switched on.
    On,
    /// Off and on.
    Cycle,
    /// The supply sags for a moment.
    BrownOut,
}

/// What may be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Subject {
    /// The truth about the robot.
    State,
    /// What the camera sees.
    Picture,
    /// The ellipses that the camera can see.
    Truth,
    /// The camera's settings.
    Camera,
    /// The world.
    World,
}

/// Where the robot is put down.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Metres forward of the start.
    pub x_m: f64,
    /// Metres to the left of the start.
    pub y_m: f64,
    /// Radians, counter-clockwise.
    #[serde(default)]
    pub heading_rad: f64,
}

/// A request; [the module](super) tells what each does. The first field is the one that names it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[expect(missing_docs, reason = "the table in the module's documentation tells every field")]
pub enum ControlRequest {
    Press { press: BumperName, held: bool },
    Bumper { bumper: BumperName, contact: Contact },
    Switch { switch: ArmName, contact: Contact },
    Stick { stick: JointName, stuck: bool },
    Move { r#move: JointName, to: f64 },
    Put { put: Place },
    Cable { cable: CableEnd },
    Line { line: LineDirection, faults: LineFaults },
    Supply { supply_mv: u32 },
    MotorSupply { motor_supply_mv: u32 },
    Drain { drain: Drain },
    Hang { hang: ControllerName },
    Power { power: PowerSwitch },
    Advance { advance_ms: u64 },
    Get { get: Subject },
}

/// The fields that name a request, in the order of the documentation.
const COMMANDS: &str = "press, bumper, switch, stick, move, put, cable, line, supply_mv, \
                        motor_supply_mv, drain, hang, power, advance_ms, get";

/// Fields of an object, taken out one by one, so that what is left is unknown.
struct Fields(Map<String, Value>);

impl Fields {
    fn required<T: DeserializeOwned>(&mut self, name: &str) -> Result<T, String> {
        self.optional(name)?.ok_or_else(|| format!("the field \"{name}\" is missing"))
    }

    fn optional<T: DeserializeOwned>(&mut self, name: &str) -> Result<Option<T>, String> {
        let value = self.0.remove(name);
        let parsed = value.map(serde_json::from_value).transpose();
        parsed.map_err(|error| format!("\"{name}\": {error}"))
    }
}

impl ControlRequest {
    /// Reads a request from one line of JSON.
    ///
    /// # Errors
    /// A text that names what is wrong and what is allowed.
    pub fn parse(line: &[u8]) -> Result<Self, String> {
        let object: Map<String, Value> = serde_json::from_slice(line)
            .map_err(|error| format!("not one JSON object on one line: {error}"))?;
        let mut fields = Fields(object);
        let request = Self::from_fields(&mut fields)?;
        match fields.0.keys().next() {
            Some(unknown) => Err(format!("the field \"{unknown}\" is not known here")),
            None => request.check(),
        }
    }

    fn from_fields(fields: &mut Fields) -> Result<Self, String> {
        let has = |name: &str| fields.0.contains_key(name);
        Ok(if has("press") {
            let press = fields.required("press")?;
            Self::Press { press, held: fields.optional("held")?.unwrap_or(true) }
        } else if has("bumper") {
            let bumper = fields.required("bumper")?;
            Self::Bumper { bumper, contact: fields.required("contact")? }
        } else if has("switch") {
            let switch = fields.required("switch")?;
            Self::Switch { switch, contact: fields.required("contact")? }
        } else if has("stick") {
            let stick = fields.required("stick")?;
            Self::Stick { stick, stuck: fields.optional("stuck")?.unwrap_or(true) }
        } else if has("move") {
            let joint = fields.required("move")?;
            Self::Move { r#move: joint, to: fields.required("to")? }
        } else if has("put") {
            Self::Put { put: fields.required("put")? }
        } else if has("cable") {
            Self::Cable { cable: fields.required("cable")? }
        } else if has("line") {
            let line = fields.required("line")?;
            Self::Line { line, faults: fields.required("faults")? }
        } else if has("supply_mv") {
            Self::Supply { supply_mv: fields.required("supply_mv")? }
        } else if has("motor_supply_mv") {
            Self::MotorSupply { motor_supply_mv: fields.required("motor_supply_mv")? }
        } else if has("drain") {
            Self::Drain { drain: fields.required("drain")? }
        } else if has("hang") {
            Self::Hang { hang: fields.required("hang")? }
        } else if has("power") {
            Self::Power { power: fields.required("power")? }
        } else if has("advance_ms") {
            Self::Advance { advance_ms: fields.required("advance_ms")? }
        } else if has("get") {
            Self::Get { get: fields.required("get")? }
        } else {
            return Err(format!("no command: name one of {COMMANDS}"));
        })
    }

    fn check(self) -> Result<Self, String> {
        let refused = match &self {
            Self::Move { to, .. } if !(0.0..=1.0).contains(to) => {
                format!("\"to\" is {to}, allowed are 0 to 1")
            }
            Self::Put { put } if !put.is_in_range() => {
                format!(
                    "\"put\" is {put:?}, allowed are -{PLACE_M_MAX} to {PLACE_M_MAX} m and -7 to 7 rad"
                )
            }
            Self::Supply { supply_mv: millivolts }
            | Self::MotorSupply { motor_supply_mv: millivolts }
                if *millivolts > HIGHEST_MV =>
            {
                format!("{millivolts} mV is too much, allowed are 0 to {HIGHEST_MV}")
            }
            Self::Line { faults, .. } if !faults.is_in_range() => {
                format!("\"faults\" is {faults:?}, allowed are 0 to 1000000 ppm each")
            }
            Self::Advance { advance_ms } if *advance_ms > ADVANCE_MS_MAX => {
                format!("\"advance_ms\" is {advance_ms}, allowed are 0 to {ADVANCE_MS_MAX}")
            }
            _ => return Ok(self),
        };
        Err(refused)
    }

    /// Does what the request says; a question changes nothing.
    ///
    /// # Errors
    /// [`NotWithFirmware`] where only a model can be treated so.
    pub fn apply(&self, robot: &mut VirtualRobot) -> Result<(), NotWithFirmware> {
        match *self {
            Self::Press { press, held } => robot.press_bumper(press.index(), held),
            Self::Bumper { bumper, contact } => robot.set_bumper(bumper.index(), contact),
            Self::Switch { switch, contact } => robot.set_switch(switch.joint(), contact),
            Self::Stick { stick, stuck } => robot.stick_joint(stick.0, stuck),
            Self::Move { r#move, to } => robot.move_joint(r#move.0, to),
            Self::Put { put } => robot.put_at(put.x_m, put.y_m, put.heading_rad),
            Self::Cable { cable } => robot.pull_cable(cable == CableEnd::Pulled),
            Self::Line { line, faults } => {
                if line != LineDirection::ToPc {
                    robot.set_line_faults(Direction::ToRobot, faults);
                }
                if line != LineDirection::ToRobot {
                    robot.set_line_faults(Direction::ToPc, faults);
                }
            }
            Self::Supply { supply_mv } => robot.set_supply_mv(supply_mv),
            Self::MotorSupply { motor_supply_mv } => robot.set_motor_supply_mv(motor_supply_mv),
            Self::Drain { drain } => robot.set_drain(drain),
            Self::Hang { hang } => robot.hang(hang.0)?,
            Self::Power { power } => match power {
                PowerSwitch::Off => robot.power_off(),
                PowerSwitch::On => robot.power_on(),
                PowerSwitch::Cycle => robot.power_cycle(),
                PowerSwitch::BrownOut => robot.brown_out(),
            },
            Self::Advance { advance_ms } => robot.advance_to(robot.now_ms() + advance_ms),
            Self::Get { .. } => {}
        }
        Ok(())
    }
}

impl Place {
    fn is_in_range(&self) -> bool {
        // Written so that a value that is no number is refused too.
        self.x_m.abs() <= PLACE_M_MAX
            && self.y_m.abs() <= PLACE_M_MAX
            && self.heading_rad.abs() <= 7.0
    }
}
