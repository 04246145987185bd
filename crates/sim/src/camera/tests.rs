use std::f64::consts::TAU;

use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;
use crate::geometry::{Ellipse, RobotPose};
use crate::world::{Ball, Cup, Light, Material, Plate, Wall, World, WorldDescription};

mod contours;

/// A dark plain floor in even light, so that nothing but contours changes the brightness.
fn plain_description() -> WorldDescription {
    let mut description = World::empty().description().clone();
    description.floor = Material::Plain { colour: [40, 40, 40] };
    description.backdrop = [40, 40, 40];
    description.light = Light { towards_lamp: [0.0, 0.0, 1.0], lamp: 0.0, sky: 0.0, ambient: 1.0 };
    description
}

fn ball(name: &str, center_m: [f64; 3], radius_m: f64) -> Ball {
    Ball { name: name.to_owned(), center_m, radius_m, colour: [220, 220, 220] }
}

fn plate(center_m: [f64; 3], radius_m: f64, inner_radius_m: f64) -> Plate {
    let (colour, rim_colour) = ([230, 230, 230], [120, 120, 120]);
    Plate { name: "plate".to_owned(), center_m, radius_m, inner_radius_m, colour, rim_colour }
}

fn straight_ahead() -> CameraPose {
    CameraPose::on_robot(&RobotPose::default(), HeadAngles::default())
}

fn truth_of(description: WorldDescription, pose: &CameraPose) -> Vec<VisibleEllipse> {
    ground_truth(&World::new(description).expect("a valid world"), &Intrinsics::default(), pose)
}

fn head(pan_centideg: i16, tilt_centideg: i16) -> HeadAngles {
    HeadAngles { pan_centideg, tilt_centideg }
}

fn robot_poses() -> impl Strategy<Value = RobotPose> {
    (-1.0..1.0f64, -1.0..1.0f64, -3.1..3.1f64, -0.2..0.2f64)
        .prop_map(|(x_m, y_m, heading_rad, roll_rad)| RobotPose { x_m, y_m, heading_rad, roll_rad })
}

#[test]
fn signs_are_those_of_the_link_and_of_pictures() {
    let intrinsics = Intrinsics::default();
    let seen = |head: HeadAngles, point: [f64; 3]| {
        let pose = CameraPose::on_robot(&RobotPose::default(), head);
        intrinsics.project(&pose.to_camera(&Vector3::from(point))).expect("in front")
    };
    let (x, y) = seen(head(0, 0), [2.0, 0.0, HEAD_HEIGHT_M]);
    assert!((x - 159.5).abs() < 1e-9 && (y - 119.5).abs() < 1e-9, "the axis is in the middle");
    assert!(seen(head(0, 0), [2.0, 0.3, HEAD_HEIGHT_M]).0 < 159.0, "left is left");
    assert!(seen(head(0, 0), [2.0, 0.0, 0.5]).1 < 119.0, "up is up");
    // Thirty degrees to either side are the edges of a 60 degree view.
    let (x, _) = seen(head(3000, 0), [2.0, 0.0, HEAD_HEIGHT_M]);
    assert!((x + 0.5).abs() < 1e-9, "panning right moves things left: {x}");
    let (_, y) = seen(head(0, 1000), [2.0, 0.0, HEAD_HEIGHT_M]);
    assert!(y > 150.0, "tilting up moves things down: {y}");
    let leaning = RobotPose { roll_rad: 0.1, ..RobotPose::default() };
    let pose = CameraPose::on_robot(&leaning, head(0, 0));
    assert!(pose.position.y < -0.01 && pose.position.z < HEAD_HEIGHT_M, "a lean to the right");
}

