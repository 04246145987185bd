//! What the demo does, step after step.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use rsapien_registry::{CompileOptions, Registry};
use rsapien_sim::VirtualRobotConfig;
use rsapien_sim::robot::Controllers;
use rsapien_sim::world::World;
use rsapien_vision::{GrayImage, Picture, draw};

use super::log;
use super::summary::{Report, Walk};
use crate::behaviour::{BallSearch, Direction, Head, Sight};
use crate::cli::camera::{Camera, Source, Truth};
use crate::cli::cmd::detect::save;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::firmware;
use crate::cli::performance;
use crate::cli::robot::{OpenRobot, open_with};
use crate::cli::view;
use crate::link::virtual_robot::{Pace, VirtualOptions};
use crate::{CameraController, LinkAddress, RobotOptions};

/// The action that the demo walks by.
const WALK: &str = "walk-forward";

/// What the user asked for.
pub(super) struct Settings {
    pub(super) link: LinkAddress,
    pub(super) fast: bool,
    pub(super) seed: u64,
    pub(super) world: World,
    pub(super) controllers: Controllers,
    /// Least and greatest radius of the ball in the picture, in pixels.
    pub(super) radius_px: (f32, f32),
    pub(super) walks: u16,
    pub(super) field_of_view_deg: f64,
    pub(super) picture_file: PathBuf,
    pub(super) log_file: PathBuf,
}

/// Runs the demo; what happens on the way is told to people.
pub(super) fn run(
    context: &Context,
    out: &mut impl Write,
    source: Source,
    settings: Settings,
) -> Result<Report> {
    let clock = Instant::now();
    let mut options = RobotOptions::for_user("rsapien demo");
    options.on_package = Some(log::to_file(&settings.log_file)?);
    let images = firmware::images(&settings.controllers);
    options.virtual_robot = VirtualOptions {
        pace: if settings.fast { Pace::Fast } else { Pace::Real },
        config: VirtualRobotConfig {
            seed: settings.seed,
            world: settings.world,
            baud: context.baud,
            controllers: settings.controllers,
            ..VirtualRobotConfig::default()
        },
    };
    let style = context.style;
    let open = open_with(context, &settings.link, options)?;
    let robot = &open.robot;
    style.remark(out, format_args!("robot: {}", robot.link_name()))?;
    for image in images {
        style.remark(out, format_args!("firmware: {image}"))?;
    }

    let mut motion = open.motion()?;
    let head = open.done(robot.camera())?;
    let start_ms = robot.now_ms();
    open.done(motion.init_unless(&open.cancel))?;
    open.done(head.home())?;
    let initialised_ms = robot.now_ms().saturating_sub(start_ms);
    style.remark(out, format_args!("initialised in {}", view::seconds(initialised_ms)))?;

    let mut camera = Camera::open(source, Some(robot))?;
    let before = camera.truth()?.map(|truth| truth.pose);
    let walk = match settings.walks {
        0 => None,
        times => {
            let options = CompileOptions { times, ..CompileOptions::default() };
            let walk = Registry::open_in_memory()?.compile(WALK, &options)?;
            let played = performance::run(context, &open, &mut motion, &walk, None)?;
            open.interrupt.check()?;
            // A bumper that ended the walk holds the robot; what follows moves the head alone.
            open.done(motion.stop())?;
            let after = camera.truth()?.map(|truth| truth.pose);
            let walk = Walk {
                played,
                distance_m: before
                    .zip(after)
                    .map(|(one, other)| (other.x_m - one.x_m).hypot(other.y_m - one.y_m)),
            };
            style.remark(out, &walk)?;
            Some(walk)
        }
    };

    let pinhole = camera.pinhole(settings.field_of_view_deg)?;
    let mut search = BallSearch::new(pinhole, settings.radius_px).map_err(|error| {
        Failure::from_error(&error).hint("--radius sets the ball's radius in pixels")
    })?;
    search.seed = settings.seed;
    let look_start_ms = robot.now_ms();
    let mut eyes = Eyes { open: &open, head: &head, camera: &mut camera, picture: None };
    let mut sights: Vec<Sight> = Vec::new();
    let mut remarks = Ok(());
    let found = search.run(&mut eyes, |sight| {
        if remarks.is_ok() {
            remarks = style.remark(out, look_text(sight));
        }
        sights.push(sight.clone());
    })?;
    remarks?;
    let picture = eyes.picture.take();
    let looked_ms = robot.now_ms().saturating_sub(look_start_ms);
    let truth = camera.truth()?;

    let picture_file = match (&picture, sights.last()) {
        (Some(picture), Some(last)) => {
            save(&annotated(picture, last), &settings.picture_file)?;
            Some(settings.picture_file)
        }
        _ => None,
    };
    Ok(Report {
        link: robot.link_name().to_owned(),
        initialised_ms,
        walk,
        looked_ms,
        sights,
        found,
        truth_balls: truth.map(|Truth { balls, .. }| balls),
        counts: motion.state().counts,
        robot_ms: robot.now_ms(),
        wall: clock.elapsed(),
        picture_file,
        log_file: settings.log_file,
    })
}

fn look_text(sight: &Sight) -> String {
    let Direction { pan_deg, tilt_deg } = sight.direction;
    let seen = match &sight.ball {
        None => "no ball".to_owned(),
        Some(ball) => {
            let ellipse = ball.ellipse;
            format!(
                "a ball at ({:.1}, {:.1}), radius {:.1} px",
                ellipse.center_x_px,
                ellipse.center_y_px,
                f64::midpoint(ellipse.semi_major_px, ellipse.semi_minor_px)
            )
        }
    };
    format!("look {}: pan {pan_deg:.1}, tilt {tilt_deg:.1}: {seen}", sight.number)
}

/// The picture with the ball drawn, where there is one.
fn annotated(picture: &Picture, sight: &Sight) -> Picture {
    let mut drawn = picture.clone();
    if let Some(ball) = &sight.ball {
        draw::ellipse(&mut drawn, &ball.ellipse, draw::ELLIPSE_COLOR);
        draw::cross(&mut drawn, &ball.ellipse, draw::ELLIPSE_COLOR);
    }
    drawn
}

/// The robot's head and its camera.
struct Eyes<'a> {
    open: &'a OpenRobot,
    head: &'a CameraController,
    camera: &'a mut Camera,
    /// The last picture, in colour.
    picture: Option<Picture>,
}

impl Head for Eyes<'_> {
    type Error = Failure;

    fn look(&mut self, to: Direction) -> Result<Direction> {
        self.open.interrupt.check()?;
        let report = self.open.done(self.head.look(to.pan_deg, to.tilt_deg, 0))?;
        let degrees = |centideg: i16| f64::from(centideg) / 100.0;
        Ok(Direction::new(degrees(report.pan_centideg), degrees(report.tilt_centideg)))
    }

    fn see(&mut self) -> Result<GrayImage> {
        let picture = self.camera.take()?;
        let gray = picture.to_gray();
        self.picture = Some(picture);
        Ok(gray)
    }
}
