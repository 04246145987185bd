//! Typed exceptions, and how the crates' errors become them.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use rsapien::Error;
use rsapien_registry::RegistryError as StoreError;

create_exception!(rsapien, RsapienError, PyException, "What every error of this module is.");
create_exception!(rsapien, LinkError, RsapienError, "The link cannot be opened, or was lost.");
create_exception!(rsapien, LinkTimeout, LinkError, "The robot does not answer.");
create_exception!(
    rsapien,
    RobotRefused,
    RsapienError,
    "A controller said no. The attribute `status` is the number of its status."
);
create_exception!(rsapien, ControllerHeld, RsapienError, "Another holder has the controller.");
create_exception!(rsapien, MotionInterrupted, RsapienError, "What was under way ended early.");
create_exception!(rsapien, OutcomeUnknown, RsapienError, "Whether the robot did it is unknown.");
create_exception!(rsapien, BadReport, RsapienError, "A report this version does not understand.");
create_exception!(rsapien, RecordingError, RsapienError, "A recording cannot be read or written.");
create_exception!(rsapien, RegistryError, RsapienError, "The registry could not do it.");
create_exception!(rsapien, RegistryTooNew, RegistryError, "A newer program wrote the registry.");
create_exception!(rsapien, UnknownAction, RegistryError, "The registry has no such action.");
create_exception!(
    rsapien,
    ActionRefused,
    RegistryError,
    "An action that is wrong; the text says where."
);

/// A value that is out of its range.
pub(crate) fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The exception of an error of the host library.
pub(crate) fn robot_error(error: Error) -> PyErr {
    let text = error.to_string();
    match error {
        Error::BadAddress { .. } | Error::OutOfRange { .. } | Error::OppositePrimitives { .. } => {
            PyValueError::new_err(text)
        }
        Error::NoAnswer { .. } | Error::TimeLimit { .. } => LinkTimeout::new_err(text),
        Error::Refused { status, .. } => Python::attach(|py| {
            let refused = RobotRefused::new_err(text);
            match refused.value(py).setattr("status", status.byte()) {
                Ok(()) => refused,
                Err(error) => error,
            }
        }),
        Error::Held { .. } | Error::Claimed { .. } => ControllerHeld::new_err(text),
        Error::Interrupted { .. } | Error::Displaced { .. } => MotionInterrupted::new_err(text),
        Error::OutcomeUnknown { .. } => OutcomeUnknown::new_err(text),
        Error::BadReport { .. } => BadReport::new_err(text),
        Error::Registry(error) => registry_error(error),
        Error::LinkNotFound { .. }
        | Error::PermissionDenied { .. }
        | Error::LinkOpen { .. }
        | Error::NoRobot { .. }
        | Error::Ambiguous { .. }
        | Error::LinkLost { .. }
        | Error::Closed => LinkError::new_err(text),
        _ => RsapienError::new_err(text),
    }
}

/// The exception of an error of a recording.
pub(crate) fn recording_error(error: rsapien::recording::RecordingError) -> PyErr {
    let cause = std::error::Error::source(&error);
    let cause = cause.map_or_else(String::new, |cause| format!(": {cause}"));
    RecordingError::new_err(format!("{error}{cause}"))
}

/// The exception of an error of the registry.
pub(crate) fn registry_error(error: StoreError) -> PyErr {
    let text = error.to_string();
    match error {
        StoreError::TooNew { .. } => RegistryTooNew::new_err(text),
        StoreError::UnknownAction { .. } | StoreError::UnknownVersion { .. } => {
            UnknownAction::new_err(text)
        }
        StoreError::Refused { .. } | StoreError::IsPrimitive { .. } => ActionRefused::new_err(text),
        _ => RegistryError::new_err(text),
    }
}

/// What a wait that Ctrl-C cut short raises, once the motors are off.
pub(crate) fn interrupted_by_keyboard() -> PyErr {
    PyKeyboardInterrupt::new_err("the motors were stopped")
}

/// Puts the exceptions into the module.
pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("RsapienError", py.get_type::<RsapienError>())?;
    module.add("LinkError", py.get_type::<LinkError>())?;
    module.add("LinkTimeout", py.get_type::<LinkTimeout>())?;
    module.add("RobotRefused", py.get_type::<RobotRefused>())?;
    module.add("ControllerHeld", py.get_type::<ControllerHeld>())?;
    module.add("MotionInterrupted", py.get_type::<MotionInterrupted>())?;
    module.add("OutcomeUnknown", py.get_type::<OutcomeUnknown>())?;
    module.add("BadReport", py.get_type::<BadReport>())?;
    module.add("RecordingError", py.get_type::<RecordingError>())?;
    module.add("RegistryError", py.get_type::<RegistryError>())?;
    module.add("RegistryTooNew", py.get_type::<RegistryTooNew>())?;
    module.add("UnknownAction", py.get_type::<UnknownAction>())?;
    module.add("ActionRefused", py.get_type::<ActionRefused>())
}
