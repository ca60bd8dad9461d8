#include "io/engine/engine_setup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <zlib.h>

#include "io/engine/byte_cursor.h"

namespace osteon::io {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{'O', 'S', 'T', 'E', 'N', 'S', 'E', 'T'};
constexpr std::uint32_t kVersion = 2;  // version of the format; version 1 had no edges
constexpr std::size_t kHeadBytes = kMagic.size() + 2 * sizeof(std::uint32_t);  // magic, version, CRC
constexpr std::size_t kMaxText = 4096;  // largest size of a name [bytes]
// Bound on coordinates and radii, far larger than any bone.
constexpr double kMax_m = 1e3;
// Largest difference between an element of R R^T and that of the identity.
constexpr double kMaxRotationError = 1e-6;
// Smallest size of an item of each list [bytes]; a material's name may be empty.
constexpr std::size_t kBallBytes = 32, kPointBytes = 33, kToolBallBytes = 34;
constexpr std::size_t kMaterialBytes = sizeof(std::uint32_t) + 6 * sizeof(double);

std::uint32_t Checksum(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

// Appends values to a growing list of bytes, little-endian.
class Output {
 public:
  template <class T>
  void Put(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof value);
  }
  void Put(const PlainVector3& v) {
    for (const double value : {v.x, v.y, v.z}) Put(value);
  }
  void Put(const std::string& text) {
    const std::string cut = text.substr(0, kMaxText);
    Put(static_cast<std::uint32_t>(cut.size()));
    bytes.insert(bytes.end(), cut.begin(), cut.end());
  }

  std::vector<std::uint8_t> bytes;
};

// Reads and checks values until the first error, and keeps that error. `what` names the value in the error.
class Input {
 public:
  explicit Input(std::span<const std::uint8_t> bytes) : reader_(bytes) {}

  template <class T>
  T Take(const char* what) {
    const T value = reader_.Get<T>();
    if (!reader_.ok()) Refuse(fmt::format("{}: found the end of the bytes, accepted a value", what));
    return value;
  }
  // Reads a number in the range [min, max]; refuses NaN.
  double Number(const char* what, double min, double max) {
    const auto value = Take<double>(what);
    if (!(value >= min && value <= max))
      Refuse(fmt::format("{}: found {:g}, accepted {:g} … {:g}", what, value, min, max));
    return value;
  }
  // Reads three coordinates, each with a magnitude of at most kMax_m.
  PlainVector3 Point(const char* what) {
    PlainVector3 p;
    for (double* value : {&p.x, &p.y, &p.z}) *value = Number(what, -kMax_m, kMax_m);
    return p;
  }
  bool Flag(const char* what) { return Word(what, 2) == 1; }
  // Reads a byte in the range 0 … values - 1.
  std::uint8_t Word(const char* what, int values) {
    const auto value = Take<std::uint8_t>(what);
    if (value >= values) Refuse(fmt::format("{}: found {}, accepted 0 … {}", what, value, values - 1));
    return value;
  }
  std::string Text(const char* what) {
    const auto size = Take<std::uint32_t>(what);
    if (size > kMaxText) Refuse(fmt::format("{}: found {} bytes, accepted up to {}", what, size, kMaxText));
    if (!ok()) return "";
    const auto bytes = reader_.GetBytes(size);
    if (!reader_.ok()) Refuse(fmt::format("{}: found the end of the bytes, accepted {} more", what, size));
    return {bytes.begin(), bytes.end()};
  }
  /// Reads the number of items that follow, each of `bytes_each` bytes. If too few bytes are left for that
  /// number of items, it is refused, so that no memory is allocated for them.
  std::size_t Count(const char* what, std::size_t min, std::size_t bytes_each) {
    const auto count = Take<std::uint64_t>(what);
    if (count < min || count > reader_.left() / bytes_each)
      Refuse(fmt::format("{}: found {}, accepted {} … {}, which the bytes hold", what, count, min,
                         reader_.left() / bytes_each));
    return ok() ? static_cast<std::size_t>(count) : 0;
  }
  // Stores the error, unless there is an earlier one.
  void Refuse(std::string wrong) {
    if (wrong_.empty()) wrong_ = std::move(wrong);
  }
  [[nodiscard]] bool ok() const { return wrong_.empty(); }
  [[nodiscard]] const std::string& wrong() const { return wrong_; }
  [[nodiscard]] std::size_t left() const { return reader_.left(); }

