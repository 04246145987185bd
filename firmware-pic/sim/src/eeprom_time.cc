// SPDX-License-Identifier: GPL-2.0-or-later
#include "eeprom_time.h"

#include <gpsim/eeprom.h>
#include <gpsim/gpsim_time.h>
#include <gpsim/pic-processor.h>

namespace bridge {
namespace {

constexpr unsigned eecon1_address = 0xFA6;
constexpr std::uint64_t write_ms = 4;

/// Stands before EECON1 and moves the end of each write that begins.
class SlowControl : public Register {
public:
    SlowControl(pic_processor &processor, Register &control, std::uint64_t write_cycles)
        : Register(&processor, "eecon1-slow"),
          control_(control),
          eeprom_(*processor.eeprom),
          write_cycles_(write_cycles) {
        address = eecon1_address;
    }

    REGISTER_TYPES isa() override { return SFR_REGISTER; }
    unsigned get() override { return control_.get(); }
    unsigned get_value() override { return control_.get_value(); }
    void put_value(unsigned value_now) override { put(value_now); }
    void reset(RESET_TYPE type) override { control_.reset(type); }

    void put(unsigned value_now) override {
        const bool was_writing = eeprom_.get_reg_eecon2()->is_writing();
        control_.put(value_now);
        if (!was_writing && eeprom_.get_reg_eecon2()->is_writing()) {
            const std::uint64_t now = get_cycles().get();
            get_cycles().reassign_break(now + EPROM_WRITE_TIME, now + write_cycles_, &eeprom_);
        }
    }

private:
    Register &control_;
    EEPROM &eeprom_;
    std::uint64_t write_cycles_;
};

}  // namespace

EepromTime::EepromTime(pic_processor &processor, std::uint64_t cycles_per_second) : processor_(processor) {
    if (processor.eeprom != nullptr) {
        replaced_ = processor.registers[eecon1_address];
        control_ = std::make_unique<SlowControl>(processor, *replaced_, cycles_per_second * write_ms / 1000);
        processor.registers[eecon1_address] = control_.get();
    }
}

EepromTime::~EepromTime() {
    if (replaced_ != nullptr) {
        processor_.registers[eecon1_address] = replaced_;
    }
}

}  // namespace bridge
