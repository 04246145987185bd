// SPDX-License-Identifier: GPL-2.0-or-later
#include "compare_mode.h"

#include <gpsim/16bit-processors.h>

namespace bridge {

void keep_timer2_from_compare_modes(pic_processor &processor) {
    if (auto *chip = dynamic_cast<_16bit_processor *>(&processor)) {
        chip->tmr2.rm_ccp(&chip->ccp1con);
        chip->tmr2.rm_ccp(&chip->ccp2con);
    }
}

}  // namespace bridge
