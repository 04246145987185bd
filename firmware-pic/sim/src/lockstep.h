// SPDX-License-Identifier: GPL-2.0-or-later
// Time that moves by `advance` alone.
#pragma once

#include <gpsim/trigger.h>

#include "chip.h"
#include "clients.h"
#include "commands.h"

namespace bridge {

/// gpsim runs all the time; where it shall stand still, a callback of its cycle counter takes
/// commands until the next `advance`. So a stop costs one callback, and it comes in exactly the
/// cycle asked for, also in the middle of a two-cycle instruction.
class LockStep : public TriggerObject {
public:
    LockStep(Chip &chip, Commands &commands, Clients &clients);

    [[noreturn]] void run();

    void callback() override;

private:
    void serve();

    Chip &chip_;
    Commands &commands_;
    Clients &clients_;
    Client *advancing_ = nullptr;
};

}  // namespace bridge