 private:
  ByteReader reader_;
  std::string wrong_;
};

// PutX and TakeX write and read the same fields in the same order.

PlainPose TakePose(Input& in) {
  PlainPose X;
  for (double& element : X.R) element = in.Number("bone's pose", -1.0 - 1e-9, 1.0 + 1e-9);
  X.p = in.Point("bone's pose");
  const Pose pose = X;
  const Matrix3 error = pose.linear() * pose.linear().transpose() - Matrix3::Identity();
  if (in.ok() && (error.cwiseAbs().maxCoeff() > kMaxRotationError || pose.linear().determinant() < 0.0))
    in.Refuse("bone's pose: found a matrix that is no rotation, accepted a rotation");
  return X;
}

void PutCutting(Output& out, const simulation::CuttingParams& c) {
  for (const double value : {c.stiffness_N_per_m, c.max_force_N, c.normal_enlargement_m,
                             c.contact_tolerance_m, c.max_slide_m, c.engaged_layer_m})
    out.Put(value);
  out.Put(c.law);
  out.Put(c.cutters);
  out.Put(static_cast<std::uint8_t>(c.edge_force ? 1 : 0));
  out.Put(static_cast<std::uint8_t>(c.split.on ? 1 : 0));
  out.Put(c.split.min_radius_m);
  out.Put(static_cast<std::int32_t>(c.split.children));
  out.Put(c.split.min_child_share);
  out.Put(static_cast<std::uint64_t>(c.split.pool_blocks));
  out.Put(static_cast<std::uint64_t>(c.split.blocks_per_frame));
}

simulation::CuttingParams TakeCutting(Input& in) {
  simulation::CuttingParams c;
  c.stiffness_N_per_m = in.Number("stiffness", 1.0, 1e7);
  c.max_force_N = in.Number("largest force", 1e-3, 1e5);
  for (double* length : {&c.normal_enlargement_m, &c.contact_tolerance_m, &c.max_slide_m, &c.engaged_layer_m})
    *length = in.Number("length of the cutting model", 1e-9, 1.0);
  c.law = static_cast<simulation::RemovalLaw>(in.Word("removal law", 2));
  c.cutters = static_cast<simulation::Cutters>(in.Word("cutters", 2));
  c.edge_force = in.Flag("edge force");
  c.split.on = in.Flag("split");
  c.split.min_radius_m = in.Number("split: radius", 0.0, 1.0);
  c.split.children = in.Take<std::int32_t>("split: children");
  c.split.min_child_share = in.Number("split: share", 0.0, 0.5);
  c.split.pool_blocks = in.Take<std::uint64_t>("split: blocks");
  c.split.blocks_per_frame = in.Take<std::uint64_t>("split: blocks a frame");
  if (c.split.children < 8 || c.split.children > 1024 || c.split.pool_blocks < 1 ||
      c.split.pool_blocks > 1'000'000 || c.split.blocks_per_frame > 1'000'000)
    in.Refuse("split: found counts out of range, accepted 8 … 1024 children and 1 … 1000000 blocks");
  return c;
}

void PutBone(Output& out, const simulation::Bone& bone) {
  out.Put(bone.name);
  out.Put(bone.site.center_m);
  out.Put(bone.site.axis);
  out.Put(bone.site.radius_m);
  out.Put(static_cast<std::uint64_t>(bone.materials.size()));
  for (const simulation::Material& m : bone.materials) {
    out.Put(m.name);
    for (const double figure : {m.density_kg_per_m3, m.specific_cutting_energy_J_per_m3,
                                m.cutting_force_ratio, m.friction, m.edge_force_N_per_m, m.measured_chip_m})
      out.Put(figure);
  }
  out.Put(static_cast<std::uint64_t>(bone.balls.size()));
  for (const simulation::Ball& ball : bone.balls) {
    out.Put(ball.center_m);
    out.Put(ball.radius_m);
  }
  out.Put(static_cast<std::uint64_t>(bone.points.size()));
  for (const simulation::MassPoint& point : bone.points) {
    out.Put(point.p_m);
    out.Put(point.volume_m3);
    out.Put(point.material);
  }
}

simulation::Bone TakeBone(Input& in) {
  simulation::Bone bone;
  bone.name = in.Text("bone's name");
  bone.site.center_m = in.Point("site");
  bone.site.axis = in.Point("site's axis");
  bone.site.radius_m = in.Number("site's radius", 0.0, kMax_m);
  bone.materials.resize(in.Count("materials", 1, kMaterialBytes));
  for (simulation::Material& m : bone.materials) {
    m.name = in.Text("material's name");
    for (double* figure : {&m.density_kg_per_m3, &m.specific_cutting_energy_J_per_m3, &m.cutting_force_ratio,
                           &m.friction, &m.edge_force_N_per_m, &m.measured_chip_m})
      *figure = in.Number("material's figure", 0.0, 1e15);
    if (!in.ok()) return bone;
  }
  try {
    if (in.ok()) simulation::CheckMaterials(bone.materials);
  } catch (const std::invalid_argument& error) {
    in.Refuse(error.what());
  }
  bone.balls.resize(in.Count("balls", 1, kBallBytes));
  for (simulation::Ball& ball : bone.balls) {
    ball.center_m = in.Point("ball");
    ball.radius_m = in.Number("ball's radius", 1e-9, kMax_m);
  }
  bone.points.resize(in.Count("mass points", 0, kPointBytes));
  for (simulation::MassPoint& point : bone.points) {
    point.p_m = in.Point("mass point");
    point.volume_m3 = in.Number("mass point's volume", 0.0, kMax_m);
    point.material = in.Word("mass point's material", static_cast<int>(bone.materials.size()));
    if (!in.ok()) return bone;
  }
  return bone;
}

void PutTool(Output& out, const simulation::Tool& tool) {
  out.Put(tool.name);
  out.Put(static_cast<std::uint64_t>(tool.balls.size()));
  for (const simulation::ToolBall& ball : tool.balls) {
    out.Put(ball.center_m);
    out.Put(ball.radius_m);
    out.Put(static_cast<std::uint8_t>(ball.cutting ? 1 : 0));
    out.Put(ball.edges);
  }
}

simulation::Tool TakeTool(Input& in) {
  simulation::Tool tool;
  tool.name = in.Text("tool's name");
  tool.balls.resize(in.Count("tool's balls", 1, kToolBallBytes));
  for (simulation::ToolBall& ball : tool.balls) {
    ball.center_m = in.Point("tool's ball");
    ball.radius_m = in.Number("tool's ball's radius", 1e-9, kMax_m);
    ball.cutting = in.Flag("tool's ball's cutting");
    ball.edges = in.Take<std::uint8_t>("tool's ball's edges");
    if (!in.ok()) return tool;
  }
  return tool;
}

}  // namespace

