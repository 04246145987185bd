//! What every command is given: the options before its own, and what the terminals can show.

use std::env;
use std::io::IsTerminal;

use clap::Args;

use super::output::{Screen, Style};

/// Options that stand before or behind every command.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Options of every command")]
pub(crate) struct GlobalOptions {
    /// Where the robot is: `auto` asks every serial port for it, `virtual` is a robot in this process, `/dev/...` a
    /// serial port, `tcp://HOST:PORT` a network address
    #[arg(long, global = true, value_name = "LINK", env = "RSAPIEN_LINK", hide_env_values = true)]
    pub(crate) link: Option<String>,

    /// Bits per second on a serial port: 19200, 38400, 57600 or 115200
    #[arg(
        long,
        global = true,
        value_name = "BAUD",
        default_value_t = 57_600,
        hide_default_value = true,
        value_parser = baud
    )]
    pub(crate) baud: u32,

    /// Answer in JSON, one value a line
    #[arg(long, global = true)]
    pub(crate) json: bool,

    /// Tell on the standard error what happens on the way; -vv tells every package
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
}

/// A speed that the robot's firmware can be built for.
fn baud(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(baud @ (19_200 | 38_400 | 57_600 | 115_200)) => Ok(baud),
        _ => Err("expected 19200, 38400, 57600 or 115200".to_owned()),
    }
}

/// What a command is given.
#[derive(Debug, Clone)]
pub(crate) struct Context {
    /// The link asked for by `--link` or `RSAPIEN_LINK`.
    pub(crate) link: Option<String>,
    /// Bits per second on a serial port.
    pub(crate) baud: u32,
    /// How answers are written.
    pub(crate) style: Style,
}

impl Context {
    /// The context of these options on this process's terminals.
    pub(crate) fn new(options: GlobalOptions) -> Self {
        let is_set = |name| env::var_os(name).is_some_and(|value| !value.is_empty());
        let is_dumb = env::var_os("TERM").is_some_and(|value| value == "dumb");
        let screen = |is_terminal| match (is_terminal, is_set("NO_COLOR") || is_dumb) {
            (false, _) => Screen::None,
            (true, true) => Screen::Plain,
            (true, false) => Screen::Color,
        };
        Self {
            // A variable that is set to nothing is not set.
            link: options.link.filter(|link| !link.is_empty()),
            baud: options.baud,
            style: Style {
                json: options.json,
                output: screen(std::io::stdout().is_terminal()),
                error: screen(std::io::stderr().is_terminal()),
            },
        }
    }
}

/// Sends what the library tells on its way to the standard error: warnings always, more with each `-v`.
pub(crate) fn start_tracing(verbose: u8, style: Style) {
    let level = match verbose {
        0 => tracing::Level::WARN,
        1 => tracing::Level::INFO,
        2 => tracing::Level::DEBUG,
        _ => tracing::Level::TRACE,
    };
    let subscriber = tracing_subscriber::fmt()
        .with_max_level(level)
        .with_writer(std::io::stderr)
        .with_ansi(style.error == Screen::Color)
        .without_time()
        .finish();
    // A second run in one process keeps the subscriber of the first.
    let _ = tracing::subscriber::set_global_default(subscriber);
}
