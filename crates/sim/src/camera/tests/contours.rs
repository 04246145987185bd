//! The rendered picture against the computed truth, with no detector between them: along the normals of a true
//! ellipse the brightness must pass half-way between inside and outside on the ellipse itself.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::*;

/// How far (pixels) from the contour the brightness of either side is read.
const ASIDE_PX: f64 = 3.0;
/// Minor semi-axis (pixels) below which the two edges of a rim are too close for that.
const SMALLEST_PX: f64 = 11.0;

fn brightness(picture: &Picture, x: f64, y: f64) -> Option<f64> {
    let (left, top) = (x.floor(), y.floor());
    if left < 0.0
        || top < 0.0
        || left + 1.0 >= f64::from(picture.width)
        || top + 1.0 >= f64::from(picture.height)
    {
        return None;
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // inside of the picture
    let (column, row) = (left as usize, top as usize);
    let at = |column: usize, row: usize| {
        let start = (row * picture.width as usize + column) * 3;
        picture.rgb[start..start + 3].iter().map(|&value| f64::from(value)).sum::<f64>()
    };
    let (right, down) = (x - left, y - top);
    let upper = at(column, row) * (1.0 - right) + at(column + 1, row) * right;
    let lower = at(column, row + 1) * (1.0 - right) + at(column + 1, row + 1) * right;
    Some(upper * (1.0 - down) + lower * down)
}

/// How far outside of the ellipse, in pixels along the normal, the brightness passes half-way.
fn offset(picture: &Picture, ellipse: &Ellipse, angle: f64) -> Option<f64> {
    const STEP_PX: f64 = 0.05;
    let ((x, y), (normal_x, normal_y)) = (ellipse.point_at(angle), ellipse.normal_at(angle));
    let at = |distance: f64| brightness(picture, x + distance * normal_x, y + distance * normal_y);
    let half = 0.5 * (at(-ASIDE_PX)? + at(ASIDE_PX)?);
    let side = at(-ASIDE_PX)? > half;
    let mut distance = -ASIDE_PX;
    while distance < ASIDE_PX {
        let (here, next) = (at(distance)?, at(distance + STEP_PX)?);
        if (next > half) != side {
            return Some(distance + STEP_PX * (half - here) / (next - here));
        }
        distance += STEP_PX;
    }
    None
}

/// How far outside of the ellipse, in pixels along the normal, the brightness changes most.
fn steepest(picture: &Picture, ellipse: &Ellipse, angle: f64) -> Option<f64> {
    let ((x, y), (normal_x, normal_y)) = (ellipse.point_at(angle), ellipse.normal_at(angle));
    let at = |distance: f64| brightness(picture, x + distance * normal_x, y + distance * normal_y);
    let steps = (-40..=40).map(|step| 0.05 * f64::from(step));
    let changes = steps.map(|place| Some((place, (at(place + 0.5)? - at(place - 0.5)?).abs())));
    let changes: Vec<(f64, f64)> = changes.collect::<Option<_>>()?;
    changes.into_iter().max_by(|one, other| one.1.total_cmp(&other.1)).map(|(place, _)| place)
}

/// Mean and mean absolute offset (pixels) over the contour, and how many of 360 places could be read.
fn offsets(offset: impl Fn(f64) -> Option<f64>) -> (f64, f64, usize) {
    let found: Vec<f64> =
        (0..360).filter_map(|degrees| offset(f64::from(degrees).to_radians())).collect();
    let mean = |of: fn(f64) -> f64| {
        let count = found.iter().map(|_| 1.0).sum::<f64>();
        found.iter().map(|&value| of(value)).sum::<f64>() / count
    };
    (mean(|value| value), mean(f64::abs), found.len())
}

fn check_contours(
    description: WorldDescription,
    pose: &CameraPose,
    blur_sigma_px: f64,
    what: &str,
) -> usize {
    let settings = CameraSettings { blur_sigma_px, noise_sigma: 0.0, ..CameraSettings::default() };
    let world = World::new(description).expect("a valid world");
    let picture = Camera::new(settings.clone()).expect("a camera").render(&world, pose, 0);
    let truth = ground_truth(&world, &settings.intrinsics, pose);
    let usable = truth
        .iter()
        .filter(|truth| truth.visible_fraction > 0.99 && truth.ellipse.semi_minor > SMALLEST_PX);
    usable
        .map(|truth| {
            let (mean, absolute, count) = offsets(|angle| offset(&picture, &truth.ellipse, angle));
            // A mean of up to 0.04 is blur itself, which pulls round contours inward.
            assert!(count >= 300, "{what}: only {count} places read on {truth:?}");
            assert!(
                mean.abs() < 0.05 && absolute < 0.1,
                "{what}: {mean} mean, {absolute} absolute, {truth:?}"
            );
        })
        .count()
}

/// A robot anywhere with its head turned so that `place` is about in the middle of the picture.
fn looking_at(random: &mut Pcg64, place: [f64; 3]) -> CameraPose {
    loop {
        let robot = RobotPose {
            x_m: random.random_range(-1.0..1.0),
            y_m: random.random_range(-1.0..1.0),
            heading_rad: random.random_range(-3.0..3.0),
            roll_rad: random.random_range(-0.15..0.15),
        };
        let [x, y, z] = place;
        let near = (robot.x_m - x).hypot(robot.y_m - y);
        let beside =
            [x + random.random_range(-0.05..0.05), y + random.random_range(-0.05..0.05), z];
        if (0.25..0.7).contains(&near)
            && let Ok(head) = HeadAngles::aim_at(&robot, beside)
        {
            return CameraPose::on_robot(&robot, head);
        }
    }
}

#[test]
fn rendered_balls_lie_on_their_true_ellipses() {
    let mut checked = 0;
    for seed in 0..16 {
        let mut random = Pcg64::seed_from_u64(seed);
        let radius = random.random_range(0.03..0.06);
        let pose = looking_at(&mut random, [0.0, 0.0, radius]);
        let mut description = plain_description();
        let blur = if seed % 2 == 0 { 0.0 } else { 0.8 };
        description.balls = vec![ball("ball", [0.0, 0.0, radius], radius)];
        checked += check_contours(description, &pose, blur, &format!("seed {seed}"));
    }
    assert!(checked >= 14, "{checked}");
}

#[test]
fn rendered_plates_lie_on_their_true_ellipses() {
    let mut checked = 0;
    for seed in 100..116 {
        let mut random = Pcg64::seed_from_u64(seed);
        let radius = random.random_range(0.09..0.14);
        let height = random.random_range(0.0..0.03);
        let pose = looking_at(&mut random, [0.0, 0.0, height]);
        let mut description = plain_description();
        description.plates = vec![plate([0.0, 0.0, height], radius, 0.55 * radius)];
        let blur = if seed % 2 == 0 { 0.0 } else { 0.8 };
        checked += check_contours(description, &pose, blur, &format!("seed {seed}"));
    }
    assert!(checked >= 20, "{checked}");
}

#[test]
fn a_lit_ball_on_wood_lies_on_its_true_ellipse() {
    let world = World::demo();
    let robot = RobotPose { x_m: 0.3, ..RobotPose::default() };
    let aim = HeadAngles::aim_at(&robot, world.description().balls[0].center_m).expect("in reach");
    let pose = CameraPose::on_robot(&robot, aim);
    let settings =
        CameraSettings { blur_sigma_px: 0.0, noise_sigma: 0.0, ..CameraSettings::default() };
    let picture = Camera::new(settings.clone()).expect("a camera").render(&world, &pose, 0);
    let truth = ground_truth(&world, &settings.intrinsics, &pose);
    let ball = truth.iter().find(|truth| truth.object == "ball").expect("in sight");
    // The soft shadow beside the ball changes more than the contour there, so the middle value speaks for the rest.
    let places = (0..360)
        .filter_map(|degrees| steepest(&picture, &ball.ellipse, f64::from(degrees).to_radians()));
    let mut distances: Vec<f64> = places.map(f64::abs).collect();
    distances.sort_by(f64::total_cmp);
    assert_eq!(distances.len(), 360);
    assert!(distances[180] < 0.25, "half of the places are {} pixels off or more", distances[180]);
}
