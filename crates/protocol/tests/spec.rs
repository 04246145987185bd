//! SPEC.md says what the code does: its tables of constants and its worked bytes.

use rsapien_protocol::session::SessionConfig;
use rsapien_protocol::{
    ACTION_CONTENT_LENGTH, ACTION_PACKAGE_LENGTH, ActionPackage, Address, AimTarget, Direction,
    Fed, GAP_MS_PC, GAP_MS_ROBOT, HeaderByte, Joint, Kind, Mode, PROTOCOL_VERSION, Parameter,
    Primitive, Receiver, ReceptionState, SYNCHRONIZATION_CONTENT_LENGTH,
    SYNCHRONIZATION_PACKAGE_LENGTH, Status, StopCause, SynchronizationPackage, crc, frame,
};

const SPEC: &str = include_str!("../SPEC.md");

/// The rows of the one table whose header begins with `first_heading`, without the header.
fn table(first_heading: &str) -> Vec<Vec<&'static str>> {
    let header = format!("| {first_heading} |");
    assert_eq!(SPEC.matches(&format!("\n{header}")).count(), 1, "one table {header}");
    let lines = SPEC.lines().skip_while(|line| !line.starts_with(&header));
    lines
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| {
            line.trim_matches('|').split('|').map(|cell| cell.trim().trim_matches('`')).collect()
        })
        .collect()
}

/// A table of two columns, name and value.
fn values(first_heading: &str) -> Vec<(&'static str, &'static str)> {
    table(first_heading).into_iter().map(|row| (row[0], row[1])).collect()
}

