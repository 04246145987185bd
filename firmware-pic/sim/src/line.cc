// SPDX-License-Identifier: GPL-2.0-or-later
#include "line.h"

#include <algorithm>
#include <cstdio>

#include <gpsim/gpsim_time.h>

#include "failure.h"

namespace bridge {
namespace {

constexpr std::uint64_t stop_bit = 9;
constexpr std::uint64_t middle_of_stop_bit = 2 * stop_bit + 1;  // in half bits
constexpr std::uint64_t end_of_frame = 2 * (stop_bit + 1);
constexpr std::uint64_t end_of_recovery = end_of_frame + 2;

}  // namespace

LineSender::LineSender(const Options &options, Chip &chip, Pins &pins, Events &events, bool tells)
    : time_(options), port_(chip.serial_port()), pin_(pins.find(options.receive_pin)), events_(events), tells_(tells) {}

void LineSender::send(std::uint8_t byte, std::uint64_t at_cycle, bool is_framed) {
    if (queue_.size() >= capacity) {
        throw Failure("the line's queue is full");
    }
    queue_.push_back({byte, is_framed, at_cycle});
    if (!busy_) {
        begin_next();
    }
}

void LineSender::begin_next() {
    busy_ = !queue_.empty();
    if (!busy_) {
        return;
    }
    frame_ = queue_.front();
    queue_.pop_front();
    const std::uint64_t now = Chip::cycle();
    begin_ = std::max(free_at_, time_.from_cycle(frame_.at_cycle));
    // Back to back the fraction of a cycle goes on; otherwise the byte begins with a whole cycle.
    if (begin_ < time_.from_cycle(now)) {
        begin_ = time_.from_cycle(now + 1);
    }
    half_bit_ = 0;
    arm();
}

void LineSender::arm() {
    const std::uint64_t cycle = time_.to_cycle(begin_ + time_.half_bits(half_bit_));
    get_cycles().set_break(std::max(cycle, Chip::cycle() + 1), this);
}

void LineSender::callback() {
    const std::uint64_t end = frame_.is_framed ? end_of_frame : end_of_recovery;
    if (half_bit_ == middle_of_stop_bit) {
        if (tells_) {
            events_.tell("heard", Chip::cycle());
        }
        half_bit_ = end_of_frame;
        if (end == end_of_frame && !queue_.empty()) {
            free_at_ = begin_ + time_.half_bits(end);
            begin_next();  // so that its start bit comes in the very cycle in which the stop bit ends
            return;
        }
        arm();
        return;
    }
    if (half_bit_ == end) {
        free_at_ = begin_ + time_.half_bits(end);
        begin_next();
        return;
    }
    const std::uint64_t bit = half_bit_ / 2;
    if (bit == 0) {
        port_.refuse_while_overrun();
        Pins::drive(pin_, false);
    } else if (bit < stop_bit) {
        Pins::drive(pin_, (frame_.byte >> (bit - 1) & 1) != 0);
    } else if (bit == stop_bit) {
        Pins::drive(pin_, frame_.is_framed);
    } else {
        Pins::drive(pin_, true);
    }
    if (bit == stop_bit) {
        half_bit_ = middle_of_stop_bit;
    } else {
        half_bit_ += 2;
    }
    arm();
}

LineReceiver::LineReceiver(const Options &options, Pins &pins, Events &events, bool tells)
    : time_(options), pin_(pins.find(options.transmit_pin)), events_(events), tells_(tells) {
    pin_.on_edge = [this](bool level) { edge(level); };
}

void LineReceiver::edge(bool level) {
    if (!busy_ && !level) {
        busy_ = true;
        bit_ = 0;
        shift_ = 0;
        begin_ = time_.from_cycle(Chip::cycle());
        arm();
    }
}

void LineReceiver::arm() {
    get_cycles().set_break(std::max(time_.to_cycle(begin_ + time_.half_bits(2 * bit_ + 1)), Chip::cycle() + 1), this);
}

void LineReceiver::callback() {
    if (bit_ == 0 && pin_.level) {
        busy_ = false;  // shorter than half a bit: no start bit
        return;
    }
    if (bit_ < stop_bit) {
        if (bit_ > 0 && pin_.level) {
            shift_ |= 1U << (bit_ - 1);
        }
        ++bit_;
        arm();
        return;
    }
    busy_ = false;
    if (!pin_.level) {
        events_.tell("framing", Chip::cycle());
        return;
    }
    if (tells_) {
        char text[4];
        std::snprintf(text, sizeof text, "%02X", shift_);
        events_.tell("byte", Chip::cycle(), text);
    }
    if (on_byte) {
        on_byte(static_cast<std::uint8_t>(shift_));
    }
}

}  // namespace bridge
