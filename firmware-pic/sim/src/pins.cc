// SPDX-License-Identifier: GPL-2.0-or-later
#include "pins.h"

#include <cctype>

#include <gpsim/pic-processor.h>
#include <gpsim/stimuli.h>

#include "failure.h"

namespace bridge {

/// Where gpsim tells the level of one pin.
class PinSink : public SignalSink {
public:
    PinSink(Pins &pins, Pin &pin) : pins_(pins), pin_(pin) {}

    void setSinkState(char state) override {
        const bool level = state == '1' || state == 'W';  // 'W': pulled up weakly
        if (level != pin_.level) {
            pins_.level_changed(pin_, level);
        }
    }

    void release() override {}

private:
    Pins &pins_;
    Pin &pin_;
};

/// What is wired to one pin outside the chip: a level behind a resistor, against which an output (150 ohm) always
/// and the chip's own pull-up (20 kilohm) never wins.
/// Without such a node gpsim lets an input follow its own latch.
class PinWire {
public:
    explicit PinWire(Pin &pin)
        : source_(("wire-" + pin.name).c_str(), 0, resistance_ohm), node_(("node-" + pin.name).c_str()) {
        node_.attach_stimulus(pin.io);
        node_.attach_stimulus(&source_);
    }

    void drive(bool level) {
        source_.set_Vth(level ? supply_volt : 0);
        node_.update();
    }

private:
    static constexpr double resistance_ohm = 1e3;
    static constexpr double supply_volt = 5;

    stimulus source_;
    Stimulus_Node node_;
};

namespace {

/// "chip.portb0" and "portb0" become "rb0"; other names ("mclr", "vdd") come back as they are.
std::string short_name(std::string name) {
    name.erase(0, name.rfind('.') + 1);
    for (char &c : name) {
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return name.rfind("port", 0) == 0 ? "r" + name.substr(4) : name;
}

}  // namespace

Pin::Pin() = default;
Pin::~Pin() = default;

Pins::Pins(Chip &chip, const Options &options, Events &events) : events_(events) {
    pic_processor &processor = chip.processor();
    for (int number = 1; number <= processor.get_pin_count(); ++number) {
        IOPIN *io = processor.get_pin(static_cast<unsigned>(number));
        if (io == nullptr || io->getMonitor() == nullptr) {
            continue;
        }
        const std::string name = short_name(io->name());
        Pin &pin = pins_[name];
        pin.name = name;
        pin.io = io;
        pin.level = io->getState();
        pin.sink = std::make_unique<PinSink>(*this, pin);
        io->getMonitor()->addSink(pin.sink.get());
        pin.wire = std::make_unique<PinWire>(pin);
        drive(pin, name == "mclr" || name.rfind("ra", 0) == 0 || name.rfind("rb", 0) == 0);
    }
    for (const std::string &name : {options.transmit_pin, options.receive_pin}) {
        Pin &pin = find(name);
        pin.is_serial = true;
        drive(pin, true);
    }
}

Pins::~Pins() {
    for (auto &[name, pin] : pins_) {
        pin.io->getMonitor()->removeSink(pin.sink.get());
    }
}

Pin &Pins::find(const std::string &name) {
    const auto found = pins_.find(short_name(name));
    if (found == pins_.end()) {
        throw Failure("the chip has no pin '" + name + "'");
    }
    return found->second;
}

std::vector<std::string> Pins::names() const {
    std::vector<std::string> names;
    for (const auto &[name, pin] : pins_) {
        names.push_back(name);
    }
    return names;
}

void Pins::drive(Pin &pin, bool level) {
    pin.wire->drive(level);
    if (pin.name == "mclr") {
        pin.level = level;  // gpsim tells the levels of all other pins
    }
}

void Pins::watch(const std::vector<std::string> &names) {
    for (const std::string &name : names) {
        find(name);  // all names are good before anything changes
    }
    watch_none();
    for (const std::string &name : names) {
        find(name).watched = true;
    }
}

void Pins::watch_outputs() {
    watch_none();
    outputs_watched_ = true;
}

void Pins::watch_none() {
    outputs_watched_ = false;
    for (auto &[name, pin] : pins_) {
        pin.watched = false;
    }
}

void Pins::level_changed(Pin &pin, bool level) {
    pin.level = level;
    if (pin.on_edge) {
        pin.on_edge(level);
    }
    bool told = pin.watched;
    if (outputs_watched_ && !pin.is_serial) {
        // The edge of a pin that a reset turns into an input belongs to the output that it was.
        const bool is_output = pin.io->get_direction() == IOPIN::DIR_OUTPUT;
        told = told || is_output || pin.was_output;
        pin.was_output = is_output;
    }
    if (told) {
        events_.tell("edge", Chip::cycle(), pin.name + (level ? " 1" : " 0"));
    }
}

}  // namespace bridge
