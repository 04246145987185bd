//! The packages of a random session: right ones, wrong ones, damaged ones and no packages at all.

use crate::firmware::reference::Reference;
use rand::{Rng, RngExt};
use rsapien_protocol::{
    ActionPackage, Address, AimTarget, BumperMask, Direction, HeaderByte, Joint, Mode, Parameter,
    Pose, Request, Step, frame,
};

/// What the PC of a session knows.
#[derive(Debug)]
pub(super) struct Packages {
    address: Address,
    session: u8,
    /// The true travel times, near to which the firmware's are configured.
    travel_ms: [u16; Joint::COUNT],
    /// Whether travel times are configured before the first INIT after a reset.
    configures: bool,
    /// Joints still to be configured.
    unconfigured: usize,
    /// The session often has steps of a few ms.
    is_hasty: bool,
    /// Steps still to come without looking at the answers, so that the queue fills.
    volley: u32,
    last: Vec<u8>,
}

impl Packages {
    pub(super) fn new(
        random: &mut impl Rng,
        address: Address,
        travel_ms: [u16; Joint::COUNT],
    ) -> Packages {
        let configures = address == Address::Motion && random.random_ratio(9, 10);
        Packages {
            address,
            session: random.random_range(1..=255),
            travel_ms,
            configures,
            unconfigured: 0,
            is_hasty: random.random_ratio(1, 3),
            volley: 0,
            last: Vec::new(),
        }
    }

    /// The last package once more.
    pub(super) fn again(&self) -> Vec<u8> {
        self.last.clone()
    }

    /// A package in its turn that the controller can understand.
    pub(super) fn right(&mut self, random: &mut impl Rng, reference: &Reference) -> Vec<u8> {
        let request = self.request(random, reference);
        self.encode(request, reference.last_sequence().wrapping_add(1))
    }

    fn encode(&mut self, request: Request, sequence: u8) -> Vec<u8> {
        let package = ActionPackage { session: self.session, sequence, request };
        self.last = package.encode(self.address).to_vec();
        self.last.clone()
    }

    /// A package that is intact, and wrong: of another session, out of its turn, for the other
    /// controller, with arguments out of range or of a kind that nobody knows.
    pub(super) fn wrong(&mut self, random: &mut impl Rng, reference: &Reference) -> Vec<u8> {
        let request = self.request(random, reference);
        let sequence = reference.last_sequence().wrapping_add(1);
        let mut package = ActionPackage { session: self.session, sequence, request };
        let mut address = self.address;
        match random.random_range(0..12) {
            9 => {
                let content = no_parameter(self.session, sequence);
                let header = HeaderByte { direction: Direction::ToRobot, address };
                self.last = frame::encode::<12, 18>(header, &content).to_vec();
                return self.last.clone();
            }
            8 | 10 | 11 => package.request = at_a_bound(random, address),
            0 => package.session = random.random(),
            1 => package.sequence = random.random(),
            2 => package.sequence = reference.last_sequence(),
            3 => {
                package.request = Request::Hello {
                    lowest_version: random.random_range(0..3),
                    highest_version: random.random_range(0..3),
                    session: if random.random() { self.session } else { random.random() },
                };
            }
            4 => address = other(address),
            5 => package.request = foreign(random, self.address),
            _ => {
                let mut content = package.content();
                for _ in 0..random.random_range(1..3) {
                    // The two bytes of numbers stay: they are looked at last.
                    let index = random.random_range(2..content.len());
                    content[index] =
                        if random.random() { random.random_range(0..10) } else { random.random() };
                }
                let header = HeaderByte { direction: Direction::ToRobot, address };
                self.last = frame::encode::<12, 18>(header, &content).to_vec();
                return self.last.clone();
            }
        }
        self.last = package.encode(address).to_vec();
        self.last.clone()
    }

    fn request(&mut self, random: &mut impl Rng, reference: &Reference) -> Request {
        if reference.session() != self.session {
            if self.configures && reference.session() == 0 {
                self.unconfigured = Joint::COUNT;
            }
            return Request::Hello { lowest_version: 0, highest_version: 1, session: self.session };
        }
        match self.address {
            Address::Motion => self.motion_request(random, reference),
            Address::Camera => camera_request(random, reference),
        }
    }