fn hex(text: &str) -> Vec<u8> {
    text.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

fn address(name: &str) -> Address {
    Address::ALL.into_iter().find(|address| address.name() == name).unwrap()
}

fn strings<const N: usize>(
    found: [(&'static str, String); N],
) -> impl Iterator<Item = (&'static str, String)> {
    found.into_iter()
}

/// Both sides as text, so that a difference shows the whole table.
fn assert_table(heading: &str, code: impl Iterator<Item = (&'static str, String)>) {
    let spec: Vec<_> =
        values(heading).into_iter().map(|(name, value)| (name, value.to_string())).collect();
    assert_eq!(spec, code.collect::<Vec<_>>(), "table {heading}");
}

#[test]
fn constants_of_the_line_and_of_packages() {
    let config = SessionConfig::default();
    assert_table(
        "line",
        strings([
            ("default speed, bit/s", config.baud.to_string()),
            ("other speeds, bit/s", "19200, 38400, 115200".into()),
            ("address of the motion controller", (Address::Motion as u8).to_string()),
            ("address of the camera controller", (Address::Camera as u8).to_string()),
            ("protocol version", PROTOCOL_VERSION.to_string()),
        ]),
    );
    let header = |direction, address| format!("{:#04x}", HeaderByte { direction, address }.byte());
    assert_table(
        "header",
        strings([
            ("to the motion controller", header(Direction::ToRobot, Address::Motion)),
            ("to the camera controller", header(Direction::ToRobot, Address::Camera)),
            ("from the motion controller", header(Direction::ToPc, Address::Motion)),
            ("from the camera controller", header(Direction::ToPc, Address::Camera)),
        ]),
    );
    let hundredths_ms = |line_bytes: usize| {
        let time = ((line_bytes * 1_000_000 + 28_800) / 57_600).to_string();
        let (whole, part) = time.split_at(time.len() - 2);
        format!("{whole}.{part} ms")
    };
    let lengths = [
        (ACTION_CONTENT_LENGTH, ACTION_PACKAGE_LENGTH),
        (SYNCHRONIZATION_CONTENT_LENGTH, SYNCHRONIZATION_PACKAGE_LENGTH),
    ];
    for (row, (content, line)) in table("package").iter().zip(lengths) {
        let expected = [content.to_string(), line.to_string(), hundredths_ms(line)];
        assert_eq!(row[1..], expected);
    }
    let reversed = crc::POLYNOMIAL_REVERSED;
    assert_table(
        "check",
        strings([
            ("polynomial", format!("{:#06x}", reversed.reverse_bits())),
            ("polynomial, bits reversed", format!("{reversed:#06x}")),
            ("initial value", format!("{:#06x}", crc::INITIAL)),
            ("final xor", format!("{:#06x}", crc::checksum(&[]) ^ crc::INITIAL)),
            ("check of the text `123456789", format!("{:#06x}", crc::checksum(b"123456789"))),
        ]),
    );
    assert_table(
        "silence",
        strings([
            ("longest gap at a controller", GAP_MS_ROBOT.to_string()),
            ("longest gap at the PC", GAP_MS_PC.to_string()),
        ]),
    );
    assert_table(
        "session of the PC",
        strings([
            ("margin, ms", config.margin_ms.to_string()),
            ("answer time at 57600, ms", config.answer_time_ms().to_string()),
            ("tries", config.tries.to_string()),
        ]),
    );
}

#[test]
fn arguments_and_joints() {
    let symmetric = |limit: i16| format!("{:?}", -limit..=limit);
    assert_table(
        "argument",
        strings([
            ("dead-man time, ms", format!("{:?}", Parameter::DEAD_MAN_MS)),
            ("dead-man time at reset, ms", Parameter::DEAD_MAN_MS_DEFAULT.to_string()),
            ("full travel time, ms", format!("{:?}", Parameter::TRAVEL_MS)),
            ("pan, 0.01 degree", symmetric(AimTarget::PAN_CENTIDEG_MAX)),
            ("tilt, 0.01 degree", symmetric(AimTarget::TILT_CENTIDEG_MAX)),
        ]),
    );
    let rows = table("joint");
    assert_eq!(rows.len(), Joint::COUNT);
    for (row, joint) in rows.iter().zip(Joint::ALL) {
        assert_eq!(row[0], joint.index().to_string());
        assert_eq!(row[1], joint.name());
        assert_eq!(row[2..], joint.position_names());
    }
    for primitive in Primitive::all() {
        let number = primitive.number();
        assert_eq!(primitive.joint().index(), (number - 1) / 3);
        assert_eq!(primitive.position().number(), (number - 1) % 3 + 1);
    }
}

#[test]
fn states_kinds_statuses_modes_and_causes() {
    let states = [
        ReceptionState::Hunting,
        ReceptionState::Synchronization,
        ReceptionState::Data,
        ReceptionState::Check,
    ];
    let names = states.map(|state| (format!("{state:?}"), (state as u8).to_string()));
    let rows = table("state of reception");
    let found = rows.iter().map(|row| (row[0].to_string(), row[1].to_string()));
    assert_eq!(found.collect::<Vec<_>>(), names);

    let rows = table("kind");
    assert_eq!(rows.len(), Kind::ALL.len());
    for (row, kind) in rows.iter().zip(Kind::ALL) {
        let served: Vec<_> =
            Address::ALL.into_iter().filter(|address| kind.is_served_by(*address)).collect();
        let controller = if let [only] = served[..] { only.name() } else { "both" };
        let byte = format!("{:#04x}", kind.byte());
        let numbered = if kind.is_numbered() { "yes" } else { "no" };
        assert_eq!([row[0], row[1], row[2], row[4]], [&byte, kind.name(), controller, numbered]);
        let takes_arguments = row[3] != "none";
        let mut content = [0; ACTION_CONTENT_LENGTH];
        content[2] = kind.byte();
        assert_eq!(
            ActionPackage::parse(&content).is_ok(),
            !takes_arguments || kind == Kind::Configure || kind == Kind::Aim
        );
    }

    let rows = table("status");
    assert_eq!(rows.len(), Status::ALL.len());
    for (row, status) in rows.iter().zip(Status::ALL) {
        assert_eq!(row[..2], [status.byte().to_string(), format!("{status:?}")]);
    }
    let order: Vec<_> = Status::PRECEDENCE.iter().map(|status| status.byte().to_string()).collect();
    assert!(SPEC.contains(&format!("the first in this order is told: {}.", order.join(", "))));

    let modes: Vec<_> = table("mode").iter().map(|row| row.join(" ")).collect();
    let expected = Mode::ALL.map(|mode| format!("{} {}", mode.byte(), mode.name()));
    assert_eq!(modes, expected);
    let causes: Vec<_> = table("cause").iter().map(|row| row.join(" ")).collect();
    let expected = StopCause::ALL.map(|cause| format!("{} {}", cause.byte(), cause.name()));
    assert_eq!(causes, expected);
}

/// Feeds the line bytes to a receiver of their direction; an intact package has to come out.
fn received(mut receiver: Receiver, line: &[u8]) -> rsapien_protocol::Content {
    let fed: Vec<_> = line.iter().map(|byte| receiver.feed(*byte, 0)).collect();
    match fed.last() {
        Some(Fed::Package(content)) => *content,
        other => panic!("{other:?} from {line:02x?}"),
    }
}

#[test]
fn worked_action_packages() {
    let rows = table("action package");
    let mut kinds = Vec::new();
    for row in &rows {
        let address = address(row[1]);
        let line = hex(row[3]);
        let content = received(Receiver::for_robot(address), &line);
        assert_eq!(content.action().to_vec(), hex(row[2]), "{}", row[0]);
        let package = ActionPackage::parse(content.action()).unwrap();
        assert_eq!(package.encode(address).to_vec(), line, "{}", row[0]);
        kinds.push(package.request.kind());
    }
    assert!(Kind::ALL.iter().all(|kind| kinds.contains(kind)), "every kind is worked: {kinds:?}");
}

#[test]
fn worked_synchronization_packages() {
    let rows = table("synchronization package");
    for row in &rows {
        let address = address(row[1]);
        let line = hex(row[3]);
        let content = received(Receiver::for_pc(), &line);
        assert_eq!(content.synchronization().to_vec(), hex(row[2]), "{}", row[0]);
        let package = SynchronizationPackage::parse(&content).unwrap();
        assert_eq!(package.encode(address).to_vec(), line, "{}", row[0]);
    }
    assert!(rows.len() + table("action package").len() >= 14);
}

#[test]
fn worked_packages_are_those_of_the_vectors() {
    for name in ["action_packages", "synchronization_packages"] {
        let path = format!("{}/../../tests/vectors/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let vectors: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let worked = vectors["packages"].as_array().unwrap().iter();
        let worked = worked.filter(|vector| !vector["meaning"].is_null()).map(|vector| {
            ["name", "address", "content", "line"].map(|key| vector[key].as_str().unwrap())
        });
        let rows = table(&name.replace('_', " ").replace("packages", "package"));
        let rows: Vec<[&str; 4]> = rows.into_iter().map(|row| row.try_into().unwrap()).collect();
        assert_eq!(rows, worked.collect::<Vec<_>>());
    }
}

#[test]
fn a_line_of_19200_still_leaves_an_answer_its_margin() {
    for baud in [19_200, 38_400, 57_600, 115_200] {
        let config = SessionConfig { baud, ..SessionConfig::default() };
        let both =
            frame::line_time_ms(ACTION_PACKAGE_LENGTH + SYNCHRONIZATION_PACKAGE_LENGTH, baud);
        assert_eq!(config.answer_time_ms(), both + u64::from(config.margin_ms));
        assert!(SPEC.contains(&baud.to_string()));
    }
}
