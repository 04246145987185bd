// SPDX-License-Identifier: GPL-2.0-or-later
#include "free_run.h"

#include <cstdio>

#include <gpsim/gpsim_time.h>

#include "leftovers.h"

namespace bridge {
namespace {

constexpr std::chrono::milliseconds period_ms{1};
/// Further behind than this (the machine was suspended, say) the pace begins anew instead of hurrying.
constexpr std::chrono::milliseconds most_behind{200};

}  // namespace

FreeRun::FreeRun(const Options &options, Chip &chip, Commands &commands, Clients &clients, LineSender &sender,
                 PseudoTerminal *terminal)
    : options_(options),
      chip_(chip),
      commands_(commands),
      clients_(clients),
      sender_(sender),
      terminal_(terminal),
      period_(options.cycles_per_second() * static_cast<std::uint64_t>(period_ms.count()) / 1000) {}

void FreeRun::run() {
    begin_ = due_ = Clock::now();
    get_cycles().set_break(Chip::cycle() + period_, this);
    chip_.run();
    std::fprintf(stderr, "rsapien-gpsim: %s\n", chip_.stopped_because().c_str());
    end(1);
}

void FreeRun::callback() {
    due_ += period_ms;
    if (options_.fast) {
        look_after(0);
    } else {
        // poll counts whole milliseconds; what remains below one is paid off at a later period.
        Clock::time_point now = Clock::now();
        do {
            const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(due_ - now);
            look_after(left.count() > 0 ? static_cast<int>(left.count()) : 0);
            now = Clock::now();
        } while (due_ - now >= std::chrono::milliseconds(1));
        if (now - due_ > most_behind) {
            due_ = now;
        }
    }
    const double seconds = static_cast<double>(Chip::cycle()) / static_cast<double>(options_.cycles_per_second());
    if (options_.limit_s > 0 && seconds >= options_.limit_s) {
        end(0);
    }
    get_cycles().set_break(Chip::cycle() + period_, this);
}

void FreeRun::look_after(int timeout_ms) {
    clients_.wait(timeout_ms, terminal_ != nullptr ? terminal_->descriptor() : -1);
    // What does not fit into the line's queue stays in the terminal, whose writer then has to wait.
    if (terminal_ != nullptr && sender_.waiting() < LineSender::capacity / 2) {
        for (const std::uint8_t byte : terminal_->read()) {
            sender_.send(byte, 0, true);
        }
    }
    std::string line;
    while (Client *client = clients_.take_line(line)) {
        const Outcome outcome = commands_.execute(line);
        Clients::answer(*client, outcome.answer);
        if (outcome.quit) {
            end(0);
        }
    }
    clients_.flush();
}

void FreeRun::end(int status) {
    clients_.flush();
    const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    std::fprintf(stderr, "rsapien-gpsim: %llu cycles in %.3f s, %.1f million a second\n",
                 static_cast<unsigned long long>(Chip::cycle()), seconds,
                 static_cast<double>(Chip::cycle()) / seconds / 1e6);
    leave(status);
}

}  // namespace bridge
