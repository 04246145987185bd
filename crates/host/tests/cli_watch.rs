//! `rsapien watch`: films that the tests make, a browser, a camera, and sources that behave badly.
#![cfg(feature = "cli")]
#![allow(clippy::cast_precision_loss)]

mod support;

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStderr, Stdio};
use std::time::Duration;

use rsapien::video::{
    FrameSource, HttpOptions, HttpStream, Next, Piece, SourceOptions, Splitter, encode_jpeg,
};
use rsapien_vision::Picture;
use serde_json::Value;
use support::{Run, User, interrupt};

const WIDTH: usize = 161;
const HEIGHT: usize = 121;
/// Radius of the disc in every film, whose centre moves by two pixels a frame.
const RADIUS_PX: f64 = 30.0;

/// Brightness of bright discs, each by centre and radius, on a dark ground.
fn discs(discs: &[(f64, f64, f64)]) -> Vec<u8> {
    let place = |index: usize| ((index % WIDTH) as f64, (index / WIDTH) as f64);
    let is_inside = |index| {
        let (x, y) = place(index);
        discs.iter().any(|&(cx, cy, radius)| (x - cx).hypot(y - cy) < radius)
    };
    (0..WIDTH * HEIGHT).map(|index| if is_inside(index) { 200 } else { 50 }).collect()
}

/// Brightness of frame `number`.
fn disc(number: usize) -> Vec<u8> {
    discs(&[(60.0 + 2.0 * number as f64, 60.0, RADIUS_PX)])
}

fn header() -> Vec<u8> {
    format!("YUV4MPEG2 W{WIDTH} H{HEIGHT} F25:1 Ip A1:1 C420jpeg\n").into_bytes()
}

/// One frame of a film with this brightness and no colours.
fn frame_of(brightness: &[u8]) -> Vec<u8> {
    let mut bytes = b"FRAME\n".to_vec();
    bytes.extend(brightness);
    bytes.resize(bytes.len() + 2 * WIDTH.div_ceil(2) * HEIGHT.div_ceil(2), 128);
    bytes
}

fn frame(number: usize) -> Vec<u8> {
    frame_of(&disc(number))
}

fn film(frames: usize) -> Vec<u8> {
    header().into_iter().chain((0..frames).flat_map(frame)).collect()
}

fn jpeg(number: usize) -> Vec<u8> {
    let rgb = disc(number).iter().flat_map(|&value| [value; 3]).collect();
    encode_jpeg(&Picture::new(rgb, WIDTH, HEIGHT).unwrap()).unwrap()
}

