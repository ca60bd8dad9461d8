#include "report/png_file.h"

#include <fstream>

#include <png.h>

namespace osteon::report {

tl::expected<std::vector<std::uint8_t>, std::string> EncodePng(const Image& image) {
  if (image.width <= 0 || image.height <= 0 ||
      image.rgb.size() != 3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    return tl::unexpected(std::string("PNG: the image's size does not fit its bytes"));
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<std::uint8_t> bytes(size);
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0)
    return tl::unexpected(std::string("PNG: ") + header.message);
  bytes.resize(size);
  return bytes;
}

tl::expected<void, std::string> WritePng(const Image& image, const std::filesystem::path& path) {
  const auto bytes = EncodePng(image);
  if (!bytes) return tl::unexpected(path.string() + ": " + bytes.error());
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes->data()), static_cast<std::streamsize>(bytes->size()));
  file.close();
  if (!file) return tl::unexpected(path.string() + ": cannot write the picture");
  return {};
}

std::string Base64(const std::vector<std::uint8_t>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t group = (static_cast<std::uint32_t>(bytes[i]) << 16u) |
                                (left > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8u : 0u) |
                                (left > 2 ? static_cast<std::uint32_t>(bytes[i + 2]) : 0u);
    out += kDigits[group >> 18u];
    out += kDigits[(group >> 12u) & 63u];
    out += left > 1 ? kDigits[(group >> 6u) & 63u] : '=';
    out += left > 2 ? kDigits[group & 63u] : '=';
  }
  return out;
}

}  // namespace osteon::report
