#pragma once

#include <string>

#include "io/recording/messages.h"

namespace osteon::app {

/// Checksum of the files that a cell was loaded from, 16 hexadecimal digits: FNV-1a of 64 bits over each
/// file's name without its folder, its size and its bytes, in the order of names, then bytes. Gains that were
/// laid over the cell are not in it. Two processes that show the same one work by the same files, wherever
/// these lie; against forgery it is no protection.
[[nodiscard]] std::string ConfigChecksum(const io::ConfigSource& source);

}  // namespace osteon::app
