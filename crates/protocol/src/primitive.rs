//! The 21 motion primitives (paper, Table 1).

use crate::{Joint, Position};
use core::fmt;

/// A basic motion primitive: one joint sent to one of its positions.
///
/// Number `n` (1..=21) is joint `(n-1)/3` at position `(n-1)%3+1`. Its name is the joint's and
/// the position's, in the order of Table 1: `right-arm-up`, `tilt-mid`, `left-leg-back`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Primitive {
    joint: Joint,
    position: Position,
}

impl Primitive {
    /// How many primitives there are.
    pub const COUNT: u8 = 21;

    /// The primitive that sends `joint` to `position`.
    pub const fn new(joint: Joint, position: Position) -> Primitive {
        Primitive { joint, position }
    }

    /// The primitive of a number 1..=21 of Table 1; none otherwise.
    pub const fn from_number(number: u8) -> Option<Primitive> {
        if number == 0 || number > Primitive::COUNT {
            return None;
        }
        let joint = Joint::ALL[((number - 1) / 3) as usize];
        let position = Position::ALL[((number - 1) % 3) as usize];
        Some(Primitive { joint, position })
    }

    /// The number in Table 1, 1..=21.
    pub const fn number(self) -> u8 {
        self.joint.index() * 3 + self.position.number()
    }

    /// The joint it moves.
    pub const fn joint(self) -> Joint {
        self.joint
    }

    /// Where it sends the joint.
    pub const fn position(self) -> Position {
        self.position
    }

    /// The name of the position alone: `up`.
    pub const fn position_name(self) -> &'static str {
        self.joint.position_names()[(self.position.number() - 1) as usize]
    }

    /// Left for right: the same of the other side; the trunk tilts to the other side.
    #[must_use]
    pub const fn mirrored(self) -> Primitive {
        let position = match (self.joint, self.position) {
            (Joint::Tilt, Position::First) => Position::Last,
            (Joint::Tilt, Position::Last) => Position::First,
            (_, position) => position,
        };
        Primitive { joint: self.joint.mirrored(), position }
    }

    /// Every primitive in the order of Table 1.
    pub fn all() -> impl ExactSizeIterator<Item = Primitive> + Clone {
        (0..Primitive::COUNT).map(|index| Primitive {
            joint: Joint::ALL[usize::from(index / 3)],
            position: Position::ALL[usize::from(index % 3)],
        })
    }

    /// The primitive of a name (`right-arm-up`, any case, `_` or space for `-`) or number (`1`).
    ///
    /// # Errors
    /// [`UnknownPrimitive`] when neither a name nor a number of Table 1.
    pub fn parse(text: &str) -> Result<Primitive, UnknownPrimitive> {
        let text = text.trim();
        if let Ok(number) = text.parse::<u8>() {
            return Primitive::from_number(number).ok_or(UnknownPrimitive);
        }
        Primitive::all().find(|primitive| primitive.is_named(text)).ok_or(UnknownPrimitive)
    }

    fn is_named(self, text: &str) -> bool {
        let name = self.joint.name().bytes().chain([b'-']).chain(self.position_name().bytes());
        let text = text.bytes().map(|byte| match byte {
            b'_' | b' ' => b'-',
            other => other.to_ascii_lowercase(),
        });
        text.eq(name)
    }
}

impl fmt::Display for Primitive {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}-{}", self.joint.name(), self.position_name())
    }
}

/// A text that names no motion primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "not a motion primitive: expected a number from 1 to 21 or a name such as right-arm-up, tilt-mid or left-leg-back"
)]
pub struct UnknownPrimitive;

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn mirroring_changes_left_and_right_in_the_name() {
        for primitive in Primitive::all() {
            let swapped = primitive
                .to_string()
                .replace("left", "?")
                .replace("right", "left")
                .replace('?', "right");
            assert_eq!(primitive.mirrored().to_string(), swapped);
        }
    }

    /// Table 1 of the paper, in its order.
    const TABLE_1: [&str; 21] = [
        "Right Arm Up",
        "Right Arm Front",
        "Right Arm Down",
        "Left Arm Up",
        "Left Arm Front",
        "Left Arm Down",
        "Right Hand In",
        "Right Hand Mid",
        "Right Hand Open",
        "Left Hand In",
        "Left Hand Mid",
        "Left Hand Open",
        "Tilt Left",
        "Tilt Mid",
        "Tilt Right",
        "Right Leg Front",
        "Right Leg Mid",
        "Right Leg Back",
        "Left Leg Front",
        "Left Leg Mid",
        "Left Leg Back",
    ];

    #[test]
    fn numbers_and_names_are_those_of_table_1() {
        for (number, name) in (1..).zip(TABLE_1) {
            let primitive = Primitive::parse(name).unwrap();
            assert_eq!(primitive.number(), number);
            assert_eq!(Primitive::from_number(number), Some(primitive));
            assert_eq!(Primitive::parse(&primitive.to_string()), Ok(primitive));
            assert_eq!(Primitive::parse(&number.to_string()), Ok(primitive));
        }
    }

    #[test]
    fn no_other_byte_or_name_is_a_primitive() {
        for byte in (0..=255u8).filter(|byte| !(1..=21).contains(byte)) {
            assert_eq!(Primitive::from_number(byte), None);
            assert_eq!(Primitive::parse(&byte.to_string()), Err(UnknownPrimitive));
        }
        for text in [
            "",
            "-",
            "right",
            "right-arm",
            "right-arm-",
            "right-arm-open",
            "tilt-front",
            "right-arm-up-",
        ] {
            assert_eq!(Primitive::parse(text), Err(UnknownPrimitive), "{text}");
        }
    }
}
