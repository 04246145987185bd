// SPDX-License-Identifier: GPL-2.0-or-later
#include "hex_image.h"

#include <cctype>
#include <cstdio>
#include <fstream>
#include <vector>

#include "failure.h"

namespace bridge {
namespace {

constexpr std::uint32_t identification_begin = 0x200000, identification_end = 0x200008;
constexpr std::uint32_t configuration_begin = 0x300000, configuration_end = 0x30000E;

enum RecordType : std::uint8_t { data = 0, end_of_file = 1, upper_segment = 2, upper_linear = 4, start_linear = 5 };

std::string hex_text(std::uint32_t value) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%X", static_cast<unsigned>(value));
    return text;
}

int digit(char c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    const char lower = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

std::string write_record(std::uint32_t address, std::uint8_t type, const std::vector<std::uint8_t> &content) {
    std::vector<std::uint8_t> record = {static_cast<std::uint8_t>(content.size()),
                                        static_cast<std::uint8_t>(address >> 8), static_cast<std::uint8_t>(address),
                                        type};
    record.insert(record.end(), content.begin(), content.end());
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : record) {
        sum = static_cast<std::uint8_t>(sum + byte);
    }
    record.push_back(static_cast<std::uint8_t>(-sum));
    std::string line = ":";
    for (const std::uint8_t byte : record) {
        char text[4];
        std::snprintf(text, sizeof text, "%02X", byte);
        line += text;
    }
    return line + "\n";
}

}  // namespace

HexImage::HexImage(const std::string &path) : path_(path) {
    std::ifstream file(path);
    if (!file) {
        throw Failure("cannot read the image '" + path + "'");
    }
    std::string line;
    for (int number = 1; !ended_ && std::getline(file, line); ++number) {
        while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) {
            line.pop_back();
        }
        if (!line.empty()) {
            read_record(line, "'" + path + "' line " + std::to_string(number));
        }
    }
    if (!ended_) {
        throw Failure("the image '" + path + "' ends without its end record");
    }
}

void HexImage::read_record(const std::string &line, const std::string &where) {
    std::vector<std::uint8_t> record;
    std::uint8_t sum = 0;
    for (std::size_t i = 1; i + 1 < line.size(); i += 2) {
        const int high = digit(line[i]), low = digit(line[i + 1]);
        if (high < 0 || low < 0) {
            throw Failure(where + " is no Intel HEX record");
        }
        record.push_back(static_cast<std::uint8_t>(high * 16 + low));
        sum = static_cast<std::uint8_t>(sum + record.back());
    }
    if (line[0] != ':' || line.size() % 2 == 0 || record.size() < 5 || record.size() != record[0] + 5U) {
        throw Failure(where + " is no Intel HEX record");
    }
    if (sum != 0) {
        throw Failure(where + " has a wrong checksum");
    }
    const std::uint32_t offset = record[1] * 256U + record[2];
    const std::uint32_t word = record[0] >= 2 ? record[4] * 256U + record[5] : 0;
    switch (record[3]) {
    case data:
        for (std::size_t i = 0; i < record[0]; ++i) {
            bytes_[upper_ + offset + static_cast<std::uint32_t>(i)] = record[4 + i];
        }
        break;
    case end_of_file:
        ended_ = true;
        break;
    case upper_segment:
        upper_ = word << 4;
        break;
    case upper_linear:
        upper_ = word << 16;
        break;
    case start_linear:
        break;
    default:
        throw Failure(where + " has the unknown record type " + std::to_string(record[3]));
    }
}

void HexImage::check_fits(std::size_t program_bytes, std::size_t eeprom_bytes) const {
    for (const auto &[address, byte] : bytes_) {
        const bool fits = address < program_bytes ||
                          (address >= identification_begin && address < identification_end) ||
                          (address >= configuration_begin && address < configuration_end) ||
                          (address >= eeprom_begin && address - eeprom_begin < eeprom_bytes);
        if (!fits) {
            throw Failure("the image '" + path_ + "' does not fit the chip: it has a byte at " + hex_text(address) +
                          ", the chip has program memory to " +
                          hex_text(static_cast<std::uint32_t>(program_bytes - 1)) + " and " +
                          std::to_string(eeprom_bytes) + " bytes of EEPROM");
        }
    }
    if (bytes_.empty() || bytes_.begin()->first >= program_bytes) {
        throw Failure("the image '" + path_ + "' holds no program");
    }
}

std::string HexImage::as_even_records() const {
    std::string text;
    std::uint32_t upper = 0;
    for (auto it = bytes_.begin(); it != bytes_.end();) {
        const std::uint32_t begin = it->first & ~1U;
        // What the file leaves out is blank: program memory reads 0xFF, an unimplemented configuration byte 0.
        const std::uint8_t blank = begin >= configuration_begin && begin < configuration_end ? 0x00 : 0xFF;
        std::vector<std::uint8_t> content;
        // A record ends at a gap, at 16 bytes and at the border of 64 KiB, which 16-aligned begins never cross.
        while (it != bytes_.end() && (it->first & ~15U) == (begin & ~15U) && it->first <= begin + content.size() + 1) {
            while (begin + content.size() < it->first) {
                content.push_back(blank);
            }
            content.push_back(it->second);
            ++it;
        }
        if (content.size() % 2 != 0) {
            content.push_back(blank);
        }
        if (begin >> 16 != upper) {
            upper = begin >> 16;
            text += write_record(0, upper_linear,
                                 {static_cast<std::uint8_t>(upper >> 8), static_cast<std::uint8_t>(upper)});
        }
        text += write_record(begin & 0xFFFF, data, content);
    }
    return text + write_record(0, end_of_file, {});
}

}  // namespace bridge
