#include "simulation/files/carved_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "base/mapped_file.h"
#include "base/output_file.h"
#include "simulation/contact/constrained_goal.h"

namespace osteon::simulation {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, kCarvedMagic.size()> Magic() {
  std::array<char, kCarvedMagic.size()> bytes{};
  std::ranges::copy(kCarvedMagic, bytes.begin());
  return bytes;
}
constexpr std::uint32_t kVersion = 1;
// largest coordinate: a float resolves it to better than a tenth of a millimetre
constexpr double kReach_mm = 1e6;

/// The header: the first bytes of the file, stored as this struct lies in memory. CarvedState describes the
/// values.
struct CarvedHeader {
  std::array<char, kCarvedMagic.size()> magic{Magic()};
  std::uint32_t version{kVersion};
  std::uint32_t header_size{0};
  std::uint64_t file_size{0};
  std::uint64_t bone{0};  ///< fingerprint of the uncut bone
  std::uint64_t balls{0}, points{0}, split_balls{0}, slots{0};
  std::uint64_t frame{0};
  std::array<double, 9> R_GP{};
  std::array<double, 3> p_GP_m{};
  double removed_volume_m3{0.0}, removed_mass_kg{0.0}, cutting_work_J{0.0}, cutting_debt_J{0.0};
  std::array<double, 12> face_n_G{};
  double friction{0.0};
  std::array<std::uint32_t, 16> pairs{};  ///< indices in turn: a bone ball, a tool ball, …
  std::uint32_t pair_count{0}, face_count{0}, held_count{0};
  std::uint32_t has_proxy{0};
  std::uint32_t payload_crc{0};
  std::uint32_t header_crc{0};  ///< of all bytes before it
};
static_assert(sizeof(CarvedHeader) == 392 && offsetof(CarvedHeader, R_GP) == 72 &&
              offsetof(CarvedHeader, has_proxy) == 380);
static_assert(kMaxFaces == 4 && kRememberedPairs == 8);

/// Continues the CRC-32 `crc` over more bytes; pass 0 in the first call.
std::uint32_t Crc(std::uint32_t crc, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const Bytef*>(data);
  while (size > 0) {  // zlib takes sizes of 32 bits
    const auto part = static_cast<uInt>(std::min<std::size_t>(size, 1u << 30));
    crc = static_cast<std::uint32_t>(crc32(crc, bytes, part));
    bytes += part;
    size -= part;
  }
  return crc;
}

/// Fingerprint of a bone: the CRCs of its balls and of its mass points. The numbers of balls and points are
/// in the header.
std::uint64_t Fingerprint(const Bone& bone) {
  std::uint32_t balls = 0, points = 0;
  for (const Ball& b : bone.balls) {
    const std::array<double, 4> values{b.center_m.x, b.center_m.y, b.center_m.z, b.radius_m};
    balls = Crc(balls, values.data(), sizeof(values));
  }
  for (const MassPoint& p : bone.points) {
    const std::array<double, 5> values{p.p_m.x, p.p_m.y, p.p_m.z, p.volume_m3,
                                       static_cast<double>(p.material)};
    points = Crc(points, values.data(), sizeof(values));
  }
  return std::uint64_t{balls} << 32 | points;
}

/// Bytes of the mass points, rounded up to a multiple of 4.
std::uint64_t Padded(std::uint64_t points) { return (points + 3) / 4 * 4; }

/// Size of a file with the header's counts; nothing if no memory could hold it.
std::optional<std::uint64_t> FileSize(const CarvedHeader& h) {
  constexpr std::uint64_t kMax = std::uint64_t{1} << 32;
  if (h.balls > kMax || h.points > kMax || h.split_balls > h.balls || h.slots > 1024) return {};
  return sizeof(CarvedHeader) + 16 * h.balls + Padded(h.points) + h.split_balls * (8 + 16 * h.slots);
}

/// Reads and checks a whole file. The first error is stored, and later ones are dropped.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::filesystem::path& path, const Bone& bone)
      : bytes_(bytes), path_(path), bone_(bone) {}

  tl::expected<CarvedState, FileError> Read() {
    CheckHeader();
    if (!error_) CheckPayload();
    if (error_) return tl::make_unexpected(*error_);
    return std::move(state_);
  }

 private:
  /// Stores an error at a byte of the file, unless an error is stored already.
  void Fail(std::uint64_t byte, std::string where, std::string found, std::string accepted) {
    if (!error_)
      error_ = FileError{.file = path_.string(),
                         .byte = byte,
                         .where = std::move(where),
                         .found = std::move(found),
                         .accepted = std::move(accepted)};
  }
  /// Stores an error unless a value of the header equals the accepted one.
  template <typename Value>
  void Expect(const Value& found, const Value& accepted, std::size_t byte, const char* where) {
    if (found != accepted) Fail(byte, where, fmt::format("{}", found), fmt::format("{}", accepted));
  }

