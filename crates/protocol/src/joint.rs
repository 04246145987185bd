//! The seven joints and their three positions (paper, Table 1).

/// A joint of the robot: one DC motor each (paper, section 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Joint {
    /// Right shoulder: the arm up, front, down.
    RightArm = 0,
    /// Left shoulder: the arm up, front, down.
    LeftArm = 1,
    /// Right gripper: in, mid, open.
    RightHand = 2,
    /// Left gripper: in, mid, open.
    LeftHand = 3,
    /// The trunk, tilted left, mid, right.
    Tilt = 4,
    /// Right leg: front, mid, back.
    RightLeg = 5,
    /// Left leg: front, mid, back.
    LeftLeg = 6,
}

impl Joint {
    /// How many joints there are.
    pub const COUNT: usize = 7;

    /// Every joint, in the order of its index.
    pub const ALL: [Joint; Joint::COUNT] = [
        Joint::RightArm,
        Joint::LeftArm,
        Joint::RightHand,
        Joint::LeftHand,
        Joint::Tilt,
        Joint::RightLeg,
        Joint::LeftLeg,
    ];

    /// The joint of an index 0..=6; none above.
    pub const fn from_index(index: u8) -> Option<Joint> {
        if (index as usize) < Joint::COUNT { Some(Joint::ALL[index as usize]) } else { None }
    }

    /// How long each joint takes from one end stop to the other, in ms, in the order of the indices:
    /// what a controller reckons with after its reset, and until CONFIGURE sets another time.
    pub const FULL_TRAVEL_MS: [u16; Joint::COUNT] = [1000, 1000, 400, 400, 500, 600, 600];

    /// How long the joint takes from one end stop to the other, in ms (see
    /// [`FULL_TRAVEL_MS`](Joint::FULL_TRAVEL_MS)).
    pub const fn full_travel_ms(self) -> u16 {
        Self::FULL_TRAVEL_MS[self as usize]
    }

    /// How long the joint is given to stand at any position from wherever it was, in ms: its full
    /// travel, the eighth of it for which a motor runs on at an end stop, and up to 25 ms.
    pub const fn settle_ms(self) -> u16 {
        let travel_ms = self.full_travel_ms();
        (travel_ms + travel_ms / 8) / 25 * 25 + 25
    }

    /// The index on the line, 0..=6.
    pub const fn index(self) -> u8 {
        self as u8
    }

    /// The name as users write it: `right-arm`.
    pub const fn name(self) -> &'static str {
        match self {
            Joint::RightArm => "right-arm",
            Joint::LeftArm => "left-arm",
            Joint::RightHand => "right-hand",
            Joint::LeftHand => "left-hand",
            Joint::Tilt => "tilt",
            Joint::RightLeg => "right-leg",
            Joint::LeftLeg => "left-leg",
        }
    }

    /// The names of positions 1, 2 and 3 of this joint (paper, Table 1).
    pub const fn position_names(self) -> [&'static str; 3] {
        match self {
            Joint::RightArm | Joint::LeftArm => ["up", "front", "down"],
            Joint::RightHand | Joint::LeftHand => ["in", "mid", "open"],
            Joint::Tilt => ["left", "mid", "right"],
            Joint::RightLeg | Joint::LeftLeg => ["front", "mid", "back"],
        }
    }

    /// Whether the joint is an arm, the only joints with a switch at the middle.
    pub const fn has_middle_switch(self) -> bool {
        matches!(self, Joint::RightArm | Joint::LeftArm)
    }

    /// The same joint of the other side; the trunk is its own mirror image.
    #[must_use]
    pub const fn mirrored(self) -> Joint {
        match self {
            Joint::RightArm => Joint::LeftArm,
            Joint::LeftArm => Joint::RightArm,
            Joint::RightHand => Joint::LeftHand,
            Joint::LeftHand => Joint::RightHand,
            Joint::Tilt => Joint::Tilt,
            Joint::RightLeg => Joint::LeftLeg,
            Joint::LeftLeg => Joint::RightLeg,
        }
    }
}

impl core::fmt::Display for Joint {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(self.name())
    }
}

/// One of the three positions of a joint, numbered as in the paper's Table 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Position {
    /// Arm up, hand in, tilt left, leg front: one end stop.
    First = 1,
    /// Arm front, hand mid, tilt mid, leg mid.
    Middle = 2,
    /// Arm down, hand open, tilt right, leg back: the other end stop.
    Last = 3,
}

impl Position {
    /// Every position, in order.
    pub const ALL: [Position; 3] = [Position::First, Position::Middle, Position::Last];

    /// The position of a number 1..=3; none otherwise.
    pub const fn from_number(number: u8) -> Option<Position> {
        match number {
            1 => Some(Position::First),
            2 => Some(Position::Middle),
            3 => Some(Position::Last),
            _ => None,
        }
    }

    /// The number on the line, 1..=3.
    pub const fn number(self) -> u8 {
        self as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_is_a_joint_or_none() {
        for byte in 0..=255u8 {
            assert_eq!(Joint::from_index(byte).map(Joint::index), (byte < 7).then_some(byte));
            let position = Position::from_number(byte).map(Position::number);
            assert_eq!(position, (1..=3).contains(&byte).then_some(byte));
        }
    }

    #[test]
    fn mirroring_twice_changes_nothing() {
        for joint in Joint::ALL {
            assert_eq!(joint.mirrored().mirrored(), joint);
            assert_eq!(joint.mirrored().position_names(), joint.position_names());
        }
    }
}
