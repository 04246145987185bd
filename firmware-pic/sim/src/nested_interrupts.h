// SPDX-License-Identifier: GPL-2.0-or-later
// Interrupts of high priority within those of low priority.
#pragma once

#include <memory>

class pic_processor;

namespace bridge {

/// While gpsim 0.31 is in an interrupt routine it lets no other begin, and it leaves GIEL set. On the chips
/// entering a routine of low priority clears GIEL until its RETFIE, and one of high priority may come in between
/// (RCON.IPEN = 1; PIC18FXX2 data sheet, section 8.0). This does so, as long as it lives.
class NestedInterrupts {
public:
    explicit NestedInterrupts(pic_processor &processor);
    ~NestedInterrupts();
    NestedInterrupts(const NestedInterrupts &) = delete;
    NestedInterrupts &operator=(const NestedInterrupts &) = delete;

private:
    class Hook;
    class Entry;
    class Return;
    std::unique_ptr<Hook> entry_;
    std::unique_ptr<Hook> return_;
};

}  // namespace bridge
