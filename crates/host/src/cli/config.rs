//! The configuration file: what a user does not want to say each time.
//!
//! A flag comes before the environment, the environment before the file, the file before the default.

use std::fs;
use std::path::{Path, PathBuf};

use directories::ProjectDirs;
use serde::Deserialize;

use super::diagnostics::{Failure, Result};

/// What the file may say.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Config {
    /// As `--link`.
    pub(crate) link: Option<String>,
    /// As `--baud`.
    pub(crate) baud: Option<u32>,
    /// As `--registry`; from the file's folder where it is relative.
    pub(crate) registry: Option<PathBuf>,
}

/// The keys, each with its default in words and what it is for.
pub(crate) const KEYS: [(&str, &str, &str); 3] = [
    ("link", "auto", "where the robot is: auto, virtual, /dev/..., tcp://HOST:PORT"),
    ("baud", "57600", "bits per second on a serial port: 19200, 38400, 57600 or 115200"),
    ("registry", "in your data folder", "the file of the actions"),
];

/// Where the file is unless `--config` or `RSAPIEN_CONFIG` names another.
pub(crate) fn default_path() -> Option<PathBuf> {
    Some(ProjectDirs::from("", "", "rsapien")?.config_dir().join("config.toml"))
}

impl Config {
    /// What the file says; one that is not there says nothing, unless it was asked for by name.
    pub(crate) fn read(named: Option<&Path>) -> Result<Config> {
        let Some(path) = named.map(Path::to_owned).or_else(default_path) else {
            return Ok(Config::default());
        };
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound && named.is_none() => {
                return Ok(Config::default());
            }
            Err(error) => return Err(Failure::file("read", &path, &error)),
        };
        Config::parse(&text, &path)
    }

    fn parse(text: &str, path: &Path) -> Result<Config> {
        let mut config: Config = toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(1, |span| {
                text.get(..span.start).unwrap_or_default().matches('\n').count() + 1
            });
            let message = error.message().trim().replace('\n', "; ");
            let keys = KEYS.map(|(key, _, _)| key).join(", ");
            Failure::new(format!("{}, line {line}: {message}", path.display()))
                .hint(format!("the keys are {keys}; rsapien config init --print shows an example"))
        })?;
        if let Some(baud) = config.baud {
            super::context::baud(&baud.to_string()).map_err(|expected| {
                Failure::new(format!("{}: baud = {baud}: {expected}", path.display()))
            })?;
        }
        if let (Some(registry), Some(folder)) = (&config.registry, path.parent()) {
            config.registry = Some(folder.join(registry));
        }
        Ok(config)
    }
}

/// An example with everything in it, commented out.
pub(crate) fn example() -> String {
    let keys = KEYS.map(|(key, default, what)| {
        let value = match key {
            "baud" => default.to_owned(),
            "registry" => "\"actions.sqlite\"".to_owned(),
            _ => format!("\"{default}\""),
        };
        format!("# {what} (without it: {default})\n# {key} = {value}\n")
    });
    format!(
        "# Configuration of rsapien. A flag comes before the environment, the environment before this file.\n\n{}",
        keys.join("\n")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Config> {
        Config::parse(text, Path::new("/etc/robot/config.toml"))
    }

    #[test]
    fn the_example_is_right_with_and_without_its_signs() {
        assert_eq!(parse(&example()).unwrap(), Config::default());
        let lines = example();
        let lines = lines.lines().filter_map(|line| line.strip_prefix("# "));
        let said: Vec<&str> = lines.filter(|line| line.contains(" = ")).collect();
        let config = parse(&said.join("\n")).unwrap();
        assert_eq!((config.link.as_deref(), config.baud), (Some("auto"), Some(57_600)));
        assert_eq!(config.registry.unwrap(), Path::new("/etc/robot/actions.sqlite"));
        assert_eq!(said.len(), KEYS.len());
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, told) in [
            ("link = \"virtual\"\nlinc = 3", "line 2"),
            ("baud = 9600", "expected 19200"),
            ("link = 3", "line 1"),
            ("link = ", "line 1"),
        ] {
            let failure = parse(text).unwrap_err().to_string();
            assert!(failure.contains(told) && failure.contains("config.toml"), "{text}: {failure}");
        }
    }
}
