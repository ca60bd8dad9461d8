#include "simulation/packing/packing_export.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/output_file.h"

namespace osteon::simulation {
namespace {

using Record = std::array<float, 4>;  // x, y, z, radius [mm]
static_assert(sizeof(Record) == 16);

Record ToRecord(const Ball& ball) {
  const Vector3 p = Vector3(ball.center_m) * 1e3;
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
          static_cast<float>(ball.radius_m * 1e3)};
}

/// Number of balls that are formatted and written together.
constexpr std::size_t kBallsPerWrite = 1 << 16;

}  // namespace

tl::expected<void, FileError> WritePly(const std::filesystem::path& path, std::span<const Ball> balls) {
  auto file = OutputFile::Create(path);
  if (!file) return tl::make_unexpected(file.error());
  file->Write(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment balls of a packing, in millimetres\n"
                  "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float "
                  "radius\nend_header\n",
                  balls.size()));
  std::vector<Record> records;
  for (std::size_t i = 0; i < balls.size(); i += kBallsPerWrite) {
    const auto part = balls.subspan(i, std::min(kBallsPerWrite, balls.size() - i));
    records.clear();
    std::ranges::transform(part, std::back_inserter(records), ToRecord);
    file->Write(std::as_bytes(std::span(records)));
  }
  return file->Commit();
}

tl::expected<void, FileError> WriteCsv(const std::filesystem::path& path, std::span<const Ball> balls) {
  auto file = OutputFile::Create(path);
  if (!file) return tl::make_unexpected(file.error());
  file->Write("x_mm,y_mm,z_mm,r_mm\n");
  std::string text;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Record r = ToRecord(balls[i]);
    fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", r[0], r[1], r[2], r[3]);
    if (i % kBallsPerWrite != kBallsPerWrite - 1 && i + 1 != balls.size()) continue;
    file->Write(text);
    text.clear();
  }
  return file->Commit();
}

}  // namespace osteon::simulation
