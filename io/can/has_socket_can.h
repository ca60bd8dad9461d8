#pragma once

namespace osteon::io {

/// Whether this kernel supports SocketCAN (many containers and virtual machines do not).
[[nodiscard]] bool HasSocketCan();

}  // namespace osteon::io
