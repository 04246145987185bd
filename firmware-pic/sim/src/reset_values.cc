// SPDX-License-Identifier: GPL-2.0-or-later
#include "reset_values.h"

#include <gpsim/pic-processor.h>

namespace bridge {
namespace {

struct Range {
    unsigned first;
    unsigned last;
};

/// Registers that every reset sets as power-on does. The others keep their values by the data sheets, too
/// (latches, Timer0, 1 and 3, CCPRx, FSRs, W, STATUS, PROD), are set by gpsim (TRISx, T0CON, STKPTR), hold nothing
/// of interest (addresses and data of EEPROM and table reads) or are RCON.
constexpr Range set_at_each_reset[] = {
    {0xF9D, 0xFA2},  // PIE1, PIR1, IPR1, PIE2, PIR2, IPR2
    {0xFAB, 0xFAD},  // RCSTA, TXSTA, TXREG
    {0xFAF, 0xFB0},  // SPBRG, SPBRGH (18F2321)
    {0xFB4, 0xFB8},  // CMCON, CVRCON, ECCP1AS, PWM1CON, BAUDCON (18F2321)
    {0xFBA, 0xFBA},  // CCP2CON
    {0xFBD, 0xFBD},  // CCP1CON
    {0xFC0, 0xFC2},  // ADCON2, ADCON1, ADCON0
    {0xFC5, 0xFC8},  // SSPCON2, SSPCON1, SSPSTAT, SSPADD
    {0xFCA, 0xFCC},  // T2CON, PR2, TMR2
    {0xFD1, 0xFD2},  // WDTCON, LVDCON
    {0xFE0, 0xFE0},  // BSR
    {0xFF0, 0xFF2},  // INTCON3, INTCON2, INTCON
};

constexpr unsigned ipr1_address = 0xF9F, ipr2_address = 0xFA2;
constexpr int pins_with_parallel_port = 40;

void set_power_on_value(pic_processor &processor, unsigned address, unsigned value) {
    processor.registers[address]->por_value = RegisterValue(value, 0);
}

}  // namespace

void correct_reset_values(pic_processor &processor) {
    const bool has_parallel_port = processor.get_pin_count() >= pins_with_parallel_port;
    set_power_on_value(processor, ipr1_address, has_parallel_port ? 0xFF : 0x7F);
    set_power_on_value(processor, ipr2_address, has_parallel_port ? 0x1F : 0xDF);
    for (const Range &range : set_at_each_reset) {
        for (unsigned address = range.first; address <= range.last; ++address) {
            if (auto *special = dynamic_cast<sfr_register *>(processor.registers[address])) {
                special->wdtr_value = special->por_value;
            }
        }
    }
}

}  // namespace bridge