  void CheckHeader() {
    const std::size_t size = bytes_.size();
    if (size < sizeof(header_))
      return Fail(size, "header", fmt::format("the end after {} bytes", size),
                  fmt::format("{} bytes and more", sizeof(header_)));
    std::memcpy(&header_, bytes_.data(), sizeof(header_));
    if (header_.magic != Magic()) return Fail(0, "magic", "other bytes", fmt::format("\"{}\"", kCarvedMagic));
    Expect(header_.version, kVersion, offsetof(CarvedHeader, version), "version");
    Expect(header_.header_size, static_cast<std::uint32_t>(sizeof(header_)),
           offsetof(CarvedHeader, header_size), "header's size");
    const std::size_t crc_at = offsetof(CarvedHeader, header_crc);
    Expect(header_.header_crc, Crc(0, bytes_.data(), crc_at), crc_at, "header's checksum");
    Expect(header_.file_size, std::uint64_t{size}, offsetof(CarvedHeader, file_size), "file's size");
    Expect(header_.balls, std::uint64_t{bone_.balls.size()}, offsetof(CarvedHeader, balls),
           "balls of the bone");
    Expect(header_.points, std::uint64_t{bone_.points.size()}, offsetof(CarvedHeader, points),
           "mass points of the bone");
    Expect(header_.bone, Fingerprint(bone_), offsetof(CarvedHeader, bone), "bone's fingerprint");
    const auto expected = FileSize(header_);
    if (!expected || *expected != size)
      Fail(offsetof(CarvedHeader, split_balls), "split balls and slots",
           fmt::format("{} of {} slots", header_.split_balls, header_.slots),
           fmt::format("what makes {} bytes in all", size));
    if (!error_) CheckTotals();
  }

  /// Checks and reads the state's values in the header: proxy, totals of the cut, contact memory.
  void CheckTotals() {
    const std::size_t pose_at = offsetof(CarvedHeader, R_GP);
    PlainPose pose;
    pose.R = header_.R_GP;
    pose.p = Vector3(header_.p_GP_m.data());
    const Pose X = pose;
    const Matrix3 deviation = X.linear() * X.linear().transpose() - Matrix3::Identity();
    if (!X.matrix().allFinite() || deviation.cwiseAbs().maxCoeff() > 1e-6 || X.linear().determinant() < 0.0)
      Fail(pose_at, "proxy", "no pose", "a rotation and a finite place");
    const std::array<double, 4> totals{header_.removed_volume_m3, header_.removed_mass_kg,
                                       header_.cutting_work_J, header_.cutting_debt_J};
    for (std::size_t i = 0; i < totals.size(); ++i)
      if (!std::isfinite(totals[i]) || (i < 3 && totals[i] < 0.0))
        Fail(offsetof(CarvedHeader, removed_volume_m3) + 8 * i, "totals", fmt::format("{}", totals[i]),
             i < 3 ? "0 and more" : "a finite number");
    CheckContact();
    if (header_.has_proxy > 1)
      Fail(offsetof(CarvedHeader, has_proxy), "proxy's flag", fmt::format("{}", header_.has_proxy), "0 or 1");
    state_.X_GP = pose;
    state_.has_proxy = header_.has_proxy == 1;
    state_.removed_volume_m3 = header_.removed_volume_m3;
    state_.removed_mass_kg = header_.removed_mass_kg;
    state_.cutting_work_J = header_.cutting_work_J;
    state_.cutting_debt_J = header_.cutting_debt_J;
    state_.frame = header_.frame;
  }

