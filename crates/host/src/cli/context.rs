//! What every command is given: the options before its own, and what the terminals can show.

use std::env;
use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;

use super::config::Config;
use super::diagnostics::Result;
use super::output::{Screen, Style};
use super::recording::Recording;

/// Options that stand before or behind every command.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Options of every command")]
pub(crate) struct GlobalOptions {
    /// Where the robot is: `auto` asks every serial port for it, `virtual` is a robot in this process, `/dev/...` a
    /// serial port, `tcp://HOST:PORT` a network address
    #[arg(long, global = true, value_name = "LINK", env = "RSAPIEN_LINK", hide_env_values = true)]
    pub(crate) link: Option<String>,

    /// Bits per second on a serial port: 19200, 38400, 57600 (where none is given) or 115200
    #[arg(
        long,
        global = true,
        value_name = "BAUD",
        env = "RSAPIEN_BAUD",
        hide_env_values = true,
        value_parser = baud
    )]
    pub(crate) baud: Option<u32>,

    /// The configuration file; without it config.toml in your configuration folder, if it is there
    #[arg(
        long,
        global = true,
        value_name = "FILE",
        env = "RSAPIEN_CONFIG",
        hide_env_values = true
    )]
    pub(crate) config: Option<PathBuf>,

    /// Answer in JSON, one value a line
    #[arg(long, global = true)]
    pub(crate) json: bool,

    /// Tell on the standard error what happens on the way; -vv tells every package
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
}

/// A speed that the robot's firmware can be built for.
pub(super) fn baud(text: &str) -> std::result::Result<u32, String> {
    match text.parse() {
        Ok(baud @ (19_200 | 38_400 | 57_600 | 115_200)) => Ok(baud),
        _ => Err("expected 19200, 38400, 57600 or 115200".to_owned()),
    }
}

/// What a command is given.
#[derive(Debug, Clone)]
pub(crate) struct Context {
    /// The link asked for by `--link`, `RSAPIEN_LINK` or the configuration file.
    pub(crate) link: Option<String>,
    /// Bits per second on a serial port.
    pub(crate) baud: u32,
    /// The registry that the configuration file names.
    pub(crate) registry: Option<PathBuf>,
    /// The configuration file that was asked for by name.
    pub(crate) config_path: Option<PathBuf>,
    /// Where values come from that are not defaults.
    pub(crate) origins: Vec<Origin>,
    /// How answers are written.
    pub(crate) style: Style,
    /// What keeps all that happens with the robot that is opened.
    pub(crate) recording: Option<Recording>,
}

/// A value of the configuration, and where it comes from.
#[derive(Debug, Clone)]
pub(crate) struct Origin {
    /// As in the file.
    pub(crate) key: &'static str,
    pub(crate) value: String,
    /// `--link`, `RSAPIEN_LINK`, `the file`.
    pub(crate) from: &'static str,
}

/// The speed of the line where nobody says otherwise.
const BAUD_DEFAULT: u32 = 57_600;

impl Context {
    /// The context of these options on this process's terminals, and of the configuration file. `keeps_going` is for
    /// what has to work whatever the file says: then a mistake in it is a warning, and the file is not used.
    pub(crate) fn new(options: GlobalOptions, keeps_going: bool) -> Result<Self> {
        let is_set = |name| env::var_os(name).is_some_and(|value| !value.is_empty());
        let is_dumb = env::var_os("TERM").is_some_and(|value| value == "dumb");
        let screen = |is_terminal| match (is_terminal, is_set("NO_COLOR") || is_dumb) {
            (false, _) => Screen::None,
            (true, true) => Screen::Plain,
            (true, false) => Screen::Color,
        };
        let config_path = options.config.filter(|path| !path.as_os_str().is_empty());
        let config = match Config::read(config_path.as_deref()) {
            Err(failure) if keeps_going => {
                tracing::warn!("{failure}");
                Config::default()
            }
            read => read?,
        };
        // A variable that is set to nothing is not set.
        let link = options.link.filter(|link| !link.is_empty());
        let mut origins = Vec::new();
        let mut note =
            |key, value: &Option<String>, names: [&'static str; 2], of_file: &Option<String>| {
                if let Some(value) = value {
                    let [flag, variable] = names;
                    let from_variable = env::var(variable).is_ok_and(|it| it == *value);
                    let from = if from_variable { variable } else { flag };
                    origins.push(Origin { key, value: value.clone(), from });
                } else if let Some(value) = of_file {
                    origins.push(Origin { key, value: value.clone(), from: "the file" });
                }
            };
        let text = |baud: Option<u32>| baud.map(|baud| baud.to_string());
        let file = |path: &PathBuf| path.display().to_string();
        let of_environment = env::var("RSAPIEN_REGISTRY").ok().filter(|path| !path.is_empty());
        note("link", &link, ["--link", "RSAPIEN_LINK"], &config.link);
        note("baud", &text(options.baud), ["--baud", "RSAPIEN_BAUD"], &text(config.baud));
        let registry = config.registry.as_ref().map(file);
        note("registry", &of_environment, ["--registry", "RSAPIEN_REGISTRY"], &registry);
        Ok(Self {
            link: link.or(config.link),
            baud: options.baud.or(config.baud).unwrap_or(BAUD_DEFAULT),
            registry: config.registry,
            config_path,
            origins,
            recording: None,
            style: Style {
                json: options.json,
                output: screen(std::io::stdout().is_terminal()),
                error: screen(std::io::stderr().is_terminal()),
            },
        })
    }
}

/// Sends what the library tells on its way to the standard error: warnings always, more with each `-v`.
pub(crate) fn start_tracing(verbose: u8) {
    let level = match verbose {
        0 => tracing::Level::WARN,
        1 => tracing::Level::INFO,
        2 => tracing::Level::DEBUG,
        _ => tracing::Level::TRACE,
    };
    let subscriber = tracing_subscriber::fmt()
        .with_max_level(level)
        .with_writer(std::io::stderr)
        .with_ansi(
            std::io::stderr().is_terminal()
                && env::var_os("NO_COLOR").is_none_or(|it| it.is_empty()),
        )
        .without_time()
        .finish();
    // A second run in one process keeps the subscriber of the first.
    let _ = tracing::subscriber::set_global_default(subscriber);
}
