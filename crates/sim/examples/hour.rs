//! Walks for an hour of virtual time, spoken to over the line by a real session, and tells how long that took.
//!
//! `cargo run --release -p rsapien-sim --example hour -- [--seconds N] [--world empty]`
//!
//! The PC interrogates the state every 100 ms and keeps the robot's queue filled, as a player does.

use std::error::Error;
use std::time::Instant;

use rsapien_protocol::{
    Address, Joint, Mode, Pose, Position, Report, Request, Session, SessionConfig, SessionEvent,
    Status, Step,
};
use rsapien_sim::world::World;
use rsapien_sim::{VirtualRobot, VirtualRobotConfig};

use Joint::{LeftLeg, RightLeg, Tilt};
use Position::{First, Last};

/// One cycle of dynamic walking: poses and their durations in ms.
const WALK: [(&[(Joint, Position)], u16); 4] = [
    (&[(Tilt, First)], 600),
    (&[(RightLeg, First), (LeftLeg, Last)], 700),
    (&[(Tilt, Last)], 600),
    (&[(LeftLeg, First), (RightLeg, Last)], 700),
];
/// The PC looks at the robot this often, in ms.
const BEAT_MS: u64 = 100;
/// Steps are sent while fewer than this wait in the robot.
const STEPS_AHEAD: u8 = 4;

struct Pc {
    session: Session,
    robot: VirtualRobot,
    packages: u64,
}

impl Pc {
    /// Sends what the session has to send and runs until the request is answered.
    fn answer(&mut self) -> Result<(Status, Report), Box<dyn Error>> {
        let mut bytes = Vec::new();
        loop {
            match self.session.poll_event() {
                Some(SessionEvent::Answered { package, .. }) => {
                    self.packages += 1;
                    return Ok((package.status, package.report));
                }
                Some(event) => return Err(format!("{event:?}").into()),
                None => {}
            }
            while let Some(package) = self.session.poll_transmit(self.robot.now_ms()) {
                self.robot.send(&package);
            }
            let limit_ms = self.session.poll_timeout().ok_or("nothing is outstanding")?;
            self.robot.advance_until_byte(limit_ms);
            self.robot.receive(&mut bytes);
            self.session.handle_bytes(&bytes, self.robot.now_ms());
            self.session.handle_timeout(self.robot.now_ms());
            bytes.clear();
        }
    }

    fn ask(&mut self, request: Request) -> Result<(Status, Report), Box<dyn Error>> {
        self.session.request(Address::Motion, request)?;
        self.answer()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (mut seconds, mut world) = (3600_u32, World::empty());
    while let Some(option) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{option} needs a value"))?;
        match option.as_str() {
            "--seconds" => seconds = value.parse()?,
            "--world" => world = World::named(&value)?,
            _ => return Err(format!("there is no option {option}").into()),
        }
    }
    let robot = VirtualRobot::new(VirtualRobotConfig { world, ..VirtualRobotConfig::default() })?;
    let mut pc = Pc { session: Session::new(SessionConfig::default()), robot, packages: 0 };
    pc.session.open(Address::Motion)?;
    pc.answer()?;
    pc.ask(Request::Init)?;

    let start = Instant::now();
    let end_ms = u64::from(seconds) * 1000;
    let mut steps = WALK.iter().cycle();
    let (mut walked_m, mut last) = (0.0, pc.robot.pose());
    let mut free = None;
    while pc.robot.now_ms() < end_ms {
        let (_, report) = pc.ask(Request::State)?;
        let Report::Motion(report) = report else { return Err("not a motion report".into()) };
        if matches!(report.mode, Mode::Idle | Mode::Executing) {
            let places = *free.get_or_insert(report.queue_free);
            for _ in places - report.queue_free..STEPS_AHEAD {
                let Some((joints, duration_ms)) = steps.next() else { break };
                let pose = joints.iter().fold(Pose::EMPTY, |pose, (joint, position)| {
                    pose.with(*joint, Some(*position))
                });
                pc.ask(Request::Step(Step::new(pose, *duration_ms)))?;
            }
        }
        let now = pc.robot.pose();
        walked_m += (now.x_m - last.x_m).hypot(now.y_m - last.y_m);
        last = now;
        let next_ms = pc.robot.now_ms() + BEAT_MS;
        pc.robot.advance_to(next_ms);
    }
    let wall_s = start.elapsed().as_secs_f64();
    println!(
        "{seconds} virtual seconds in {wall_s:.2} s: {:.0} virtual seconds a second",
        f64::from(seconds) / wall_s
    );
    println!("{} packages answered, {walked_m:.1} m walked, now at {last:?}", pc.packages);
    Ok(())
}