  /// Checks and reads the contact memory: pairs of touching balls. The index of a bone ball runs over the
  /// bone's balls first, and then over the slots of the split balls.
  void CheckContact() {
    ContactMemory& contact = state_.contact;
    if (header_.pair_count > kRememberedPairs)
      return Fail(offsetof(CarvedHeader, pair_count), "contact pairs", fmt::format("{}", header_.pair_count),
                  fmt::format("0 … {}", kRememberedPairs));
    if (header_.held_count > std::min<std::uint32_t>(header_.pair_count, kMaxHolding))
      return Fail(offsetof(CarvedHeader, held_count), "contact pairs that hold",
                  fmt::format("{}", header_.held_count),
                  fmt::format("{} at most", std::min<std::uint32_t>(header_.pair_count, kMaxHolding)));
    if (header_.face_count > kMaxFaces)
      return Fail(offsetof(CarvedHeader, face_count), "contact faces", fmt::format("{}", header_.face_count),
                  fmt::format("0 … {}", kMaxFaces));
    const std::uint64_t places = header_.balls + header_.slots * header_.split_balls;
    for (std::size_t i = 0; i < header_.pair_count; ++i) {
      contact.pairs[i] = {.bone_ball = header_.pairs[2 * i], .tool_ball = header_.pairs[2 * i + 1]};
      if (contact.pairs[i].bone_ball >= places)
        Fail(offsetof(CarvedHeader, pairs) + 8 * i, fmt::format("contact pair {}: ball", i),
             fmt::format("{}", contact.pairs[i].bone_ball), fmt::format("less than {}", places));
    }
    for (std::size_t i = 0; i < header_.face_count; ++i) {
      const Vector3 n(&header_.face_n_G[3 * i]);
      if (!n.allFinite() || n.norm() > 1.0 + 1e-6)
        Fail(offsetof(CarvedHeader, face_n_G) + 24 * i, fmt::format("contact face {}", i), "no direction",
             "a length of 1 at most");
      contact.face_n_G[i] = n;
    }
    if (!(header_.friction >= 0.0) || !std::isfinite(header_.friction))
      Fail(offsetof(CarvedHeader, friction), "friction", fmt::format("{}", header_.friction), "0 and more");
    contact.pair_count = static_cast<std::int32_t>(header_.pair_count);
    contact.face_count = static_cast<std::int32_t>(header_.face_count);
    contact.held_count = static_cast<std::int32_t>(header_.held_count);
    contact.friction = header_.friction;
  }

  /// Copies `count` values from byte `at` on, and moves `at` past them.
  template <typename Value>
  void Take(std::uint64_t& at, std::uint64_t count, std::vector<Value>& values) {
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), bytes_.data() + at, count * sizeof(Value));
    at += count * sizeof(Value);
  }

  /// Checks values in groups of four: x y z r. The slots of a ball that waits for its children hold capsules
  /// in the same form.
  void CheckFloats(const std::vector<float>& values, std::uint64_t at, const char* where) {
    for (std::size_t i = 0; i < values.size() && !error_; ++i) {
      const bool radius = i % 4 == 3;
      if (!(std::abs(values[i]) <= kReach_mm) || (radius && values[i] < 0.0f))
        Fail(at + 4 * i, fmt::format("{} {}: {}", where, i / 4, "xyzr"[i % 4]),
             fmt::format("{} mm", values[i]),
             radius ? fmt::format("0 … {:g} mm", kReach_mm) : fmt::format("-{0:g} … {0:g} mm", kReach_mm));
    }
  }

  /// Checks and reads the data after the header: balls, mass points, split balls.
  void CheckPayload() {
    const std::uint32_t crc =
        Crc(0, bytes_.data() + sizeof(CarvedHeader), bytes_.size() - sizeof(CarvedHeader));
    Expect(header_.payload_crc, crc, offsetof(CarvedHeader, payload_crc),
           "checksum of what follows the header");
    if (error_) return;
    std::uint64_t at = sizeof(CarvedHeader);
    Take(at, 4 * header_.balls, state_.balls);
    CheckFloats(state_.balls, at - 16 * header_.balls, "ball");
    const std::uint64_t cleared_at = at;
    Take(at, header_.points, state_.cleared);
    const auto odd = std::ranges::find_if(state_.cleared, [](std::uint8_t c) { return c > 1; });
    if (odd != state_.cleared.end())
      Fail(cleared_at + static_cast<std::uint64_t>(odd - state_.cleared.begin()), "mass point",
           fmt::format("{}", *odd), "0 or 1");
    for (std::uint64_t i = cleared_at + header_.points; i < cleared_at + Padded(header_.points); ++i)
      if (bytes_[i] != std::byte{0}) Fail(i, "padding", "another byte", "0");
    at = cleared_at + Padded(header_.points);
    const std::uint64_t split_at = at;
    Take(at, header_.split_balls, state_.split_balls);
    Take(at, header_.split_balls, state_.split_cuts);
    for (std::size_t j = 0; j < state_.split_balls.size(); ++j) {
      const std::uint64_t min_ball = j > 0 ? std::uint64_t{state_.split_balls[j - 1]} + 1 : 0;
      if (state_.split_balls[j] < min_ball || state_.split_balls[j] >= header_.balls)
        Fail(split_at + 4 * j, fmt::format("split ball {}", j), fmt::format("{}", state_.split_balls[j]),
             fmt::format("{} … {}", min_ball, header_.balls - 1));
      if (state_.split_cuts[j] > 0 && 1 + 2 * (std::uint64_t{state_.split_cuts[j]} - 1) > header_.slots)
        Fail(split_at + 4 * (header_.split_balls + j), fmt::format("split ball {}: capsules", j),
             fmt::format("{}", state_.split_cuts[j] - 1), fmt::format("what {} slots hold", header_.slots));
    }
    const std::uint64_t slots_at = at;
    Take(at, 4 * header_.slots * header_.split_balls, state_.split_slots);
    CheckFloats(state_.split_slots, slots_at, "slot");
  }

  std::span<const std::byte> bytes_;
  std::filesystem::path path_;
  const Bone& bone_;
  CarvedHeader header_;
  CarvedState state_;
  std::optional<FileError> error_;
};

}  // namespace

