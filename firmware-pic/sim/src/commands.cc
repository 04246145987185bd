// SPDX-License-Identifier: GPL-2.0-or-later
#include "commands.h"

#include <cctype>
#include <cstdio>
#include <sstream>

#include "failure.h"

namespace bridge {
namespace {

/// More at once would overflow the line's clock only after years; this keeps a slip of the pen from hanging a client.
constexpr std::uint64_t most_cycles_at_once = 1'000'000'000'000;

std::string hexadecimal(std::uint64_t value, int digits) {
    char text[24];
    std::snprintf(text, sizeof text, "0x%0*llX", digits, static_cast<unsigned long long>(value));
    return text;
}

void expect(const std::vector<std::string> &words, std::size_t least, std::size_t most) {
    if (words.size() < least || words.size() > most) {
        throw Failure("`" + words[0] + "` takes " + std::to_string(least - 1) +
                      (most == least ? "" : " to " + std::to_string(most - 1)) + " words, not " +
                      std::to_string(words.size() - 1));
    }
}

std::vector<std::uint8_t> parse_bytes(const std::string &text) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
        const std::string pair = text.substr(i, 2);
        if (!std::isxdigit(static_cast<unsigned char>(pair[0])) ||
            !std::isxdigit(static_cast<unsigned char>(pair[1]))) {
            break;
        }
        bytes.push_back(static_cast<std::uint8_t>(std::stoul(pair, nullptr, 16)));
    }
    if (bytes.empty() || bytes.size() * 2 != text.size()) {
        throw Failure("bytes are pairs of hexadecimal digits without spaces");
    }
    return bytes;
}

}  // namespace

Commands::Commands(const Options &options, Chip &chip, Pins &pins, LineSender &sender, Events &events)
    : options_(options), chip_(chip), pins_(pins), sender_(sender), events_(events), marks_(chip, events) {
    if (!options.symbols.empty()) {
        symbols_.read(options.symbols);
    }
}

std::string Commands::answer(const std::string &rest) {
    return events_.take() + (rest.empty() ? "ok\n" : "ok " + rest + "\n");
}

std::string Commands::answer_of_advance() {
    if (!chip_.stopped_because().empty()) {
        return events_.take() + "error " + chip_.stopped_because() + "\n";
    }
    return answer(std::to_string(Chip::cycle()));
}

Outcome Commands::execute(const std::string &line) {
    Words words;
    std::istringstream stream(line);
    for (std::string word; stream >> word;) {
        words.push_back(word);
    }
    try {
        if (words.empty()) {
            throw Failure("an empty line is no command");
        }
        if (words[0] == "quit") {
            return {answer(""), std::nullopt, true};
        }
        if (words[0] == "advance") {
            expect(words, 2, 2);
            const std::uint64_t cycles = parse_number(words[1]);
            if (!options_.lockstep) {
                throw Failure("time runs by itself; `advance` needs --lockstep");
            }
            if (cycles > most_cycles_at_once) {
                throw Failure("at most " + std::to_string(most_cycles_at_once) + " cycles at once");
            }
            if (cycles == 0 || !chip_.stopped_because().empty()) {
                return {answer_of_advance()};
            }
            return {"", cycles};
        }
        return {run(words)};
    } catch (const std::exception &failure) {
        return {events_.take() + "error " + failure.what() + "\n"};
    }
}

std::string Commands::run(const Words &words) {
    const std::string &command = words[0];
    if (command == "pins") {
        expect(words, 1, 1);
        std::string names;
        for (const std::string &name : pins_.names()) {
            names += (names.empty() ? "" : " ") + name;
        }
        return answer(names);
    }
    if (command == "get") {
        expect(words, 2, 2);
        return answer(pins_.find(words[1]).level ? "1" : "0");
    }
    if (command == "set") {
        expect(words, 3, 3);
        Pin &pin = pins_.find(words[1]);
        if (words[2] != "0" && words[2] != "1") {
            throw Failure("a level is 0 or 1");
        }
        const bool level = words[2] == "1";
        if (pin.name != "mclr") {
            Pins::drive(pin, level);
        } else if (level != pin.level) {
            chip_.change_mclr(level, [&] { Pins::drive(pin, level); });
        }
        return answer("");
    }
    if (command == "watch") {
        return watch(words);
    }
    if (command == "send" || command == "send-framing") {
        return send(words, command == "send");
    }
    if (command == "mark") {
        return mark(words);
    }
    if (command == "unmark") {
        expect(words, 2, 2);
        marks_.remove(words[1]);
        return answer("");
    }
    if (command == "register" || command == "eeprom") {
        return memory(words, command == "eeprom");
    }
    if (command == "reset") {
        expect(words, 2, 2);
        chip_.reset(words[1]);
        return answer("");
    }
    if (command == "symbols") {
        expect(words, 1, 1);
        return tell_symbols();
    }
    if (command == "cycles") {
        expect(words, 1, 1);
        return answer(std::to_string(Chip::cycle()));
    }
    if (command == "program-counter") {
        expect(words, 1, 1);
        return answer(hexadecimal(chip_.program_counter(), 6));
    }
    throw Failure("unknown command '" + command + "'");
}

std::string Commands::watch(const Words &words) {
    if (words.size() < 2) {
        throw Failure("`watch` takes pins, or `outputs`, or `none`");
    }
    if (words.size() == 2 && words[1] == "outputs") {
        pins_.watch_outputs();
    } else if (words.size() == 2 && words[1] == "none") {
        pins_.watch_none();
    } else {
        pins_.watch(Words(words.begin() + 1, words.end()));
    }
    return answer("");
}

std::string Commands::send(const Words &words, bool is_framed) {
    expect(words, 2, 3);
    const std::vector<std::uint8_t> bytes = parse_bytes(words[1]);
    const std::uint64_t at_cycle = words.size() == 3 ? parse_number(words[2]) : 0;
    if (at_cycle > Chip::cycle() + most_cycles_at_once) {
        throw Failure("at most " + std::to_string(most_cycles_at_once) + " cycles ahead");
    }
    if (bytes.size() > LineSender::capacity - sender_.waiting()) {
        throw Failure("the line's queue is full");
    }
    for (const std::uint8_t byte : bytes) {
        sender_.send(byte, at_cycle, is_framed);
    }
    return answer("");
}

std::string Commands::mark(const Words &words) {
    expect(words, 3, 3);
    const auto symbol = symbols_.program.find(words[1]);
    marks_.add(symbol != symbols_.program.end() ? symbol->second : parse_number(words[1]), words[2]);
    return answer("");
}

std::string Commands::memory(const Words &words, bool is_eeprom) {
    expect(words, 2, 3);
    const std::uint32_t *const symbol = is_eeprom ? nullptr : symbols_.find_data(words[1]);
    const std::uint64_t address = symbol != nullptr ? *symbol : parse_number(words[1]);
    if (words.size() == 3) {
        const std::uint64_t value = parse_number(words[2]);
        is_eeprom ? chip_.write_eeprom(address, value) : chip_.write_register(address, value);
    }
    return answer(hexadecimal(is_eeprom ? chip_.read_eeprom(address) : chip_.read_register(address), 2));
}

std::string Commands::tell_symbols() {
    std::string lines = events_.take();
    for (const auto &[name, address] : symbols_.program) {
        lines += "symbol " + name + " " + hexadecimal(address, 6) + "\n";
    }
    for (const auto &[name, address] : symbols_.data) {
        lines += "data-symbol " + name + " " + hexadecimal(address, 3) + "\n";
    }
    return lines + "ok\n";
}

}  // namespace bridge
