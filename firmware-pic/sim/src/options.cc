// SPDX-License-Identifier: GPL-2.0-or-later
#include "options.h"

#include <cmath>
#include <cstdlib>

#include "failure.h"

namespace bridge {

const char *const usage =
    "rsapien-gpsim --hex FILE [option...]\n"
    "  --hex FILE          Intel HEX image that the chip runs (required)\n"
    "  --processor NAME    gpsim's name of the chip: p18f452 (default), p18f2321 for the 18F2320\n"
    "  --clock-mhz MHZ     Fosc after the PLL (default 40)\n"
    "  --baud RATE         of the line outside the chip (default 57600)\n"
    "  --tx-pin, --rx-pin  the chip's serial pins (default rc6, rc7)\n"
    "  --watchdog-ms MS    the watchdog's time without postscaler (default 18 for an 18Fxx2, 4 for others)\n"
    "  --symbols FILE      gplink's .map, or lines `NAME ADDRESS`\n"
    "  --pty LINK          free running: the line as a pseudo-terminal with this symbolic link\n"
    "  --control SOCKET    commands on a UNIX socket\n"
    "  --fast              free running: as fast as it goes instead of paced to real time\n"
    "  --limit-s SECONDS   free running: end after this simulated time\n"
    "  --lockstep          commands on stdin, answers on stdout, time moves only by `advance`\n"
    "  --verbose           gpsim's own words on stderr\n"
    "The commands are described in firmware-pic/sim/README.md.\n";

namespace {

double read_number(const std::string &option, const std::string &text, double least, double most) {
    char *end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !(number >= least && number <= most)) {
        throw Failure(option + " is '" + text + "', allowed is a number from " + std::to_string(least) + " to " +
                      std::to_string(most));
    }
    return number;
}

void check(const Options &options) {
    if (options.hex.empty()) {
        throw Failure("--hex FILE is missing; --help tells the options");
    }
    if (options.lockstep && (!options.pty_link.empty() || options.fast || options.limit_s > 0)) {
        throw Failure("--lockstep excludes --pty, --fast and --limit-s: its time moves by `advance` alone");
    }
    if (!options.lockstep && options.pty_link.empty() && options.control_socket.empty() && options.limit_s == 0) {
        throw Failure("nothing to run for: give --lockstep, --pty LINK, --control SOCKET or --limit-s SECONDS");
    }
}

}  // namespace

Options read_options(int count, const char *const *arguments) {
    Options options;
    for (int i = 1; i < count; ++i) {
        const std::string option = arguments[i];
        const auto value = [&]() -> std::string {
            if (i + 1 >= count) {
                throw Failure(option + " has no value");
            }
            return arguments[++i];
        };
        if (option == "--hex") {
            options.hex = value();
        } else if (option == "--processor") {
            options.processor = value();
        } else if (option == "--clock-mhz") {
            const double megahertz = read_number(option, value(), 1, 64);
            options.clock_hz = 4 * static_cast<std::uint64_t>(std::llround(megahertz * 250'000));
        } else if (option == "--baud") {
            options.baud = static_cast<std::uint64_t>(std::llround(read_number(option, value(), 300, 1'000'000)));
        } else if (option == "--tx-pin") {
            options.transmit_pin = value();
        } else if (option == "--rx-pin") {
            options.receive_pin = value();
        } else if (option == "--symbols") {
            options.symbols = value();
        } else if (option == "--pty") {
            options.pty_link = value();
        } else if (option == "--control") {
            options.control_socket = value();
        } else if (option == "--limit-s") {
            options.limit_s = read_number(option, value(), 1e-6, 1e9);
        } else if (option == "--watchdog-ms") {
            options.watchdog_ms = read_number(option, value(), 0.1, 1000);
        } else if (option == "--fast") {
            options.fast = true;
        } else if (option == "--lockstep") {
            options.lockstep = true;
        } else if (option == "--verbose") {
            options.verbose = true;
        } else if (option == "--help" || option == "-h") {
            options.help = true;
            return options;
        } else {
            throw Failure("unknown option '" + option + "'; --help tells them");
        }
    }
    check(options);
    return options;
}

}  // namespace bridge
