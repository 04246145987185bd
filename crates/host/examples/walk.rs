//! Walks as the paper describes: the trunk tilts like a pendulum, and the leg that is free swings.
//!
//! ```text
//! cargo run -p rsapien --features virtual --example walk [-- LINK]
//! ```
//! without LINK on the virtual robot, as fast as it goes.

use rsapien::link::virtual_robot::Pace;
use rsapien::protocol::{BumperMask, Pose, Primitive, Step};
use rsapien::{Error, LinkAddress, PlayOptions, Robot, RobotOptions};

fn main() -> Result<(), Error> {
    let address = match std::env::args().nth(1) {
        Some(link) => link.parse()?,
        None => LinkAddress::Virtual,
    };
    let mut options = RobotOptions::for_user("walk example");
    options.virtual_robot.pace = Pace::Fast;
    let robot = Robot::open(&address, options)?;

    let mut motion = robot.motion()?;
    motion.init()?;
    let stride = [
        step(["tilt-left", "right-leg-front", "left-leg-back"]),
        step(["tilt-right", "left-leg-front", "right-leg-back"]),
    ];
    let mut play = PlayOptions {
        on_progress: Some(Box::new(|progress| {
            println!("{} of {} steps", progress.steps_ended, progress.steps_total);
        })),
        ..PlayOptions::default()
    };
    let report = motion.play(&stride.repeat(4), &mut play)?;
    println!("{report}");

    if let Some(shared) = robot.virtual_robot()
        && let Ok(virtual_robot) = shared.lock()
    {
        let pose = virtual_robot.pose();
        println!("the robot stands at x {:.2} m, y {:.2} m", pose.x_m, pose.y_m);
    }
    Ok(())
}

/// The primitives together for 600 ms, ended by the toes.
fn step(names: [&str; 3]) -> Step {
    let pose = names
        .iter()
        .filter_map(|name| Primitive::parse(name).ok())
        .fold(Pose::EMPTY, |pose, next| pose.with(next.joint(), Some(next.position())));
    Step { ending_bumpers: BumperMask::FEET, ..Step::new(pose, 600) }
}
