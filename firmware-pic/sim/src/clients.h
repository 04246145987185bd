// SPDX-License-Identifier: GPL-2.0-or-later
// Those who give commands: lines in, answers out.
#pragma once

#include <list>
#include <string>

namespace bridge {

struct Client {
    int input = -1;
    int output = -1;
    bool is_stdin = false;
    bool has_ended = false;      ///< no more input will come
    bool line_too_long = false;  ///< the rest of the line is skipped
    std::string received;
    std::string to_send;
};

class Clients {
public:
    /// `listener` and `output_of_stdin` are -1 where there is no socket or no client on stdin.
    Clients(int listener, int output_of_stdin);

    /// The next complete line, without its end, that has come; nullptr when there is none.
    Client *take_line(std::string &line);

    /// Queues an answer; it is written by `wait`.
    static void answer(Client &client, const std::string &text) { client.to_send += text; }

    /// Writes the answers, then waits for input, at most `timeout_ms` (-1: as long as it takes), on the
    /// clients and on `other` (-1: none). A client that does not read its answers for a second is dropped.
    void wait(int timeout_ms, int other = -1);

    /// The client on stdin has closed it and all its lines are taken.
    bool is_stdin_finished() const { return stdin_finished_; }

    /// Writes what is still queued.
    void flush();

private:
    void read_from(Client &client);
    void accept_one();

    int listener_;
    bool stdin_finished_ = false;
    std::list<Client> clients_;  // a client stays where it is while its `advance` runs
};

}  // namespace bridge
