// SPDX-License-Identifier: GPL-2.0-or-later
#include "nested_interrupts.h"

#include <gpsim/16bit-processors.h>
#include <gpsim/breakpoints.h>
#include <gpsim/trace.h>

#include "failure.h"

namespace bridge {
namespace {

constexpr unsigned low_priority_vector = 0x18;
constexpr unsigned retfie = 0x0010, retfie_fast = 0x0011;

}  // namespace

class NestedInterrupts::Hook : public TriggerObject {
public:
    explicit Hook(_16bit_processor &chip) : chip_(chip) {}

    void add(unsigned address) {
        if (chip_.pma->set_notify_at_address(address, this) >= MAX_BREAKPOINTS) {
            throw Failure("gpsim has no place for a hook at an interrupt routine");
        }
    }

protected:
    bool uses_priorities() const { return (chip_.rcon.value.get() & RCON::IPEN) != 0; }

    _16bit_processor &chip_;
};

class NestedInterrupts::Entry : public Hook {
public:
    using Hook::Hook;

    void callback() override {
        if (!uses_priorities()) {
            return;
        }
        INTCON_16 &intcon = chip_.intcon;
        intcon.value.put(intcon.value.get() & ~static_cast<unsigned>(INTCON_16::GIEL));
        intcon.in_interrupt = false;
        // A cause of high priority that came in the cycles of the entry.
        if ((chip_.pir1.get_value() & chip_.pie1.get_value() & chip_.ipr1.get_value()) != 0) {
            intcon.peripheral_interrupt(true);
        }
    }
};

/// Runs before the RETFIE does, which clears `in_interrupt` and looks for causes that wait.
class NestedInterrupts::Return : public Hook {
public:
    using Hook::Hook;

    void callback() override {
        INTCON_16 &intcon = chip_.intcon;
        const bool is_of_low_priority = !intcon.in_interrupt;
        if (uses_priorities() && is_of_low_priority) {
            intcon.value.put(intcon.value.get() | INTCON_16::GIEL);
        }
    }
};

NestedInterrupts::NestedInterrupts(pic_processor &processor) {
    auto *chip = dynamic_cast<_16bit_processor *>(&processor);
    if (chip == nullptr) {
        return;
    }
    // With the first hook gpsim opens its log, by default a file gpsim.log in the present folder.
    GetTraceLog().enable_logging("/dev/null");
    entry_ = std::make_unique<Entry>(*chip);
    return_ = std::make_unique<Return>(*chip);
    for (unsigned index = 0; index < chip->program_memory_size(); ++index) {
        if (chip->pma->hasValid_opcode_at_index(index)) {
            const unsigned opcode = chip->pma->get_opcode(index * 2);
            if (opcode == retfie || opcode == retfie_fast) {
                return_->add(index * 2);
            }
        }
    }
    if (chip->pma->hasValid_opcode_at_index(low_priority_vector / 2)) {
        entry_->add(low_priority_vector);
    }
}

NestedInterrupts::~NestedInterrupts() = default;

}  // namespace bridge
