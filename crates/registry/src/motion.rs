//! Where the joints are while an action is played, reckoned as the controllers reckon it: by nominal
//! travel times.

use rsapien_protocol::{Joint, Position};

use crate::compiled::CompiledAction;

/// The sense in which a motor drives its joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sense {
    /// Towards the first position of the paper's Table 1: up, in, left, front.
    First,
    /// Towards the last: down, open, right, back.
    Last,
}

/// A movement of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement {
    /// When it begins, in ms since the action began; waits for bumpers take no time here.
    pub from_ms: u64,
    /// When the joint arrives, or is sent elsewhere.
    pub to_ms: u64,
    /// Until when the motor runs: at an end stop it goes on for an eighth of the full travel.
    pub motor_until_ms: u64,
    /// Where the joint begins: 0 at its first position, 1 at its last.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Where it was sent.
    pub target: Position,
    /// The sense of the motor.
    pub sense: Sense,
    /// Whether it is known where it began. At the beginning of an action the middle is assumed, where
    /// the robot's initialisation leaves every joint.
    pub is_certain: bool,
    /// Whether it arrives.
    pub is_complete: bool,
    /// The index of the compiled step that sends it.
    pub step: usize,
}

/// The movements of every joint in an action, in the order of the joints' indices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// The movements of each joint in their order; they do not overlap.
    pub rows: [Vec<Movement>; Joint::COUNT],
    /// When each compiled step begins, in ms, and when the last one ends.
    pub step_begins_ms: Vec<u64>,
}

/// Where a position is on a joint's travel.
pub fn place_of(position: Position) -> f64 {
    f64::from(position.number() - 1) / 2.0
}

impl Motion {
    /// The motion of an action that begins with every joint in the middle.
    pub fn of(action: &CompiledAction) -> Motion {
        let mut motion = Motion::default();
        let mut joints = Joint::ALL.map(Reckoning::new);
        let mut waits = action.waits.iter().peekable();
        let mut at_ms = 0;
        for (index, step) in action.steps.iter().enumerate() {
            while waits.next_if(|wait| wait.before_step <= index).is_some() {
                settle(&mut joints, at_ms);
            }
            motion.step_begins_ms.push(at_ms);
            for primitive in step.pose.primitives() {
                let joint = usize::from(primitive.joint().index());
                joints[joint].send(primitive.position(), at_ms, index, &mut motion.rows[joint]);
            }
            at_ms += u64::from(step.duration_ms);
        }
        motion.step_begins_ms.push(at_ms);
        if waits.next().is_some() {
            settle(&mut joints, at_ms);
        }
        for (joint, row) in joints.into_iter().zip(&mut motion.rows) {
            row.extend(joint.under_way);
        }
        motion
    }

    /// How long the action lasts, in ms.
    pub fn duration_ms(&self) -> u64 {
        self.step_begins_ms.last().copied().unwrap_or(0)
    }

    /// Where a joint is at a moment: 0 at its first position, 1 at its last.
    pub fn place(&self, joint: Joint, at_ms: u64) -> f64 {
        let row = &self.rows[usize::from(joint.index())];
        let behind = row.partition_point(|movement| movement.from_ms <= at_ms);
        let Some(movement) = behind.checked_sub(1).and_then(|index| row.get(index)) else {
            return place_of(Position::Middle);
        };
        let length_ms = movement.to_ms - movement.from_ms;
        if at_ms >= movement.to_ms || length_ms == 0 {
            return movement.to;
        }
        #[expect(clippy::cast_precision_loss, reason = "times of an action are exact in f64")]
        let share = (at_ms - movement.from_ms) as f64 / length_ms as f64;
        movement.from + (movement.to - movement.from) * share
    }
}

fn settle(joints: &mut [Reckoning], at_ms: u64) {
    for joint in joints {
        joint.settle(at_ms);
    }
}

/// What is reckoned of one joint.
struct Reckoning {
    travel_ms: f64,
    place: f64,
    is_certain: bool,
    /// Not yet cut short.
    under_way: Option<Movement>,
}

impl Reckoning {
    fn new(joint: Joint) -> Reckoning {
        let travel_ms = f64::from(joint.full_travel_ms());
        let place = place_of(Position::Middle);
        Reckoning { travel_ms, place, is_certain: false, under_way: None }
    }

