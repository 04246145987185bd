//! Prints `docs/firmware-timing.md`: how fast the firmware is, in the simulator of the chips.
//!
//! ```text
//! cargo run -p rsapien-tests --release --features firmware-simulator --example firmware-timing
//! ```
//!
//! Images for other clocks and speeds than the committed ones are built first, by `make` in
//! `firmware-pic/port/pic18`; words behind `--` go to it (`SDCC=...` names another compiler).

use rsapien_tests::firmware::timing;
use rsapien_tests::workspace;
use std::process::{Command, ExitCode, Stdio};

fn run() -> Result<String, String> {
    let folder = workspace().join("target/firmware/pic18/timing");
    for (clock_mhz, baud) in timing::other_images() {
        let mut command = Command::new("make");
        command.arg("-s").arg("-C").arg(workspace().join("firmware-pic/port/pic18"));
        command.arg(format!("CLOCK_MHZ={clock_mhz}")).arg(format!("BAUD={baud}"));
        command.arg(format!("OUT={}", folder.display())).args(std::env::args().skip(1));
        let status = command.stdout(Stdio::null()).status().map_err(|error| error.to_string())?;
        if !status.success() {
            return Err(format!(
                "no image for {clock_mhz} MHz and {baud} bit/s: has the compiler been built \
                 (firmware-pic/toolchain/build.sh)?"
            ));
        }
    }
    timing::document(&folder).map_err(|error| error.to_string())
}

fn main() -> ExitCode {
    match run() {
        Ok(document) => {
            print!("{document}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