    fn motion_request(&mut self, random: &mut impl Rng, reference: &Reference) -> Request {
        if let Some(index) = self.unconfigured.checked_sub(1) {
            self.unconfigured = index;
            return self.travel_time(random, index);
        }
        if self.volley > 0 {
            self.volley -= 1;
            let mut step = self.step(random);
            step.replace = false;
            return Request::Step(step);
        }
        let mode = reference.mode();
        if mode == Mode::Initialising && random.random_ratio(3, 4) {
            return Request::State;
        }
        match (mode, random.random_range(0..1000)) {
            (_, 0..20) => Request::Counters,
            (_, 20..25) => Request::Stop,
            (_, 30..40) => {
                Request::Hello { lowest_version: 1, highest_version: 1, session: self.session }
            }
            (_, 40..60) => {
                let index = random.random_range(0..Joint::COUNT);
                self.travel_time(random, index)
            }
            (_, 60..65) => dead_man(random),
            (_, 25..30) | (Mode::Fresh | Mode::Stopped | Mode::Held, 65..800) => Request::Init,
            (_, 65..150) => Request::State,
            (Mode::Idle | Mode::Executing, 150..160) => {
                self.volley = random.random_range(5..50);
                Request::State
            }
            _ => Request::Step(self.step(random)),
        }
    }

    /// A travel time near the true one.
    fn travel_time(&self, random: &mut impl Rng, index: usize) -> Request {
        let true_ms = u32::from(self.travel_ms[index]);
        let told_ms = true_ms * random.random_range(70..140) / 100;
        let full_travel_ms = u16::try_from(told_ms.max(100)).unwrap_or(u16::MAX);
        let full_travel_ms = if random.random_ratio(1, 500) {
            random.random_range(100..=10_000)
        } else {
            full_travel_ms
        };
        Request::Configure(Parameter::TravelTime { joint: Joint::ALL[index], full_travel_ms })
    }

    fn step(&self, random: &mut impl Rng) -> Step {
        const EXTREMES: [u16; 5] = [0x1555, 0x2AAA, 0x3FFF, 0x0000, 0x3333];
        let word = match random.random_range(0..10) {
            0..4 => random.random::<u16>() & 0x3FFF,
            4..7 => random.random::<u16>() & random.random::<u16>() & 0x3FFF,
            _ => EXTREMES[random.random_range(0..EXTREMES.len())],
        };
        let duration_ms = match random.random_range(0..100) {
            0..10 => random.random_range(1..4),
            10..85 if self.is_hasty => random.random_range(1..60),
            10..85 => random.random_range(30..500),
            85..98 => random.random_range(300..2000),
            _ => random.random_range(1..=u16::MAX),
        };
        let bumpers = if random.random_ratio(1, 5) { random.random() } else { 0 };
        Step {
            pose: Pose::from_word(word).unwrap_or(Pose::EMPTY),
            duration_ms,
            replace: random.random_ratio(1, 10),
            ending_bumpers: BumperMask::from_low_bits(bumpers),
        }
    }
}

fn camera_request(random: &mut impl Rng, reference: &Reference) -> Request {
    let mode = reference.mode();
    if mode == Mode::Initialising && random.random_ratio(3, 4) {
        return Request::State;
    }
    match (mode, random.random_range(0..1000)) {
        (_, 0..30) => Request::Counters,
        (_, 30..40) => {
            Request::Hello { lowest_version: 1, highest_version: 9, session: reference.session() }
        }
        (_, 40..50) => dead_man(random),
        (_, 50..60) => Request::Stop,
        (Mode::Fresh | Mode::Stopped | Mode::Held, 60..600) | (_, 60..70) => Request::Home,
        (_, 70..150) => Request::State,
        _ => Request::Aim(aim(random)),
    }
}

fn aim(random: &mut impl Rng) -> AimTarget {
    let (pan, tilt) = (AimTarget::PAN_CENTIDEG_MAX, AimTarget::TILT_CENTIDEG_MAX);
    let mut angle = |limit: i16| match random.random_range(0..5) {
        0 => limit,
        1 => -limit,
        2 => random.random_range(-20..20),
        _ => random.random_range(-limit..=limit),
    };
    AimTarget {
        pan_centideg: angle(pan),
        tilt_centideg: angle(tilt),
        speed_deg_per_s: match random.random_range(0..5) {
            0 => 0,
            1 => random.random_range(1..15),
            2 => random.random(),
            _ => random.random_range(1..300),
        },
    }
}

