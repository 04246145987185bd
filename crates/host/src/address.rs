//! How a link is named: `auto`, `virtual`, `tcp://HOST:PORT`, or a serial port.

use std::fmt;
use std::str::FromStr;

use crate::Error;

/// Which link leads to the robot.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub enum LinkAddress {
    /// The one robot found by HELLO on the serial ports.
    #[default]
    Auto,
    /// The virtual robot, inside this program.
    Virtual,
    /// A serial port: a path such as `/dev/ttyUSB0`, or a name such as `COM3`.
    Serial(String),
    /// A TCP server that passes the line's bytes on: `HOST:PORT`.
    Tcp(String),
}

impl FromStr for LinkAddress {
    type Err = Error;

    /// Reads what [`Display`](fmt::Display) writes. `auto` and `virtual` in any case.
    ///
    /// # Errors
    /// [`Error::BadAddress`] for a text that can name no link.
    fn from_str(text: &str) -> Result<LinkAddress, Error> {
        let bad = |problem| Error::BadAddress { text: text.to_owned(), problem };
        if text.eq_ignore_ascii_case("auto") {
            return Ok(LinkAddress::Auto);
        }
        if text.eq_ignore_ascii_case("virtual") {
            return Ok(LinkAddress::Virtual);
        }
        if let Some(target) = text.strip_prefix("tcp://") {
            return parse_tcp(target.trim_end_matches('/'), bad);
        }
        if text.contains("://") {
            return Err(bad("the only scheme is tcp://"));
        }
        if text.is_empty() || text.trim() != text {
            return Err(bad("it is empty, or begins or ends with a space"));
        }
        if text.contains(['/', '\\']) || is_windows_port(text) {
            return Ok(LinkAddress::Serial(text.to_owned()));
        }
        Err(bad("it is neither a known word nor the path of a device"))
    }
}

fn parse_tcp(target: &str, bad: impl Fn(&'static str) -> Error) -> Result<LinkAddress, Error> {
    let (host, port) = target.rsplit_once(':').ok_or_else(|| bad("the port is missing"))?;
    if host.is_empty() {
        return Err(bad("the host is missing"));
    }
    if host.contains(':') && !(host.starts_with('[') && host.ends_with(']')) {
        return Err(bad("an IPv6 host stands in brackets"));
    }
    match port.parse::<u16>() {
        Ok(1..) => Ok(LinkAddress::Tcp(target.to_owned())),
        _ => Err(bad("the port is a number from 1 to 65535")),
    }
}

fn is_windows_port(text: &str) -> bool {
    text.get(..3).is_some_and(|prefix| prefix.eq_ignore_ascii_case("com"))
        && text.len() > 3
        && text.bytes().skip(3).all(|byte| byte.is_ascii_digit())
}

impl fmt::Display for LinkAddress {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinkAddress::Auto => formatter.write_str("auto"),
            LinkAddress::Virtual => formatter.write_str("virtual"),
            LinkAddress::Serial(path) => formatter.write_str(path),
            LinkAddress::Tcp(target) => write!(formatter, "tcp://{target}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read_and_written_alike() {
        for (text, address) in [
            ("auto", LinkAddress::Auto),
            ("virtual", LinkAddress::Virtual),
            ("/dev/ttyUSB0", LinkAddress::Serial("/dev/ttyUSB0".into())),
            ("./robot", LinkAddress::Serial("./robot".into())),
            ("COM3", LinkAddress::Serial("COM3".into())),
            ("tcp://localhost:4000", LinkAddress::Tcp("localhost:4000".into())),
            ("tcp://[::1]:1", LinkAddress::Tcp("[::1]:1".into())),
        ] {
            assert_eq!(text.parse::<LinkAddress>().unwrap(), address);
            assert_eq!(address.to_string(), text);
        }
        assert_eq!("AUTO".parse::<LinkAddress>().unwrap(), LinkAddress::Auto);
    }

    #[test]
    fn what_names_no_link_is_refused_with_the_reason() {
        for (text, reason) in [
            ("", "empty"),
            (" /dev/ttyUSB0", "space"),
            ("ttyUSB0", "path"),
            ("COM", "path"),
            ("comé", "path"),
            ("http://robot:80", "scheme"),
            ("tcp://", "port is missing"),
            ("tcp://robot", "port is missing"),
            ("tcp://:4000", "host is missing"),
            ("tcp://robot:0", "1 to 65535"),
            ("tcp://robot:65536", "1 to 65535"),
            ("tcp://::1:4000", "brackets"),
        ] {
            let message = text.parse::<LinkAddress>().unwrap_err().to_string();
            assert!(message.contains(reason), "{text}: {message}");
        }
    }
}
