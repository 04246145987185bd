//! What a content means: round trips, and every content that a line can carry.

use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;
use rsapien_protocol::{
    ActionPackage, ActionView, Address, AimTarget, AxisFlags, BumperMask, CameraReport, Content,
    CountersReport, Direction, Fed, HeaderByte, HelloReport, Joint, Kind, Mode, MotionReport,
    Parameter, Pose, Receiver, Report, Request, Status, Step, StopCause, SynchronizationPackage,
    frame,
};

fn config() -> ProptestConfig {
    let kept = FileFailurePersistence::Direct("tests/packages.proptest-regressions");
    ProptestConfig { failure_persistence: Some(Box::new(kept)), ..ProptestConfig::with_cases(4000) }
}

fn pose() -> impl Strategy<Value = Pose> {
    (0..0x4000u16).prop_map(|word| Pose::from_word(word).unwrap())
}

fn bumpers() -> impl Strategy<Value = BumperMask> {
    any::<u8>().prop_map(BumperMask::from_low_bits)
}

fn request() -> impl Strategy<Value = Request> {
    let step = (pose(), 1..=u16::MAX, any::<bool>(), bumpers());
    let travel = (prop::sample::select(&Joint::ALL), Parameter::TRAVEL_MS);
    let aim = (-9000..=9000i16, -4500..=4500i16, any::<u16>());
    prop_oneof![
        (any::<u8>(), any::<u8>(), 1..=u8::MAX).prop_map(|(a, b, session)| Request::Hello {
            lowest_version: a.min(b),
            highest_version: a.max(b),
            session
        }),
        prop::sample::select(&[
            Request::State,
            Request::Stop,
            Request::Counters,
            Request::Init,
            Request::Home
        ]),
        step.prop_map(|(pose, duration_ms, replace, ending_bumpers)| {
            Request::Step(Step { pose, duration_ms, replace, ending_bumpers })
        }),
        prop_oneof![Just(0), Parameter::DEAD_MAN_MS]
            .prop_map(|timeout_ms| Request::Configure(Parameter::DeadMan { timeout_ms })),
        travel.prop_map(|(joint, full_travel_ms)| {
            Request::Configure(Parameter::TravelTime { joint, full_travel_ms })
        }),
        aim.prop_map(|(pan_centideg, tilt_centideg, speed_deg_per_s)| {
            Request::Aim(AimTarget { pan_centideg, tilt_centideg, speed_deg_per_s })
        }),
    ]
}

fn tail() -> impl Strategy<Value = (u8, u8, StopCause)> {
    (any::<u8>(), any::<u8>(), prop::sample::select(&StopCause::ALL))
}

fn motion() -> impl Strategy<Value = Report> {
    let inputs = (bumpers(), any::<[bool; 2]>(), prop::array::uniform6(0..16u8));
    let motors = (0..0x80u8, any::<bool>(), pose(), any::<u8>(), any::<u16>());
    (prop::sample::select(&Mode::ALL), inputs, motors, tail()).prop_map(
        |(mode, inputs, motors, (boot, reception_errors, cause))| {
            Report::Motion(MotionReport {
                mode,
                bumpers: inputs.0,
                middle_switches: inputs.1,
                presses: inputs.2,
                motors: motors.0,
                supply_low: motors.1,
                pose_reached: motors.2,
                queue_free: motors.3,
                steps_ended: motors.4,
                boot,
                reception_errors,
                cause,
            })
        },
    )
}

fn camera() -> impl Strategy<Value = Report> {
    (prop::sample::select(&Mode::ALL), any::<[i16; 4]>(), any::<u8>(), tail()).prop_map(
        |(mode, [pan, tilt, pan_target, tilt_target], axes, (boot, reception_errors, cause))| {
            Report::Camera(CameraReport {
                mode,
                pan_centideg: pan,
                tilt_centideg: tilt,
                pan_target_centideg: pan_target,
                tilt_target_centideg: tilt_target,
                axes: AxisFlags::from_bits(axes),
                boot,
                reception_errors,
                cause,
            })
        },
    )
}

