#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::report {

/// A picture of 8-bit RGB pixels, rows from the top.
struct Image {
  int width{0}, height{0};
  std::vector<std::uint8_t> rgb{};
};

/// Encodes an image as the bytes of a PNG file. The error is libpng's message, or says that the image's size
/// does not match its bytes.
[[nodiscard]] tl::expected<std::vector<std::uint8_t>, std::string> EncodePng(const Image& image);

/// Writes a PNG file. The error names the file.
[[nodiscard]] tl::expected<void, std::string> WritePng(const Image& image, const std::filesystem::path& path);

/// Encodes bytes as Base64 (RFC 4648, with padding), for data: addresses.
[[nodiscard]] std::string Base64(const std::vector<std::uint8_t>& bytes);

}  // namespace osteon::report
