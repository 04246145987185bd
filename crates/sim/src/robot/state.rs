//! The truth about a robot as one reading, for tests and for other programs.

use rsapien_protocol::Joint;
use serde::{Deserialize, Serialize};

use super::{Power, VirtualRobot};
use crate::camera::HeadAngles;
use crate::geometry::RobotPose;

/// One joint as it truly is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointReading {
    /// Name, such as `left-arm`.
    pub joint: String,
    /// Fraction of full travel: 0 at the first position of the paper's Table 1, 1 at the last.
    pub position: f64,
    /// The motor's pins: `off`, or the name of the position it is driven towards, such as `up`.
    pub motor: String,
    /// Whether the motor runs against an end stop or a jam.
    pub stalled: bool,
}

/// The truth about the robot at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotReading {
    /// Virtual time in ms.
    pub time_ms: u64,
    /// Whether the controllers run.
    pub power: Power,
    /// Mode of the motion controller, such as `idle`; of a firmware in a simulator, as it last told it on the line.
    pub motion_mode: String,
    /// Mode of the camera controller, as for the motion controller.
    pub camera_mode: String,
    /// Every joint, in the order of the link.
    pub joints: Vec<JointReading>,
    /// Names of the bumpers whose contacts are closed.
    pub bumpers: Vec<String>,
    /// Whether the mid-arm switches are closed: left, right.
    pub middle_switches: [bool; 2],
    /// Where the robot stands.
    pub pose: RobotPose,
    /// Where the head points.
    pub head: HeadAngles,
    /// Supply of the controllers in mV.
    pub supply_mv: u32,
    /// Supply of the motors in mV.
    pub motor_supply_mv: u32,
    /// Whether the cable is pulled.
    pub cable_pulled: bool,
}

impl VirtualRobot {
    /// The truth about the robot now.
    pub fn reading(&self) -> RobotReading {
        RobotReading {
            time_ms: self.now_ms,
            power: self.power,
            motion_mode: self.motion_report().mode.name().to_owned(),
            camera_mode: self.camera_report().mode.name().to_owned(),
            joints: Joint::ALL.map(|joint| self.joint_reading(joint)).into(),
            bumpers: self.body.bumpers().names().map(str::to_owned).collect(),
            middle_switches: self.body.middle_switches(),
            pose: self.pose(),
            head: self.camera_angles(),
            supply_mv: self.body.supply_mv(),
            motor_supply_mv: self.body.motor_supply_mv(),
            cable_pulled: self.is_cable_pulled(),
        }
    }

    fn joint_reading(&self, joint: Joint) -> JointReading {
        let (pins, bit) = (self.motors(), 1 << joint.index());
        let [first, _, last] = joint.position_names();
        let motor = match (pins.towards_first & bit != 0, pins.towards_last & bit != 0) {
            (true, false) => first,
            (false, true) => last,
            _ => "off",
        };
        JointReading {
            joint: joint.name().to_owned(),
            position: self.body.position(joint),
            motor: motor.to_owned(),
            stalled: self.body.stalled() & bit != 0,
        }
    }
}
