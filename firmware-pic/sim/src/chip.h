// SPDX-License-Identifier: GPL-2.0-or-later
// One PIC18 in gpsim: image, memories, resets. gpsim keeps its clock and breakpoints in globals,
// so a process holds one chip.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <gpsim/gpsim_classes.h>

#include "events.h"
#include "options.h"

class ClockPhase;
class pic_processor;

namespace bridge {

class EepromTime;
class NestedInterrupts;
class ResetProbe;
class SerialPort;

class Chip {
public:
    /// Makes the processor and loads the image. Throws `Failure` for an unknown processor and an
    /// image that cannot be read or does not fit.
    Chip(const Options &options, Events &events);
    ~Chip();
    Chip(const Chip &) = delete;
    Chip &operator=(const Chip &) = delete;

    pic_processor &processor() { return *processor_; }
    SerialPort &serial_port() { return *serial_port_; }

    /// Instruction cycles (Fosc/4) since power-on. The same in all commands and events.
    static std::uint64_t cycle();

    /// Runs until gpsim stops by itself, which a program does that executes an invalid instruction
    /// or touches memory that is not there. Otherwise it does not return.
    void run();

    /// Why the simulation stands still for good; empty while it can go on.
    const std::string &stopped_because() const { return stopped_because_; }

    /// Data memory as the CPU sees it, without the side effects of a read.
    unsigned read_register(std::uint64_t address);
    void write_register(std::uint64_t address, std::uint64_t value);
    unsigned read_eeprom(std::uint64_t address);
    void write_eeprom(std::uint64_t address, std::uint64_t value);

    /// "power-on", "mclr" or "brown-out". The cycle count goes on. Throws `Failure` for other words.
    void reset(const std::string &cause);

    /// Around a change of the MCLR pin, which `drive` makes: low holds the chip in reset.
    void change_mclr(bool level, const std::function<void()> &drive);

    /// Byte address of the instruction that comes next.
    unsigned program_counter();

private:
    /// What the chip does in the next cycle. A reset may come inside a two-cycle instruction, whose second half
    /// would set the program counter; and there gpsim's own choice is lost.
    void continue_with(ClockPhase *present, ClockPhase *next);

    pic_processor *processor_ = nullptr;  // owned by gpsim
    std::unique_ptr<SerialPort> serial_port_;
    std::unique_ptr<ResetProbe> probe_;
    std::unique_ptr<EepromTime> eeprom_time_;
    std::unique_ptr<NestedInterrupts> nested_interrupts_;
    Events &events_;
    std::string stopped_because_;
};

}  // namespace bridge
