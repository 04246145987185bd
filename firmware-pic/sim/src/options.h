// SPDX-License-Identifier: GPL-2.0-or-later
// The command line.
#pragma once

#include <cstdint>
#include <string>

namespace bridge {

struct Options {
    std::string hex;                       ///< Intel HEX file; required
    std::string processor = "p18f452";     ///< a PIC18 of gpsim's list
    std::uint64_t clock_hz = 40'000'000;   ///< Fosc after the PLL, 1 to 64 MHz, a multiple of 4 Hz
    std::uint64_t baud = 57'600;           ///< of the line outside the chip, 300 to 1 000 000
    std::string transmit_pin = "rc6";      ///< the chip's TX
    std::string receive_pin = "rc7";       ///< the chip's RX
    std::string symbols;                   ///< gplink's .map or lines `NAME ADDRESS`; empty: none
    std::string pty_link;                  ///< symbolic link to the pseudo-terminal; empty: none
    std::string control_socket;            ///< UNIX socket for commands; empty: none
    double watchdog_ms = 0;                ///< watchdog's time without postscaler; 0: the data sheet's nominal one
    double limit_s = 0;                    ///< stop after this simulated time; 0: never
    bool fast = false;                     ///< free running: not paced to real time
    bool lockstep = false;                 ///< commands on stdin, time moves only by `advance`
    bool verbose = false;                  ///< gpsim's own words go to stderr instead of nowhere
    bool help = false;

    /// Instruction cycles a second (Fosc/4).
    std::uint64_t cycles_per_second() const { return clock_hz / 4; }
};

/// Reads the command line. Throws `Failure` for an unknown option, a missing value or one out of range.
Options read_options(int count, const char *const *arguments);

/// The text of `--help`.
extern const char *const usage;

}  // namespace bridge
