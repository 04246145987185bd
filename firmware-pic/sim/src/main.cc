// SPDX-License-Identifier: GPL-2.0-or-later
// rsapien-gpsim: a PIC18 image in gpsim, its serial line and its pins for other programs.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <optional>

#include "chip.h"
#include "clients.h"
#include "commands.h"
#include "events.h"
#include "free_run.h"
#include "leftovers.h"
#include "line.h"
#include "lockstep.h"
#include "options.h"
#include "pins.h"
#include "pseudo_terminal.h"

namespace {

constexpr std::size_t most_events_free_running = 10'000;

/// gpsim writes to stdout as it likes, where it would stand between our answers. Returns stdout's new descriptor.
int move_gpsims_words(bool is_verbose) {
    const int output = dup(STDOUT_FILENO);
    const int words = is_verbose ? dup(STDERR_FILENO) : open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(words, STDOUT_FILENO);
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    close(words);
    return output;
}

[[noreturn]] void run(const bridge::Options &options, int output) {
    using namespace bridge;
    end_cleanly_on_signals();
    Events events(options.lockstep ? 0 : most_events_free_running);
    Chip chip(options, events);
    Pins pins(chip, options, events);
    LineSender sender(options, chip, pins, events, options.lockstep);
    LineReceiver receiver(options, pins, events, options.lockstep);
    Commands commands(options, chip, pins, sender, events);
    std::optional<PseudoTerminal> terminal;
    if (!options.pty_link.empty()) {
        terminal.emplace(options.pty_link);
        receiver.on_byte = [&](std::uint8_t byte) { terminal->write(byte); };
    }
    const int listener = options.control_socket.empty() ? -1 : make_socket(options.control_socket);
    Clients clients(listener, options.lockstep ? output : -1);
    if (options.lockstep) {
        pins.watch_outputs();
        LockStep(chip, commands, clients).run();
    }
    FreeRun(options, chip, commands, clients, sender, terminal ? &*terminal : nullptr).run();
}

}  // namespace

int main(int count, char **arguments) {
    try {
        const bridge::Options options = bridge::read_options(count, arguments);
        if (options.help) {
            std::printf("%s", bridge::usage);
            return 0;
        }
        run(options, move_gpsims_words(options.verbose));
    } catch (const std::exception &failure) {
        std::fprintf(stderr, "rsapien-gpsim: %s\n", failure.what());
        bridge::leave(2);
    }
}
