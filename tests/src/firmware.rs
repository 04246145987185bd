//! The comparison of the firmware with its reference model.
//!
//! ```text
//!   scenarios (tests/scenarios), vectors, random sessions, kept failures (tests/regressions/firmware)
//!        │ actions
//!        ▼
//!      bench ──► reference model ─────────── record after every event ───────────┐
//!        │                                                                       ▼
//!        ├─ lock step: events ──► C core as a program of this machine ──────► equal?
//!        └─ hex:       cycles ──► the image that is flashed, in gpsim ──────► equal?
//! ```

pub mod bench;
pub mod body;
pub mod compare;
pub mod constants;
pub mod coverage;
pub mod event;
pub mod mutants;
pub mod program;
pub mod random;
pub mod record;
pub mod reference;
pub mod scenario;
pub mod vectors;

#[cfg(feature = "firmware-simulator")]
pub mod gpsim;
#[cfg(feature = "firmware-simulator")]
pub mod hex;
#[cfg(feature = "firmware-simulator")]
pub mod servos;
#[cfg(feature = "firmware-simulator")]
pub mod timing;
