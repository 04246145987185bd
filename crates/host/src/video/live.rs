//! Looking at a source live: its own thread reads it, and the newest frame waits for whoever looks at it.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::{Frame, FrameSource, Next, Trouble, VideoError};

/// So many troubles wait to be told; more are only counted.
const TROUBLES_MAX: usize = 32;

/// What becomes of a frame that nobody has taken when the next one comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delivery {
    /// It is dropped, so that what is looked at is never old.
    Newest,
    /// The source waits: every frame is looked at, for films and folders.
    Every,
}

/// What came from a source.
#[derive(Debug)]
pub enum Incoming {
    /// A picture.
    Frame(Box<Frame>),
    /// Something went wrong, and the source goes on.
    Trouble(Trouble),
    /// Nothing for as long as was to be waited.
    Nothing,
    /// There will be no more.
    End,
}

/// Counts of what a source gave.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames that came.
    pub frames: u64,
    /// Of these, those dropped because a newer one came before they were looked at.
    pub dropped: u64,
    /// Pictures left out as broken.
    pub bad_pictures: u64,
    /// Bytes skipped that belong to no picture.
    pub skipped_bytes: u64,
    /// How often a connection was lost or could not be made again.
    pub losses: u64,
}

#[derive(Default)]
struct State {
    frame: Option<Box<Frame>>,
    troubles: VecDeque<Trouble>,
    /// Whether the source has ended, and with what.
    is_over: bool,
    error: Option<VideoError>,
    /// Whether nobody looks any more.
    is_closed: bool,
    counts: Counts,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A source that is read on a thread of its own.
pub struct Live {
    shared: Arc<Shared>,
}

impl Live {
    /// Starts to read `source`.
    pub fn start(source: Box<dyn FrameSource>, delivery: Delivery) -> Self {
        let shared = Arc::new(Shared::default());
        let for_thread = Ending(Arc::clone(&shared));
        // Not joined: it may be waiting for a source that never speaks again. One that cannot be made drops its side,
        // which tells the other.
        let _ = thread::Builder::new()
            .name("source".to_owned())
            .spawn(move || for_thread.read(source, delivery));
        Self { shared }
    }

