//! How long the routines take: the interrupts', the main routine's, and how long interrupts wait.

use super::Measured;
use super::rig::Rig;
use crate::firmware::gpsim::{GpsimError, Happening, Image};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rsapien_protocol::{Address, AimTarget, BumperMask, Joint, Parameter, Pose, Request, Step};

/// What the routines take, measured of one image under all at once that can happen.
#[derive(Clone, Debug, Default)]
pub(super) struct Routines {
    /// The receive interrupt.
    pub(super) receive: Measured,
    /// The low interrupt when it was for the tick alone, less the receive interrupts inside.
    pub(super) tick: Measured,
    /// The same for an input change alone.
    pub(super) input_change: Measured,
    /// The same for a transmission alone.
    pub(super) transmit: Measured,
    /// The low interrupt whatever it was for, with the receive interrupts inside.
    pub(super) low: Measured,
    /// One pass of the main routine with all interrupts that fall into it.
    pub(super) pass: Measured,
    /// With the low interrupts locked by the main routine, with the receive interrupts inside.
    pub(super) locked: Measured,
    /// What the receive interrupt waits longer than it must.
    pub(super) receive_waits: Measured,
}

const RECEIVE: &str = "_interrupt_receive";
const LOW: &str = "_interrupt_low";
const TIMER: &str = "_controller_timer_interrupt";
const CHANGE: &str = "_controller_input_change_interrupt";
const TRANSMIT: &str = "_controller_transmit_interrupt";
const MAIN: &str = "_controller_main_routine";
const LOCK: &str = "_port_lock";
const UNLOCK: &str = "_port_unlock";
/// Where the interrupts' vectors are, and what the return itself takes.
const VECTORS: [(&str, u32); 2] = [("high", 0x08), ("low", 0x18)];
const RETURN_CYCLES: u64 = 2;
const PACKAGE_BYTES: usize = rsapien_protocol::ACTION_PACKAGE_LENGTH;
const ANSWER_BYTES: usize = rsapien_protocol::SYNCHRONIZATION_PACKAGE_LENGTH;
/// How many packages the line is told ahead.
const PACKAGES_AHEAD: usize = 2;
/// How long everything happens at once.
const BUSY_MS: u64 = 1500;

pub(super) fn measure(image: &Image) -> Result<Routines, GpsimError> {
    let mut rig = Rig::ready(image)?;
    for (name, address) in VECTORS {
        rig.chip.tell(&format!("mark {address} {name}"))?;
    }
    for (name, symbol) in [("high-end", RECEIVE), ("low-end", LOW)] {
        let address = rig.interrupt_return(symbol)?;
        rig.chip.tell(&format!("mark {address} {name}"))?;
    }
    rig.mark(&[TIMER, TRANSMIT, MAIN, LOCK, UNLOCK])?;
    if image.address == Address::Motion {
        rig.mark(&[CHANGE])?;
    }
    rig.take();
    let mut routines = Routines::default();
    for travel_ms in [100, 10_000] {
        if image.address == Address::Motion {
            rig.configure_travel(travel_ms)?;
        }
        let log = busy(&mut rig, BUSY_MS)?;
        routines.read(&log);
        // What the burst left is answered and done before the next one.
        rig.run_ms(100)?;
        rig.expect_all_executed()?;
        rig.take();
    }
    Ok(routines)
}