fn hello() -> impl Strategy<Value = Report> {
    (any::<[u8; 7]>(), any::<u16>(), tail()).prop_map(
        |(bytes, dead_man_ms, (boot, reception_errors, cause))| {
            Report::Hello(HelloReport {
                version: bytes[0],
                firmware: [bytes[1], bytes[2], bytes[3]],
                clock_mhz: bytes[4],
                queue_length: bytes[5],
                dead_man_ms,
                last_sequence: bytes[6],
                boot,
                reception_errors,
                cause,
            })
        },
    )
}

fn counters() -> impl Strategy<Value = Report> {
    any::<[u16; 7]>().prop_map(|counts| {
        Report::Counters(CountersReport {
            accepted: counts[0],
            resets: counts[1],
            crc_errors: counts[2],
            framing_errors: counts[3],
            overruns: counts[4],
            duplicates: counts[5],
            dead_man_trips: counts[6],
        })
    })
}

/// A package with the address it comes from and the kind it answers, known or not.
fn answer() -> impl Strategy<Value = (Address, SynchronizationPackage)> {
    let other = any::<u8>().prop_filter("a kind with a report of its own", |byte| {
        ![Kind::Hello.byte(), Kind::Counters.byte()].contains(byte)
    });
    let address = prop::sample::select(&Address::ALL);
    let report = prop_oneof![
        (Just(Address::Motion), other.clone(), motion()),
        (Just(Address::Camera), other, camera()),
        (address.clone(), Just(Kind::Hello.byte()), hello()),
        (address, Just(Kind::Counters.byte()), counters()),
    ];
    (report, any::<[u8; 2]>(), prop::sample::select(&Status::ALL)).prop_map(
        |((address, kind_byte, report), [session, sequence], status)| {
            (address, SynchronizationPackage { session, sequence, kind_byte, status, report })
        },
    )
}

fn received(mut receiver: Receiver, line: &[u8]) -> Option<Content> {
    line.iter().fold(None, |content, byte| match receiver.feed(*byte, 0) {
        Fed::Package(new) => Some(new),
        _ => content,
    })
}

/// Contents near the border between sense and nonsense: a valid one with a byte or two changed.
fn near_action() -> impl Strategy<Value = [u8; 12]> {
    let change = (0..12usize, any::<u8>());
    (any::<[u8; 2]>(), request(), prop::collection::vec(change, 0..3)).prop_map(
        |([session, sequence], request, changes)| {
            let mut content = ActionPackage { session, sequence, request }.content();
            for (place, byte) in changes {
                content[place] = byte;
            }
            content
        },
    )
}