fn dead_man(random: &mut impl Rng) -> Request {
    let timeout_ms = match random.random_range(0..10) {
        0 => 0,
        1..3 => random.random_range(100..400),
        _ => random.random_range(400..=10_000),
    };
    Request::Configure(Parameter::DeadMan { timeout_ms })
}

/// CONFIGURE of the parameter behind the last joint's travel time, which there is not.
fn no_parameter(session: u8, sequence: u8) -> [u8; 12] {
    let [last_but_one, mut content] = [Joint::RightLeg, Joint::LeftLeg].map(|joint| {
        let parameter = Parameter::TravelTime { joint, full_travel_ms: 1000 };
        ActionPackage { session, sequence, request: Request::Configure(parameter) }.content()
    });
    for (byte, before) in content.iter_mut().zip(last_but_one) {
        *byte = byte.wrapping_add(byte.wrapping_sub(before));
    }
    content
}

/// A request with an argument at the end of its range, inside or outside.
fn at_a_bound(random: &mut impl Rng, address: Address) -> Request {
    let (dead_man, travel) = (Parameter::DEAD_MAN_MS, Parameter::TRAVEL_MS);
    let around = |random: &mut dyn FnMut(u16) -> u16, bound: u16| bound - 1 + random(3);
    let mut below = |count: u16| random.random_range(0..count);
    if below(2) == 0 {
        let bound = if below(2) == 0 { *dead_man.start() } else { *dead_man.end() };
        let timeout_ms = around(&mut below, bound);
        return Request::Configure(Parameter::DeadMan { timeout_ms });
    }
    if address == Address::Motion {
        let joint = Joint::ALL[usize::from(below(7))];
        let bound = if below(2) == 0 { *travel.start() } else { *travel.end() };
        let full_travel_ms = around(&mut below, bound);
        return Request::Configure(Parameter::TravelTime { joint, full_travel_ms });
    }
    let mut angle = |limit: i16| {
        let angle = limit.unsigned_abs() - 1 + below(3);
        if below(2) == 0 { angle.cast_signed() } else { -angle.cast_signed() }
    };
    Request::Aim(AimTarget {
        pan_centideg: angle(AimTarget::PAN_CENTIDEG_MAX),
        tilt_centideg: angle(AimTarget::TILT_CENTIDEG_MAX),
        speed_deg_per_s: 0,
    })
}

/// A request that the other controller serves.
fn foreign(random: &mut impl Rng, address: Address) -> Request {
    match (address, random.random()) {
        (Address::Motion, true) => Request::Home,
        (Address::Motion, false) => Request::Aim(aim(random)),
        (Address::Camera, true) => Request::Init,
        (Address::Camera, false) => Request::Step(Step::new(Pose::MIDDLE, 10)),
    }
}

fn other(address: Address) -> Address {
    match address {
        Address::Motion => Address::Camera,
        Address::Camera => Address::Motion,
    }
}

/// A package as a bad line brings it.
pub(super) fn damaged(random: &mut impl Rng, mut line: Vec<u8>) -> Vec<u8> {
    for _ in 0..random.random_range(1..4) {
        let index = random.random_range(0..line.len());
        match random.random_range(0..6) {
            0 if line.len() > 2 => {
                line.remove(index);
            }
            1 => line.insert(index, random.random()),
            2 => line[index] = any_header(random),
            _ => line[index] ^= 1 << random.random_range(0..8),
        }
    }
    line
}

/// Bytes that are no package, though they may look like the beginning of one.
pub(super) fn garbage(random: &mut impl Rng) -> Vec<u8> {
    let count = random.random_range(1..30);
    let mut bytes: Vec<u8> = (0..count).map(|_| random.random()).collect();
    if random.random() {
        bytes.push(any_header(random));
        bytes.push(0x80 | random.random_range(0..64u8));
        bytes.extend((0..random.random_range(0..7)).map(|_| random.random_range(0..128u8)));
    }
    bytes
}

fn any_header(random: &mut impl Rng) -> u8 {
    let headers = Address::ALL.map(|address| {
        [Direction::ToRobot, Direction::ToPc]
            .map(|direction| HeaderByte { direction, address }.byte())
    });
    match random.random_range(0..5) {
        0..4 => headers[random.random_range(0..headers.len())][random.random_range(0..2)],
        _ => 0xC0 | random.random_range(0..64u8),
    }
}
