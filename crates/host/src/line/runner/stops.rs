//! STOP, which goes before everything else.

use rsapien_protocol::{Address, Kind};

use super::{Asked, Runner};

impl Runner {
    /// Hands STOPs to the session; whether one was.
    pub(super) fn put_stops(&mut self) -> bool {
        let mut progressed = false;
        while let Some(index) = self.next_stop() {
            let Some((address, reply)) = self.stops.remove(index) else { break };
            let Ok(ticket) = self.session.stop(address) else {
                self.stops.insert(index, (address, reply));
                break;
            };
            self.asked.push(Asked { ticket, address, kind: Kind::Stop, dead_man_ms: None, reply });
            progressed = true;
        }
        progressed
    }

    /// The STOP that is handed to the session next. A STOP displaces what is on the line when that is not answered at
    /// once, so the camera's waits until the motors' is settled: it is sent again as often as needed.
    fn next_stop(&self) -> Option<usize> {
        let stops_motors =
            |asked: &Asked| asked.kind == Kind::Stop && asked.address == Address::Motion;
        let is_for_now = !self.asked.iter().any(stops_motors);
        self.stops.iter().position(|(address, _)| *address == Address::Motion || is_for_now)
    }
}
