// SPDX-License-Identifier: GPL-2.0-or-later
#include "pseudo_terminal.h"

#include <fcntl.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "failure.h"
#include "leftovers.h"

namespace bridge {

PseudoTerminal::PseudoTerminal(const std::string &link) {
    termios settings{};
    cfmakeraw(&settings);
    settings.c_cflag |= CREAD | CLOCAL;
    char name[256] = {};
    if (openpty(&master_, &slave_, name, &settings, nullptr) != 0) {
        throw Failure(std::string("cannot open a pseudo-terminal: ") + std::strerror(errno));
    }
    fcntl(master_, F_SETFL, O_NONBLOCK);
    make_link(name, link);
}

std::vector<std::uint8_t> PseudoTerminal::read() {
    std::vector<std::uint8_t> bytes(4096);
    const ssize_t count = ::read(master_, bytes.data(), bytes.size());
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
}

void PseudoTerminal::write(std::uint8_t byte) {
    const ssize_t count = ::write(master_, &byte, 1);
    static_cast<void>(count);
}

}  // namespace bridge
