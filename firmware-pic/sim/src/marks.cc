// SPDX-License-Identifier: GPL-2.0-or-later
#include "marks.h"

#include <algorithm>
#include <vector>

#include <gpsim/breakpoints.h>
#include <gpsim/pic-processor.h>
#include <gpsim/trace.h>

#include "failure.h"

namespace bridge {

class Mark : public TriggerObject {
public:
    explicit Mark(Events &events) : events_(events) {}

    void callback() override {
        for (const std::string &name : names) {
            events_.tell("mark", Chip::cycle(), name);
        }
    }

    std::vector<std::string> names;
    unsigned breakpoint = 0;

private:
    Events &events_;
};

Marks::Marks(Chip &chip, Events &events) : chip_(chip), events_(events) {
    // With the first mark gpsim opens its log, by default a file gpsim.log in the present folder.
    GetTraceLog().enable_logging("/dev/null");
}
Marks::~Marks() = default;

void Marks::add(std::uint64_t address, const std::string &name) {
    for (const auto &[marked, mark] : marks_) {
        if (std::count(mark->names.begin(), mark->names.end(), name) != 0) {
            throw Failure("the mark '" + name + "' is already set");
        }
    }
    pic_processor &processor = chip_.processor();
    if (address % 2 != 0 || address / 2 >= processor.program_memory_size() ||
        !processor.pma->hasValid_opcode_at_index(static_cast<unsigned>(address / 2))) {
        throw Failure("no instruction stands at this address");
    }
    std::unique_ptr<Mark> &mark = marks_[address];
    if (mark == nullptr) {
        mark = std::make_unique<Mark>(events_);
        mark->breakpoint = processor.pma->set_notify_at_address(static_cast<unsigned>(address), mark.get());
        if (mark->breakpoint >= MAX_BREAKPOINTS) {
            marks_.erase(address);
            throw Failure("gpsim has no place for another mark");
        }
    }
    mark->names.push_back(name);
}

void Marks::remove(const std::string &name) {
    for (auto it = marks_.begin(); it != marks_.end(); ++it) {
        std::vector<std::string> &names = it->second->names;
        const auto found = std::find(names.begin(), names.end(), name);
        if (found != names.end()) {
            names.erase(found);
            if (names.empty()) {
                get_bp().clear(it->second->breakpoint);
                marks_.erase(it);
            }
            return;
        }
    }
    throw Failure("no mark is called '" + name + "'");
}

}  // namespace bridge
