// SPDX-License-Identifier: GPL-2.0-or-later
#include "lockstep.h"

#include <gpsim/gpsim_time.h>

#include "leftovers.h"

namespace bridge {

LockStep::LockStep(Chip &chip, Commands &commands, Clients &clients)
    : chip_(chip), commands_(commands), clients_(clients) {}

void LockStep::run() {
    for (;;) {
        serve();
        chip_.run();
        // gpsim stopped by itself: the answer says so, and a reset can make it go on.
        get_cycles().clear_break(this);
        Clients::answer(*advancing_, commands_.answer_of_advance());
    }
}

void LockStep::callback() {
    Clients::answer(*advancing_, commands_.answer_of_advance());
    serve();
}

void LockStep::serve() {
    for (;;) {
        std::string line;
        Client *client = clients_.take_line(line);
        if (client == nullptr) {
            clients_.wait(-1);
            if (clients_.is_stdin_finished()) {
                leave(0);
            }
            continue;
        }
        const Outcome outcome = commands_.execute(line);
        if (outcome.advance) {
            advancing_ = client;
            get_cycles().set_break(Chip::cycle() + *outcome.advance, this);
            return;
        }
        Clients::answer(*client, outcome.answer);
        if (outcome.quit) {
            clients_.flush();
            leave(0);
        }
    }
}

}  // namespace bridge
