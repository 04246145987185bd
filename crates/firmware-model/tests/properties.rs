//! Random packages, bytes, inputs and faults: what always holds.

mod common;

use common::{Motion, SESSION, pause};
use proptest::prelude::*;
use rsapien_firmware_model::{
    CameraController, Controller, Inputs, MiddleSwitches, MotionController, MotorOutput, ResetCause,
};
use rsapien_protocol::{
    ActionPackage, Address, AimTarget, BumperMask, Joint, LineError, Mode, Parameter, Pose,
    Request, Step,
};

/// What happens to a controller in one tick.
#[derive(Clone, Debug)]
enum Event {
    /// A package under the right session, numbered so far from the next one.
    Package {
        request: Request,
        ahead: u8,
    },
    /// The last package once more.
    Again,
    Garbage(Vec<u8>),
    Damaged {
        request: Request,
        index: usize,
        bit: u8,
    },
    Error(LineError),
    Pins(Inputs),
    Silence(u16),
    Hang,
    Reset(ResetCause),
}

fn any_step() -> impl Strategy<Value = Step> {
    (0..0x4000u16, prop_oneof![1..200u16, 1..=65_535u16], any::<bool>(), 0..64u8).prop_map(
        |(word, duration_ms, replace, bumpers)| Step {
            pose: Pose::from_word(word).unwrap(),
            duration_ms,
            replace,
            ending_bumpers: BumperMask::from_low_bits(bumpers & (bumpers >> 3)),
        },
    )
}

fn any_request() -> impl Strategy<Value = Request> {
    let version = 0..3u8;
    prop_oneof![
        1 => (version.clone(), version, 6..9u8).prop_map(|(lowest_version, highest_version, session)| {
            Request::Hello { lowest_version, highest_version, session }
        }),
        3 => Just(Request::State),
        1 => Just(Request::Stop),
        1 => Just(Request::Counters),
        2 => Just(Request::Init),
        12 => any_step().prop_map(Request::Step),
        1 => prop_oneof![Just(0), 90..700u16]
            .prop_map(|timeout_ms| Request::Configure(Parameter::DeadMan { timeout_ms })),
        1 => (0..7u8, 90..1500u16).prop_map(|(index, full_travel_ms)| {
            let joint = Joint::from_index(index).unwrap();
            Request::Configure(Parameter::TravelTime { joint, full_travel_ms })
        }),
        3 => (-9100..9100i16, -4600..4600i16, 0..300u16).prop_map(
            |(pan_centideg, tilt_centideg, speed_deg_per_s)| {
                Request::Aim(AimTarget { pan_centideg, tilt_centideg, speed_deg_per_s })
            }
        ),
        2 => Just(Request::Home),
    ]
}

fn any_event() -> impl Strategy<Value = Event> {
    let error = prop_oneof![Just(LineError::Framing), Just(LineError::Overrun)];
    let cause = prop_oneof![Just(ResetCause::PowerOn), Just(ResetCause::BrownOut)];
    let pins = (0..64u8, any::<[bool; 3]>()).prop_map(|(bumpers, [left, right, supply_low])| {
        Event::Pins(Inputs {
            bumpers: BumperMask::from_low_bits(bumpers & (bumpers >> 2)),
            middle_switches: MiddleSwitches { left, right },
            supply_low,
        })
    });
    prop_oneof![
        20 => (any_request(), prop_oneof![9 => Just(0u8), 1 => any::<u8>()])
            .prop_map(|(request, ahead)| Event::Package { request, ahead }),
        3 => Just(Event::Again),
        2 => prop::collection::vec(any::<u8>(), 0..60).prop_map(Event::Garbage),
        2 => (any_request(), 0..18usize, 0..8u8)
            .prop_map(|(request, index, bit)| Event::Damaged { request, index, bit }),
        1 => error.prop_map(Event::Error),
        5 => pins,
        20 => prop_oneof![9 => 1..100u16, 1 => 100..2000u16].prop_map(Event::Silence),
        1 => prop_oneof![3 => Just(Event::Hang), 1 => cause.prop_map(Event::Reset)],
    ]
}

/// Feeds events to a controller; `check` sees it after every tick.
fn drive<C: Controller>(controller: &mut C, events: &[Event], mut check: impl FnMut(&C)) {
    let address = controller.address();
    let open = Request::Hello { lowest_version: 1, highest_version: 1, session: SESSION };
    let first = [
        ActionPackage { session: SESSION, sequence: 0, request: open },
        ActionPackage {
            session: SESSION,
            sequence: 1,
            request: match address {
                Address::Motion => Request::Init,
                Address::Camera => Request::Home,
            },
        },
    ];
    let mut last = first[0].encode(address);
    let mut inputs = Inputs::default();
    let mut next_sequence = 2u8;
    let mut tick = |controller: &mut C, inputs: Inputs| {
        controller.tick(inputs);
        // The line takes six bytes a tick at 57600 baud.
        for _ in 0..6 {
            if let Some(byte) = controller.transmit_interrupt() {
                assert!(byte < 0xC0 || byte == 0xE1 | (address as u8) << 3);
            }
        }
        check(controller);
    };
    for package in first {
        package.encode(address).into_iter().for_each(|byte| controller.receive_interrupt(byte));
        tick(controller, inputs);
    }
    for event in events {
        let mut line = Vec::new();
        let mut ticks = 1;
        match event {
            Event::Package { request, ahead } => {
                let sequence = next_sequence.wrapping_add(*ahead);
                last =
                    ActionPackage { session: SESSION, sequence, request: *request }.encode(address);
                line.extend(last);
                if request.kind().is_numbered() && request.kind().is_served_by(address) {
                    next_sequence = sequence.wrapping_add(1);
                }
            }
            Event::Again => line.extend(last),
            Event::Garbage(bytes) => line.extend(bytes),
            Event::Damaged { request, index, bit } => {
                let package =
                    ActionPackage { session: SESSION, sequence: next_sequence, request: *request };
                line.extend(package.encode(address));
                line[*index] ^= 1 << bit;
            }
            Event::Error(error) => controller.receive_error(*error),
            Event::Pins(pins) => inputs = *pins,
            Event::Silence(silence) => ticks = *silence,
            Event::Hang => controller.hang(),
            Event::Reset(cause) => controller.reset(*cause),
        }
        for byte in line {
            controller.receive_interrupt(byte);
        }
        for _ in 0..ticks {
            tick(controller, inputs);
        }
    }
}

