//! The bridge to gpsim in lock step: an image, its serial line and its pins, with time standing still
//! but for [`Gpsim::advance`].

use super::record::hex;
use crate::workspace;
use rsapien_protocol::Address;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// The longest that the bridge may work on one command.
const PATIENCE: Duration = Duration::from_mins(2);

/// Something that the chip or the line did.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Happening {
    /// The chip sent a byte; the cycle is the middle of its stop bit.
    Byte(u8),
    /// What the chip sent had no stop bit.
    Framing,
    /// A byte for the chip is complete; the cycle is the middle of its stop bit.
    Heard,
    /// A pin that is watched has changed to this level.
    Edge(String, bool),
    /// The program counter came to the address of this mark.
    Mark(String),
    /// The chip was reset: `power-on`, `mclr` or, by itself, `watchdog`.
    Reset(String),
}

/// What the simulator could not do.
#[derive(Debug, thiserror::Error)]
pub enum GpsimError {
    /// The bridge is not built, or the image is missing.
    #[error("{} is missing: {how}", path.display())]
    Missing {
        /// What is missing.
        path: PathBuf,
        /// How it is made.
        how: &'static str,
    },
    /// It does not start, or ended.
    #[error("the simulator of the chips: {0}")]
    Broken(String),
    /// It refuses a command.
    #[error("the simulator of the chips refuses `{command}`: {why}")]
    Refused {
        /// The command.
        command: String,
        /// Why.
        why: String,
    },
}

/// An image for a chip.
#[derive(Clone, Debug)]
pub struct Image {
    /// The controller it is.
    pub address: Address,
    /// Intel HEX.
    pub hex: PathBuf,
    /// Addresses of its functions, if the build kept them.
    pub symbols: Option<PathBuf>,
    /// Its clock in MHz.
    pub clock_mhz: u8,
    /// The speed of its line.
    pub baud: u32,
}

/// The chip's name in an image's.
const fn chip(address: Address) -> &'static str {
    match address {
        Address::Motion => "18f452",
        Address::Camera => "18f2320",
    }
}

impl Image {
    /// The image that is flashed, as it is committed: 40 MHz and 57600 bit/s.
    pub fn committed(address: Address) -> Image {
        Image::of(&workspace().join("firmware-pic/hex"), address, 40, 57_600)
    }

    /// The image of a folder for a clock and a speed.
    pub fn of(folder: &Path, address: Address, clock_mhz: u8, baud: u32) -> Image {
        let name = format!("rsapien-{}-{}-{clock_mhz}mhz-{baud}", address.name(), chip(address));
        let symbols = folder.join(format!("{name}.symbols"));
        Image {
            address,
            hex: folder.join(format!("{name}.hex")),
            symbols: symbols.exists().then_some(symbols),
            clock_mhz,
            baud,
        }
    }

    /// Instruction cycles a ms.
    pub fn cycles_a_ms(&self) -> u64 {
        u64::from(self.clock_mhz) * 250
    }

    /// Cycles that a byte takes on the line, rounded up.
    pub fn cycles_a_byte(&self) -> u64 {
        (self.cycles_a_ms() * 10_000).div_ceil(u64::from(self.baud))
    }
}

/// A running chip.
#[derive(Debug)]
pub struct Gpsim {
    child: Child,
    commands: ChildStdin,
    lines: Receiver<String>,
}

