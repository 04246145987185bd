//! The line on TCP: every connection is an end of it.

use std::io::{ErrorKind, Read};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::address::socket_address;
use super::hub::Hub;
use super::{SimulatorError, put_on_line, wait_readable};
use crate::shared::SharedRobot;

/// Connections at a time; more are closed at once.
const CLIENTS_MAX: usize = 32;
/// How long a read waits before the stop flag is looked at again.
const READ_TURN: Duration = Duration::from_millis(100);
/// How long an answer may wait for a client that does not read, before it is lost to it.
const WRITE_PATIENCE: Duration = Duration::from_millis(2);

/// A listener with the address it was given.
pub(super) struct Listener {
    pub(super) listener: TcpListener,
    pub(super) address: SocketAddr,
}

/// Listens on an address as people write it.
pub(super) fn bind(text: &str, allow_remote: bool) -> Result<Listener, SimulatorError> {
    let address = socket_address(text, allow_remote)?;
    let bound = TcpListener::bind(address).and_then(|listener| {
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        Ok(Listener { listener, address })
    });
    bound.map_err(|source| SimulatorError::Bind { address: address.to_string(), source })
}

impl Listener {
    /// Takes clients and carries their bytes until `stop` is set.
    pub(super) fn serve(
        self,
        robot: SharedRobot,
        hub: Arc<Hub>,
        stop: Arc<AtomicBool>,
    ) -> JoinHandle<()> {
        thread::spawn(move || {
            let mut clients: Vec<JoinHandle<()>> = Vec::new();
            while !stop.load(Ordering::Relaxed) {
                if !matches!(wait_readable(&self.listener), Ok(true)) {
                    continue;
                }
                let Ok((stream, _)) = self.listener.accept() else { continue };
                clients.retain(|client| !client.is_finished());
                if hub.count() < CLIENTS_MAX
                    && let Ok(id) = join(&stream, &hub)
                {
                    let (robot, hub, stop) = (robot.clone(), Arc::clone(&hub), Arc::clone(&stop));
                    clients.push(thread::spawn(move || {
                        read_until(stream, &robot, &stop);
                        hub.remove(id);
                    }));
                }
            }
            for client in clients {
                // A client's thread that panicked has nothing left to clean up.
                let _ = client.join();
            }
        })
    }
}

/// Makes a connection an end of the line.
fn join(stream: &TcpStream, hub: &Hub) -> std::io::Result<u64> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(READ_TURN))?;
    stream.set_write_timeout(Some(WRITE_PATIENCE))?;
    Ok(hub.add(Box::new(stream.try_clone()?)))
}

fn read_until(mut stream: TcpStream, robot: &SharedRobot, stop: &AtomicBool) {
    let mut bytes = [0; 1024];
    while !stop.load(Ordering::Relaxed) {
        match stream.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => put_on_line(robot, bytes.get(..count).unwrap_or_default(), stop),
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => {}
                _ => return,
            },
        }
    }
}
