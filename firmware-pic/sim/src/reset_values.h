// SPDX-License-Identifier: GPL-2.0-or-later
// What the registers hold after a reset.
#pragma once

class pic_processor;

namespace bridge {

/// gpsim lets most special function registers keep their values across a reset other than power-on, where
/// the chips set them anew: without this a timer, a transmission or the interrupts would go on through a
/// watchdog reset. Source: the tables "Initialization Conditions for All Registers" of the data sheets of
/// PIC18FXX2 (section 3) and PIC18F2220/2320/4220/4320 (section 5). It also corrects the interrupt
/// priorities, which are high after each reset and low in gpsim.
void correct_reset_values(pic_processor &processor);

}  // namespace bridge
