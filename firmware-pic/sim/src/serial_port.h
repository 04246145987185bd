// SPDX-License-Identifier: GPL-2.0-or-later
// The chip's serial port where gpsim's differs from it.
#pragma once

#include <memory>

class pic_processor;
class USART_MODULE;
class _RCREG;
class _TXREG;

namespace bridge {

/// Puts its own TXREG and RCREG in the places of gpsim's as long as it lives.
class SerialPort {
public:
    /// Throws `Failure` for a processor without a serial port.
    explicit SerialPort(pic_processor &processor);
    ~SerialPort();
    SerialPort(const SerialPort &) = delete;
    SerialPort &operator=(const SerialPort &) = delete;

    /// At every reset, before gpsim's own: takes back what the port still had planned. gpsim leaves it, and a port
    /// that the firmware starts anew within a bit's time then stands still for good.
    void stop();

    /// Before each start bit from outside: while OERR is set the chip receives nothing; gpsim would.
    void refuse_while_overrun();

private:
    void install(_TXREG *transmit, _RCREG *receive);

    pic_processor &processor_;
    USART_MODULE &port_;
    _TXREG *gpsims_transmit_;
    _RCREG *gpsims_receive_;
    std::unique_ptr<_TXREG> transmit_;
    std::unique_ptr<_RCREG> receive_;
};

}  // namespace bridge