    /// What came, at the latest after `longest`. Troubles come before the frame that came with them.
    ///
    /// # Errors
    /// The [`VideoError`] that ended the source, once every frame before it was taken.
    pub fn next(&self, longest: Duration) -> Result<Incoming, VideoError> {
        let end = Instant::now() + longest;
        let mut state = self.shared.lock();
        loop {
            if let Some(trouble) = state.troubles.pop_front() {
                return Ok(Incoming::Trouble(trouble));
            }
            if let Some(frame) = state.frame.take() {
                self.shared.changed.notify_all();
                return Ok(Incoming::Frame(frame));
            }
            if state.is_over {
                return state.error.take().map_or(Ok(Incoming::End), Err);
            }
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(Incoming::Nothing);
            }
            let waited = self.shared.changed.wait_timeout(state, left);
            (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// What the source has given until now.
    pub fn counts(&self) -> Counts {
        self.shared.lock().counts
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.shared.lock().is_closed = true;
        self.shared.changed.notify_all();
    }
}

/// The reading thread's side: however the thread ends, the other side learns of it.
struct Ending(Arc<Shared>);

impl Ending {
    fn read(self, mut source: Box<dyn FrameSource>, delivery: Delivery) {
        loop {
            let next = source.next_frame();
            let mut state = self.0.lock();
            if state.is_closed {
                return;
            }
            match next {
                Ok(Next::Frame(frame)) => {
                    state.counts.frames += 1;
                    while delivery == Delivery::Every && state.frame.is_some() && !state.is_closed {
                        let waited = self.0.changed.wait(state);
                        state = waited.unwrap_or_else(PoisonError::into_inner);
                    }
                    state.counts.dropped += u64::from(state.frame.is_some());
                    state.frame = Some(frame);
                }
                Ok(Next::Trouble(trouble)) => {
                    match &trouble {
                        Trouble::Skipped { bytes } => state.counts.skipped_bytes += bytes,
                        Trouble::BadPicture { .. } => state.counts.bad_pictures += 1,
                        Trouble::Lost { .. } => state.counts.losses += 1,
                        Trouble::Back => {}
                    }
                    if state.troubles.len() < TROUBLES_MAX {
                        state.troubles.push_back(trouble);
                    }
                }
                Ok(Next::End) => {
                    state.error = (state.counts.frames == 0).then_some(VideoError::Empty);
                    state.is_over = true;
                    return;
                }
                Err(error) => {
                    state.error = Some(error);
                    state.is_over = true;
                    return;
                }
            }
            self.0.changed.notify_all();
        }
    }
}

impl Drop for Ending {
    fn drop(&mut self) {
        let mut state = self.0.lock();
        if !state.is_over {
            state.error = Some(VideoError::Died);
            state.is_over = true;
        }
        drop(state);
        self.0.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SourceOptions, Taken, Ticker};
    use super::*;
    use rsapien_vision::{GrayImage, Picture};

    const LONG: Duration = Duration::from_secs(10);

    /// Gives so many frames as quickly as they are asked for, with a trouble in the middle, and then an end.
    struct Quick {
        left: u64,
        ticker: Ticker,
        told: bool,
    }

    impl FrameSource for Quick {
        fn next_frame(&mut self) -> Result<Next, VideoError> {
            if self.left == 5 && !std::mem::replace(&mut self.told, true) {
                return Ok(Next::Trouble(Trouble::Skipped { bytes: 3 }));
            }
            if self.left == 0 {
                return Ok(Next::End);
            }
            self.left -= 1;
            let gray = GrayImage::new(vec![0], 1, 1)?;
            Ok(Next::Frame(Box::new(self.ticker.frame(gray, None))))
        }
    }

    fn quick(frames: u64, delivery: Delivery) -> Live {
        let source = Quick { left: frames, ticker: Ticker::default(), told: false };
        Live::start(Box::new(source), delivery)
    }

    #[test]
    fn the_newest_frame_is_given_and_the_others_are_dropped_and_counted() {
        let live = quick(10, Delivery::Newest);
        while !live.shared.lock().is_over {
            thread::yield_now();
        }
        let Incoming::Trouble(trouble) = live.next(LONG).unwrap() else { panic!("a trouble") };
        assert_eq!(trouble, Trouble::Skipped { bytes: 3 });
        let Incoming::Frame(frame) = live.next(LONG).unwrap() else { panic!("a frame") };
        assert_eq!(frame.number, 9);
        assert!(matches!(live.next(LONG).unwrap(), Incoming::End));
        let expected = Counts { frames: 10, dropped: 9, skipped_bytes: 3, ..Counts::default() };
        assert_eq!(live.counts(), expected);
    }

    #[test]
    fn where_every_frame_counts_the_source_waits() {
        let live = quick(10, Delivery::Every);
        let mut numbers = Vec::new();
        loop {
            match live.next(LONG).unwrap() {
                Incoming::Frame(frame) => numbers.push(frame.number),
                Incoming::Trouble(_) => {}
                Incoming::Nothing | Incoming::End => break,
            }
        }
        assert_eq!(numbers, (0..10).collect::<Vec<u64>>());
        assert_eq!(live.counts().dropped, 0);
    }

    #[test]
    fn silence_ends_a_wait_and_a_reader_that_dies_or_finds_nothing_is_told() {
        let slow = Taken::new(
            || {
                thread::sleep(LONG);
                Ok(Picture::new(vec![0; 3], 1, 1)?)
            },
            25.0,
            SourceOptions::default(),
        );
        let live = Live::start(Box::new(slow), Delivery::Newest);
        let nothing = live.next(Duration::from_millis(20)).unwrap();
        assert!(matches!(nothing, Incoming::Nothing), "{nothing:?}");
        let dies = Taken::new(|| panic!("as a decoder might"), 25.0, SourceOptions::default());
        let live = Live::start(Box::new(dies), Delivery::Newest);
        assert!(matches!(live.next(LONG), Err(VideoError::Died)));
        assert!(matches!(quick(0, Delivery::Newest).next(LONG), Err(VideoError::Empty)));
    }
}
