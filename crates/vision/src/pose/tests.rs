//! There and back: projected and recovered, exactly and with noise.

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;

const CAMERA: Intrinsics =
    Intrinsics { focal_x_px: 620.0, focal_y_px: 600.0, center_x_px: 322.5, center_y_px: 236.0 };

fn distance(one: [f64; 3], other: [f64; 3]) -> f64 {
    (Vector3::from(one) - Vector3::from(other)).norm()
}

/// A circle at `tilt` from its line of sight, towards `turn` around it.
fn tilted(center_m: [f64; 3], tilt_rad: f64, turn_rad: f64) -> CirclePose {
    let sight = -Vector3::from(center_m).normalize();
    let side = sight.cross(&Vector3::new(0.3, 1.0, 0.2)).normalize();
    let across = side * turn_rad.cos() + sight.cross(&side) * turn_rad.sin();
    CirclePose { center_m, normal: (sight * tilt_rad.cos() + across * tilt_rad.sin()).into() }
}

/// The pose among the two that is nearest by its normal.
fn nearest(poses: &[CirclePose; 2], to: &CirclePose) -> CirclePose {
    let off = |pose: &CirclePose| distance(pose.normal, to.normal);
    if off(&poses[0]) <= off(&poses[1]) { poses[0] } else { poses[1] }
}

#[test]
fn a_circle_looked_at_straight_has_one_pose_twice() {
    let poses = circle_poses(
        &Ellipse {
            center_x_px: 322.5,
            center_y_px: 236.0,
            semi_major_px: 62.0,
            semi_minor_px: 60.0,
            theta_rad: 0.0,
        },
        &CAMERA,
        0.05,
    );
    for pose in poses.unwrap() {
        assert!(distance(pose.center_m, [0.0, 0.0, 0.5]) < 1e-9, "{pose:?}");
        // A difference of the axes in the last digit tilts by its square root.
        assert!(distance(pose.normal, [0.0, 0.0, -1.0]) < 1e-6, "{pose:?}");
    }
}

#[test]
fn the_first_pose_is_that_of_a_rim_on_a_table() {
    let rim = CirclePose { center_m: [0.1, 0.2, 0.6], normal: [0.0, -0.8, -0.6] };
    let seen = project_circle(&rim, 0.04, &CAMERA).unwrap();
    let [first, second] = circle_poses(&seen, &CAMERA, 0.04).unwrap();
    assert!(distance(first.normal, rim.normal) < 1e-6, "{first:?}");
    assert!(distance(second.normal, rim.normal) > 0.5, "{second:?}");
    assert!(
        (Vector3::from(first.center_m).norm() - Vector3::from(second.center_m).norm()).abs() < 1e-9
    );
}

#[test]
fn what_is_beside_or_behind_the_camera_is_not_seen() {
    assert_eq!(project_ball([0.0, 0.0, 0.05], 0.06, &CAMERA), None);
    assert_eq!(project_ball([0.0, 0.0, -0.5], 0.06, &CAMERA), None);
    let facing = CirclePose { center_m: [0.0, 0.0, 0.05], normal: [0.0, 0.0, -1.0] };
    assert!(project_circle(&facing, 0.06, &CAMERA).is_some());
    assert_eq!(
        project_circle(&CirclePose { normal: [0.0, 1.0, 0.0], ..facing }, 0.06, &CAMERA),
        None
    );
    let edge_on = CirclePose { center_m: [0.0, 0.0, 0.5], normal: [0.0, 1.0, 0.0] };
    assert_eq!(project_circle(&edge_on, 0.06, &CAMERA), None);
    assert_eq!(project_circle(&CirclePose { normal: [0.0; 3], ..facing }, 0.06, &CAMERA), None);
    assert_eq!(project_ball([f64::NAN, 0.0, 0.5], 0.06, &CAMERA), None);
    assert_eq!(project_ball([0.0, 0.0, 0.5], f64::NAN, &CAMERA), None);
}

