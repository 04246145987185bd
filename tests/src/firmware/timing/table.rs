//! The tables of `docs/firmware-timing.md`.

use super::load::{self, Load};
use super::motors::{self, Motors};
use super::routines::{self, Routines};
use super::{Measured, time};
use crate::firmware::gpsim::{GpsimError, Image};
use rsapien_protocol::Address;
use std::fmt::Write as _;
use std::path::Path;

/// Clocks and their speeds: those whose baud rate is less than 2 % off.
const SPEEDS: [(u8, &[u32]); 4] = [
    (40, &[115_200, 57_600, 38_400, 19_200]),
    (20, &[115_200, 57_600, 38_400, 19_200]),
    (10, &[57_600, 38_400, 19_200]),
    (4, &[19_200]),
];
/// The speed at which motors and routines are measured at each clock.
const fn usual_baud(clock_mhz: u8) -> u32 {
    if clock_mhz == 4 { 19_200 } else { 57_600 }
}

/// A row: what, and what is wanted or the paper says.
type Row = (&'static str, &'static str);

const MOTOR_ROWS: [Row; 8] = [
    (
        "last byte of a STEP to its seven motors on",
        "under 0.1 ms at 40 MHz, under 1 ms at 4 MHz (paper: 1 ms, 50 ms)",
    ),
    ("the same in a crowd", "under 1 ms at 40 MHz, under 50 ms at 4 MHz"),
    ("last byte of a STEP that turns seven motors to all of them off", "as the first"),
    (
        "tick in which a step starts to its seven motors on",
        "under 0.1 ms at 40 MHz, under 1 ms at 4 MHz (paper: 1 ms, 50 ms)",
    ),
    ("last byte of STOP to seven motors off", "at once"),
    ("the same in a crowd", "at once"),
    ("last byte before the cable is pulled to seven motors off", "500 ms"),
    ("both outputs of a motor off when its sense turns", "up to 1 ms, never 0"),
];

const ROUTINE_ROWS: [Row; 8] = [
    ("receive interrupt (high priority)", "less than a byte"),
    ("tick (low priority), by itself", "less than 1 ms"),
    ("input change (low), by itself", ""),
    ("transmit interrupt (low), by itself", "less than a byte"),
    ("low interrupt, several causes at once, receive interrupts inside", "less than 1 ms"),
    ("one pass of the main routine, interrupts inside", "less than the ring of 32 bytes lasts"),
    ("low interrupts locked by the main routine", "less than 1 ms"),
    ("receive interrupt kept waiting", "less than a byte"),
];

fn motor_values(motors: &Motors) -> [Measured; MOTOR_ROWS.len()] {
    [
        motors.step_on,
        motors.step_on_in_a_crowd,
        motors.step_turns,
        motors.start_on,
        motors.stop_off,
        motors.stop_off_in_a_crowd,
        motors.silence_off,
        motors.dead,
    ]
}

fn routine_values(routines: &Routines) -> [Measured; ROUTINE_ROWS.len()] {
    let Routines { receive, tick, input_change, transmit, low, pass, locked, receive_waits } =
        routines.clone();
    [receive, tick, input_change, transmit, low, pass, locked, receive_waits]
}

fn rows(text: &mut String, image: &Image, rows: &[Row], values: &[Measured]) {
    let ms = image.cycles_a_ms();
    for ((what, wanted), measured) in rows.iter().zip(values) {
        // The camera has no inputs.
        if measured.samples > 0 {
            let _ = writeln!(
                text,
                "| {what} | {} MHz | {} | {} | {} | {} | {wanted} |",
                image.clock_mhz,
                time(measured.best, ms),
                time(measured.worst, ms),
                measured.worst,
                measured.samples
            );
        }
    }
}

const TABLE_HEAD: &str = "| what | clock | best | worst | worst, cycles | samples | wanted |\n\
                          |---|---|---|---|---|---|---|\n";

fn motor_table(images: &[Image]) -> Result<String, GpsimError> {
    let mut text = TABLE_HEAD.to_owned();
    let measured =
        images.iter().map(motors::measure).collect::<Result<Vec<Motors>, GpsimError>>()?;
    for row in 0..MOTOR_ROWS.len() {
        for (image, motors) in images.iter().zip(&measured) {
            let value = motor_values(motors)[row];
            rows(&mut text, image, &MOTOR_ROWS[row..=row], &[value]);
        }
    }
    Ok(text)
}

fn routine_table(image: &Image) -> Result<String, GpsimError> {
    let mut text = TABLE_HEAD.to_owned();
    rows(&mut text, image, &ROUTINE_ROWS, &routine_values(&routines::measure(image)?));
    Ok(text)
}

fn load_table(images: &[Image]) -> Result<String, GpsimError> {
    let mut text = "| clock | bit/s | load at rest | all moving | everything at once | packages sent \
                    without a pause | accepted | line to the PC full | errors | cold start: first tick \
                    | first answer ends |\n|---|---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    let percent = |permille: u64| format!("{}.{} %", permille / 10, permille % 10);
    for image in images {
        let load: Load = load::measure(image)?;
        let _ = writeln!(
            text,
            "| {} MHz | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            image.clock_mhz,
            image.baud,
            percent(load.rest_permille),
            percent(load.moving_permille),
            percent(load.busy_permille),
            load.sent,
            load.accepted,
            percent(load.answered_permille),
            load.errors,
            time(load.first_tick, image.cycles_a_ms()),
            time(load.first_answer, image.cycles_a_ms()),
        );
    }
    Ok(text)
}

