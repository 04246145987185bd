// SPDX-License-Identifier: GPL-2.0-or-later
// Time that runs by itself: paced to real time, or as fast as it goes.
#pragma once

#include <chrono>
#include <cstdint>

#include <gpsim/trigger.h>

#include "chip.h"
#include "clients.h"
#include "commands.h"
#include "line.h"
#include "options.h"
#include "pseudo_terminal.h"

namespace bridge {

/// Looks after the terminal, the clients and the pace every simulated millisecond.
class FreeRun : public TriggerObject {
public:
    /// `terminal` may be nullptr.
    FreeRun(const Options &options, Chip &chip, Commands &commands, Clients &clients, LineSender &sender,
            PseudoTerminal *terminal);

    [[noreturn]] void run();

    void callback() override;

private:
    using Clock = std::chrono::steady_clock;

    void look_after(int timeout_ms);
    [[noreturn]] void end(int status);

    const Options &options_;
    Chip &chip_;
    Commands &commands_;
    Clients &clients_;
    LineSender &sender_;
    PseudoTerminal *terminal_;
    std::uint64_t period_;  // cycles
    Clock::time_point begin_;
    Clock::time_point due_;  // when the present cycle would come on a board
};

}  // namespace bridge