#[test]
fn an_error_names_what_is_wrong_and_what_to_do() {
    let good = Ellipse {
        center_x_px: 300.0,
        center_y_px: 200.0,
        semi_major_px: 40.0,
        semi_minor_px: 30.0,
        theta_rad: 0.4,
    };
    let told = |ellipse: &Ellipse, camera: &Intrinsics, radius_m: f64| {
        let error = ball_position(ellipse, camera, radius_m).unwrap_err();
        let told = error.to_string();
        assert_eq!(circle_poses(ellipse, camera, radius_m).unwrap_err().to_string(), told);
        told
    };
    assert_eq!(
        told(&good, &CAMERA, 0.0),
        "the radius is 0 m; give the true radius in metres, a positive number"
    );
    assert!(told(&good, &CAMERA, f64::NAN).starts_with("the radius is NaN m"));
    assert!(
        told(&good, &Intrinsics { focal_y_px: -1.0, ..CAMERA }, 0.1)
            .starts_with("the camera's focal_y_px is -1, it must be a positive number; take")
    );
    assert!(
        told(&Ellipse { theta_rad: f64::INFINITY, ..good }, &CAMERA, 0.1)
            .starts_with("the ellipse's theta_rad is inf, it must be a number; leave")
    );
    assert!(
        told(&Ellipse { semi_minor_px: 0.0, ..good }, &CAMERA, 0.1)
            .starts_with("the ellipse's semi_minor_px is 0, it must be a positive number")
    );
    assert!(told(&Ellipse { semi_minor_px: 1e-9, ..good }, &CAMERA, 0.1).contains("too thin"),);
    let wide = Intrinsics::from_field_of_view(640, 480, 3.2).unwrap_err();
    assert!(wide.to_string().contains("less than π"), "{wide}");
}

#[test]
fn the_field_of_view_is_that_between_the_outer_edges() {
    let camera = Intrinsics::from_field_of_view(640, 480, std::f64::consts::FRAC_PI_2).unwrap();
    assert!((camera.focal_x_px - 320.0).abs() < 1e-9);
    assert!((camera.center_x_px - 319.5).abs() < 1e-9 && (camera.center_y_px - 239.5).abs() < 1e-9);
}

prop_compose! {
    /// A place in the field of view, 0.3 to 2 m ahead.
    fn place()(x in -0.45..0.45_f64, y in -0.35..0.35_f64, depth_m in 0.3..2.0_f64) -> [f64; 3] {
        [x * depth_m, y * depth_m, depth_m]
    }
}

prop_compose! {
    /// Errors of the five parameters with a standard deviation of about 0.1 pixels, the angle's at the end of the
    /// major axis.
    fn noise()(values in [-0.17..0.17_f64, -0.17..0.17, -0.17..0.17, -0.17..0.17, -0.17..0.17]) -> [f64; 5] { values }
}

fn with_noise(ellipse: &Ellipse, noise: [f64; 5]) -> Ellipse {
    Ellipse {
        center_x_px: ellipse.center_x_px + noise[0],
        center_y_px: ellipse.center_y_px + noise[1],
        semi_major_px: ellipse.semi_major_px + noise[2],
        semi_minor_px: ellipse.semi_minor_px + noise[3],
        theta_rad: ellipse.theta_rad + noise[4] / ellipse.semi_major_px,
    }
}

