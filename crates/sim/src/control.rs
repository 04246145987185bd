//! The control channel: a hand that reaches into the virtual robot, for tests and for the camera of other processes.
//!
//! It stands on a Unix socket (for `sim --pty LINK` at `LINK.control`) and, if asked for, on TCP. One JSON object a
//! line goes in, one JSON object a line comes out, in order. It knows nothing of the robot's line and works while the
//! cable is pulled.
//!
//! | request | what it does |
//! |---|---|
//! | `{"press":"left-hand"}` | holds a bumper pressed; with `"held":false` lets it go |
//! | `{"bumper":"left-hand","contact":"stuck-open"}` | breaks a bumper: `working`, `stuck-open` or `stuck-closed` |
//! | `{"switch":"left-arm","contact":"stuck-closed"}` | the same for a mid-arm switch |
//! | `{"stick":"left-arm"}` | jams a joint; with `"stuck":false` frees it |
//! | `{"move":"left-arm","to":0.5}` | moves a joint by hand: 0 is its first position, 1 its last |
//! | `{"put":{"x_m":0.3,"y_m":0,"heading_rad":0}}` | lifts the robot and puts it down there |
//! | `{"cable":"pulled"}` | pulls the cable; `plugged` puts it back |
//! | `{"line":"both","faults":{"lost_ppm":1000}}` | damages bytes `to-robot`, `to-pc` or `both` ways: [`LineFaults`](crate::line::LineFaults) |
//! | `{"supply_mv":4300}` | sets the controllers' voltage: low below 5000, held in reset below 4200 |
//! | `{"motor_supply_mv":5000}` | sets the motors' voltage |
//! | `{"drain":{"motor_uv_per_s":500000}}` | sets how fast the batteries drain: [`Drain`](crate::body::Drain) |
//! | `{"hang":"motion"}` | hangs a controller until its watchdog bites; or `camera` |
//! | `{"power":"cycle"}` | `off`, `on`, `cycle`, or `brown-out` for a moment |
//! | `{"advance_ms":500}` | moves the virtual clock on, up to an hour at once |
//! | `{"get":"state"}` | the truth: [`RobotReading`](crate::robot::RobotReading) |
//! | `{"get":"picture"}` | what the camera sees, see below |
//! | `{"get":"truth"}` | `{"truth":[…]}`: every ellipse that the camera can see now |
//! | `{"get":"camera"}` | the camera's settings, with the pinhole |
//! | `{"get":"world"}` | the world as JSON |
//!
//! Whatever is no question is answered `{"done_at_ms":TIME}` with the virtual time. A picture is answered
//! `{"time_ms":…,"width":…,"height":…,"rgb_bytes":N}`, and N bytes follow the line's end: rows from the top, three
//! bytes a pixel. What is not understood is answered `{"error":"…"}` and changes nothing; the connection stays.

mod client;
mod names;
mod request;
mod serve;
#[cfg(test)]
mod tests;

pub use client::{ControlClient, ControlError};
pub use names::{ArmName, BumperName, ControllerName, JointName};
pub use request::{CableEnd, ControlRequest, LineDirection, Place, PowerSwitch, Subject};
pub(crate) use serve::{serve_tcp, serve_unix};
