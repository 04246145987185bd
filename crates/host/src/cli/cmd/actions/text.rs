//! Texts of actions from files, and times for people.

use std::fs;
use std::io::Read;
use std::path::Path;

use crate::cli::diagnostics::{Failure, Result};

/// More than any text that a person writes; a longer one is a mistake and not read to its end.
const TEXT_BYTES_MAX: u64 = 64 << 20;

/// The text of a file; `-` is the standard input.
pub(super) fn read(path: &Path) -> Result<String> {
    let failed = |error| Failure::file("read", path, &error);
    let mut text = String::new();
    let mut from: Box<dyn Read> = if path == Path::new("-") {
        Box::new(std::io::stdin())
    } else {
        Box::new(fs::File::open(path).map_err(failed)?)
    };
    from.by_ref().take(TEXT_BYTES_MAX).read_to_string(&mut text).map_err(failed)?;
    Ok(text)
}

/// `2.4 s` of milliseconds.
pub(super) fn seconds(duration_ms: u64) -> String {
    format!("{}.{} s", (duration_ms + 50) / 1000, (duration_ms + 50) % 1000 / 100)
}

/// `2006-05-25 14:03 UTC` of milliseconds since 1970.
pub(super) fn date(time_ms: i64) -> String {
    let minutes = time_ms.div_euclid(60_000);
    let (days, minute) = (minutes.div_euclid(24 * 60), minutes.rem_euclid(24 * 60));
    // Years begin in March here, so that the day that comes and goes is the last one; eras have 400 years.
    let days = days + 719_468;
    let (era, day) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02} UTC", minute / 60, minute % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (time_ms, text) in [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_399_999, "2000-02-28 23:59 UTC"),
            (951_782_400_000, "2000-02-29 00:00 UTC"),
            (951_868_800_000, "2000-03-01 00:00 UTC"),
            (1_735_689_599_000, "2024-12-31 23:59 UTC"),
            (4_107_542_400_000, "2100-03-01 00:00 UTC"),
            (-1, "1969-12-31 23:59 UTC"),
        ] {
            assert_eq!(date(time_ms), text, "{time_ms}");
        }
    }

    #[test]
    fn seconds_are_rounded_to_tenths() {
        assert_eq!(
            [0, 49, 50, 949, 950, 12_340].map(seconds),
            ["0.0 s", "0.0 s", "0.1 s", "0.9 s", "1.0 s", "12.3 s"]
        );
    }
}
