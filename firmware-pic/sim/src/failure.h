// SPDX-License-Identifier: GPL-2.0-or-later
// The one exception of this program: what went wrong, as a line for a person.
#pragma once

#include <stdexcept>
#include <string>

namespace bridge {

/// Thrown for every bad option, file or command; `what()` is one line without a full stop.
class Failure : public std::runtime_error {
public:
    explicit Failure(const std::string &why) : std::runtime_error(why) {}
};

}  // namespace bridge
