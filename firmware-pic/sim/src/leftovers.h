// SPDX-License-Identifier: GPL-2.0-or-later
// What the program leaves in the file system while it runs, removed at each way out.
#pragma once

#include <string>

namespace bridge {

/// From now on SIGINT and SIGTERM end the program with status 0, and its link and socket go with it.
void end_cleanly_on_signals();

/// Makes a symbolic link. One that points into /dev/pts is taken as left by a program that died;
/// anything else at this place is left alone and a `Failure`.
void make_link(const std::string &target, const std::string &link);

/// Binds and listens. A socket that nobody listens at is replaced; a live one and any other file
/// are left alone and a `Failure`. Returns the descriptor, non-blocking.
int make_socket(const std::string &path);

/// Removes link and socket as far as they are still ours and ends the program at once: gpsim's own
/// tear-down is not made for it.
[[noreturn]] void leave(int status);

}  // namespace bridge