fn any_events() -> impl Strategy<Value = Vec<Event>> {
    prop::collection::vec(any_event(), 1..120)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn motion_keeps_its_promises(events in any_events()) {
        let mut controller = MotionController::new(ResetCause::PowerOn, 0);
        let mut before = controller.motors();
        let mut was_at_rest = false;
        drive(&mut controller, &events, |controller| {
            let report = controller.report();
            let motors = controller.motors();
            let off = motors == [MotorOutput::Off; 7];
            if matches!(report.mode, Mode::Fresh | Mode::Stopped | Mode::Held) {
                assert!(off && report.motors == 0 && report.queue_free == 32);
            }
            // INIT ends in the tick after the last joint has come to rest, at the latest.
            let at_rest = report.mode == Mode::Initialising && report.motors == 0;
            assert!(!(at_rest && was_at_rest));
            was_at_rest = at_rest;
            for joint in Joint::ALL {
                let index = usize::from(joint.index());
                let running = report.is_running(joint);
                // A motor is driven only when the report says that it runs, and its sense never
                // turns from one tick to the next.
                assert!(running || motors[index] == MotorOutput::Off);
                assert!(!running || report.pose_reached.get(joint).is_none());
                let turned = [MotorOutput::TowardsFirst, MotorOutput::TowardsLast];
                assert!(
                    motors[index] == before[index]
                        || !(turned.contains(&motors[index]) && turned.contains(&before[index]))
                );
                assert!(controller.joint_position_ms(joint) <= controller.full_travel_ms(joint));
            }
            before = motors;
        });
        // Whatever happened, silence ends all motion, unless the user switched the dead-man off.
        let dead_man_off = events.iter().any(|event| matches!(
            event,
            Event::Package { request: Request::Configure(Parameter::DeadMan { timeout_ms: 0 }), .. }
        ));
        for _ in 0..701 {
            controller.tick(Inputs::default());
        }
        if !dead_man_off {
            prop_assert_eq!(controller.motors(), [MotorOutput::Off; 7]);
            prop_assert_ne!(controller.mode(), Mode::Executing);
        }
    }

    #[test]
    fn camera_keeps_its_promises(events in any_events()) {
        let mut controller = CameraController::new(ResetCause::PowerOn, 0);
        let mut before = controller.outputs();
        drive(&mut controller, &events, |controller| {
            let report = controller.report();
            let outputs = controller.outputs();
            let target = AimTarget {
                pan_centideg: report.pan_centideg,
                tilt_centideg: report.tilt_centideg,
                speed_deg_per_s: 0,
            };
            assert!(target.is_in_range());
            if matches!(report.mode, Mode::Fresh | Mode::Stopped | Mode::Held | Mode::Idle) {
                assert!(!report.axes.pan_moving && !report.axes.tilt_moving);
            }
            if let (Some(now), Some(then)) = (outputs.pan_centideg, before.pan_centideg) {
                assert!(now.abs_diff(then) <= 18, "180 degrees per second at most");
            }
            before = outputs;
        });
    }

    #[test]
    fn no_step_runs_twice_whatever_is_sent_again(repeats in prop::collection::vec(1..4u8, 1..30)) {
        let mut motion = Motion::initialised();
        for count in &repeats {
            motion.accepts(Request::Step(pause(7)));
            for _ in 1..*count {
                motion.sends_numbered(motion.sequence, Request::Step(pause(7)));
            }
        }
        let total = repeats.len() as u64;
        prop_assert_eq!(motion.at(7 * total - 1).controller.mode(), Mode::Executing);
        let report = motion.at(7 * total).controller.report();
        prop_assert_eq!((report.mode, u64::from(report.steps_ended)), (Mode::Idle, total));
    }

    #[test]
    fn garbage_never_costs_the_next_package(
        garbage in prop::collection::vec(any::<u8>(), 0..32),
    ) {
        let mut motion = Motion::fresh();
        motion.line_brings(&garbage);
        let package = ActionPackage { session: 0, sequence: 0, request: Request::State };
        motion.hears();
        motion.line_brings(&package.encode(Address::Motion));
        prop_assert_eq!(motion.hears().len(), 1);
    }
}
