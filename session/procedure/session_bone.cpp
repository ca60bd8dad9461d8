#include "session/procedure/session_bone.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/mapped_file.h"
#include "base/write_text.h"
#include "config/reading/load_surgical_plan.h"
#include "config/reading/strict/config_error.h"
#include "io/recording/recording_reader.h"
#include "session/planning/planned_cell.h"
#include "session/planning/recorded_packing.h"
#include "session/procedure/session_file.h"
#include "simulation/bone/scenes.h"
#include "simulation/engine/state_hash.h"
#include "simulation/files/carved_file.h"

namespace osteon::session {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, 8> kBoneMagic{'O', 'S', 'T', 'B', 'O', 'N', 'E', '1'};  // first bytes of a file
constexpr std::size_t kBallNumbers = 4, kPointNumbers = 5;  // number of doubles of a ball, of a mass point
constexpr std::uint64_t kMaxItems = 1ull << 32;             // a file with more balls or points is refused

// The head of the file. The doubles of the balls and of the mass points follow.
struct BoneHeader {
  std::array<char, 8> magic{kBoneMagic};
  std::array<char, 16> checksum{};  // TextChecksum of the doubles
  std::uint64_t balls{0}, points{0};
};

// Returns the 16 digits of TextChecksum.
std::array<char, 16> ChecksumOf(const std::string& numbers) {
  std::array<char, 16> digits{};
  const std::string text = TextChecksum(numbers);
  std::memcpy(digits.data(), text.data(), std::min(text.size(), digits.size()));
  return digits;
}

}  // namespace

tl::expected<void, std::string> WriteSessionBone(const std::filesystem::path& folder,
                                                 const simulation::Bone& bone) {
  std::vector<double> numbers;
  numbers.reserve(kBallNumbers * bone.balls.size() + kPointNumbers * bone.points.size());
  for (const simulation::Ball& ball : bone.balls)
    numbers.insert(numbers.end(), {ball.center_m.x, ball.center_m.y, ball.center_m.z, ball.radius_m});
  for (const simulation::MassPoint& point : bone.points)
    numbers.insert(numbers.end(), {point.p_m.x, point.p_m.y, point.p_m.z, point.volume_m3,
                                   static_cast<double>(point.material)});
  const std::string bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
  const BoneHeader header{
      .checksum = ChecksumOf(bytes), .balls = bone.balls.size(), .points = bone.points.size()};
  return base::WriteText(folder / kSessionBoneName,
                         std::string(reinterpret_cast<const char*>(&header), sizeof header) + bytes);
}

tl::expected<simulation::CarvedState, std::string> ReadSessionState(const std::filesystem::path& folder,
                                                                    const SessionFile& session,
                                                                    const std::string& name,
                                                                    const simulation::Bone& bone) {
  auto state = simulation::ReadCarvedState(folder / name, bone);
  if (!state) return tl::make_unexpected(state.error().Text());
  const auto pass = std::ranges::find(session.passes, name, &SessionPass::state);
  const std::string found = simulation::HashText(*state);
  if (pass == session.passes.end() || pass->state_hash.empty() || pass->state_hash == found)
    return std::move(*state);
  return tl::make_unexpected(fmt::format("{}: found a state of {}, accepted that of {} after pass {}",
                                         (folder / name).string(), found, pass->state_hash, pass->number));
}

std::optional<PackedBone> ReadSessionBone(const std::filesystem::path& folder) {
  const auto file = simulation::MappedFile::Open(folder / kSessionBoneName);
  if (!file || file->bytes().size() < sizeof(BoneHeader)) return std::nullopt;
  BoneHeader header;
  std::memcpy(&header, file->bytes().data(), sizeof header);
  if (header.magic != kBoneMagic || header.balls > kMaxItems || header.points > kMaxItems)
    return std::nullopt;
  const std::uint64_t count = kBallNumbers * header.balls + kPointNumbers * header.points;
  if (file->bytes().size() != sizeof header + count * sizeof(double)) return std::nullopt;
  const auto payload = file->bytes().subspan(sizeof header);
  if (ChecksumOf({reinterpret_cast<const char*>(payload.data()), payload.size()}) != header.checksum)
    return std::nullopt;
  std::vector<double> numbers(count);
  std::memcpy(numbers.data(), payload.data(), payload.size());
  PackedBone bone;
  const double* at = numbers.data();
  bone.balls.reserve(header.balls);
  for (std::uint64_t i = 0; i < header.balls; ++i, at += kBallNumbers)
    bone.balls.push_back({.center_m = {at[0], at[1], at[2]}, .radius_m = at[3]});
  bone.points.reserve(header.points);
  for (std::uint64_t i = 0; i < header.points; ++i, at += kPointNumbers) {
    if (!(at[4] >= 0.0 && at[4] <= std::numeric_limits<simulation::MaterialIndex>::max()))
      return std::nullopt;
    bone.points.push_back({.p_m = {at[0], at[1], at[2]},
                           .volume_m3 = at[3],
                           .material = static_cast<simulation::MaterialIndex>(at[4])});
  }
  return bone;
}

tl::expected<std::optional<MeshChoice>, std::string> MeshOfSession(const std::filesystem::path& recording) {
  const std::filesystem::path folder = recording.parent_path();
  const auto session = ReadSession(folder);
  if (!session) return tl::make_unexpected(session.error());
  if (session->mesh_file.empty()) return std::optional<MeshChoice>();
  std::error_code error;
  if (!std::filesystem::exists(session->mesh_file, error))
    return tl::make_unexpected(fmt::format("{}: found no file {}, accepted the session's bone where it lay",
                                           (folder / kSessionFileName).string(), session->mesh_file));
  MeshChoice mesh{.file = session->mesh_file, .scale = session->mesh_scale};
  try {
    mesh.cup = config::LoadSurgicalPlan(folder / session->plan_file).mesh_cup;
  } catch (const config::ConfigError& refused) {
    return tl::make_unexpected(std::string(refused.what()));
  }
  return std::optional(std::move(mesh));
}

tl::expected<CellSetup, std::string> SetUpSessionCell(const std::filesystem::path& recording) {
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return tl::make_unexpected(stream.error());
  if (const auto first = stream->Next(); !first) return tl::make_unexpected(first.error());
  const auto mesh = MeshOfSession(recording);
  if (!mesh) return tl::make_unexpected(mesh.error());
  auto setup = SetUpRecorded(stream->session, *mesh);
  if (!setup) return tl::make_unexpected(recording.string() + ": " + setup.error());
  if (auto kept = setup->solid ? ReadSessionBone(recording.parent_path()) : std::nullopt) {
    setup->bone =
        simulation::SceneBone({.name = setup->bone.name, .solid = setup->solid, .site = setup->bone.site},
                              setup->config.scene, std::move(kept->balls), std::move(kept->points));
    return setup;
  }
  const EngineChoice engine = ChooseEngine(stream->session.engine, "");
  const auto packed = stream->session.packing ? PackAsRecorded(*setup, stream->session.packing)
                                              : PackCell(*setup, {}, engine, false);
  if (!packed) return tl::make_unexpected(recording.string() + ": " + packed.error());
  return setup;
}

}  // namespace osteon::session
