#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace osteon::io::mcap {

/// Unpacks a chunk's records.
/// @param compression  as the chunk names it: "zstd", "lz4" (its frame format), or "" for none
/// @param size  of the records, as the chunk announces it; no more is allocated
/// @returns them, or what was found and what is accepted.
[[nodiscard]] tl::expected<std::string, std::string> Decompress(std::string_view compression,
                                                                std::span<const char> bytes,
                                                                std::uint64_t size);

}  // namespace osteon::io::mcap