proptest! {
    #[test]
    fn any_numbers_give_an_error_or_finite_poses(values: [f64; 5], camera: [f64; 4], radius_m: f64) {
        let ellipse = Ellipse {
            center_x_px: values[0],
            center_y_px: values[1],
            semi_major_px: values[2].abs(),
            semi_minor_px: values[3].abs(),
            theta_rad: values[4],
        };
        let camera = Intrinsics {
            focal_x_px: camera[0].abs(),
            focal_y_px: camera[1].abs(),
            center_x_px: camera[2],
            center_y_px: camera[3],
        };
        for camera in [camera, CAMERA] {
            if let Ok(poses) = circle_poses(&ellipse, &camera, radius_m.abs()) {
                prop_assert!(poses.iter().flat_map(|pose| pose.normal).all(f64::is_finite));
            }
            if let Ok(ball) = ball_position(&ellipse, &camera, radius_m.abs()) {
                prop_assert!(ball.center_m.iter().all(|value| value.is_finite()));
            }
            let _ = project_ball([values[0], values[1], values[2].abs()], radius_m.abs(), &camera);
        }
    }

    #[test]
    fn a_circle_is_where_it_was(center_m in place(), tilt in 0.05..1.4_f64, turn in 0.0..TAU, radius_m in 0.02..0.1_f64) {
        let truth = tilted(center_m, tilt, turn);
        let seen = project_circle(&truth, radius_m, &CAMERA).unwrap();
        let poses = circle_poses(&seen, &CAMERA, radius_m).unwrap();
        let found = nearest(&poses, &truth);
        prop_assert!(distance(found.center_m, truth.center_m) < 1e-6, "{found:?}");
        prop_assert!(distance(found.normal, truth.normal) < 1e-6, "{found:?}");
        // The other one looks the same.
        for pose in poses {
            let again = project_circle(&pose, radius_m, &CAMERA).unwrap();
            prop_assert!((again.center_x_px - seen.center_x_px).abs() < 1e-6);
            prop_assert!((again.semi_major_px - seen.semi_major_px).abs() < 1e-6);
            prop_assert!((again.semi_minor_px - seen.semi_minor_px).abs() < 1e-6);
        }
    }

    #[test]
    fn the_points_of_a_circle_are_seen_on_the_ellipse(center_m in place(), tilt in 0.0..1.4_f64, turn in 0.0..TAU, t in 0.0..TAU) {
        let pose = tilted(center_m, tilt, turn);
        let seen = project_circle(&pose, 0.08, &CAMERA).unwrap();
        let normal = Vector3::from(pose.normal);
        let side = normal.cross(&Vector3::new(1.0, 0.2, 0.1)).normalize();
        let point = Vector3::from(center_m) + (side * t.cos() + normal.cross(&side) * t.sin()) * 0.08;
        let (column, row) = (322.5 + 620.0 * point.x / point.z, 236.0 + 600.0 * point.y / point.z);
        prop_assert!(seen.distance_px(column, row).abs() < 1e-6);
    }

    #[test]
    fn a_ball_is_where_it_was(center_m in place(), radius_m in 0.02..0.1_f64) {
        let seen = project_ball(center_m, radius_m, &CAMERA).unwrap();
        let found = ball_position(&seen, &CAMERA, radius_m).unwrap();
        prop_assert!(distance(found.center_m, center_m) < 1e-6, "{found:?}");
        prop_assert!(found.misfit_rad < 1e-6);
    }

    #[test]
    fn a_ball_with_noise_is_off_by_the_share_that_its_radius_is(center_m in place(), radius_m in 0.02..0.1_f64, noise in noise()) {
        let seen = project_ball(center_m, radius_m, &CAMERA).unwrap();
        let found = ball_position(&with_noise(&seen, noise), &CAMERA, radius_m).unwrap();
        // Distance goes with the inverse of the radius, direction with the centre.
        let bound_m = Vector3::from(center_m).norm() * (0.25 / seen.semi_minor_px + 0.25 / 600.0);
        prop_assert!(distance(found.center_m, center_m) < bound_m, "{found:?} {bound_m}");
        prop_assert!(found.misfit_rad < 0.4 / 600.0);
    }

    #[test]
    fn a_tilted_circle_with_noise_keeps_its_pose(center_m in place(), tilt in 0.5..1.3_f64, turn in 0.0..TAU, radius_m in 0.05..0.1_f64, noise in noise()) {
        let truth = tilted(center_m, tilt, turn);
        let seen = project_circle(&truth, radius_m, &CAMERA).unwrap();
        let found = nearest(&circle_poses(&with_noise(&seen, noise), &CAMERA, radius_m).unwrap(), &truth);
        let bound_m = Vector3::from(center_m).norm() * (0.3 / seen.semi_major_px + 0.3 / 600.0);
        prop_assert!(distance(found.center_m, center_m) < bound_m, "{found:?} {bound_m}");
        // cos(tilt) is the ratio of the axes, so a pixel is worth 1 / (a sin(tilt)) radians.
        let bound_rad = 0.6 / (seen.semi_major_px * tilt.sin());
        prop_assert!(distance(found.normal, truth.normal) < bound_rad, "{found:?} {bound_rad}");
    }
}
