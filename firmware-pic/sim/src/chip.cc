// SPDX-License-Identifier: GPL-2.0-or-later
#include "chip.h"

#include <cstdio>

#include <gpsim/clock_phase.h>
#include <gpsim/eeprom.h>
#include <gpsim/gpsim_time.h>
#include <gpsim/hexutils.h>
#include <gpsim/interface.h>
#include <gpsim/pic-processor.h>
#include <gpsim/sim_context.h>

#include "compare_mode.h"
#include "eeprom_time.h"
#include "failure.h"
#include "hex_image.h"
#include "nested_interrupts.h"
#include "reset_values.h"
#include "serial_port.h"

namespace bridge {
namespace {

constexpr unsigned rcon_address = 0xFD0;
constexpr unsigned t1con_address = 0xFCD, t3con_address = 0xFB1;
constexpr unsigned rcon_priority_enable = 0x80, rcon_no_reset_instruction = 0x10;
constexpr unsigned rcon_after_brown_out = 0x1E;  // RI, TO, PD, POR 1; BOR 0; IPEN 0

const char *name_of(RESET_TYPE type) {
    switch (type) {
    case POR_RESET:
        return "power-on";
    case WDT_RESET:
        return "watchdog";
    case MCLR_RESET:
        return "mclr";
    case SOFT_RESET:
        return "instruction";
    case BOD_RESET:
        return "brown-out";
    case STKUNF_RESET:
        return "stack-underflow";
    case STKOVF_RESET:
        return "stack-overflow";
    default:
        return "other";
    }
}

std::string hexadecimal(unsigned value) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%X", value);
    return text;
}

/// Data sheets, parameter 31: the RC watchdog of the first flash PIC18 (18F452 and its kin), and the one
/// of the internal oscillator in all later ones, which gpsim does not tell apart.
double nominal_watchdog_ms(const std::string &processor) {
    return !processor.empty() && processor.back() == '2' ? 18 : 4;
}

}  // namespace

/// gpsim has no hook that tells a reset, but it resets each register of the data memory: this one
/// takes the place of an unimplemented address, behaves like it otherwise and tells the cause.
class ResetProbe : public InvalidRegister {
public:
    ResetProbe(pic_processor *processor, SerialPort &serial_port, Events &events)
        : InvalidRegister(processor, "reset-probe"), processor_(processor), serial_port_(serial_port), events_(events) {
        for (unsigned i = 0; i < processor->rma.get_size(); ++i) {
            if (processor->registers[i]->isa() == INVALID_REGISTER) {
                address = i;
                replaced_ = processor->registers[i];
                processor->registers[i] = this;
                return;
            }
        }
        throw Failure("the processor has no free data address to see resets with");
    }

    ~ResetProbe() override { processor_->registers[address] = replaced_; }

    void reset(RESET_TYPE type) override {
        // The second half of MCLR, when the pin is released, is no reset of its own.
        if (type == EXIT_RESET) {
            return;
        }
        events_.tell("reset", get_cycles().get(), name_of(type));
        serial_port_.stop();
        Register *rcon = processor_->registers[rcon_address];
        const unsigned cleared = rcon_priority_enable | (type == SOFT_RESET ? rcon_no_reset_instruction : 0);
        rcon->put_value(rcon->get_value() & ~cleared);
    }

private:
    pic_processor *processor_;
    SerialPort &serial_port_;
    Events &events_;
    Register *replaced_ = nullptr;
};

