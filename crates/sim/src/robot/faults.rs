//! Faults, and hands that reach in from outside.

use rsapien_protocol::{Address, Direction, Joint};

use super::{NotWithFirmware, Power, VirtualRobot};
use crate::body::{Contact, Drain};
use crate::line::LineFaults;

impl VirtualRobot {
    /// Presses or releases a bumper (0..=5, in the order of [`rsapien_protocol::BumperMask`]); others do nothing.
    pub fn press_bumper(&mut self, index: usize, held: bool) {
        self.body.press_bumper(index, held);
    }

    /// Breaks or repairs a bumper (0..=5); others do nothing.
    pub fn set_bumper(&mut self, index: usize, contact: Contact) {
        self.body.set_bumper(index, contact);
    }

    /// Breaks or repairs the mid-arm switch of an arm; other joints have none.
    pub fn set_switch(&mut self, arm: Joint, contact: Contact) {
        self.body.set_switch(arm, contact);
    }

    /// Jams or frees a joint.
    pub fn stick_joint(&mut self, joint: Joint, stuck: bool) {
        self.body.stick_joint(joint, stuck);
    }

    /// Moves a joint by hand to a fraction of its travel, clamped to 0..=1.
    pub fn move_joint(&mut self, joint: Joint, position: f64) {
        self.body.move_joint(joint, position);
    }

    /// Lifts the robot and puts it down elsewhere: metres, and radians counter-clockwise.
    pub fn put_at(&mut self, x_m: f64, y_m: f64, heading_rad: f64) {
        self.body.put_at(x_m, y_m, heading_rad);
    }

    /// Pulls the cable or plugs it in again; bytes on their way are lost.
    pub fn pull_cable(&mut self, pulled: bool) {
        self.line.pulled = pulled;
    }

    /// Whether the cable is pulled.
    pub fn is_cable_pulled(&self) -> bool {
        self.line.pulled
    }

    /// Damages the bytes of one direction from now on.
    pub fn set_line_faults(&mut self, direction: Direction, faults: LineFaults) {
        self.line.set_faults(direction, faults);
    }

    /// Sets the controllers' supply in mV: below [`LOW_MV`](crate::body::LOW_MV) they report it, below
    /// [`BROWN_OUT_MV`](crate::body::BROWN_OUT_MV) they are held in reset.
    pub fn set_supply_mv(&mut self, millivolts: u32) {
        self.body.set_supply_mv(millivolts);
    }

    /// Sets the motors' supply in mV; their speed is in proportion to it.
    pub fn set_motor_supply_mv(&mut self, millivolts: u32) {
        self.body.set_motor_supply_mv(millivolts);
    }

    /// Sets how fast the batteries drain.
    pub fn set_drain(&mut self, drain: Drain) {
        self.body.set_drain(drain);
    }

    /// Hangs the main routine of a controller until its watchdog resets it.
    ///
    /// # Errors
    /// [`NotWithFirmware`]: the firmware itself gives no hold to hang it by.
    pub fn hang(&mut self, controller: Address) -> Result<(), NotWithFirmware> {
        self.electronics.hang(controller)
    }

    /// Lets the supply of both controllers sag for a moment: they are reset with the brown-out as cause.
    pub fn brown_out(&mut self) {
        if self.power.is_on() {
            self.power = Power::BrownOut;
            self.come_back();
        }
    }

    /// Switches the robot off and leaves it off.
    pub fn power_off(&mut self) {
        self.power = Power::Off;
    }

    /// Switches the robot on again, if it is off.
    pub fn power_on(&mut self) {
        if self.power == Power::Off {
            self.come_back();
        }
    }

    /// Switches the robot off and on.
    pub fn power_cycle(&mut self) {
        self.power_off();
        self.power_on();
    }
}