tl::expected<void, FileError> WriteCarvedState(const std::filesystem::path& path, const CarvedState& state,
                                               const Bone& bone) {
  const std::size_t split = state.split_balls.size(),
                    slots = split > 0 ? state.split_slots.size() / (4 * split) : 0;
  const auto refuse = [&](const char* where, std::size_t found, std::size_t accepted) {
    return tl::make_unexpected(FileError{.file = path.string(),
                                         .byte = {},
                                         .where = where,
                                         .found = fmt::format("{}", found),
                                         .accepted = fmt::format("{}, as the bone has", accepted)});
  };
  if (state.balls.size() != 4 * bone.balls.size())
    return refuse("balls of the state", state.balls.size() / 4, bone.balls.size());
  if (state.cleared.size() != bone.points.size())
    return refuse("mass points of the state", state.cleared.size(), bone.points.size());
  if (state.split_cuts.size() != split || state.split_slots.size() != 4 * split * slots)
    return refuse("split balls of the state", state.split_cuts.size(), split);

  CarvedHeader header;
  header.header_size = sizeof(header);
  header.bone = Fingerprint(bone);
  header.balls = bone.balls.size();
  header.points = bone.points.size();
  header.split_balls = split;
  header.slots = slots;
  header.frame = state.frame;
  header.R_GP = state.X_GP.R;
  header.p_GP_m = {state.X_GP.p.x, state.X_GP.p.y, state.X_GP.p.z};
  header.removed_volume_m3 = state.removed_volume_m3;
  header.removed_mass_kg = state.removed_mass_kg;
  header.cutting_work_J = state.cutting_work_J;
  header.cutting_debt_J = state.cutting_debt_J;
  header.has_proxy = state.has_proxy ? 1 : 0;
  const ContactMemory& contact = state.contact;
  header.pair_count = static_cast<std::uint32_t>(std::clamp(contact.pair_count, 0, kRememberedPairs));
  header.face_count = static_cast<std::uint32_t>(std::clamp(contact.face_count, 0, kMaxFaces));
  header.held_count = static_cast<std::uint32_t>(std::clamp(contact.held_count, 0, contact.pair_count));
  header.friction = contact.friction;
  for (std::size_t i = 0; i < header.pair_count; ++i) {
    header.pairs[2 * i] = contact.pairs[i].bone_ball;
    header.pairs[2 * i + 1] = contact.pairs[i].tool_ball;
  }
  for (std::size_t i = 0; i < header.face_count; ++i) {
    const PlainVector3& n = contact.face_n_G[i];
    header.face_n_G[3 * i] = n.x;
    header.face_n_G[3 * i + 1] = n.y;
    header.face_n_G[3 * i + 2] = n.z;
  }
  header.file_size = FileSize(header).value();
  const std::array<std::byte, 3> zeros{};
  const std::span padding(zeros.data(), Padded(header.points) - header.points);
  const std::array<std::span<const std::byte>, 6> parts{std::as_bytes(std::span(state.balls)),
                                                        std::as_bytes(std::span(state.cleared)),
                                                        padding,
                                                        std::as_bytes(std::span(state.split_balls)),
                                                        std::as_bytes(std::span(state.split_cuts)),
                                                        std::as_bytes(std::span(state.split_slots))};
  for (const auto& part : parts) header.payload_crc = Crc(header.payload_crc, part.data(), part.size());
  header.header_crc = Crc(0, &header, offsetof(CarvedHeader, header_crc));

  auto file = OutputFile::Create(path);
  if (!file) return tl::make_unexpected(file.error());
  file->Write(std::as_bytes(std::span(&header, 1)));
  for (const auto& part : parts) file->Write(part);
  return file->Commit();
}

tl::expected<CarvedState, FileError> ReadCarvedState(const std::filesystem::path& path, const Bone& bone) {
  const auto file = MappedFile::Open(path);
  if (!file) return tl::make_unexpected(file.error());
  return Reader(file->bytes(), path, bone).Read();
}

}  // namespace osteon::simulation
