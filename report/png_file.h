#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::report {

/// 8-bit RGB, rows from the top.
struct Image {
  int width{0}, height{0};
  std::vector<std::uint8_t> rgb{};
};

/// Encodes the PNG file's bytes. @returns libpng's message if it fails, or a message if the image's size does
/// not match its bytes.
[[nodiscard]] tl::expected<std::vector<std::uint8_t>, std::string> EncodePng(const Image& image);

/// @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WritePng(const Image& image, const std::filesystem::path& path);

/// Encodes by RFC 4648, with padding; for data: addresses.
[[nodiscard]] std::string Base64(const std::vector<std::uint8_t>& bytes);

}  // namespace osteon::report
