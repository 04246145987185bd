//! Poses (where joints are sent together) and steps (a pose with a duration).

use crate::{Joint, Position, Primitive};

/// Where up to seven joints are sent together: a 16-bit word with joint `j` in bits `2j` and
/// `2j+1`, 0 leaving the joint as it is; bits 14 and 15 are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Pose(u16);

/// A pose word whose unused bits 14-15 are not zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("pose word {word:#06x} has bits above the seven joints set: bits 14 and 15 must be zero")]
pub struct BadPose {
    /// The word refused.
    pub word: u16,
}

impl Pose {
    /// Leaves every joint as it is.
    pub const EMPTY: Pose = Pose(0);

    /// Every joint at its middle position: where INIT leaves the robot.
    pub const MIDDLE: Pose = Pose(0x2AAA);

    /// The pose of a word from the line.
    ///
    /// # Errors
    /// [`BadPose`] when bit 14 or 15 is set.
    pub const fn from_word(word: u16) -> Result<Pose, BadPose> {
        if word & 0xC000 == 0 { Ok(Pose(word)) } else { Err(BadPose { word }) }
    }

    /// The word on the line.
    pub const fn word(self) -> u16 {
        self.0
    }

    /// Where `joint` is sent, if it is.
    pub const fn get(self, joint: Joint) -> Option<Position> {
        Position::from_number(((self.0 >> (2 * joint.index())) & 3) as u8)
    }

    /// This pose with `joint` sent to `position`, or left as it is for none.
    #[must_use]
    pub const fn with(self, joint: Joint, position: Option<Position>) -> Pose {
        let shift = 2 * joint.index();
        let number = match position {
            Some(position) => position.number() as u16,
            None => 0,
        };
        Pose((self.0 & !(3 << shift)) | (number << shift))
    }

    /// Whether no joint is sent anywhere.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The primitives that make up this pose, in the order of the joints.
    pub fn primitives(self) -> impl Iterator<Item = Primitive> + Clone {
        Joint::ALL
            .into_iter()
            .filter_map(move |joint| Some(Primitive::new(joint, self.get(joint)?)))
    }
}

/// Bumpers by bit, in the order of the paper's layout: 0 left foot front, 1 left foot back,
/// 2 right foot front, 3 right foot back, 4 left hand, 5 right hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct BumperMask(u8);

impl BumperMask {
    /// How many bumpers the robot has.
    pub const COUNT: usize = 6;
    /// No bumper.
    pub const NONE: BumperMask = BumperMask(0);
    /// All six bumpers.
    pub const ALL: BumperMask = BumperMask(0x3F);
    /// The four bumpers of the feet.
    pub const FEET: BumperMask = BumperMask(0x0F);
    /// The bumpers' names in the order of their bits.
    pub const NAMES: [&'static str; BumperMask::COUNT] = [
        "left-foot-front",
        "left-foot-back",
        "right-foot-front",
        "right-foot-back",
        "left-hand",
        "right-hand",
    ];

    /// The bumpers of bits 0-5; none when bit 6 or 7 is set.
    pub const fn from_bits(bits: u8) -> Option<BumperMask> {
        if bits & !0x3F == 0 { Some(BumperMask(bits)) } else { None }
    }

    /// The bumpers of bits 0-5 of a byte whose other bits mean something else.
    pub const fn from_low_bits(bits: u8) -> BumperMask {
        BumperMask(bits & 0x3F)
    }

    /// The bits, 0-5.
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Whether the bumper of `index` (0..=5) is among them.
    pub const fn contains(self, index: usize) -> bool {
        index < BumperMask::COUNT && self.0 & (1 << index) != 0
    }

    /// Whether no bumper is among them.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Left for right.
    #[must_use]
    pub const fn mirrored(self) -> BumperMask {
        let bits = self.0;
        let feet = ((bits & 0x03) << 2) | ((bits & 0x0C) >> 2);
        let hands = ((bits & 0x10) << 1) | ((bits & 0x20) >> 1);
        BumperMask(feet | hands)
    }

    /// Those in both.
    #[must_use]
    pub const fn intersection(self, other: BumperMask) -> BumperMask {
        BumperMask(self.0 & other.0)
    }

    /// The names of those among them.
    pub fn names(self) -> impl Iterator<Item = &'static str> + Clone {
        (0..BumperMask::COUNT)
            .filter(move |index| self.contains(*index))
            .map(|index| BumperMask::NAMES[index])
    }
}

/// One step of an action: joints that start together, for a duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Step {
    /// Where joints are sent; an empty pose is a pause.
    pub pose: Pose,
    /// How long the step lasts, 1..=65535 ms, whether or not the joints have arrived.
    pub duration_ms: u16,
    /// Whether the queue is emptied and the running step cut short first (pre-emption).
    pub replace: bool,
    /// Bumpers that end the action when pressed while this step runs.
    pub ending_bumpers: BumperMask,
}

impl Step {
    /// A step that is appended to the queue and that no bumper ends.
    pub const fn new(pose: Pose, duration_ms: u16) -> Step {
        Step { pose, duration_ms, replace: false, ending_bumpers: BumperMask::NONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirroring_bumpers_changes_left_and_right_in_their_names() {
        for (index, name) in (0..).zip(BumperMask::NAMES) {
            let mirrored = BumperMask(1 << index).mirrored();
            let swapped = match name.split_once('-') {
                Some(("left", rest)) => std::format!("right-{rest}"),
                Some((_, rest)) => std::format!("left-{rest}"),
                None => std::string::String::new(),
            };
            assert!(mirrored.names().eq([swapped.as_str()]), "{name}");
        }
    }

    #[test]
    fn every_word_is_a_pose_or_refused() {
        for word in 0..=u16::MAX {
            match Pose::from_word(word) {
                Ok(pose) => {
                    assert!(word < 0x4000);
                    let rebuilt = pose.primitives().fold(Pose::EMPTY, |pose, primitive| {
                        pose.with(primitive.joint(), Some(primitive.position()))
                    });
                    assert_eq!(rebuilt.word(), word);
                }
                Err(error) => assert!(error.word == word && word >= 0x4000),
            }
        }
    }

    #[test]
    fn the_middle_pose_sends_every_joint_to_its_middle() {
        for joint in Joint::ALL {
            assert_eq!(Pose::MIDDLE.get(joint), Some(Position::Middle));
        }
    }

    #[test]
    fn bumper_bytes_and_names() {
        for bits in 0..=255u8 {
            assert_eq!(BumperMask::from_bits(bits).is_some(), bits < 64);
            let mask = BumperMask::from_low_bits(bits);
            assert_eq!(mask.names().count(), mask.bits().count_ones() as usize);
        }
    }
}