std::vector<std::uint8_t> EncodeSetup(const EngineSetup& setup) {
  Output out;
  out.bytes.assign(kMagic.begin(), kMagic.end());
  out.Put(kVersion);
  out.Put(std::uint32_t{0});
  for (const double element : setup.X_WG.R) out.Put(element);
  out.Put(setup.X_WG.p);
  PutCutting(out, setup.cutting);
  PutTool(out, setup.tool);
  PutBone(out, setup.bone);
  const std::uint32_t crc = Checksum(std::span(out.bytes).subspan(kHeadBytes));
  std::memcpy(out.bytes.data() + kHeadBytes - sizeof crc, &crc, sizeof crc);
  return std::move(out.bytes);
}

tl::expected<EngineSetup, std::string> DecodeSetup(std::span<const std::uint8_t> bytes) {
  const auto refuse = [](std::string what) {
    return tl::make_unexpected("engine's set-up: " + std::move(what));
  };
  if (bytes.size() < kHeadBytes)
    return refuse(fmt::format("found {} bytes, accepted {} and more", bytes.size(), kHeadBytes));
  if (!std::equal(kMagic.begin(), kMagic.end(), bytes.begin()))
    return refuse("found other first bytes, accepted \"OSTENSET\"");
  ByteReader head(bytes.subspan(kMagic.size()));
  if (const auto version = head.Get<std::uint32_t>(); version != kVersion)
    return refuse(fmt::format("found version {}, accepted {}", version, kVersion));
  if (head.Get<std::uint32_t>() != Checksum(bytes.subspan(kHeadBytes)))
    return refuse("found another checksum than its bytes', accepted unchanged bytes");
  Input in(bytes.subspan(kHeadBytes));
  EngineSetup setup;
  setup.X_WG = TakePose(in);
  if (in.ok()) setup.cutting = TakeCutting(in);
  if (in.ok()) setup.tool = TakeTool(in);
  if (in.ok()) setup.bone = TakeBone(in);
  if (in.ok() && in.left() > 0) in.Refuse(fmt::format("found {} bytes too many, accepted none", in.left()));
  if (!in.ok()) return refuse(in.wrong());
  return setup;
}

}  // namespace osteon::io
