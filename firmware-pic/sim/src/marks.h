// SPDX-License-Identifier: GPL-2.0-or-later
// Marked places of the program: each time the program counter comes there is told.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "chip.h"
#include "events.h"

namespace bridge {

class Mark;

/// Marks cost nothing but where they stand: gpsim puts a notifying instruction around the marked one.
class Marks {
public:
    Marks(Chip &chip, Events &events);
    ~Marks();
    Marks(const Marks &) = delete;
    Marks &operator=(const Marks &) = delete;

    /// Marks a byte address, which may have several names. Throws `Failure` for an address that holds
    /// no instruction or a name already in use.
    void add(std::uint64_t address, const std::string &name);
    void remove(const std::string &name);

private:
    Chip &chip_;
    Events &events_;
    std::map<std::uint64_t, std::unique_ptr<Mark>> marks_;
};

}  // namespace bridge