proptest! {
    #[test]
    fn aiming_at_a_point_centres_it_and_so_does_centring_its_pixel(
        robot in robot_poses(), pan in -60.0..60.0f64, tilt in -30.0..30.0f64, distance in 0.3..3.0f64,
        off_pan in -20.0..20.0f64, off_tilt in -12.0..12.0f64,
    ) {
        let intrinsics = Intrinsics::default();
        let degrees = |pan: f64, tilt: f64| HeadAngles::from_radians(pan.to_radians(), tilt.to_radians()).expect("in reach");
        let target = CameraPose::on_robot(&robot, degrees(pan, tilt));
        let point = target.position + target.rotation * Vector3::new(0.0, 0.0, distance);
        prop_assert_eq!(HeadAngles::aim_at(&robot, point.into()), Ok(degrees(pan, tilt)));

        let now = degrees(pan + off_pan, tilt + off_tilt);
        let (x, y) = intrinsics.project(&CameraPose::on_robot(&robot, now).to_camera(&point)).expect("in front");
        let then = now.centering(&intrinsics, x, y).expect("in reach");
        let (x, y) = intrinsics.project(&CameraPose::on_robot(&robot, then).to_camera(&point)).expect("in front");
        // Half a hundredth of a degree on each axis is 0.024 pixels of this camera.
        prop_assert!((x - intrinsics.cx).hypot(y - intrinsics.cy) < 0.05, "{x}, {y}");
    }

    #[test]
    fn every_contour_ray_touches_its_sphere_and_its_circle(
        robot in robot_poses(), x in -2.0..2.0f64, y in -2.0..2.0f64, z in 0.01..0.28f64,
        radius in 0.01..0.2f64, angle in 0.0..TAU,
    ) {
        let intrinsics = Intrinsics::default();
        let pose = CameraPose::on_robot(&robot, HeadAngles::default());
        let center = pose.to_camera(&Vector3::new(x, y, z));
        if let Some(ellipse) = truth::project_sphere(&intrinsics, &center, radius) {
            let (x, y) = ellipse.point_at(angle);
            let ray = intrinsics.direction(x, y).normalize();
            // The tangent cone xᵀ (c cᵀ - (|c|² - r²) I) x = 0.
            let residual = center.dot(&ray).powi(2) - (center.norm_squared() - radius * radius);
            prop_assert!(residual.abs() < 1e-6, "sphere: {residual}");
        }
        let to_camera = pose.rotation.inverse();
        let [one, other, up] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| to_camera * axis);
        if let Some(ellipse) = truth::project_circle(&intrinsics, &center, &(radius * one), &(radius * other)) {
            let (x, y) = ellipse.point_at(angle);
            let ray = intrinsics.direction(x, y);
            let on_plane = ray * (center.dot(&up) / ray.dot(&up));
            let off = (on_plane - center).norm() / radius - 1.0;
            prop_assert!(off.abs() < 1e-4, "circle: {off}");
        }
    }
}

#[test]
fn directions_and_settings_out_of_reach_are_refused_with_their_limits() {
    let behind = HeadAngles::aim_at(&RobotPose::default(), [-1.0, 0.2, 0.3]).expect_err("behind");
    let text = behind.to_string();
    assert!(text.starts_with("pan -168.69 and tilt") && text.contains("-90 to 90"), "{text}");
    assert!(HeadAngles::from_radians(f64::NAN, 0.0).is_err());
    assert_eq!(HeadAngles::from_radians(90_f64.to_radians(), 0.0), Ok(head(9000, 0)));
    assert!(HeadAngles::from_radians(90.01_f64.to_radians(), 0.0).is_err());

    let wide = Intrinsics::with_field_of_view(1921, 1080, 60.0).expect_err("too wide").to_string();
    assert_eq!(wide, "the picture's width (pixels) is 1921, allowed are 16 to 1920");
    assert!(Intrinsics::with_field_of_view(640, 480, f64::NAN).is_err());
    let refused =
        |settings: CameraSettings| Camera::new(settings).expect_err("refused").to_string();
    let default = CameraSettings::default;
    assert!(refused(CameraSettings { blur_sigma_px: 9.0, ..default() }).contains("blur"));
    assert!(refused(CameraSettings { noise_sigma: -1.0, ..default() }).contains("noise"));
    assert!(refused(CameraSettings { samples_per_axis: 0, ..default() }).contains("rays"));
}

#[test]
fn hidden_parts_are_told_and_hidden_things_are_not() {
    let mut description = plain_description();
    description.balls = vec![ball("near", [0.5, 0.0, 0.3], 0.05)];
    let fraction = |description: &WorldDescription| -> Vec<(String, f64)> {
        let truth = truth_of(description.clone(), &straight_ahead());
        truth.into_iter().map(|ellipse| (ellipse.object, ellipse.visible_fraction)).collect()
    };
    assert_eq!(fraction(&description), [("near".to_owned(), 1.0)]);
    // A wall whose end is straight ahead hides the left half.
    description.walls.push(Wall {
        name: "screen".to_owned(),
        from_m: [0.3, 0.0],
        to_m: [0.3, 1.0],
        thickness_m: 0.001,
        height_m: 1.0,
        colour: [90, 90, 90],
    });
    let half = fraction(&description);
    assert!((half[0].1 - 0.5).abs() < 0.02, "{half:?}");
    // Twice as far, of twice the size and a bit more: the nearer ball hides the other's middle, not its outline.
    description.walls.clear();
    description.balls.push(ball("far", [1.0, 0.0, 0.3], 0.104));
    assert_eq!(fraction(&description), [("near".to_owned(), 1.0), ("far".to_owned(), 1.0)]);
    description.balls[1].radius_m = 0.096;
    assert_eq!(fraction(&description), [("near".to_owned(), 1.0)], "hidden completely");
    // At the picture's edge half is seen; behind the camera and around it nothing is.
    description.balls = vec![ball("edge", [0.5, 0.5 * 30_f64.to_radians().tan(), 0.3], 0.02)];
    let edge = fraction(&description);
    assert!((edge[0].1 - 0.5).abs() < 0.03, "{edge:?}");
    description.balls =
        vec![ball("behind", [-0.5, 0.0, 0.3], 0.05), ball("around", [0.0, 0.0, 0.3], 0.1)];
    assert_eq!(fraction(&description), []);
}

