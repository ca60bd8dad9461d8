#include "simulation/surface/swept_file.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "base/mapped_file.h"
#include "base/output_file.h"

namespace osteon::surface {
namespace {

using simulation::FileError;
using simulation::MappedFile;
using simulation::OutputFile;

static_assert(std::endian::native == std::endian::little);

/// The byte of a brick in the file: nothing swept, everything swept, or values follow.
enum BrickContent : std::uint8_t { kNothing = 0, kEverything = 1, kValues = 2 };
constexpr std::size_t kValueBytes = kBrickNodes * sizeof(std::int16_t);

/// The file's first 48 bytes.
struct SweptHeader {
  std::array<char, 8> magic{'O', 'S', 'T', 'S', 'W', 'E', 'P', 'T'};
  std::uint32_t version{1};
  std::uint32_t payload_crc{0};  ///< CRC-32 of all bytes after the header
  std::array<float, 3> origin_mm{};
  float voxel_mm{0.0F};
  std::array<std::int32_t, 3> bricks{};
  std::uint32_t with_values{0};  ///< number of bricks of content kValues
};
static_assert(sizeof(SweptHeader) == 48);

/// Header of a file for this grid, without checksum and number of bricks with values.
SweptHeader HeaderOf(const BrickLayout& layout) {
  return {.origin_mm = {layout.origin_mm.x, layout.origin_mm.y, layout.origin_mm.z},
          .voxel_mm = layout.voxel_mm,
          .bricks = {layout.bricks[0], layout.bricks[1], layout.bricks[2]}};
}

/// CRC-32, as zlib computes it.
std::uint32_t Crc(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Appends the bytes of `count` values.
template <class T>
void Append(std::vector<std::byte>& bytes, const T* values, std::size_t count) {
  const auto* first = reinterpret_cast<const std::byte*>(values);
  bytes.insert(bytes.end(), first, first + count * sizeof(T));
}

}  // namespace

tl::expected<void, FileError> WriteSweptField(const std::filesystem::path& path, const BrickField& swept,
                                              const BrickLayout& layout) {
  SweptHeader header = HeaderOf(layout);
  std::vector<std::byte> payload;
  for (BrickIndex brick = 0; brick < swept.Count(); ++brick) {
    const bool has_values = swept.HasValues(brick);
    const std::uint8_t content = has_values                                   ? kValues
                                 : swept.State(brick) == BrickField::kAllHigh ? kEverything
                                                                              : kNothing;
    header.with_values += has_values ? 1 : 0;
    Append(payload, &content, 1);
  }
  for (BrickIndex brick = 0; brick < swept.Count(); ++brick)
    if (const std::int16_t* values = swept.Values(brick)) Append(payload, values, kBrickNodes);
  header.payload_crc = Crc(payload);
  auto file = OutputFile::Create(path);
  if (!file) return tl::make_unexpected(file.error());
  file->Write(std::as_bytes(std::span(&header, 1)));
  file->Write(payload);
  return file->Commit();
}

tl::expected<BrickField, FileError> ReadSweptField(const std::filesystem::path& path,
                                                   const BrickLayout& layout) {
  const auto file = MappedFile::Open(path);
  if (!file) return tl::make_unexpected(file.error());
  const std::span<const std::byte> bytes = file->bytes();
  // The error for a value at a byte of the file.
  const auto refuse = [&](std::uint64_t byte, const std::string& where, const std::string& found,
                          const std::string& accepted) {
    return tl::make_unexpected(
        FileError{.file = path.string(), .byte = byte, .where = where, .found = found, .accepted = accepted});
  };
  SweptHeader header;
  const SweptHeader expected_header = HeaderOf(layout);
  const std::size_t count = layout.Count();
  if (bytes.size() < sizeof header + count)
    return refuse(bytes.size(), "the end", fmt::format("{} bytes", bytes.size()),
                  fmt::format("at least {}", sizeof header + count));
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != expected_header.magic) return refuse(0, "magic", "another kind of file", "OSTSWEPT");
  if (header.version != expected_header.version)
    return refuse(8, "version", std::to_string(header.version), std::to_string(expected_header.version));
  if (header.origin_mm != expected_header.origin_mm || header.voxel_mm != expected_header.voxel_mm ||
      header.bricks != expected_header.bricks)
    return refuse(16, "grid",
                  fmt::format("{} × {} × {} bricks of {} mm", header.bricks[0], header.bricks[1],
                              header.bricks[2], header.voxel_mm),
                  fmt::format("this bone's and tool's {} × {} × {} of {} mm", layout.bricks[0],
                              layout.bricks[1], layout.bricks[2], layout.voxel_mm));
  const std::size_t size = sizeof header + count + header.with_values * kValueBytes;
  if (bytes.size() != size)
    return refuse(44, "bricks with values", std::to_string(header.with_values),
                  fmt::format("as many as {} bytes hold", bytes.size()));
  if (const std::uint32_t crc = Crc(bytes.subspan(sizeof header)); crc != header.payload_crc)
    return refuse(12, "checksum", fmt::format("{:08x}", header.payload_crc), fmt::format("{:08x}", crc));

  // read the bricks, each by its kind of content
  BrickField swept(layout.Count(), BrickField::kAllLow);
  std::size_t at = sizeof header + count;
  for (BrickIndex brick = 0; brick < layout.Count(); ++brick) {
    const auto content = static_cast<std::uint8_t>(bytes[sizeof header + brick]);
    if (content > kValues)
      return refuse(sizeof header + brick, fmt::format("brick {}", brick), std::to_string(content), "0 … 2");
    if (content == kEverything) swept.MakeUniform(brick, BrickField::kAllHigh);
    if (content != kValues) continue;
    if (at + kValueBytes > size)
      return refuse(44, "bricks with values", std::to_string(header.with_values), "as many as are marked");
    std::int16_t* values = swept.MakeValues(brick);
    std::memcpy(values, bytes.data() + at, kValueBytes);
    for (int i = 0; i < kBrickNodes; ++i)
      if (values[i] < -kFieldLimit || values[i] > kFieldLimit)
        return refuse(at + sizeof(std::int16_t) * static_cast<std::size_t>(i),
                      fmt::format("brick {}, node {}", brick, i), std::to_string(values[i]),
                      fmt::format("-{0} … {0}", kFieldLimit));
    at += kValueBytes;
  }
  if (at != size)
    return refuse(44, "bricks with values", std::to_string(header.with_values), "as many as are marked");
  return swept;
}

}  // namespace osteon::surface
