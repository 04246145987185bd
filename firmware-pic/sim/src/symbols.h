// SPDX-License-Identifier: GPL-2.0-or-later
// Names of addresses.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace bridge {

/// Program symbols (byte addresses) and data symbols of an image.
struct Symbols {
    std::map<std::string, std::uint32_t> program;  ///< and data, where the file does not tell them apart
    std::map<std::string, std::uint32_t> data;
    bool is_told_apart = true;

    /// nullptr where the name is not one of data memory.
    const std::uint32_t *find_data(const std::string &name) const;

    /// Reads gplink's .map, or a file of lines `NAME ADDRESS` (hexadecimal, with or without 0x;
    /// program addresses in bytes; `#` begins a comment), which does not tell the memories apart. Throws `Failure` naming the line.
    void read(const std::string &path);
};

/// A number as commands write it: decimal, or hexadecimal behind 0x. Throws `Failure` for anything else.
std::uint64_t parse_number(const std::string &text);

}  // namespace bridge
