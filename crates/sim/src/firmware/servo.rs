//! What a servo makes of the pulses that it gets.

/// Without a pulse for this long a servo is limp, in ms: three times the 20 ms between pulses.
const LIMP_MS: u64 = 60;

/// One servo: a pulse of 1500 us means straight ahead, and 10 us more a degree to the right or up.
#[derive(Debug, Clone)]
pub(super) struct Servo {
    clock_mhz: u8,
    /// The cycle in which the pulse began that is not over.
    rose: Option<u64>,
    /// The last pulse: the cycle in which it ended, and the angle that it asks for.
    asked: Option<(u64, i16)>,
}

impl Servo {
    /// A servo of a chip with a clock of `clock_mhz`, whose cycles are four periods of the clock.
    pub(super) fn new(clock_mhz: u8) -> Self {
        Self { clock_mhz, rose: None, asked: None }
    }

    /// An edge on its wire.
    pub(super) fn edge(&mut self, cycle: u64, level: bool) {
        if level {
            self.rose = Some(cycle);
        } else if let Some(rose) = self.rose.take() {
            let width = i64::try_from(cycle.saturating_sub(rose)).unwrap_or(i64::MAX / 100);
            let clock = i64::from(self.clock_mhz);
            // A cycle is 4 / clock us, and 0.1 us are 0.01 degree.
            let centideg = (width * 40 + clock / 2) / clock - 15_000;
            let centideg = centideg.clamp(i64::from(i16::MIN), i64::from(i16::MAX));
            self.asked = i16::try_from(centideg).ok().map(|centideg| (cycle, centideg));
        }
    }

    /// Time has passed up to `cycle`.
    pub(super) fn pass(&mut self, cycle: u64) {
        let limp_cycles = LIMP_MS * u64::from(self.clock_mhz) * 250;
        self.asked = self.asked.filter(|(ended, _)| cycle.saturating_sub(*ended) <= limp_cycles);
    }

    /// No pulses any more.
    pub(super) fn release(&mut self) {
        (self.rose, self.asked) = (None, None);
    }

    /// The angle that the pulses ask for, in 0.01 degree; none when it is limp.
    pub(super) fn centideg(&self) -> Option<i16> {
        self.asked.map(|(_, centideg)| centideg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_width_of_a_pulse_is_an_angle_at_every_clock() {
        for clock_mhz in [4, 10, 20, 40] {
            let cycles_per_us = f64::from(clock_mhz) / 4.0;
            for (width_us, centideg) in
                [(1500.0, 0), (2400.0, 9000), (1050.0, -4500), (1600.0, 1000)]
            {
                let mut servo = Servo::new(clock_mhz);
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                let width = (width_us * cycles_per_us) as u64;
                servo.edge(70_000, true);
                assert_eq!(servo.centideg(), None, "a pulse tells when it ends");
                servo.edge(70_000 + width, false);
                assert_eq!(servo.centideg(), Some(centideg), "{width_us} us at {clock_mhz} MHz");
            }
        }
        let mut servo = Servo::new(40);
        servo.edge(0, true);
        servo.edge(15_001, false);
        assert_eq!(servo.centideg(), Some(1), "0.1 us is 0.01 degree");
    }

    #[test]
    fn a_servo_without_pulses_is_limp() {
        let mut servo = Servo::new(10);
        servo.edge(0, true);
        servo.edge(3750, false);
        servo.pass(3750 + 60 * 2500);
        assert_eq!(servo.centideg(), Some(0));
        servo.pass(3751 + 60 * 2500);
        assert_eq!(servo.centideg(), None);
    }
}
