#pragma once

#include <unistd.h>

#include <string>

namespace osteon::app {

/// First of the ten ports that this test process uses. It depends on the process id, so a collision with
/// other tests is unlikely. All lie below the ports that Linux itself gives to sockets (32768 … 60999), which
/// could be in use.
inline std::string FirstPort() { return std::to_string(10000 + getpid() % 2000 * 10); }

}  // namespace osteon::app
