//! Names of the robot's parts as they stand in requests.

use rsapien_protocol::{Address, BumperMask, Joint};
use serde::{Deserialize, Serialize};

/// A joint by its name, such as `left-arm`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct JointName(pub Joint);

/// An arm by its name: `right-arm` or `left-arm`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ArmName(Joint);

/// A bumper by its name, such as `left-foot-front`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct BumperName(usize);

/// A controller by its name: `motion` or `camera`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ControllerName(pub Address);

impl ArmName {
    /// The name of a joint that is an arm.
    pub fn new(joint: Joint) -> Option<Self> {
        joint.has_middle_switch().then_some(Self(joint))
    }

    /// The arm.
    pub const fn joint(self) -> Joint {
        self.0
    }
}

impl BumperName {
    /// The name of the bumper of an index 0..=5.
    pub fn new(index: usize) -> Option<Self> {
        (index < BumperMask::COUNT).then_some(Self(index))
    }

    /// The index, 0..=5.
    pub const fn index(self) -> usize {
        self.0
    }
}

/// The name among `known` that `text` is, or what it may be.
fn find<T: Copy>(
    text: &str,
    mut known: impl Iterator<Item = (&'static str, T)> + Clone,
) -> Result<T, String> {
    known.clone().find(|(name, _)| *name == text).map(|(_, value)| value).ok_or_else(|| {
        let first = known.next().map_or("", |(name, _)| name).to_owned();
        let names = known.fold(first, |names, (name, _)| names + ", " + name);
        format!("{text:?} is none of {names}")
    })
}

impl TryFrom<String> for JointName {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        find(&text, Joint::ALL.into_iter().map(|joint| (joint.name(), Self(joint))))
    }
}

impl TryFrom<String> for ArmName {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let arms = Joint::ALL.into_iter().filter(|joint| joint.has_middle_switch());
        find(&text, arms.map(|joint| (joint.name(), Self(joint))))
    }
}

impl TryFrom<String> for BumperName {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let names = BumperMask::NAMES.into_iter().enumerate();
        find(&text, names.map(|(index, name)| (name, Self(index))))
    }
}

impl TryFrom<String> for ControllerName {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        find(&text, Address::ALL.into_iter().map(|address| (address.name(), Self(address))))
    }
}

impl From<JointName> for String {
    fn from(name: JointName) -> String {
        name.0.name().to_owned()
    }
}

impl From<ArmName> for String {
    fn from(name: ArmName) -> String {
        name.0.name().to_owned()
    }
}

impl From<BumperName> for String {
    fn from(name: BumperName) -> String {
        BumperMask::NAMES.get(name.0).copied().unwrap_or_default().to_owned()
    }
}

impl From<ControllerName> for String {
    fn from(name: ControllerName) -> String {
        name.0.name().to_owned()
    }
}
