// SPDX-License-Identifier: GPL-2.0-or-later
// The chip's pins: levels, driving them from outside, telling their edges.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "chip.h"
#include "events.h"

class IOPIN;

namespace bridge {

class PinSink;
class PinWire;

/// One port pin, named as in data sheets and in lower case ("rb0").
struct Pin {
    Pin();
    ~Pin();
    std::string name;
    IOPIN *io = nullptr;
    bool level = false;                         ///< as gpsim told it last
    bool watched = false;                       ///< its edges are told whatever its direction is
    bool was_output = false;                    ///< an edge was told while the chip drove the pin
    bool is_serial = false;                     ///< its bytes are told instead of its edges
    std::function<void(bool)> on_edge;          ///< called at every edge, in the cycle of the edge
    std::unique_ptr<PinSink> sink;
    std::unique_ptr<PinWire> wire;
};

class Pins {
public:
    /// Finds the pins and gives each the level that it has as an input until `drive`: ports A and B high
    /// (open switches with pull-ups), the serial pins high (an idle line), MCLR high, all others low (pull-downs).
    Pins(Chip &chip, const Options &options, Events &events);
    ~Pins();
    Pins(const Pins &) = delete;
    Pins &operator=(const Pins &) = delete;

    /// Throws `Failure` for a name that is not there. gpsim's name ("portb0") is understood, too.
    Pin &find(const std::string &name);

    std::vector<std::string> names() const;
    static void drive(Pin &pin, bool level);

    /// Tells edges of these pins only.
    void watch(const std::vector<std::string> &names);
    /// Tells edges of all pins that the chip drives, but the serial ones (what Pins begins with in lock step).
    void watch_outputs();
    void watch_none();

    /// Called by the sink of a pin.
    void level_changed(Pin &pin, bool level);

private:
    std::map<std::string, Pin> pins_;  // nodes stay where they are: the sinks refer to them
    Events &events_;
    bool outputs_watched_ = false;
};

}  // namespace bridge
