// SPDX-License-Identifier: GPL-2.0-or-later
#include "leftovers.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstring>

#include "failure.h"

namespace bridge {
namespace {

/// A path of ours and which file it was; plain memory, since a signal handler reads it.
struct Leftover {
    char path[PATH_MAX];
    dev_t device;
    ino_t file;
    volatile sig_atomic_t is_ours;
};

Leftover leftovers[2];

void keep(Leftover &leftover, const std::string &path) {
    struct stat status {};
    if (path.size() < sizeof leftover.path && lstat(path.c_str(), &status) == 0) {
        std::memcpy(leftover.path, path.c_str(), path.size() + 1);
        leftover.device = status.st_dev;
        leftover.file = status.st_ino;
        leftover.is_ours = 1;
    }
}

/// Only functions that a signal handler may call.
void remove_leftovers() {
    for (Leftover &leftover : leftovers) {
        struct stat status {};
        if (leftover.is_ours != 0 && lstat(leftover.path, &status) == 0 && status.st_dev == leftover.device &&
            status.st_ino == leftover.file) {
            unlink(leftover.path);
        }
        leftover.is_ours = 0;
    }
}

void on_signal(int) {
    remove_leftovers();
    _exit(0);
}

std::string reason() { return std::strerror(errno); }

}  // namespace

void end_cleanly_on_signals() {
    struct sigaction action {};
    action.sa_handler = on_signal;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    signal(SIGPIPE, SIG_IGN);
}

void leave(int status) {
    remove_leftovers();
    _exit(status);
}

void make_link(const std::string &target, const std::string &link) {
    char old_target[PATH_MAX] = {};
    const ssize_t length = readlink(link.c_str(), old_target, sizeof old_target - 1);
    if (length >= 0 && std::strncmp(old_target, "/dev/pts/", 9) == 0) {
        unlink(link.c_str());
    } else if (length >= 0 || errno != ENOENT) {
        throw Failure("'" + link + "' is there already and is no link to a pseudo-terminal; it is left alone");
    }
    if (symlink(target.c_str(), link.c_str()) != 0) {
        throw Failure("cannot make the link '" + link + "': " + reason());
    }
    keep(leftovers[0], link);
}

int make_socket(const std::string &path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) {
        throw Failure("the socket's path '" + path + "' is longer than " +
                      std::to_string(sizeof address.sun_path - 1) + " bytes");
    }
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    const auto *generic = reinterpret_cast<const sockaddr *>(&address);
    const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (listener < 0) {
        throw Failure("cannot make a socket: " + reason());
    }
    struct stat status {};
    if (lstat(path.c_str(), &status) == 0) {
        if (!S_ISSOCK(status.st_mode)) {
            throw Failure("'" + path + "' is there already and is no socket; it is left alone");
        }
        const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const bool is_stale = connect(probe, generic, sizeof address) != 0 && errno == ECONNREFUSED;
        close(probe);
        if (!is_stale) {
            throw Failure("another program listens at '" + path + "'");
        }
        unlink(path.c_str());
    }
    if (bind(listener, generic, sizeof address) != 0 || listen(listener, 4) != 0) {
        throw Failure("cannot listen at '" + path + "': " + reason());
    }
    keep(leftovers[1], path);
    return listener;
}

}  // namespace bridge
