//! The robot's state as a dictionary.

use crate::errors::LinkTimeout;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rsapien::RobotState;
use rsapien::protocol::{BumperMask, Joint, Primitive};

/// Names in place of bits, degrees in place of hundredths.
pub(crate) fn state_dict<'py>(py: Python<'py>, state: &RobotState) -> PyResult<Bound<'py, PyDict>> {
    let silent = || LinkTimeout::new_err("the motion controller has not reported yet");
    let motion = state.motion_report().ok_or_else(silent)?;
    let told = PyDict::new(py);
    told.set_item("time_ms", state.time_ms)?;
    told.set_item("mode", motion.mode.name())?;
    told.set_item("bumpers", motion.bumpers.names().collect::<Vec<_>>())?;
    let presses = PyDict::new(py);
    for (name, count) in BumperMask::NAMES.iter().zip(motion.presses) {
        presses.set_item(name, count)?;
    }
    told.set_item("presses", presses)?;
    let running = |joint: &Joint| motion.is_running(*joint).then(|| joint.name());
    told.set_item("motors", Joint::ALL.iter().filter_map(running).collect::<Vec<_>>())?;
    let positions = PyDict::new(py);
    for joint in Joint::ALL {
        let position = motion.position(joint);
        let name = position.map(|position| Primitive::new(joint, position).position_name());
        positions.set_item(joint.name(), name)?;
    }
    told.set_item("positions", positions)?;
    told.set_item("queue_free", motion.queue_free)?;
    told.set_item("steps_ended", motion.steps_ended)?;
    told.set_item("supply_low", motion.supply_low)?;
    told.set_item("boot", motion.boot)?;
    told.set_item("cause", motion.cause.name())?;
    let camera = state.camera_report();
    told.set_item("pan", camera.map(|camera| f64::from(camera.pan_centideg) / 100.0))?;
    told.set_item("tilt", camera.map(|camera| f64::from(camera.tilt_centideg) / 100.0))?;
    Ok(told)
}