#[test]
fn of_a_cup_the_rim_is_seen_whole_and_the_foot_by_half() {
    let mut description = plain_description();
    description.cups = vec![Cup {
        name: "cup".to_owned(),
        base_m: [0.5, 0.0, 0.0],
        radius_m: 0.05,
        inner_radius_m: 0.045,
        height_m: 0.03,
        colour: [200, 200, 200],
        rim_colour: [20, 20, 20],
    }];
    let truth = truth_of(description, &CameraPose::on_robot(&RobotPose::default(), head(0, -2500)));
    let fraction = |kind| {
        truth
            .iter()
            .find(|ellipse| ellipse.kind == kind)
            .map_or(0.0, |ellipse| ellipse.visible_fraction)
    };
    assert!((fraction(ContourKind::CupRimOuter) - 1.0).abs() < 1e-9);

    assert!((fraction(ContourKind::CupRimInner) - 1.0).abs() < 1e-9);
    let foot = fraction(ContourKind::CupBase);
    assert!(foot > 0.4 && foot < 0.6, "{foot}");
    let inner_floor = fraction(ContourKind::CupInnerFloor);
    assert!(inner_floor > 0.1 && inner_floor < 0.6, "{inner_floor}");
}

#[test]
fn the_demo_hides_its_ball_from_the_first_look_and_shows_it_to_the_second() {
    let world = World::demo();
    let intrinsics = Intrinsics::default();
    let ball_seen_by = |pose: &CameraPose| {
        ground_truth(&world, &intrinsics, pose).into_iter().find(|ellipse| ellipse.object == "ball")
    };
    assert_eq!(ball_seen_by(&straight_ahead()), None);
    for x_m in [0.0, 0.1, 0.2, 0.3, 0.4, 0.5] {
        let robot = RobotPose { x_m, ..RobotPose::default() };
        let way = world.blocked_motion([0.0, 0.0], [x_m, 0.0], 0.16);
        assert_eq!(way.blocked_by, None, "{x_m} m ahead");
        let aim =
            HeadAngles::aim_at(&robot, world.description().balls[0].center_m).expect("in reach");
        let ball = ball_seen_by(&CameraPose::on_robot(&robot, aim)).expect("in sight");
        assert!((ball.visible_fraction - 1.0).abs() < 1e-9, "{ball:?}");
        let off =
            (ball.ellipse.center_x - intrinsics.cx).hypot(ball.ellipse.center_y - intrinsics.cy);
        assert!(off < 0.5 && ball.ellipse.semi_minor > 12.0, "{ball:?} is {off} pixels off");
    }
}

#[test]
fn a_picture_is_the_same_on_any_number_of_threads() {
    let intrinsics = Intrinsics::with_field_of_view(160, 121, 60.0).expect("a small camera");
    let camera =
        Camera::new(CameraSettings { intrinsics, ..CameraSettings::default() }).expect("a camera");
    let world = World::random(3);
    let pose = CameraPose::on_robot(&RobotPose::default(), head(0, -1500));
    let on_threads = |count: usize, frame: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        pool.install(|| camera.render(&world, &pose, frame))
    };
    let picture = on_threads(1, 5);
    assert_eq!(picture.rgb.len(), 160 * 121 * 3);
    assert_eq!(picture, on_threads(2, 5));
    assert_eq!(picture, on_threads(8, 5));
    assert_ne!(picture, on_threads(2, 6), "each frame has its own noise");
    assert!(picture.to_ppm().starts_with(b"P6\n160 121\n255\n"));
}

#[test]
fn odd_places_give_a_picture_all_the_same() {
    let intrinsics = Intrinsics::with_field_of_view(16, 16, 60.0).expect("a small camera");
    let camera =
        Camera::new(CameraSettings { intrinsics, ..CameraSettings::default() }).expect("a camera");
    let world = World::demo();
    let inside_wall = RobotPose { x_m: 2.2, ..RobotPose::default() };
    let inside_table = RobotPose { x_m: 1.0, roll_rad: 1.5, ..RobotPose::default() };
    let nowhere = RobotPose { x_m: f64::NAN, heading_rad: f64::INFINITY, ..RobotPose::default() };
    let far_off = RobotPose { x_m: 1e300, y_m: -1e300, ..RobotPose::default() };
    for robot in [inside_wall, inside_table, nowhere, far_off] {
        let pose = CameraPose::on_robot(&robot, HeadAngles::default());
        assert_eq!(camera.render(&world, &pose, 0).rgb.len(), 16 * 16 * 3);
        ground_truth(&world, &intrinsics, &pose);
    }
}
