// SPDX-License-Identifier: GPL-2.0-or-later
// What happened and has not been told yet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace bridge {

/// Event lines in the order in which they came about. In lock step all are kept until the answer
/// that tells them; free running, where nobody may ever ask, only a bounded number.
class Events {
public:
    /// `most_lines` 0: no bound. Beyond it new events are counted instead of kept.
    explicit Events(std::size_t most_lines) : most_lines_(most_lines) {}

    void tell(const char *kind, std::uint64_t cycle, const std::string &rest = {}) {
        if (most_lines_ != 0 && lines_ >= most_lines_) {
            ++lost_;
            return;
        }
        ++lines_;
        text_ += kind;
        text_ += ' ';
        text_ += std::to_string(cycle);
        if (!rest.empty()) {
            text_ += ' ';
            text_ += rest;
        }
        text_ += '\n';
    }

    /// All lines, which count as told from now on.
    std::string take() {
        std::string text;
        text.swap(text_);
        if (lost_ != 0) {
            text += "lost " + std::to_string(lost_) + '\n';
        }
        lines_ = 0;
        lost_ = 0;
        return text;
    }

private:
    std::string text_;
    std::size_t most_lines_;
    std::size_t lines_ = 0;
    std::uint64_t lost_ = 0;
};

}  // namespace bridge