impl Gpsim {
    /// Starts the bridge with an image. Nothing runs before the first [`advance`](Gpsim::advance).
    ///
    /// # Errors
    /// When the bridge or the image is missing, or does not start.
    pub fn start(image: &Image) -> Result<Gpsim, GpsimError> {
        let bridge = workspace().join("target/firmware/sim/rsapien-gpsim");
        let missing = |path: &Path, how| GpsimError::Missing { path: path.to_owned(), how };
        if !bridge.exists() {
            let how = "`make -C firmware-pic/sim` builds it (apt-get install gpsim-dev)";
            return Err(missing(&bridge, how));
        }
        if !image.hex.exists() {
            let how =
                "images are in firmware-pic/hex; `make -C firmware-pic/port/pic18` builds others";
            return Err(missing(&image.hex, how));
        }
        // gpsim knows no 18F2320; the 18F2321 is the nearest.
        let processor = match image.address {
            Address::Motion => "p18f452",
            Address::Camera => "p18f2321",
        };
        let mut command = Command::new(bridge);
        command.arg("--lockstep").arg("--hex").arg(&image.hex).args(["--processor", processor]);
        command.arg("--clock-mhz").arg(image.clock_mhz.to_string());
        command.arg("--baud").arg(image.baud.to_string());
        if let Some(symbols) = &image.symbols {
            command.arg("--symbols").arg(symbols);
        }
        let broken = |error: std::io::Error| GpsimError::Broken(error.to_string());
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit())
            .spawn()
            .map_err(broken)?;
        let gone = || GpsimError::Broken("it has no pipes".to_owned());
        let commands = child.stdin.take().ok_or_else(gone)?;
        let answers = child.stdout.take().ok_or_else(gone)?;
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in BufReader::new(answers).lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Ok(Gpsim { child, commands, lines })
    }

    /// Gives a command. Gives the event lines of the answer, and what stands behind its `ok`.
    ///
    /// # Errors
    /// When the bridge refuses it or is gone.
    pub fn command(
        &mut self,
        command: &str,
    ) -> Result<(Vec<(u64, Happening)>, String), GpsimError> {
        let broken = |why: String| GpsimError::Broken(format!("`{command}`: {why}"));
        writeln!(self.commands, "{command}").map_err(|error| broken(error.to_string()))?;
        let mut happenings = Vec::new();
        loop {
            let line = self.lines.recv_timeout(PATIENCE).map_err(|error| match error {
                RecvTimeoutError::Timeout => broken(format!("nothing for {PATIENCE:?}")),
                RecvTimeoutError::Disconnected => broken("it has ended".to_owned()),
            })?;
            match line.split_once(' ').unwrap_or((&line, "")) {
                ("ok", rest) => return Ok((happenings, rest.to_owned())),
                ("error", why) => {
                    let (command, why) = (command.to_owned(), why.to_owned());
                    return Err(GpsimError::Refused { command, why });
                }
                _ => happenings.push(parse(&line).ok_or_else(|| broken(line.clone()))?),
            }
        }
    }

    /// Gives a command whose answer says nothing.
    ///
    /// # Errors
    /// As [`command`](Gpsim::command).
    pub fn tell(&mut self, command: &str) -> Result<(), GpsimError> {
        self.command(command).map(|_| ())
    }

    /// Runs so many cycles.
    ///
    /// # Errors
    /// As [`command`](Gpsim::command).
    pub fn advance(&mut self, cycles: u64) -> Result<Vec<(u64, Happening)>, GpsimError> {
        Ok(self.command(&format!("advance {cycles}"))?.0)
    }

    /// Drives a pin.
    ///
    /// # Errors
    /// As [`command`](Gpsim::command).
    pub fn set(&mut self, pin: &str, level: bool) -> Result<(), GpsimError> {
        self.tell(&format!("set {pin} {}", u8::from(level)))
    }

    /// Puts bytes on the line, not before a cycle.
    ///
    /// # Errors
    /// As [`command`](Gpsim::command).
    pub fn send(&mut self, bytes: &[u8], at_cycle: u64) -> Result<(), GpsimError> {
        let hex = hex(bytes).replace(' ', "");
        self.tell(&format!("send {hex} {at_cycle}"))
    }
}

impl Drop for Gpsim {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn parse(line: &str) -> Option<(u64, Happening)> {
    let mut words = line.split(' ');
    let sort = words.next()?;
    let cycle = words.next()?.parse().ok()?;
    let happening = match sort {
        "byte" => Happening::Byte(u8::from_str_radix(words.next()?, 16).ok()?),
        "framing" => Happening::Framing,
        "heard" => Happening::Heard,
        "edge" => Happening::Edge(words.next()?.to_owned(), words.next()? == "1"),
        "reset" => Happening::Reset(words.next()?.to_owned()),
        "mark" => Happening::Mark(words.next()?.to_owned()),
        _ => return None,
    };
    Some((cycle, happening))
}
