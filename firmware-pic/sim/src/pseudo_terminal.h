// SPDX-License-Identifier: GPL-2.0-or-later
// The line as a pseudo-terminal.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bridge {

class PseudoTerminal {
public:
    /// Opens a raw pseudo-terminal with a symbolic link to it. Throws `Failure`.
    explicit PseudoTerminal(const std::string &link);

    int descriptor() const { return master_; }

    /// What has come, without waiting.
    std::vector<std::uint8_t> read();

    /// A byte for which there is no room, since nobody reads, is lost as on a line without a listener.
    void write(std::uint8_t byte);

private:
    int master_ = -1;
    int slave_ = -1;  // held open so that the terminal outlives its clients
};

}  // namespace bridge
