// SPDX-License-Identifier: GPL-2.0-or-later
#include "serial_port.h"

#include <initializer_list>

#include <gpsim/16bit-processors.h>
#include <gpsim/gpsim_time.h>
#include <gpsim/uart.h>

#include "failure.h"

namespace bridge {
namespace {

constexpr unsigned txreg_address = 0xFAD, rcreg_address = 0xFAE;

/// TXREG. In gpsim a byte written in the very cycle in which the byte before leaves the shift register is never
/// sent, and TXIF stays clear for good: TXIF is cleared a cycle after the write, so the register seems empty.
class TransmitRegister : public _TXREG {
public:
    TransmitRegister(_16bit_processor &processor, USART_MODULE &port)
        : _TXREG(&processor, "txreg-race", nullptr, &port), port_(port) {
        address = txreg_address;
        assign_txsta(&port.txsta);
        assign_rcsta(&port.rcsta);
    }

    void put(unsigned byte) override {
        value.put(byte & 0xFF);
        is_written_ = true;
        get_cycles().set_break_delta(1, this);
        begin_if_idle();
    }

    void put_value(unsigned byte) override { put(byte); }

    /// One cycle after a write TXIF falls, one after a byte went on to the shift register it rises.
    void callback() override {
        if (is_written_) {
            is_written_ = false;
            port_.full();
            begin_if_idle();
        } else {
            port_.emptyTX();
        }
    }

private:
    void begin_if_idle() {
        if (port_.txsta.bTRMT() && port_.txsta.bTXEN()) {
            get_cycles().set_break_delta(is_written_ ? 2 : 1, this);
            port_.txsta.start_transmitting();
        }
    }

    USART_MODULE &port_;
    bool is_written_ = false;
};

/// RCREG with its FIFO of two bytes, each with its own FERR. gpsim's reads the older of two bytes twice and loses
/// the other, has one FERR for both, and does not shift a byte without stop bit into place.
class ReceiveFifo : public _RCREG {
public:
    ReceiveFifo(_16bit_processor &processor, USART_MODULE &port)
        : _RCREG(&processor, "rcreg-fifo", nullptr, &port), port_(port) {
        address = rcreg_address;
        assign_rcsta(&port.rcsta);
    }

    void push(unsigned received) override {
        const bool is_framed = (port_.rcsta.value.get() & _RCSTA::FERR) == 0;
        if (count_ == size) {
            port_.rcsta.overrun();
        } else {
            entries_[count_++] = {is_framed ? received : port_.rcsta.rsr >> 1, is_framed};
        }
        show_front();
        port_.set_rcif();
    }

    void pop() override {
        if (count_ == 0) {
            return;
        }
        value.put(entries_[0].byte & 0xFF);
        entries_[0] = entries_[1];
        --count_;
        show_front();
        if (count_ == 0) {
            port_.clear_rcif();
        }
    }

    unsigned get() override {
        pop();
        return value.get();
    }

private:
    static constexpr unsigned size = 2;
    struct Entry {
        unsigned byte;
        bool is_framed;
    };

    /// FERR is that of the byte which is read next, and stays when there is none.
    void show_front() {
        if (count_ > 0) {
            constexpr unsigned framing_error = _RCSTA::FERR;
            const unsigned status = port_.rcsta.value.get();
            port_.rcsta.value.put(entries_[0].is_framed ? status & ~framing_error : status | framing_error);
        }
    }

    USART_MODULE &port_;
    Entry entries_[size] = {};
    unsigned count_ = 0;
};

USART_MODULE &port_of(pic_processor &processor) {
    auto *const wide = dynamic_cast<_16bit_processor *>(&processor);
    if (wide == nullptr || wide->usart.rcreg == nullptr || processor.registers[rcreg_address] != wide->usart.rcreg) {
        throw Failure("the processor has no serial port where an 18F452 has it");
    }
    return wide->usart;
}

}  // namespace

SerialPort::SerialPort(pic_processor &processor)
    : processor_(processor), port_(port_of(processor)), gpsims_transmit_(port_.txreg), gpsims_receive_(port_.rcreg) {
    auto &wide = dynamic_cast<_16bit_processor &>(processor);
    transmit_ = std::make_unique<TransmitRegister>(wide, port_);
    receive_ = std::make_unique<ReceiveFifo>(wide, port_);
    install(transmit_.get(), receive_.get());
}

SerialPort::~SerialPort() { install(gpsims_transmit_, gpsims_receive_); }

void SerialPort::install(_TXREG *transmit, _RCREG *receive) {
    processor_.registers[txreg_address] = port_.txreg = port_.txsta.txreg = port_.rcsta.txreg = transmit;
    processor_.registers[rcreg_address] = port_.rcreg = port_.rcsta.rcreg = receive;
}

void SerialPort::stop() {
    for (TriggerObject *part : std::initializer_list<TriggerObject *>{&port_.txsta, port_.txreg, &port_.rcsta,
                                                                      &port_.spbrg}) {
        get_cycles().clear_break(part);
    }
    port_.spbrg.running = false;
    port_.spbrg.last_cycle = get_cycles().get();
}

void SerialPort::refuse_while_overrun() {
    if ((port_.rcsta.value.get() & _RCSTA::OERR) != 0) {
        port_.rcsta.state = _RCSTA::RCSTA_DISABLED;
    }
}

}  // namespace bridge
