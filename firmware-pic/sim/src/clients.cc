// SPDX-License-Identifier: GPL-2.0-or-later
#include "clients.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

namespace bridge {
namespace {

constexpr std::size_t longest_line = 1 << 20;
constexpr std::size_t most_clients = 16;
constexpr int patience_ms = 1000;

/// False when the reader is gone or does not read.
bool write_all(int output, const std::string &text) {
    std::size_t written = 0;
    while (written < text.size()) {
        const ssize_t count = write(output, text.data() + written, text.size() - written);
        if (count > 0) {
            written += static_cast<std::size_t>(count);
        } else if (count < 0 && errno == EAGAIN) {
            pollfd ready{output, POLLOUT, 0};
            if (poll(&ready, 1, patience_ms) == 0) {
                return false;
            }
        } else if (count == 0 || errno != EINTR) {
            return false;
        }
    }
    return true;
}

}  // namespace

Clients::Clients(int listener, int output_of_stdin) : listener_(listener) {
    if (output_of_stdin >= 0) {
        Client client;
        client.input = STDIN_FILENO;
        client.output = output_of_stdin;
        client.is_stdin = true;
        clients_.push_back(client);
    }
}

Client *Clients::take_line(std::string &line) {
    for (Client &client : clients_) {
        const std::size_t end = client.received.find('\n');
        if (end != std::string::npos) {
            line = client.received.substr(0, end);
            client.received.erase(0, end + 1);
            if (client.line_too_long) {
                client.line_too_long = false;
                answer(client, "error the line is longer than 1 MiB\n");
                return take_line(line);
            }
            return &client;
        }
    }
    return nullptr;
}

void Clients::flush() {
    for (Client &client : clients_) {
        if (!client.to_send.empty()) {
            client.has_ended = !write_all(client.output, client.to_send) || client.has_ended;
            client.to_send.clear();
        }
    }
}

void Clients::wait(int timeout_ms, int other) {
    flush();
    for (auto it = clients_.begin(); it != clients_.end();) {
        if (!it->has_ended) {
            ++it;
        } else if (it->is_stdin) {
            stdin_finished_ = true;
            it = clients_.erase(it);
        } else {
            close(it->input);
            it = clients_.erase(it);
        }
    }
    if (stdin_finished_) {
        return;
    }
    std::vector<pollfd> ready;
    ready.push_back({other, POLLIN, 0});  // poll passes over a descriptor of -1
    ready.push_back({clients_.size() < most_clients ? listener_ : -1, POLLIN, 0});
    for (const Client &client : clients_) {
        ready.push_back({client.input, POLLIN, 0});
    }
    if (poll(ready.data(), ready.size(), timeout_ms) <= 0) {
        return;
    }
    std::size_t i = 2;
    for (Client &client : clients_) {
        if (ready[i++].revents != 0) {
            read_from(client);
        }
    }
    if (ready[1].revents != 0) {
        accept_one();
    }
}

void Clients::read_from(Client &client) {
    char bytes[65536];
    const ssize_t count = read(client.input, bytes, sizeof bytes);
    if (count > 0) {
        client.received.append(bytes, static_cast<std::size_t>(count));
        if (client.received.size() > longest_line && client.received.find('\n') == std::string::npos) {
            client.received.clear();
            client.line_too_long = true;
        }
    } else if (count == 0 || (errno != EAGAIN && errno != EINTR)) {
        client.has_ended = true;
    }
}

void Clients::accept_one() {
    const int connection = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (connection >= 0) {
        Client client;
        client.input = connection;
        client.output = connection;
        clients_.push_back(client);
    }
}

}  // namespace bridge
