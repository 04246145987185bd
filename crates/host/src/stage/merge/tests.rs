use super::*;
use proptest::prelude::*;
use rsapien_protocol::Position;

/// What a joint was sent to, and when.
type Sent = Vec<(u64, Joint, Position)>;

/// A robot that does slice after slice.
#[derive(Default)]
struct Robot {
    queue: VecDeque<Step>,
    now_ms: u64,
    sent: Sent,
}

impl Robot {
    /// Does the oldest slice to its end.
    fn step(&mut self) {
        let Some(step) = self.queue.pop_front() else { return };
        let at_ms = self.now_ms;
        let sent = step.pose.primitives().map(|it| (at_ms, it.joint(), it.position()));
        self.sent.extend(sent);
        self.now_ms += u64::from(step.duration_ms);
    }
}

/// What the steps of an action that begins at `at_ms` send, and when.
fn expected(steps: &[Step], at_ms: u64) -> Sent {
    let mut at_ms = at_ms;
    let mut sent = Sent::new();
    for step in steps {
        sent.extend(step.pose.primitives().map(|it| (at_ms, it.joint(), it.position())));
        at_ms += u64::from(step.duration_ms);
    }
    sent
}

/// An action of two joints that no other index has.
fn action(index: usize) -> impl Strategy<Value = Vec<Step>> {
    let joints = [Joint::ALL[2 * index], Joint::ALL[2 * index + 1]];
    let step = (proptest::array::uniform2(0..=3_u8), 1..1500_u16).prop_map(move |(to, ms)| {
        let pose = joints.into_iter().zip(to).fold(Pose::EMPTY, |pose, (joint, number)| {
            pose.with(joint, Position::from_number(number))
        });
        Step::new(pose, ms)
    });
    proptest::collection::vec(step, 1..6)
}

proptest! {
    /// Whenever an action joins, each of its joints is sent where and when its own text says, whatever goes on
    /// beside it; and each lasts as long as alone.
    #[test]
    fn side_by_side_each_is_as_alone(
        first in action(0), second in action(1), third in action(2),
        joins in proptest::array::uniform2(0..8_usize), is_shared: bool,
    ) {
        let actions = [first, second, third];
        let [join_second, join_third] = joins;
        let mut merge = Merge { is_shared, ..Merge::default() };
        let mut robot = Robot::default();
        let mut begun_ms = [None; 3];
        let mut ended = [0; 3];
        for slice in 0..1000_usize {
            for (id, after) in [(0, 0), (1, join_second), (2, join_third)] {
                if slice == after {
                    merge.parts.push(Part::new(id, actions[usize::try_from(id).unwrap()].clone()));
                }
            }
            let Some(step) = merge.propose(|_| true) else {
                if slice > 8 { break }
                continue;
            };
            prop_assert!(step.duration_ms >= 1);
            prop_assert!(!is_shared || step.duration_ms <= SLICE_MS);
            for part in &merge.parts {
                let index = usize::try_from(part.id).unwrap();
                if part.accepted == 0 && begun_ms[index].is_none() {
                    begun_ms[index] = Some(robot.now_ms);
                }
            }
            merge.accept();
            robot.queue.push_back(step);
            robot.step();
            for id in merge.end(1) {
                ended[usize::try_from(id).unwrap()] += 1;
            }
        }
        for (index, steps) in actions.iter().enumerate() {
            let own = [Joint::ALL[2 * index], Joint::ALL[2 * index + 1]];
            let of_it: Sent =
                robot.sent.iter().copied().filter(|(_, joint, _)| own.contains(joint)).collect();
            prop_assert_eq!(&of_it, &expected(steps, begun_ms[index].unwrap()));
            prop_assert_eq!(ended[index], steps.len());
            prop_assert!(merge.parts[index].is_sent() && merge.parts[index].stands());
        }
    }

    /// After the robot has forgotten its queue, nothing is missing: every step ends once, and every joint comes to
    /// stand where the action leaves it.
    #[test]
    fn what_was_forgotten_is_sent_again(
        first in action(0), second in action(1),
        cuts in proptest::collection::vec(1..6_usize, 0..5),
    ) {
        let mut merge = Merge { parts: vec![Part::new(0, first.clone()), Part::new(1, second.clone())], ..Merge::default() };
        let mut robot = Robot::default();
        let mut ended = [0, 0];
        let mut cuts = cuts.into_iter();
        let mut until_cut = cuts.next();
        for _ in 0..2000 {
            while robot.queue.len() < 3 && let Some(step) = merge.propose(|_| true) {
                merge.accept();
                robot.queue.push_back(step);
            }
            if robot.queue.is_empty() { break }
            if until_cut == Some(0) {
                robot.queue.clear();
                merge.rewind();
                until_cut = cuts.next();
                continue;
            }
            until_cut = until_cut.map(|count| count - 1);
            robot.step();
            for id in merge.end(1) {
                ended[usize::try_from(id).unwrap()] += 1;
            }
        }
        prop_assert_eq!(ended, [first.len(), second.len()]);
        let mut left = Pose::EMPTY;
        for (_, joint, position) in &robot.sent {
            left = left.with(*joint, Some(*position));
        }
        let all = [&first, &second].into_iter().flatten();
        let wanted = all.fold(Pose::EMPTY, |pose, step| joined(pose, step.pose));
        prop_assert_eq!(left, wanted);
    }
}

#[test]
fn a_part_that_may_not_go_on_is_left_where_it_is() {
    let tilt = Pose::EMPTY.with(Joint::Tilt, Some(Position::First));
    let arm = Pose::EMPTY.with(Joint::RightArm, Some(Position::First));
    let mut merge = Merge {
        parts: vec![
            Part::new(1, vec![Step::new(tilt, 100)]),
            Part::new(2, vec![Step::new(arm, 50)]),
        ],
        ..Merge::default()
    };
    let slice = merge.propose(|part| part.id == 2).unwrap();
    assert_eq!((slice.pose, slice.duration_ms), (arm, 50));
    merge.accept();
    assert_eq!(merge.end(1), [2]);
    assert!(!merge.parts[0].is_sent() && merge.parts[1].is_sent());
    assert_eq!(merge.propose(|_| true).unwrap().pose, tilt);
}

#[test]
fn each_bumper_that_ends_one_of_them_ends_the_slice() {
    let step = |bits| Step {
        ending_bumpers: BumperMask::from_low_bits(bits),
        ..Step::new(Pose::EMPTY, 100)
    };
    let mut merge = Merge {
        parts: vec![Part::new(1, vec![step(1)]), Part::new(2, vec![step(4)])],
        ..Merge::default()
    };
    assert_eq!(merge.propose(|_| true).unwrap().ending_bumpers.bits(), 5);
}
