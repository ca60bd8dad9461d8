#pragma once

// Inside gpu only: what the sources of the engine share. engine_setup.cpp makes it, engine_frame.cpp prepares
// and runs a frame, engine_solution.cpp reads what it found, vulkan_engine.cpp is what others see.

#include <algorithm>
#include <cstring>
#include <optional>

#include "gpu/cluster_tree.h"
#include "gpu/frame_program.h"
#include "gpu/shaders/bin_key.h"
#include "gpu/split_pool.h"
#include "gpu/tool_layout.h"
#include "gpu/vulkan_engine.h"
#include "gpu/work_list.h"
#include "simulation/contact_law.h"
#include "simulation/cutting_math.h"
#include "simulation/frame_solution.h"

namespace osteon::gpu {

static_assert(kMaxMaterials == simulation::kMaxMaterials && kBins == simulation::kContactBins &&
              kCuttingBinCount == simulation::kCuttingBins && kRemembered == simulation::kRememberedPairs &&
              kFaces == simulation::kMaxFaces && kCandidates == kBins + kRemembered);

inline constexpr double kMillimetres = 1e3;
inline constexpr double kLargestSummand =
    4'194'304.0;  // 2^22 units: half of what a sum over a subgroup can take
// of a face's weights: the largest lens in the middle of its cone
inline constexpr double kLargestFaceWeight_mm3 =
    simulation::kLargestLensVolume * 1e9 * (1.0 - simulation::kFaceCosine) * (1.0 - simulation::kFaceCosine);
// How long a lost device may go on with what it was given.
inline constexpr std::uint64_t kLostTimeout_ns = 20'000'000'000;
inline constexpr std::uint64_t kWarmUpTimeout_ns =
    120'000'000'000;  // software drivers compile a pass when it first runs
inline constexpr std::uint64_t kBruteTimeout_ns =
    900'000'000'000;  // every pair in every pass: a measurement, no product
// What floats may make of a distance: eight units in the last place of the places' own size, and, along a way
// that is long beside the balls, of its square over the sum of radii.
inline constexpr double kPlaceRounding = 0x1p-21, kWayRounding = 4e-7;
// How far the tool may move before the lists of live balls and points are made anew. Balls that do not cut
// are mostly far from bone, so a wide margin costs nothing.
// A software driver makes their words anew beyond this drift; a GPU has no use for that.
inline constexpr float kWordDrift_mm = 0.03f;
inline constexpr double kCuttingMargin_m = 0.15e-3, kShaftMargin_m = 0.6e-3;
// Room for what the tool can meet: tool balls of all entries of the lists, tool balls of all clusters.
inline constexpr std::size_t kSpans = 4'000'000, kToolRefs = 1'000'000;

inline std::size_t ClusterCount(std::size_t count) { return (count + kGroupSize - 1) / kGroupSize; }

inline vec4 ToMillimetres(const Vector3& v, double w) {
  return {static_cast<float>(v.x() * kMillimetres), static_cast<float>(v.y() * kMillimetres),
          static_cast<float>(v.z() * kMillimetres), static_cast<float>(w)};
}
inline vec4 Unscaled(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0.0f};
}
inline Vector3 Direction(const vec4& v) { return {v.x, v.y, v.z}; }
inline Vector3 ToMetres(const vec4& v) { return Direction(v) / kMillimetres; }

inline dvec3 Exactly(const Vector3& v) {
  return {v.x() * kMillimetres, v.y() * kMillimetres, v.z() * kMillimetres};
}
inline Vector3 Direction(const dvec3& v) { return {v.x, v.y, v.z}; }
inline Vector3 ToMetres(const dvec3& v) { return Direction(v) / kMillimetres; }
// What ToMillimetres leaves. Volatile, since GCC 12.2 takes the rounding away where it sees both, in some
// builds.
inline vec4 Rest(const Vector3& v_m, double w_m, const vec4& rounded) {
  const volatile float x = rounded.x, y = rounded.y, z = rounded.z, w = rounded.w;
  const dvec3 v = Exactly(v_m);
  return {static_cast<float>(v.x - static_cast<double>(x)), static_cast<float>(v.y - static_cast<double>(y)),
          static_cast<float>(v.z - static_cast<double>(z)),
          static_cast<float>(w_m * kMillimetres - static_cast<double>(w))};
}

inline double Total(const Sum& sum, double scale) {
  return (sum.high * 65536.0 + static_cast<double>(sum.low)) / scale;
}

// Balls lie in two buffers, since a binding holds so many only.
inline void WriteBalls(const FrameProgram& program, const void* data, std::size_t count) {
  const std::size_t first = std::min<std::size_t>(count, kBallsPerBuffer);
  program.Write(kBindBalls, data, first * sizeof(vec4));
  program.Write(kBindMoreBalls, static_cast<const vec4*>(data) + first, (count - first) * sizeof(vec4));
}
inline void ReadBalls(const FrameProgram& program, void* data, std::size_t count) {
  const std::size_t first = std::min<std::size_t>(count, kBallsPerBuffer);
  program.Read(kBindBalls, data, first * sizeof(vec4));
  program.Read(kBindMoreBalls, static_cast<vec4*>(data) + first, (count - first) * sizeof(vec4));
}

