//! Recorded requests, each with its answer.

use std::collections::VecDeque;

use rsapien_protocol::{ActionPackage, Address, Direction, SynchronizationPackage};

use super::{LineDecoder, LineEntry, RecordingError, RecordingReader, Topic, What};

/// A package that the PC sent, and what came back before the next one was sent.
#[derive(Clone, Debug)]
pub(super) struct Exchange {
    /// Its number among the packages of the PC, from 1 on.
    pub(super) number: u64,
    /// When it was sent, in ms of the recorded clock.
    pub(super) time_ms: u64,
    pub(super) address: Address,
    pub(super) package: ActionPackage,
    /// What it says, in words.
    pub(super) words: String,
    /// When its answer was complete, and the answer.
    pub(super) answer: Option<(u64, SynchronizationPackage)>,
}

/// Gives the exchanges of a recording in their order.
pub(super) struct Exchanges {
    reader: RecordingReader,
    decoder: LineDecoder,
    entries: VecDeque<LineEntry>,
    /// Sent, and perhaps answered; the next one sent ends it.
    under_way: Option<Exchange>,
    count: u64,
    /// Looked at already, and given again.
    given_back: VecDeque<Exchange>,
}

impl Exchanges {
    pub(super) fn new(reader: RecordingReader) -> Exchanges {
        let (decoder, entries) = (LineDecoder::new(), VecDeque::new());
        let given_back = VecDeque::new();
        Exchanges { reader, decoder, entries, under_way: None, count: 0, given_back }
    }

    /// Gives exchanges again, the next ones first.
    pub(super) fn give_back(&mut self, exchanges: Vec<Exchange>) {
        for exchange in exchanges.into_iter().rev() {
            self.given_back.push_front(exchange);
        }
    }

    /// Takes an entry; the exchange that ended by it.
    fn take(&mut self, entry: &LineEntry) -> Option<Exchange> {
        let What::Package(content) = &entry.what else { return None };
        match entry.direction {
            Direction::ToRobot => {
                let package = ActionPackage::parse(content.action()).ok()?;
                self.count += 1;
                let next = Exchange {
                    number: self.count,
                    time_ms: entry.time_ms,
                    address: content.address(),
                    package,
                    words: entry.words(),
                    answer: None,
                };
                self.under_way.replace(next)
            }
            Direction::ToPc => {
                let answer = SynchronizationPackage::parse(content).ok()?;
                if let Some(exchange) = &mut self.under_way
                    && exchange.address == content.address()
                    && is_answer(&answer, &exchange.package)
                {
                    exchange.answer.get_or_insert((entry.time_ms, answer));
                }
                None
            }
        }
    }
}

/// Whether `answer` names `request`.
pub(super) fn is_answer(answer: &SynchronizationPackage, request: &ActionPackage) -> bool {
    (answer.session, answer.sequence, answer.kind_byte)
        == (request.session, request.sequence, request.request.kind().byte())
}

impl Iterator for Exchanges {
    type Item = Result<Exchange, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(exchange) = self.given_back.pop_front() {
            return Some(Ok(exchange));
        }
        loop {
            while let Some(entry) = self.entries.pop_front() {
                if let Some(exchange) = self.take(&entry) {
                    return Some(Ok(exchange));
                }
            }
            let message = match self.reader.next() {
                Some(Ok(entry)) if entry.topic == Topic::Bytes => entry.bytes(),
                Some(Ok(_)) => continue,
                Some(Err(error)) => Err(error),
                None => return self.under_way.take().map(Ok),
            };
            match message {
                Ok(message) => self.entries.extend(self.decoder.feed(&message)),
                Err(error) => return Some(Err(error)),
            }
        }
    }
}
