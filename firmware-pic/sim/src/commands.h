// SPDX-License-Identifier: GPL-2.0-or-later
// The text commands. README.md is their description.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "chip.h"
#include "events.h"
#include "line.h"
#include "marks.h"
#include "options.h"
#include "pins.h"
#include "symbols.h"

namespace bridge {

/// What a command asks for besides its answer.
struct Outcome {
    std::string answer;                      ///< complete lines; empty for an `advance` that is accepted
    std::optional<std::uint64_t> advance{};  ///< cycles to run before the answer
    bool quit = false;
};

class Commands {
public:
    Commands(const Options &options, Chip &chip, Pins &pins, LineSender &sender, Events &events);

    /// Executes one line. Whatever it holds, this answers and throws nothing.
    Outcome execute(const std::string &line);

    /// Event lines and `ok REST`, or `error WHY` when the simulation stands still for good.
    std::string answer_of_advance();

private:
    using Words = std::vector<std::string>;

    std::string answer(const std::string &rest);
    std::string run(const Words &words);
    std::string watch(const Words &words);
    std::string send(const Words &words, bool is_framed);
    std::string mark(const Words &words);
    std::string memory(const Words &words, bool is_eeprom);
    std::string tell_symbols();

    const Options &options_;
    Chip &chip_;
    Pins &pins_;
    LineSender &sender_;
    Events &events_;
    Symbols symbols_;
    Marks marks_;
};

}  // namespace bridge