/// The rows of the images that are flashed, to be found in the document as they are.
///
/// # Errors
/// When an image cannot be run.
pub fn tables_of_the_committed_images() -> Result<String, GpsimError> {
    let [motion, camera] = Address::ALL.map(Image::committed);
    let motors = motor_table(std::slice::from_ref(&motion))?;
    let routines = routine_table(&motion)? + &routine_table(&camera)?;
    let loads = load_table(&[motion])? + &load_table(&[camera])?;
    Ok(motors + &routines + &loads)
}

/// The whole document, with images of other clocks and speeds from `folder`.
///
/// # Errors
/// When an image is missing or cannot be run.
pub fn document(folder: &Path) -> Result<String, GpsimError> {
    let image = |address, clock_mhz: u8, baud| {
        if (clock_mhz, baud) == (40, 57_600) {
            Image::committed(address)
        } else {
            Image::of(folder, address, clock_mhz, baud)
        }
    };
    let clocks = SPEEDS.map(|(clock_mhz, _)| clock_mhz);
    let at_clocks = |address| clocks.map(|mhz| image(address, mhz, usual_baud(mhz)));
    let at_speeds = |address| -> Vec<Image> {
        let speeds = SPEEDS.into_iter();
        speeds
            .flat_map(|(mhz, bauds)| bauds.iter().map(move |baud| image(address, mhz, *baud)))
            .collect()
    };
    let mut text = INTRODUCTION.to_owned();
    text.push_str(&motor_table(&at_clocks(Address::Motion))?);
    text.push_str(ABOUT_ROUTINES);
    text.push_str("\n### Motion\n\n");
    for image in at_clocks(Address::Motion) {
        text.push_str(&routine_table(&image)?);
        text.push('\n');
    }
    text.push_str("### Camera\n\n");
    for image in at_clocks(Address::Camera) {
        text.push_str(&routine_table(&image)?);
        text.push('\n');
    }
    text.push_str(ABOUT_LOADS);
    text.push_str("\n### Motion\n\n");
    text.push_str(&load_table(&at_speeds(Address::Motion))?);
    text.push_str("\n### Camera\n\n");
    text.push_str(&load_table(&at_speeds(Address::Camera))?);
    Ok(text)
}

/// The images that [`document`] needs beside those committed: clock and speed.
pub fn other_images() -> Vec<(u8, u32)> {
    let speeds = SPEEDS.into_iter();
    let all = speeds.flat_map(|(mhz, bauds)| bauds.iter().map(move |baud| (mhz, *baud)));
    all.filter(|image| *image != (40, 57_600)).collect()
}

const INTRODUCTION: &str = "\
# How fast the firmware is

Measured in instruction cycles (four clocks each) in the simulator of the chips, which is exact to the
cycle, by one command, which prints this page:

    cargo run -p rsapien-tests --release --features firmware-simulator --example firmware-timing

It needs the simulator (`make -C firmware-pic/sim`) and builds images for other clocks by
`firmware-pic/toolchain`. The rows at 40 MHz and 57600 bit/s are those of the images that are flashed; a
test measures them again and compares. Not in these numbers: what a real crystal and a real supply take
to start, and the electronics outside the chip.

## Motors

Over all phases of the tick; the times count from the middle of the last stop bit. A package comes
alone, as the rules of the link have it; *in a crowd* it comes right behind another one, whose answer
goes out at that moment, with more bytes right behind it. The paper: a motion primitive \"as fast as
1 ms at 40 MHz\"; below 4 MHz more than 50 ms, and the robot no longer walks. At 4 MHz the line has
19200 bit/s, otherwise 57600. A motor's sense turns at the next tick, so its two outputs rest for what
is left of the present one. Beyond what is wanted are the STEPs that turn all seven motors at once: the
tick that may come in between has seven joints to reckon.

";

const ABOUT_ROUTINES: &str = "
## Routines

With everything at once: packages that turn all seven joints every few ms, answers, mid-arm switches
and bumpers that never rest; first with travel times of 100 ms, so that joints arrive all the time, then
with long ones. At 40 and 20 MHz the packages come without a pause, at 10 and 4 MHz each when the one
before can have been answered. A routine counts from its vector to its return. The receive
interrupt is never locked out but by itself; \"kept waiting\" is what it comes later than at its
earliest. A byte takes 173.6 µs at 57600 bit/s and 520.8 µs at 19200. Where a worst case stands above
what is wanted, it is so: at 4 MHz, with everything at once, the low interrupts can be busy or locked
out (by a CONFIGURE of a travel time) for more than a tick, which then comes late or is lost.
";

const ABOUT_LOADS: &str = "
## Load, full line and cold start

Load is the share of the time that is not spent in empty passes of the main routine. For the full line
STATE comes without a pause for two seconds; the answers, which are longer, fill the other direction.
The rules of the link never fill it so: a PC waits for each answer. Filled so, the camera controller at
4 MHz loses packages (more while its axes move); every other combination loses none.
Errors are resets of reception, wrong checks, framing errors and overruns at the chip and broken answers
at the PC. From power-on the PC asks
again and again, with a pause of one byte.
";
