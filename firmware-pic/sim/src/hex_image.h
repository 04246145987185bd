// SPDX-License-Identifier: GPL-2.0-or-later
// An Intel HEX file, read and checked before gpsim sees it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace bridge {

/// The bytes of a PIC18 image by their address (program from 0, identification from 0x200000,
/// configuration from 0x300000, EEPROM from 0xF00000).
class HexImage {
public:
    static constexpr std::uint32_t eeprom_begin = 0xF00000;

    /// Reads `path`. Throws `Failure` naming the line when the file is missing, is not Intel HEX,
    /// has a wrong checksum or lacks its end record.
    explicit HexImage(const std::string &path);

    /// Throws `Failure` naming the first address that a chip with this much memory has not.
    void check_fits(std::size_t program_bytes, std::size_t eeprom_bytes) const;

    bool holds(std::uint32_t address) const { return bytes_.count(address) != 0; }

    /// The same image written anew, every record beginning at an even address and of even length:
    /// gpsim 0.31 misreads others, for example the one at 0x300001 that gpasm's CONFIG writes.
    std::string as_even_records() const;

private:
    void read_record(const std::string &line, const std::string &where);

    std::string path_;
    std::map<std::uint32_t, std::uint8_t> bytes_;
    std::uint32_t upper_ = 0;
    bool ended_ = false;
};

}  // namespace bridge