Chip::Chip(const Options &options, Events &events) : events_(events) {
    const HexImage image(options.hex);
    initialize_gpsim_core();
    initialization_is_complete();
    if (ProcessorConstructor::GetList()->findByType(options.processor.c_str()) == nullptr) {
        throw Failure("gpsim knows no processor '" + options.processor + "'");
    }
    Processor *added = CSimulationContext::GetContext()->add_processor(options.processor.c_str(), "chip");
    processor_ = dynamic_cast<pic_processor *>(added);
    if (processor_ == nullptr || processor_->base_isa() != _PIC18_PROCESSOR_) {
        throw Failure("the processor '" + options.processor + "' is no PIC18");
    }
    image.check_fits(processor_->program_memory_size() * 2,
                     processor_->eeprom != nullptr ? processor_->eeprom->get_rom_size() : 0);

    const std::string records = image.as_even_records();
    const std::unique_ptr<FILE, int (*)(FILE *)> file(
        fmemopen(const_cast<char *>(records.data()), records.size(), "r"), std::fclose);
    IntelHexProgramFileType loader;
    if (!file || loader.readihex16(processor_, file.get()) != ProgramFileType::SUCCESS) {
        throw Failure("gpsim cannot load the image '" + options.hex + "'");
    }
    if (processor_->eeprom != nullptr) {
        for (unsigned address = 0; address < processor_->eeprom->get_rom_size(); ++address) {
            if (!image.holds(HexImage::eeprom_begin + address)) {
                processor_->eeprom->change_rom(address, 0xFF);  // erased, which gpsim takes for 0
            }
        }
    }
    processor_->set_frequency(static_cast<double>(options.clock_hz));
    const double watchdog_ms = options.watchdog_ms > 0 ? options.watchdog_ms : nominal_watchdog_ms(options.processor);
    processor_->wdt.set_timeout(watchdog_ms / 1000);
    processor_->setBreakOnReset(false);
    correct_reset_values(*processor_);
    keep_timer2_from_compare_modes(*processor_);
    processor_->reset(POR_RESET);
    serial_port_ = std::make_unique<SerialPort>(*processor_);
    probe_ = std::make_unique<ResetProbe>(processor_, *serial_port_, events_);
    nested_interrupts_ = std::make_unique<NestedInterrupts>(*processor_);
    eeprom_time_ = std::make_unique<EepromTime>(*processor_, options.cycles_per_second());
}

Chip::~Chip() = default;

std::uint64_t Chip::cycle() { return get_cycles().get(); }

void Chip::run() {
    processor_->run(false);
    stopped_because_ = "gpsim stopped at cycle " + std::to_string(cycle()) + ", program address " +
                       hexadecimal(program_counter()) +
                       ": an invalid instruction or memory that the chip has not";
    events_.tell("halt", cycle(), hexadecimal(program_counter()));
}

unsigned Chip::read_register(std::uint64_t address) {
    if (address >= processor_->rma.get_size() || processor_->registers[address]->isa() == Register::INVALID_REGISTER) {
        throw Failure("the chip has no register at this address");
    }
    return processor_->rma.get_register(static_cast<unsigned>(address))->get_value();
}

void Chip::write_register(std::uint64_t address, std::uint64_t value) {
    read_register(address);
    if (value > 0xFF) {
        throw Failure("a register holds 0 to 255");
    }
    processor_->rma.get_register(static_cast<unsigned>(address))->put_value(static_cast<unsigned>(value));
}

unsigned Chip::read_eeprom(std::uint64_t address) {
    if (processor_->eeprom == nullptr || address >= processor_->eeprom->get_rom_size()) {
        throw Failure("the chip has no EEPROM at this address");
    }
    return processor_->eeprom->get_rom()[address]->get_value();
}

void Chip::write_eeprom(std::uint64_t address, std::uint64_t value) {
    read_eeprom(address);
    if (value > 0xFF) {
        throw Failure("an EEPROM byte holds 0 to 255");
    }
    processor_->eeprom->change_rom(static_cast<unsigned>(address), static_cast<unsigned>(value));
}

void Chip::reset(const std::string &cause) {
    ClockPhase *const present = processor_->mCurrentPhase;
    if (cause == "power-on") {
        processor_->reset(POR_RESET);
    } else if (cause == "mclr") {
        processor_->reset(MCLR_RESET);
        processor_->reset(EXIT_RESET);
    } else if (cause == "brown-out") {
        processor_->reset(BOD_RESET);
        processor_->rma.get_register(rcon_address)->put_value(rcon_after_brown_out);
        for (const unsigned address : {t1con_address, t3con_address}) {  // other resets leave these two running
            processor_->rma.get_register(address)->put(0);
        }
    } else {
        throw Failure("a reset is power-on, mclr or brown-out");
    }
    continue_with(present, processor_->mExecute1Cycle);
    stopped_because_.clear();
}

void Chip::change_mclr(bool level, const std::function<void()> &drive) {
    ClockPhase *const present = processor_->mCurrentPhase;
    drive();
    if (level) {
        continue_with(present, processor_->mExecute1Cycle);
    } else {
        continue_with(present, processor_->mIdle);
    }
}

void Chip::continue_with(ClockPhase *present, ClockPhase *next) {
    present->setNextPhase(next);  // where time stands inside of gpsim's cycle
    processor_->mCurrentPhase = next;  // where it stands before the first
}

unsigned Chip::program_counter() { return processor_->pma->get_PC(); }

}  // namespace bridge
