#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <fmt/format.h>

namespace osteon::simulation {

/// Why a file was refused, or could not be written.
struct FileError {
  std::string file;
  std::optional<std::uint64_t> byte;  ///< offset in the file; absent if the error concerns the whole file
  std::string where;                  ///< the item at this offset, such as "balls: ball 7"; may be empty
  std::string found;
  std::string accepted;  ///< empty if the system refused: disk full, no permission

  /// One line: "bone.osp: byte 4112: balls: ball 7: found radius -1 mm, accepted 0 … 512 mm, above 0".
  [[nodiscard]] std::string Text() const {
    std::string text = file + ": ";
    if (byte) text += fmt::format("byte {}: ", *byte);
    if (!where.empty()) text += where + ": ";
    text += "found " + found;
    if (!accepted.empty()) text += ", accepted " + accepted;
    return text;
  }
};

}  // namespace osteon::simulation
