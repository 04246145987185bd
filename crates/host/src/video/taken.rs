//! Pictures that a function takes, at a steady rate: a camera that is asked for each one.

use std::thread;
use std::time::{Duration, Instant};

use rsapien_vision::Picture;

use super::{FrameSource, Next, SourceOptions, Ticker, VideoError};

/// Asks for pictures at a steady rate; a picture that took longer than its turn is followed by the next at once.
pub struct Taken<F> {
    take: F,
    period: Duration,
    due: Instant,
    color: bool,
    ticker: Ticker,
}

impl<F: FnMut() -> Result<Picture, VideoError> + Send> Taken<F> {
    /// A camera whose pictures `take` takes, `rate_hz` a second (0.01 to 1000; what lies outside is clipped).
    pub fn new(take: F, rate_hz: f64, options: SourceOptions) -> Self {
        let period = Duration::from_secs_f64(1.0 / rate_hz.clamp(0.01, 1000.0));
        let ticker = Ticker::new(options.frame_rate);
        Self { take, period, due: Instant::now(), color: options.color, ticker }
    }
}

impl<F: FnMut() -> Result<Picture, VideoError> + Send> FrameSource for Taken<F> {
    fn next_frame(&mut self) -> Result<Next, VideoError> {
        let now = Instant::now();
        thread::sleep(self.due.saturating_duration_since(now));
        // What one picture is late, the next makes up for, but no more.
        self.due = (self.due + self.period).max(now);
        let picture = (self.take)()?;
        Ok(Next::Frame(Box::new(self.ticker.picture(picture, self.color))))
    }
}