fn check_action(content: &[u8; 12]) {
    let view = ActionView::new(content);
    for kind in Kind::ALL {
        if let Ok(request) = view.request(kind) {
            assert!(request.is_valid() && request.kind() == kind);
        }
    }
    match ActionPackage::parse(content) {
        Ok(package) => assert_eq!(package.content(), *content),
        Err(status) => {
            let unknown = Kind::from_byte(content[2]).is_none();
            assert_eq!(status, if unknown { Status::UnknownKind } else { Status::BadArgument });
        }
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn an_action_package_comes_back(
        address in prop::sample::select(&Address::ALL),
        session in any::<u8>(),
        sequence in any::<u8>(),
        request in request(),
    ) {
        let package = ActionPackage { session, sequence, request };
        prop_assert!(request.is_valid());
        let content = received(Receiver::for_robot(address), &package.encode(address)).unwrap();
        prop_assert_eq!((content.address(), content.direction()), (address, Direction::ToRobot));
        prop_assert_eq!(ActionPackage::parse(content.action()), Ok(package));
    }

    #[test]
    fn a_synchronization_package_comes_back((address, package) in answer()) {
        let content = received(Receiver::for_pc(), &package.encode(address)).unwrap();
        prop_assert_eq!((content.address(), content.direction()), (address, Direction::ToPc));
        prop_assert_eq!(SynchronizationPackage::parse(&content), Ok(package));
        prop_assert!(package.report.answers(package.kind_byte));
    }

    #[test]
    fn a_content_is_refused_or_comes_back(content in near_action()) {
        check_action(&content);
    }

    #[test]
    fn any_content_is_refused_or_comes_back(content in any::<[u8; 12]>()) {
        check_action(&content);
    }

    #[test]
    fn any_answer_is_refused_or_comes_back_but_for_bits_without_meaning(
        address in prop::sample::select(&Address::ALL),
        mut bytes in any::<[u8; 18]>(),
        sensible in any::<bool>(),
    ) {
        if sensible {
            bytes[3] %= 10;
            bytes[4] %= 6;
            bytes[11] &= 0x3F;
            bytes[17] %= 6;
        }
        let header = HeaderByte { direction: Direction::ToPc, address };
        let line: [u8; 25] = frame::encode(header, &bytes);
        let content = received(Receiver::for_pc(), &line).unwrap();
        prop_assert_eq!(content.synchronization(), &bytes);
        match SynchronizationPackage::parse(&content) {
            Ok(package) => {
                if matches!(package.report, Report::Camera(_)) {
                    bytes[13] &= 0x0F;
                    bytes[14] = 0;
                }
                if matches!(package.report, Report::Hello(_)) {
                    bytes[13..15].fill(0);
                }
                prop_assert_eq!(package.content(), bytes);
            }
            Err(_) => prop_assert!(!sensible),
        }
    }
}

#[test]
fn every_byte_in_every_place_of_every_kind() {
    for kind in Kind::ALL {
        for place in 3..12 {
            for byte in 0..=255u8 {
                for filler in [0, 1] {
                    let mut content = [0; 12];
                    content[2] = kind.byte();
                    // Arguments that are valid for every kind: HELLO 1, 1, 1; a step of 257 ms.
                    content[3..6].fill(filler);
                    content[6] = u8::from(kind == Kind::Step);
                    content[place] = byte;
                    check_action(&content);
                }
            }
        }
    }
}

#[test]
fn every_kind_and_status_byte_in_an_answer() {
    for address in Address::ALL {
        for kind_byte in 0..=255u8 {
            for status in 0..=255u8 {
                let mut bytes = [0; 18];
                (bytes[2], bytes[3]) = (kind_byte, status);
                let header = HeaderByte { direction: Direction::ToPc, address };
                let line: [u8; 25] = frame::encode(header, &bytes);
                let content = received(Receiver::for_pc(), &line).unwrap();
                match SynchronizationPackage::parse(&content) {
                    Ok(package) => {
                        assert_eq!((package.status.byte(), package.kind_byte), (status, kind_byte));
                        assert!(package.report.answers(kind_byte));
                    }
                    Err(_) => assert!(status > 9),
                }
            }
        }
    }
}

#[test]
fn the_border_values_of_every_argument() {
    let is_valid = |request: Request| {
        let content = ActionPackage { session: 1, sequence: 1, request }.content();
        let parsed = ActionPackage::parse(&content).is_ok();
        assert_eq!(parsed, request.is_valid(), "{request:?}");
        parsed
    };
    for timeout_ms in 0..=u16::MAX {
        let expected = timeout_ms == 0 || (100..=10_000).contains(&timeout_ms);
        assert_eq!(is_valid(Request::Configure(Parameter::DeadMan { timeout_ms })), expected);
        let joint = Joint::Tilt;
        let travel = Parameter::TravelTime { joint, full_travel_ms: timeout_ms };
        assert_eq!(is_valid(Request::Configure(travel)), (100..=10_000).contains(&timeout_ms));
        let step = Step::new(Pose::EMPTY, timeout_ms);
        assert_eq!(is_valid(Request::Step(step)), timeout_ms != 0);
    }
    for angle in i16::MIN..=i16::MAX {
        let aim = |pan_centideg, tilt_centideg| {
            is_valid(Request::Aim(AimTarget { pan_centideg, tilt_centideg, speed_deg_per_s: 0 }))
        };
        assert_eq!(aim(angle, 0), (-9000..=9000).contains(&angle));
        assert_eq!(aim(0, angle), (-4500..=4500).contains(&angle));
    }
    for lowest_version in 0..=255u8 {
        for highest_version in 0..=255u8 {
            for session in [0, 1, 255] {
                let hello = Request::Hello { lowest_version, highest_version, session };
                assert_eq!(is_valid(hello), session != 0 && lowest_version <= highest_version);
            }
        }
    }
}
