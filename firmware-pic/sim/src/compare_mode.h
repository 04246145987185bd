// SPDX-License-Identifier: GPL-2.0-or-later
// The compare modes of the CCP units.
#pragma once

class pic_processor;

namespace bridge {

/// gpsim 0.31 takes the compare modes (CCPxM3:0 = 1000 to 1011) for PWM and lets Timer2 turn the pin at each
/// of its periods. This takes both units from Timer2: compare modes then do what the data sheets say
/// (PIC18F2220/2320/4220/4320, section 15.3), and PWM does nothing.
void keep_timer2_from_compare_modes(pic_processor &processor);

}  // namespace bridge