impl Routines {
    fn read(&mut self, log: &[(u64, Happening)]) {
        let (mut high, mut low, mut main, mut lock) = (None, None, None, None);
        let mut heard = None;
        let mut inside = 0;
        let mut sources: Vec<&str> = Vec::new();
        let mut waits = Vec::new();
        for (at, happening) in log {
            let name = match happening {
                Happening::Mark(name) => name.as_str(),
                Happening::Heard => {
                    heard = Some(*at);
                    continue;
                }
                _ => continue,
            };
            match name {
                "high" => {
                    high = Some(*at);
                    waits.extend(heard.take().map(|heard: u64| at - heard));
                }
                "high-end" => {
                    if let Some(begin) = high.take() {
                        let cycles = at - begin + RETURN_CYCLES;
                        self.receive.add(cycles);
                        inside += cycles;
                    }
                }
                "low" => {
                    (low, inside) = (Some(*at), 0);
                    sources.clear();
                }
                "low-end" => {
                    if let Some(begin) = low.take() {
                        let cycles = at - begin + RETURN_CYCLES;
                        self.low.add(cycles);
                        match sources.as_slice() {
                            [TIMER] => self.tick.add(cycles - inside),
                            [CHANGE] => self.input_change.add(cycles - inside),
                            [TRANSMIT] => self.transmit.add(cycles - inside),
                            _ => {}
                        }
                    }
                }
                MAIN => {
                    if let Some(begin) = main.replace(*at) {
                        self.pass.add(at - begin);
                    }
                }
                LOCK => lock = Some(*at),
                UNLOCK => {
                    if let Some(begin) = lock.take() {
                        self.locked.add(at - begin);
                    }
                }
                source => sources.push(match source {
                    TIMER => TIMER,
                    CHANGE => CHANGE,
                    _ => TRANSMIT,
                }),
            }
        }
        // The chip sees a byte a fixed while behind the middle of its stop bit.
        let least = waits.iter().copied().min().unwrap_or(0);
        let waits = Measured::of(waits.into_iter().map(|wait| wait - least));
        for cycles in [waits.best, waits.worst] {
            self.receive_waits.add(cycles);
        }
        self.receive_waits.samples += waits.samples.saturating_sub(2);
    }
}

/// Everything at once: packages that turn all seven joints every few ms, answers to them, arms' switches
/// and bumpers that never rest. From 20 MHz on the packages come without a pause, below as the rules of
/// the link have it: each when the one before can have been answered.
pub(super) fn busy(rig: &mut Rig, ms: u64) -> Result<Vec<(u64, Happening)>, GpsimError> {
    let mut random = Pcg64::seed_from_u64(18);
    let tick = rig.cycles_a_ms();
    let end = rig.cycle + ms * tick;
    let pause = if rig.image.clock_mhz >= 20 { 0 } else { rig.line_cycles(ANSWER_BYTES) };
    let mut line_free = rig.cycle;
    let mut log = Vec::new();
    while rig.cycle < end {
        // The line is kept full some packages ahead.
        while line_free < rig.cycle + rig.line_cycles(PACKAGES_AHEAD * PACKAGE_BYTES) {
            let request = busy_request(rig.image.address, &mut random);
            let bytes = rig.package(request);
            rig.chip.send(&bytes, line_free)?;
            line_free = line_free.max(rig.cycle) + rig.line_cycles(bytes.len()) + pause;
        }
        rig.run_to(rig.cycle + random.random_range(tick / 5..tick))?;
        if rig.image.address == Address::Motion {
            const INPUTS: [&str; 8] = ["rb4", "rb5", "rb4", "rb5", "rb0", "rb3", "ra0", "ra1"];
            let pin = INPUTS[random.random_range(0..INPUTS.len())];
            rig.chip.set(pin, random.random())?;
        }
        log.extend(rig.take());
    }
    for pin in ["rb0", "rb3", "rb4", "rb5", "ra0", "ra1"] {
        if rig.image.address == Address::Motion {
            rig.chip.set(pin, true)?;
        }
    }
    Ok(log)
}

fn busy_request(address: Address, random: &mut Pcg64) -> Request {
    const POSES: [u16; 4] = [0x1555, 0x3FFF, 0x2AAA, 0x1777];
    match (address, random.random_range(0..12)) {
        (_, 0) => Request::State,
        (_, 1) => Request::Counters,
        (Address::Motion, 2) => {
            let joint = Joint::ALL[random.random_range(0..Joint::COUNT)];
            let full_travel_ms = random.random_range(100..=10_000);
            Request::Configure(Parameter::TravelTime { joint, full_travel_ms })
        }
        (Address::Motion, dice) => Request::Step(Step {
            pose: Pose::from_word(POSES[random.random_range(0..POSES.len())])
                .unwrap_or(Pose::MIDDLE),
            duration_ms: random.random_range(1..5),
            replace: dice == 3,
            ending_bumpers: BumperMask::NONE,
        }),
        (Address::Camera, _) => Request::Aim(AimTarget {
            pan_centideg: random.random_range(-9000..=9000),
            tilt_centideg: random.random_range(-4500..=4500),
            speed_deg_per_s: random.random_range(0..200),
        }),
    }
}
