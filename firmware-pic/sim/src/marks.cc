// SPDX-License-Identifier: GPL-2.0-or-later
#include "marks.h"

#include <gpsim/breakpoints.h>
#include <gpsim/pic-processor.h>

#include "failure.h"

namespace bridge {

class Mark : public TriggerObject {
public:
    Mark(std::string name, Events &events) : name_(std::move(name)), events_(events) {}

    void callback() override { events_.tell("mark", Chip::cycle(), name_); }

    int breakpoint = -1;

private:
    std::string name_;
    Events &events_;
};

Marks::Marks(Chip &chip, Events &events) : chip_(chip), events_(events) {}
Marks::~Marks() = default;

void Marks::add(std::uint64_t address, const std::string &name) {
    pic_processor &processor = chip_.processor();
    if (marks_.count(name) != 0) {
        throw Failure("the mark '" + name + "' is already set");
    }
    if (address % 2 != 0 || address / 2 >= processor.program_memory_size() ||
        !processor.pma->hasValid_opcode_at_index(static_cast<unsigned>(address / 2))) {
        throw Failure("no instruction stands at this address");
    }
    auto mark = std::make_unique<Mark>(name, events_);
    mark->breakpoint = static_cast<int>(
        processor.pma->set_notify_at_address(static_cast<unsigned>(address), mark.get()));
    if (mark->breakpoint < 0 || mark->breakpoint >= MAX_BREAKPOINTS) {
        throw Failure("gpsim has no place for another mark");
    }
    marks_[name] = std::move(mark);
}

void Marks::remove(const std::string &name) {
    const auto found = marks_.find(name);
    if (found == marks_.end()) {
        throw Failure("no mark is called '" + name + "'");
    }
    get_bp().clear(static_cast<unsigned>(found->second->breakpoint));
    marks_.erase(found);
}

}  // namespace bridge