/// Starts the command with its standard input open.
fn start(user: &User, arguments: &[&str]) -> Child {
    let mut command = user.command(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Runs the command with this on its standard input.
fn run(user: &User, arguments: &[&str], input: &[u8]) -> Run {
    let path = user.path("input");
    std::fs::write(&path, input).unwrap();
    let mut command = user.command(arguments);
    let input = std::fs::File::open(path).unwrap();
    let child = command.stdin(input).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    Run::of_child(child)
}

/// What is told on the standard error until a line holds `part`.
fn told(stderr: &mut BufReader<ChildStderr>, part: &str) -> String {
    let mut text = String::new();
    while !text.contains(part) {
        let length = text.len();
        stderr.read_line(&mut text).unwrap();
        assert!(text.len() > length, "{part:?} is not told:\n{text}");
    }
    text
}

/// The tracks of a line by identity, with centre and state.
fn tracks(line: &Value) -> Vec<(u64, [f64; 2], &str)> {
    let center = |track: &Value, index: usize| track["ellipse"][index].as_f64().unwrap();
    (line["tracks"].as_array().unwrap().iter())
        .map(|track| {
            let at = [center(track, 0), center(track, 1)];
            (track["id"].as_u64().unwrap(), at, track["state"].as_str().unwrap())
        })
        .collect()
}

#[test]
fn each_frame_of_a_film_is_a_line_and_the_disc_is_where_it_is() {
    let user = User::new();
    let run = run(&user, &["watch", "-", "--every-frame", "--frames", "5"], &film(7));
    let lines = run.json_lines();
    assert_eq!(lines.len(), 5, "{}", run.stderr);
    for (number, line) in lines.iter().enumerate() {
        assert_eq!(line["frame"], number);
        assert_eq!(line["time_s"], number as f64 / 25.0);
        assert_eq!((&line["width"], &line["height"]), (&WIDTH.into(), &HEIGHT.into()));
        assert!(line["delay_ms"].as_f64() >= line["ms"].as_f64(), "{line}");
        let ellipses = line["ellipses"].as_array().unwrap();
        assert_eq!((ellipses.len(), line["scores"].as_array().unwrap().len()), (1, 1), "{line}");
        let off = |index: usize, expected: f64| ellipses[0][index].as_f64().unwrap() - expected;
        assert!(off(0, 60.0 + 2.0 * number as f64).abs() < 1.0, "{line}");
        assert!(off(1, 60.0).abs() < 1.0 && off(2, RADIUS_PX).abs() < 1.0, "{line}");
        let tracks = tracks(line);
        let state = if number == 0 { "tentative" } else { "confirmed" };
        assert_eq!((tracks.len(), tracks[0].0, tracks[0].2), (1, 0, state), "{line}");
    }
    assert_eq!(run.status, 0);
    run.told(&["rsapien: 5 frames in ", "frames/s in", "looked at, 0 dropped; delay "]);
    assert!(
        run.stdout.starts_with("{\"frame\":0,\"time_s\":0.0,\"width\":161,\"height\":121,\"ms\":")
    );

    let bare = self::run(&user, &["watch", "input", "--no-tracks", "--fps", "50"], &film(1));
    assert!(bare.json()["tracks"].is_null(), "{}", bare.stdout);
    assert_eq!(bare.json()["ellipses"].as_array().unwrap().len(), 1, "{}", bare.stdout);
}

#[test]
fn what_is_followed_keeps_its_identity_when_the_camera_jumps() {
    const JUMP_AT: usize = 6;
    let at = |number: usize| {
        let (x, y) = if number < JUMP_AT { (0.0, 0.0) } else { (45.0, 30.0) };
        let x = x + number as f64;
        [(25.0 + x, 25.0 + y, 15.0), (65.0 + x, 30.0 + y, 11.0), (40.0 + x, 62.0 + y, 13.0)]
    };
    let frames = (0..10).flat_map(|number| frame_of(&discs(&at(number))));
    let film: Vec<u8> = header().into_iter().chain(frames).collect();
    let user = User::new();
    let run = run(&user, &["watch", "-", "--every-frame"], &film);
    let lines = run.json_lines();
    assert_eq!(lines.len(), 10, "{}", run.stderr);
    let seen_as = |number: usize| -> Vec<Option<u64>> {
        let followed = tracks(&lines[number]);
        let near = |x: f64, y: f64| {
            let is_here = |at: [f64; 2]| (at[0] - x).hypot(at[1] - y) < 2.0;
            followed.iter().find(|(_, at, state)| is_here(*at) && *state == "confirmed")
        };
        at(number).iter().map(|&(x, y, _)| near(x, y).map(|track| track.0)).collect()
    };
    let before = seen_as(JUMP_AT - 1);
    assert!(before.iter().all(Option::is_some), "{before:?} {}", lines[JUMP_AT - 1]);
    // Three frames are allowed for it.
    assert_eq!(seen_as(JUMP_AT + 2), before, "{}", run.stdout);
}

#[test]
fn a_drawn_film_can_be_watched_again_and_a_folder_gives_names() {
    let user = User::new();
    std::fs::create_dir(user.path("folder")).unwrap();
    for number in [2, 10, 1] {
        std::fs::write(user.path(&format!("folder/shot{number}.jpg")), jpeg(number)).unwrap();
    }
    std::fs::write(user.path("folder/shot3.jpg"), "no picture").unwrap();
    let run = user.run(&["watch", "folder", "--mjpeg", "found.mjpeg", "--json"]);
    let names: Vec<Value> = run.json_lines().iter().map(|line| line["image"].clone()).collect();
    assert_eq!(names, ["shot1.jpg", "shot2.jpg", "shot10.jpg"]);
    run.told(&["left out shot3.jpg", "1 picture left out"]);

    let again = user.run(&["watch", "found.mjpeg", "--every-frame"]);
    assert_eq!(again.json_lines().len(), 3, "{}", again.stderr);
    let mut command = user.command(&["watch", "found.mjpeg", "--every-frame", "--mjpeg", "-"]);
    let output = command.output().unwrap();
    let mut splitter = Splitter::default();
    splitter.push(&output.stdout);
    let pieces: Vec<Piece> = std::iter::from_fn(|| splitter.next_piece()).collect();
    assert!(pieces.len() == 3 && pieces.iter().all(|piece| matches!(piece, Piece::Picture(_))));
}

#[test]
fn a_source_that_stalls_and_sends_rubbish_is_told_and_survived() {
    let user = User::new();
    let mut child = start(&user, &["watch", "-", "--stall-ms", "100"]);
    let mut input = child.stdin.take().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let rubbish: Vec<u8> = (0..200).collect();
    input.write_all(&jpeg(0)).unwrap();
    input.write_all(&rubbish).unwrap();
    told(&mut stderr, "the source stalls: no frame for 0.");
    input.write_all(&jpeg(1)).unwrap();
    let text = told(&mut stderr, "frames come again, after ");
    assert!(text.contains("skipped 200 bytes"), "{text}");
    // It breaks off in its third picture.
    input.write_all(&jpeg(2)[..500]).unwrap();
    drop(input);
    told(&mut stderr, "it breaks off after 500 bytes");
    told(&mut stderr, "1 picture left out; 200 bytes skipped");
    assert_eq!(Run::of_child(child).json_lines().len(), 2);
}

#[test]
fn browsers_are_served_until_ctrl_c() {
    let user = User::new();
    let mut child = start(&user, &["watch", "-", "--serve", "0"]);
    let mut input = child.stdin.take().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let text = told(&mut stderr, "showing the frames at http://127.0.0.1:");
    let address = text.trim().rsplit(' ').next().unwrap().parse().unwrap();
    let mut viewer = HttpStream::new(
        address,
        HttpOptions::default(),
        SourceOptions { color: true, frame_rate: None },
    );
    let viewer = std::thread::spawn(move || match viewer.next_frame() {
        Ok(Next::Frame(frame)) => frame.picture(),
        other => panic!("{other:?}"),
    });
    input.write_all(&header()).unwrap();
    for number in 0.. {
        input.write_all(&frame(number % 10)).unwrap();
        if viewer.is_finished() {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let picture = viewer.join().unwrap();
    assert_eq!((picture.width(), picture.height()), (WIDTH, HEIGHT));
    interrupt(&child);
    let run = Run::of_child(child);
    assert_eq!((run.status, run.stdout.as_str()), (0, ""));
    drop(input);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let user = User::new();
    let mut child = start(&user, &["watch", "-"]);
    drop(child.stdout.take());
    let mut input = child.stdin.take().unwrap();
    // More than any pipe holds; the command ends before it has read all.
    let _ = input.write_all(&film(20));
    drop(input);
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0), "{stderr}");
    assert!(!stderr.contains("cannot"), "{stderr}");
}

#[test]
fn the_virtual_robot_is_watched() {
    let user = User::new();
    let run = user.run(&["watch", "virtual", "--frames", "3", "--fps", "100"]);
    let lines = run.json_lines();
    assert_eq!(lines.len(), 3, "{}", run.stderr);
    assert_eq!((&lines[0]["width"], &lines[0]["height"]), (&320.into(), &240.into()));
}

#[test]
fn what_cannot_be_watched_is_refused_with_the_next_thing_to_do() {
    let user = User::new();
    std::fs::create_dir(user.path("empty")).unwrap();
    let refused = |arguments: &[&str], parts: &[&str]| {
        let all: Vec<&str> = ["watch"].iter().chain(arguments).copied().collect();
        user.expect(2, &all).told(parts);
    };
    refused(&["missing.y4m"], &["missing.y4m", "check the name"]);
    refused(&["empty"], &["empty holds no picture", "png, jpg"]);
    refused(&["https://camera/"], &["only http://", "ffmpeg"]);
    refused(&["http://127.0.0.1:1/"], &["no stream from http://127.0.0.1:1/", "browser"]);
    refused(&["camera:/dev/no-such-camera"], &["camera"]);
    refused(&["-"], &["ended before its first picture"]);
    refused(&["-", "--pan", "5"], &["--pan and --tilt", "virtual"]);
    refused(&["-", "--json", "--mjpeg", "-"], &["both want the standard output"]);
    refused(&["-", "--serve", "0.0.0.0:0"], &["--allow-remote"]);
    refused(&["-", "--min-axis", "1"], &["semi_axis_min_px is 1", "--min-axis"]);
    refused(&["-", "--size", "large"], &["640x480"]);
    let huge = b"YUV4MPEG2 W60000 H60000 F25:1\nFRAME\n";
    let run = run(&user, &["watch", "-"], huge);
    assert_eq!(run.status, 2);
    run.told(&["too large: 60000 x 60000"]);
}