    fn send(&mut self, target: Position, at_ms: u64, step: usize, row: &mut Vec<Movement>) {
        if self.under_way.is_some_and(|movement| movement.target == target) {
            return;
        }
        self.end(at_ms, row);
        let to = place_of(target);
        let distance = (to - self.place).abs();
        let is_there = distance < f64::EPSILON;
        if is_there && self.is_certain {
            return;
        }
        let time_ms = whole_ms(distance * self.travel_ms);
        let is_end_stop = target != Position::Middle;
        let overrun_ms = if is_end_stop { whole_ms(self.travel_ms / 8.0) } else { 0 };
        self.under_way = Some(Movement {
            from_ms: at_ms,
            to_ms: at_ms + time_ms,
            motor_until_ms: at_ms + time_ms + overrun_ms,
            from: self.place,
            to,
            target,
            sense: if to < self.place || (is_there && target == Position::First) {
                Sense::First
            } else {
                Sense::Last
            },
            is_certain: self.is_certain,
            is_complete: true,
            step,
        });
    }

    /// Ends the movement under way at a moment, if it has not ended before.
    fn end(&mut self, at_ms: u64, row: &mut Vec<Movement>) {
        let Some(mut movement) = self.under_way.take() else { return };
        movement.motor_until_ms = movement.motor_until_ms.min(at_ms);
        if movement.to_ms > at_ms {
            #[expect(clippy::cast_precision_loss, reason = "times of an action are exact in f64")]
            let share =
                (at_ms - movement.from_ms) as f64 / (movement.to_ms - movement.from_ms) as f64;
            movement.to = movement.from + (movement.to - movement.from) * share;
            movement.to_ms = at_ms;
            movement.is_complete = false;
        } else {
            self.is_certain = true;
        }
        self.place = movement.to;
        row.push(movement);
    }

    /// A wait: whatever is under way arrives meanwhile.
    fn settle(&mut self, at_ms: u64) {
        if let Some(movement) = &mut self.under_way {
            movement.to_ms = movement.to_ms.min(at_ms.max(movement.from_ms));
            movement.motor_until_ms = movement.motor_until_ms.min(at_ms.max(movement.from_ms));
        }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 10,000 ms")]
fn whole_ms(ms: f64) -> u64 {
    ms.round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::check_text;
    use crate::expand::NoActions;
    use proptest::prelude::*;

    fn motion(body: &str) -> Motion {
        let text = format!("action a {{ allow too-short \"a test\" {body} }}");
        let checked = check_text(&text, &NoActions);
        Motion::of(checked.actions[0].compiled.as_ref().expect(&text))
    }

    #[test]
    fn a_joint_travels_by_its_time_overruns_at_its_stop_and_is_cut_when_sent_elsewhere() {
        let motion = motion("do tilt-left for 400ms do tilt-right for 100ms do tilt-mid for 1s");
        let [first, second, third] = motion.rows[4].as_slice() else { panic!("{motion:?}") };
        assert_eq!((first.from_ms, first.to_ms, first.motor_until_ms), (0, 250, 313));
        assert!(!first.is_certain && first.is_complete && first.sense == Sense::First);
        assert_eq!((second.from_ms, second.to_ms, second.motor_until_ms), (400, 500, 500));
        assert!(second.is_certain && !second.is_complete && second.sense == Sense::Last);
        assert!((second.to - 0.2).abs() < 1e-9);
        assert_eq!((third.from_ms, third.to_ms, third.motor_until_ms), (500, 650, 650));
        assert!((motion.place(Joint::Tilt, 125) - 0.25).abs() < 1e-9);
        assert!((motion.place(Joint::Tilt, 9999) - 0.5).abs() < 1e-9);
        assert_eq!(motion.duration_ms(), 1500);
    }

    #[test]
    fn a_joint_sent_where_it_is_or_goes_goes_on_as_it_is() {
        let motion = motion("do tilt-left for 100ms do tilt-left for 1s do tilt-left for 1s");
        assert_eq!(motion.rows[4].len(), 1);
    }

    proptest! {
        #[test]
        fn movements_of_a_joint_follow_each_other(
            steps in proptest::collection::vec((1_u8..=21, 1_u16..1500), 1..30)
        ) {
            let body: Vec<String> =
                steps.iter().map(|(number, ms)| format!("do {number} for {ms}ms")).collect();
            let motion = motion(&body.join(" "));
            for row in &motion.rows {
                for pair in row.windows(2) {
                    prop_assert!(pair[0].to_ms <= pair[1].from_ms);
                    prop_assert!(pair[0].motor_until_ms <= pair[1].from_ms);
                    prop_assert!((pair[0].to - pair[1].from).abs() < 1e-9);
                }
                for movement in row {
                    prop_assert!(movement.from_ms <= movement.to_ms);
                    prop_assert!((0.0..=1.0).contains(&movement.to));
                }
            }
        }
    }
}
