//! How deep a comparison went: counted as it runs, told as tables.

use super::event::Event;
use super::reference::Reference;
use rsapien_firmware_model::JointState;
use rsapien_protocol::{
    Address, CountersReport, Fed, Joint, Kind, Mode, Receiver, Status, StopCause,
    SynchronizationPackage,
};
use std::collections::BTreeMap;
use std::fmt::Write as _;

const JOINT_STATES: [(JointState, &str); 5] = [
    (JointState::Resting, "resting"),
    (JointState::Homing, "homing"),
    (JointState::Travelling, "travelling"),
    (JointState::Searching, "searching"),
    (JointState::SearchingBack, "searching back"),
];

/// What was seen of one controller.
#[derive(Clone, Debug)]
pub struct Coverage {
    address: Address,
    /// Sessions compared.
    pub sessions: u64,
    events: [u64; Event::SORTS],
    answers: BTreeMap<(u8, u8), u64>,
    statuses: [u64; Status::ALL.len()],
    mode_ticks: [u64; Mode::ALL.len()],
    mode_changes: BTreeMap<(u8, u8), u64>,
    causes: [u64; StopCause::ALL.len()],
    joint_state_ticks: [u64; JOINT_STATES.len()],
    counters: [u64; COUNTER_NAMES.len()],
    watchdog_resets: u64,
    queue_full_ticks: u64,
    limit_ticks: u64,
    last: Option<(Mode, StopCause, CountersReport, u8)>,
    heard: Receiver,
}

const COUNTER_NAMES: [&str; 7] = [
    "packages accepted",
    "resets of reception",
    "check errors",
    "framing errors",
    "overruns",
    "duplicates",
    "dead-man trips",
];

fn counters(report: &CountersReport) -> [u16; COUNTER_NAMES.len()] {
    [
        report.accepted,
        report.resets,
        report.crc_errors,
        report.framing_errors,
        report.overruns,
        report.duplicates,
        report.dead_man_trips,
    ]
}

impl Coverage {
    /// Nothing seen yet.
    pub fn new(address: Address) -> Coverage {
        Coverage {
            address,
            sessions: 0,
            events: [0; Event::SORTS],
            answers: BTreeMap::new(),
            statuses: [0; Status::ALL.len()],
            mode_ticks: [0; Mode::ALL.len()],
            mode_changes: BTreeMap::new(),
            causes: [0; StopCause::ALL.len()],
            joint_state_ticks: [0; JOINT_STATES.len()],
            counters: [0; COUNTER_NAMES.len()],
            watchdog_resets: 0,
            queue_full_ticks: 0,
            limit_ticks: 0,
            last: None,
            heard: Receiver::for_pc(),
        }
    }

    /// How many events were seen.
    pub fn event_count(&self) -> u64 {
        self.events.iter().sum()
    }

    /// Packages that the controller accepted.
    pub fn packages(&self) -> u64 {
        self.counters[0]
    }

    /// Sees the moment after `event`, in which the controller transmitted `transmitted`.
    pub fn see(&mut self, event: Event, after: &Reference, transmitted: &[u8]) {
        self.events[event.sort()] += 1;
        for byte in transmitted {
            if let Fed::Package(content) = self.heard.feed(*byte, 0)
                && let Ok(answer) = SynchronizationPackage::parse(&content)
            {
                let status = answer.status.byte();
                self.statuses[usize::from(status)] += 1;
                let kind = Kind::from_byte(answer.kind_byte).map_or(0, Kind::byte);
                *self.answers.entry((kind, status)).or_default() += 1;
            }
        }
        let now = (after.mode(), after.cause(), after.counters(), after.boot());
        if let Some((mode, cause, before, boot)) = self.last.replace(now) {
            if mode != now.0 {
                *self.mode_changes.entry((mode.byte(), now.0.byte())).or_default() += 1;
            }
            if cause != now.1 || mode != Mode::Held && now.0 == Mode::Held {
                self.causes[usize::from(now.1.byte())] += 1;
            }
            for ((sum, after), before) in
                self.counters.iter_mut().zip(counters(&now.2)).zip(counters(&before))
            {
                if boot == now.3 {
                    *sum += u64::from(after.wrapping_sub(before));
                }
            }
            let by_itself = matches!(event, Event::Tick(_) | Event::Timer);
            self.watchdog_resets += u64::from(by_itself && boot != now.3);
        }
        if matches!(event, Event::Tick(_) | Event::Timer) {
            self.see_tick(after);
        }
    }

