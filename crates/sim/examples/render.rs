//! Writes what the robot's camera sees as a portable pixmap, and tells the truth about it.
//!
//! `cargo run --release -p rsapien-sim --example render -- OUT.ppm [--world demo] [--pan DEG] [--tilt DEG] [--x M]
//! [--y M] [--heading DEG] [--width PX] [--height PX] [--noise GREY] [--seed N] [--repeat N]`
//!
//! A `--world` of `random` takes its seed from `--seed`; `--repeat` renders so many frames and tells the mean time.

use std::error::Error;
use std::time::Instant;

use rsapien_sim::camera::{
    Camera, CameraPose, CameraSettings, HeadAngles, Intrinsics, ground_truth,
};
use rsapien_sim::geometry::RobotPose;
use rsapien_sim::world::World;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let out = arguments.next().ok_or("name the file to write first, such as out.ppm")?;
    let (mut world_name, mut pan, mut tilt) = ("demo".to_owned(), 58.0_f64, -18.0_f64);
    let mut robot = RobotPose { x_m: 0.3, ..RobotPose::default() };
    let (mut width, mut height, mut repeat) = (320, 240, 1_u32);
    let mut settings = CameraSettings::default();
    while let Some(option) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{option} needs a value"))?;
        match option.as_str() {
            "--world" => world_name = value,
            "--pan" => pan = value.parse()?,
            "--tilt" => tilt = value.parse()?,
            "--x" => robot.x_m = value.parse()?,
            "--y" => robot.y_m = value.parse()?,
            "--heading" => robot.heading_rad = value.parse::<f64>()?.to_radians(),
            "--width" => width = value.parse()?,
            "--height" => height = value.parse()?,
            "--noise" => settings.noise_sigma = value.parse()?,
            "--seed" => settings.seed = value.parse()?,
            "--repeat" => repeat = value.parse::<u32>()?.max(1),
            _ => return Err(format!("there is no option {option}").into()),
        }
    }
    settings.intrinsics = Intrinsics::with_field_of_view(width, height, 60.0)?;
    let world = if world_name == "random" {
        World::random(settings.seed)
    } else {
        World::named(&world_name)?
    };
    let camera = Camera::new(settings)?;
    let pose = CameraPose::on_robot(
        &robot,
        HeadAngles::from_radians(pan.to_radians(), tilt.to_radians())?,
    );

    let start = Instant::now();
    let mut picture = camera.render(&world, &pose, 0);
    for frame in 1..repeat {
        picture = camera.render(&world, &pose, u64::from(frame));
    }
    let milliseconds = start.elapsed().as_secs_f64() * 1000.0 / f64::from(repeat);
    std::fs::write(&out, picture.to_ppm())?;
    println!("{out}: {width}x{height}, {milliseconds:.1} ms a frame over {repeat}");
    for truth in ground_truth(&world, &camera.settings().intrinsics, &pose) {
        println!("{}", serde_json::to_string(&truth)?);
    }
    Ok(())
}