inline vec4 PointFloats(const simulation::MassPoint& point) {
  return ToMillimetres(point.p_m, point.volume_m3 * 1e9);
}

struct VulkanEngine::Impl {
  std::unique_ptr<FrameProgram> program;
  ToolLayout tool;
  std::vector<uint> device_tool;  // by the tool's own numbers
  double lever_m{0.0};
  std::vector<simulation::Material> materials;
  simulation::MaterialMap map{simulation::Bone{}};
  Pose X_WG;
  simulation::CuttingParams params;
  simulation::FrameMemory memory;
  std::size_t ball_count{0}, point_count{0};
  std::optional<SplitPool> pool;  // of balls that are split
  std::size_t ball_clusters{0};   // with those of the pool
  double unit_mm3{1.0};
  // the largest coordinate of a tool ball that can touch; the least tool ball
  double extent_m{0.0}, least_radius_m{1.0};
  bool lost{false}, brute_force{false};
  std::uint64_t frame_timeout_ns{0};
  FrameStats stats;
  simulation::NearField near;  // of the last frame: its faces alone
  simulation::Candidates candidates;

  Frame still{};  // what does not change from frame to frame
  ClusterTree ball_tree, point_tree;
  std::unique_ptr<WorkList> work;
  std::vector<Item> ball_items, point_items;
  std::vector<BallSweep> group_sweeps, ball_sweeps;

  // the lists that lie on the device, as the last frame that made them left them
  struct Lists {
    bool made{false};
    float ball_reach_mm{0.0f}, point_reach_mm{0.0f};
    uint balls{0}, points{0}, shaft{0}, spans{0}, longest_span{1};
    std::vector<Vector3> built_m;  // the tool's balls where they were made
    std::vector<Vector3> words_m;  // and where their words were
  } lists;
  bool was_free{true};                        // the last frame met nothing
  Pose X_GT;                                  // the tool's, this frame
  std::vector<Vector3> start_m, goal_m;       // of the tool's balls, this frame
  std::vector<vec4> placed;                   // the same for the device: in floats, then what they leave
  std::vector<simulation::Capsule> capsules;  // that its cutting balls have swept, where balls are split

  std::string Open(std::unique_ptr<Context> context, const simulation::Bone& bone,
                   const VulkanParams& vulkan);
  void Upload(const simulation::Bone& bone);
  void FillStill(const simulation::Bone& bone);
  void ListEverything();
  bool WarmUp(const simulation::Bone& bone);
  void Place(const Pose& pose);
  [[nodiscard]] Frame Prepare(const simulation::FrameInput& input);
  void FindWork(Frame& f, FrameMode mode);
  bool RunFrame(const Frame& prepared, FrameMode mode);
  void SetUploads(Frame& f) const;
  void EndSplits(const Frame& done, const simulation::FrameSolution& solution);
  // of the device's list
  [[nodiscard]] std::size_t AllBalls() const { return pool ? pool->ball_count() : ball_count; }
  [[nodiscard]] std::span<Block> Blocks() const {
    return {program->host<Block>(kBindBlocks), pool->block_count()};
  }
  // the tool ball that touches first is the only one that cuts
  [[nodiscard]] bool CutsAlone() const { return params.cutters == simulation::Cutters::kContactSphere; }
  void MeasureDrift(Frame& f) const;
  [[nodiscard]] float FarthestFrom(const std::vector<Vector3>& was_m, const std::vector<Vector3>& is_m,
                                   bool cuts) const;
  [[nodiscard]] uint Chunk(std::size_t entries, std::size_t span) const;
  [[nodiscard]] Groups Work(std::size_t entries, uint chunk, uint rows) const;
  void SetFlush(Frame& f) const;
  // the words of spans that hold all tool balls of a kind: those that cut, then the others; spans begin at
  // multiples of 4
  [[nodiscard]] std::ptrdiff_t FirstOfShaftSpan() const {
    return static_cast<std::ptrdiff_t>((tool.cutter_count + 3) / 4 * 4);
  }
  [[nodiscard]] std::size_t WholeSpans() const {
    return (static_cast<std::size_t>(FirstOfShaftSpan()) + tool.balls.size() - tool.cutter_count + 3) / 4 * 4;
  }
  [[nodiscard]] bool Flush() const;  // false where the device is lost
  void ReadState(simulation::CarvedState& state) const;
  void WriteState(const simulation::CarvedState& state);
  // a tool ball of the tool's own list; none for a number that is not in it
  [[nodiscard]] uint DeviceTool(uint number) const {
    return number < device_tool.size() ? device_tool[number] : still.tool_count;
  }
  void ReadNearField(const Frame& done, double s);
  [[nodiscard]] simulation::FrameSolution Solution(const Frame& done);
  simulation::ContactModel Step(const simulation::FrameInput& input);
};
}  // namespace osteon::gpu
