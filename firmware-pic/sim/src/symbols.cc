// SPDX-License-Identifier: GPL-2.0-or-later
#include "symbols.h"

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

#include "failure.h"

namespace bridge {
namespace {

bool parse(const std::string &text, int base, std::uint64_t &value) {
    if (text.empty() || !std::isxdigit(static_cast<unsigned char>(text[0]))) {
        return false;
    }
    char *end = nullptr;
    errno = 0;
    value = std::strtoull(text.c_str(), &end, base);
    return errno == 0 && *end == '\0';
}

}  // namespace

const std::uint32_t *Symbols::find_data(const std::string &name) const {
    const auto &names = is_told_apart ? data : program;
    const auto found = names.find(name);
    return found == names.end() ? nullptr : &found->second;
}

std::uint64_t parse_number(const std::string &text) {
    std::uint64_t value = 0;
    const bool is_hexadecimal = text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    if (!parse(text, is_hexadecimal ? 16 : 10, value)) {
        throw Failure("'" + text + "' is no number (decimal, or 0x and hexadecimal digits)");
    }
    return value;
}

void Symbols::read(const std::string &path) {
    std::ifstream file(path);
    if (!file) {
        throw Failure("cannot read the symbols '" + path + "'");
    }
    bool is_map = false;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        is_map = is_map || line.find("gplink") != std::string::npos;
        line.erase(std::min(line.find('#'), line.size()));
        std::istringstream words(line);
        std::vector<std::string> fields;
        for (std::string word; words >> word;) {
            fields.push_back(word);
        }
        std::uint64_t address = 0;
        if (is_map) {
            // "  _main  0x00002a  program  extern  main.c"; section and other lines have another third field.
            const bool is_symbol = fields.size() >= 4 && (fields[3] == "extern" || fields[3] == "static") &&
                                   parse(fields[1], 16, address) && address <= UINT32_MAX;
            if (is_symbol) {
                (fields[2] == "data" ? data : program)[fields[0]] = static_cast<std::uint32_t>(address);
            }
        } else if (fields.size() == 2 && parse(fields[1], 16, address) && address <= UINT32_MAX) {
            program[fields[0]] = static_cast<std::uint32_t>(address);
            is_told_apart = false;
        } else if (!fields.empty()) {
            throw Failure("'" + path + "' line " + std::to_string(number) + " is not `NAME ADDRESS`");
        }
    }
}

}  // namespace bridge