    fn see_tick(&mut self, after: &Reference) {
        self.mode_ticks[usize::from(after.mode().byte())] += 1;
        if let Some(motion) = after.motion() {
            for joint in Joint::ALL {
                self.joint_state_ticks[motion.joint_state(joint) as usize] += 1;
            }
            self.queue_full_ticks += u64::from(motion.report().queue_free == 0);
        }
        if let Some(camera) = after.camera() {
            let axes = camera.report().axes;
            self.limit_ticks += u64::from(axes.pan_at_limit || axes.tilt_at_limit);
        }
    }

    /// Adds what another comparison of the same controller saw.
    pub fn add(&mut self, other: &Coverage) {
        self.sessions += other.sessions;
        self.watchdog_resets += other.watchdog_resets;
        self.queue_full_ticks += other.queue_full_ticks;
        self.limit_ticks += other.limit_ticks;
        for (key, count) in &other.answers {
            *self.answers.entry(*key).or_default() += count;
        }
        for (key, count) in &other.mode_changes {
            *self.mode_changes.entry(*key).or_default() += count;
        }
        add(&mut self.events, &other.events);
        add(&mut self.statuses, &other.statuses);
        add(&mut self.mode_ticks, &other.mode_ticks);
        add(&mut self.causes, &other.causes);
        add(&mut self.joint_state_ticks, &other.joint_state_ticks);
        add(&mut self.counters, &other.counters);
    }

    fn rows(&self) -> Vec<(String, u64)> {
        let mut rows = vec![("sessions".to_owned(), self.sessions)];
        let mut group = |name: &str, names: &mut dyn Iterator<Item = String>, counts: &[u64]| {
            rows.extend(names.map(|of| format!("{name}: {of}")).zip(counts.iter().copied()));
        };
        group("events", &mut Event::NAMES.into_iter().map(str::to_owned), &self.events);
        let statuses = Status::ALL.into_iter().map(|status| format!("{status:?}"));
        group("answers", &mut { statuses }, &self.statuses);
        let modes = Mode::ALL.into_iter().map(|mode| mode.name().to_owned());
        group("ticks in mode", &mut { modes }, &self.mode_ticks);
        let causes = StopCause::ALL.into_iter().map(|cause| cause.name().to_owned());
        group("holds and resets by", &mut { causes }, &self.causes);
        group("counted", &mut COUNTER_NAMES.into_iter().map(str::to_owned), &self.counters);
        rows.push(("watchdog resets".to_owned(), self.watchdog_resets));
        match self.address {
            Address::Motion => {
                for ((_, name), count) in JOINT_STATES.into_iter().zip(self.joint_state_ticks) {
                    rows.push((format!("ticks of joints: {name}"), count));
                }
                rows.push(("ticks with a full queue".to_owned(), self.queue_full_ticks));
            }
            Address::Camera => {
                rows.push(("ticks with an axis at a limit".to_owned(), self.limit_ticks));
            }
        }
        rows
    }

    /// What a deep comparison must have met and this one did not.
    pub fn missing(&self) -> Vec<String> {
        let camera = self.address == Address::Camera;
        let never = |row: &str| {
            // Nothing tells that a controller does not know why it was reset; the camera has neither
            // a queue nor bumpers.
            row == "holds and resets by: nothing"
                || camera && (row == "answers: QueueFull" || row == "holds and resets by: bumper")
        };
        let rows = self.rows().into_iter();
        let mut missing: Vec<String> =
            rows.filter(|(row, count)| *count == 0 && !never(row)).map(|(row, _)| row).collect();
        for kind in Kind::ALL.into_iter().filter(|kind| kind.is_served_by(self.address)) {
            if !self.answers.contains_key(&(kind.byte(), Status::Accepted.byte())) {
                missing.push(format!("{} accepted", kind.name()));
            }
        }
        missing
    }

    /// The tables.
    pub fn table(&self) -> String {
        let mut text = format!("{} controller\n", self.address.name());
        for (name, count) in self.rows() {
            let _ = writeln!(text, "  {name:38} {count:>10}");
        }
        let _ = writeln!(text, "  changes of mode:");
        for ((from, to), count) in &self.mode_changes {
            let name = |byte: &u8| Mode::from_byte(*byte).map_or("?", Mode::name);
            let _ = writeln!(text, "    {:14} -> {:19} {count:>10}", name(from), name(to));
        }
        let _ = writeln!(text, "  answers by kind and status:");
        for ((kind, status), count) in &self.answers {
            let kind = Kind::from_byte(*kind).map_or("(unknown)", Kind::name);
            let status = Status::from_byte(*status).map(|status| format!("{status:?}"));
            let _ =
                writeln!(text, "    {kind:14}    {:19} {count:>10}", status.unwrap_or_default());
        }
        text
    }
}

fn add(sums: &mut [u64], counts: &[u64]) {
    for (sum, count) in sums.iter_mut().zip(counts) {
        *sum += count;
    }
}
