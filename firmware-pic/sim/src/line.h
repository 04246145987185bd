// SPDX-License-Identifier: GPL-2.0-or-later
// The serial line at its two wires, bit by bit: 8 data bits, no parity, 1 stop bit.
//
// Times are counted in 1/(2 * baud) of a cycle, so that half a bit is a whole number
// (cycles a second) and a long train of bytes keeps its rate exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>

#include <gpsim/trigger.h>

#include "chip.h"
#include "events.h"
#include "options.h"
#include "pins.h"
#include "serial_port.h"

namespace bridge {

/// Exact times on the line.
class LineTime {
public:
    explicit LineTime(const Options &options) : half_bit_(options.cycles_per_second()), units_(2 * options.baud) {}

    std::uint64_t half_bits(std::uint64_t count) const { return count * half_bit_; }
    std::uint64_t from_cycle(std::uint64_t cycle) const { return cycle * units_; }
    /// The nearest cycle.
    std::uint64_t to_cycle(std::uint64_t time) const { return (time + units_ / 2) / units_; }

private:
    std::uint64_t half_bit_;
    std::uint64_t units_;
};

/// Bytes from outside to the chip's RX pin, queued one behind the other.
class LineSender : public TriggerObject {
public:
    /// Most bytes that may wait in the queue.
    static constexpr std::size_t capacity = 1 << 20;

    LineSender(const Options &options, Chip &chip, Pins &pins, Events &events, bool tells);

    /// Queues a byte that begins behind the ones before it, but not before `at_cycle`; with
    /// `is_framed` false its stop bit is low, and the line is idle for one bit after it.
    /// Throws `Failure` when the queue is full.
    void send(std::uint8_t byte, std::uint64_t at_cycle, bool is_framed);

    std::size_t waiting() const { return queue_.size(); }

    void callback() override;

private:
    struct Frame {
        std::uint8_t byte;
        bool is_framed;
        std::uint64_t at_cycle;
    };

    void begin_next();
    void arm();

    LineTime time_;
    SerialPort &port_;
    Pin &pin_;
    Events &events_;
    bool tells_;
    std::deque<Frame> queue_;
    Frame frame_{};
    bool busy_ = false;
    std::uint64_t begin_ = 0;     // of the frame's start bit
    std::uint64_t half_bit_ = 0;  // position in the frame of what is done next
    std::uint64_t free_at_ = 0;   // end of the frame before
};

/// Bytes from the chip's TX pin.
class LineReceiver : public TriggerObject {
public:
    LineReceiver(const Options &options, Pins &pins, Events &events, bool tells);

    /// Called with each byte that came with a stop bit.
    std::function<void(std::uint8_t)> on_byte;

    void callback() override;

private:
    void edge(bool level);
    void arm();

    LineTime time_;
    Pin &pin_;
    Events &events_;
    bool tells_;
    bool busy_ = false;
    std::uint64_t begin_ = 0;
    unsigned bit_ = 0;  // 0 start, 1 to 8 data, 9 stop
    unsigned shift_ = 0;
};

}  // namespace bridge
