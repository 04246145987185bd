//! Addresses as people write them.

use std::net::{SocketAddr, ToSocketAddrs};

use super::SimulatorError;

/// The address of `HOST:PORT`, `:PORT` or `PORT`; without a host it is 127.0.0.1.
///
/// # Errors
/// [`SimulatorError::Address`] when the text is none of these or the host is unknown, and
/// [`SimulatorError::NotLoopback`] when other machines could reach it and `allow_remote` is not set.
pub fn socket_address(text: &str, allow_remote: bool) -> Result<SocketAddr, SimulatorError> {
    let port = text.strip_prefix(':').unwrap_or(text);
    let with_host = match port.parse::<u16>() {
        Ok(port) => format!("127.0.0.1:{port}"),
        Err(_) => text.to_owned(),
    };
    let found = with_host.to_socket_addrs().ok().and_then(|mut found| found.next());
    let address = found.ok_or_else(|| SimulatorError::Address { address: text.to_owned() })?;
    if allow_remote || address.ip().is_loopback() {
        Ok(address)
    } else {
        Err(SimulatorError::NotLoopback { address: address.to_string() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_host_it_is_this_machine_alone() {
        for text in ["7000", ":7000", "127.0.0.1:7000"] {
            let address = socket_address(text, false).expect(text);
            assert_eq!(address.to_string(), "127.0.0.1:7000", "{text}");
        }
        assert_eq!(socket_address("[::1]:7", false).expect("loopback").to_string(), "[::1]:7");
    }

    #[test]
    fn other_machines_only_when_allowed_and_nonsense_never() {
        for text in ["0.0.0.0:7000", "[::]:7000", "192.0.2.1:7000"] {
            let refused = socket_address(text, false);
            assert!(matches!(refused, Err(SimulatorError::NotLoopback { .. })), "{text}");
            assert!(socket_address(text, true).is_ok(), "{text}");
        }
        for text in ["", ":", "70000", "127.0.0.1", "127.0.0.1:port", "7000:", "a b:1"] {
            let refused = socket_address(text, true);
            assert!(matches!(refused, Err(SimulatorError::Address { .. })), "{text}");
        }
    }
}
