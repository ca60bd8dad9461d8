#pragma once

#include <string>

#include "io/recording/messages.h"

namespace osteon::session {

/// Computes the checksum of the files that a cell was loaded from, 16 hexadecimal digits: FNV-1a of 64 bits
/// over each file's name without its folder, its size and its bytes, with the files ordered by name, then by
/// bytes. Gains that override the cell's are not included. Two processes with the same checksum use the same
/// files, wherever these lie; it does not protect against forgery.
[[nodiscard]] std::string ConfigChecksum(const io::ConfigSource& source);

}  // namespace osteon::session
