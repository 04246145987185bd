// SPDX-License-Identifier: GPL-2.0-or-later
// How long a write of the data EEPROM takes.
#pragma once

#include <cstdint>
#include <memory>

class pic_processor;
class Register;

namespace bridge {

/// gpsim ends a write of the data EEPROM after 20 cycles. With this it takes the data sheets' typical 4 ms
/// (parameter D122), so that a start-up that waits for one takes its time.
class EepromTime {
public:
    EepromTime(pic_processor &processor, std::uint64_t cycles_per_second);
    ~EepromTime();
    EepromTime(const EepromTime &) = delete;
    EepromTime &operator=(const EepromTime &) = delete;

private:
    pic_processor &processor_;
    std::unique_ptr<Register> control_;
    Register *replaced_ = nullptr;
};

}  // namespace bridge
