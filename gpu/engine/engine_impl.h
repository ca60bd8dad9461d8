#pragma once

// For files of gpu/ only: shared by the engine's sources. engine_setup.cpp creates the engine,
// engine_frame.cpp prepares and runs a frame, engine_solution.cpp reads the result, and vulkan_engine.cpp is
// the public interface.

#include <algorithm>
#include <cstring>
#include <optional>

#include "gpu/engine/cluster_tree.h"
#include "gpu/engine/split_pool.h"
#include "gpu/engine/tool_layout.h"
#include "gpu/engine/vulkan_engine.h"
#include "gpu/engine/work_list.h"
#include "gpu/program/frame_program.h"
#include "gpu/shaders/bin_key.h"
#include "simulation/contact/contact_law.h"
#include "simulation/contact/cutting_math.h"
#include "simulation/engine/frame_solution.h"

namespace osteon::gpu {

static_assert(kMaxMaterials == simulation::kMaxMaterials && kBins == simulation::kContactBins &&
              kCuttingBinCount == simulation::kCuttingBins && kRemembered == simulation::kRememberedPairs &&
              kFaces == simulation::kMaxFaces && kCandidates == kBins + kRemembered);

inline constexpr double kMillimetres = 1e3;
// 2^22 units, half of the range that a sum over a subgroup allows for one summand
inline constexpr double kMaxSummand = 4'194'304.0;
// Largest weight of a contact in a face's sums: that of the largest lens, in the middle of the face's cone.
inline constexpr double kMaxFaceWeight_mm3 =
    simulation::kMaxLensVolume * 1e9 * (1.0 - simulation::kFaceCosine) * (1.0 - simulation::kFaceCosine);
// Time that the destructor gives a lost device to finish its work.
inline constexpr std::uint64_t kLostTimeout_ns = 20'000'000'000;
// Timeout of the warm-up: software drivers compile a pass at its first run.
inline constexpr std::uint64_t kWarmUpTimeout_ns = 120'000'000'000;
// Timeout of a brute-force frame, which tests every pair in every pass; brute force is for measurements only.
inline constexpr std::uint64_t kBruteTimeout_ns = 900'000'000'000;
// Factors in the bound on the rounding error of a distance in floats. kPlaceRounding (eight units in the last
// place) multiplies the coordinates. kWayRounding multiplies the square of the path's length divided by the
// smallest radius; this term matters on paths that are long compared with the balls.
inline constexpr double kPlaceRounding = 0x1p-21, kWayRounding = 4e-7;
// kCuttingSkin_m, kShaftSkin_m: displacement of the tool's cutting balls, or of its other balls, beyond which
// the lists of balls and points are rebuilt. Balls that do not cut are mostly far from bone, so their larger
// displacement costs little. kRemeasureDisplacement_mm: displacement beyond which the gaps of the lists'
// packed pairs are measured again on a software driver; on a GPU this saves no time.
inline constexpr float kRemeasureDisplacement_mm = 0.03f;
inline constexpr double kCuttingSkin_m = 0.15e-3, kShaftSkin_m = 0.6e-3;
// Capacities: kPackedPairs, number of packed pairs of all list entries together; kToolRefs, number of tool
// refs of all clusters together.
inline constexpr std::size_t kPackedPairs = 4'000'000, kToolRefs = 1'000'000;

inline std::size_t ClusterCount(std::size_t count) { return (count + kGroupSize - 1) / kGroupSize; }

// Converts a vector in metres to floats in millimetres; the fourth component w is not scaled.
inline vec4 ToMillimetres(const Vector3& v, double w) {
  return {static_cast<float>(v.x() * kMillimetres), static_cast<float>(v.y() * kMillimetres),
          static_cast<float>(v.z() * kMillimetres), static_cast<float>(w)};
}
// Converts a vector that is not a length, such as a direction, to floats without scaling.
inline vec4 Unscaled(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0.0f};
}
inline Vector3 Direction(const vec4& v) { return {v.x, v.y, v.z}; }
inline Vector3 ToMetres(const vec4& v) { return Direction(v) / kMillimetres; }

// Converts a vector in metres to doubles in millimetres.
inline dvec3 Exactly(const Vector3& v) {
  return {v.x() * kMillimetres, v.y() * kMillimetres, v.z() * kMillimetres};
}
inline Vector3 Direction(const dvec3& v) { return {v.x, v.y, v.z}; }
inline Vector3 ToMetres(const dvec3& v) { return Direction(v) / kMillimetres; }
// Returns the differences [mm] between v_m, w_m and their values `rounded` to floats. Volatile because
// GCC 12.2 optimises the rounding away in some builds if it sees both this function and ToMillimetres.
inline vec4 FloatRemainder(const Vector3& v_m, double w_m, const vec4& rounded) {
  const volatile float x = rounded.x, y = rounded.y, z = rounded.z, w = rounded.w;
  const dvec3 v = Exactly(v_m);
  return {static_cast<float>(v.x - static_cast<double>(x)), static_cast<float>(v.y - static_cast<double>(y)),
          static_cast<float>(v.z - static_cast<double>(z)),
          static_cast<float>(w_m * kMillimetres - static_cast<double>(w))};
}

// Returns the value of a sum that a frame accumulated in integer units: (high × 2^16 + low) / scale.
inline double Total(const Sum& sum, double scale) {
  return (sum.high * 65536.0 + static_cast<double>(sum.low)) / scale;
}

// WriteBalls, ReadBalls: copy the list of balls. The list is split over two buffers because the size of a
// binding is limited.
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

// Position [mm] and volume [mm³] of a mass point.
inline vec4 PointFloats(const simulation::MassPoint& point) {
  return ToMillimetres(point.p_m, point.volume_m3 * 1e9);
}

struct VulkanEngine::Impl {
  std::unique_ptr<FrameProgram> program;
  ToolLayout tool;
  std::vector<uint> device_tool;  // a tool ball's index on the device, by its index in the tool's own list
  double lever_m{0.0};
  std::vector<simulation::Material> materials;
  simulation::MaterialMap map{simulation::Bone{}};
  Pose X_WG;
  simulation::CuttingParams params;
  simulation::FrameMemory memory;
  std::size_t ball_count{0}, point_count{0};
  std::optional<SplitPool> pool;  // only where balls are split
  std::size_t ball_clusters{0};   // number of clusters of balls, including those of the pool
  double unit_mm3{1.0};           // volume of one integer unit; the points' volumes are summed in these units
  // largest coordinate of a tool ball that can touch; smallest tool ball's radius
  double extent_m{0.0}, min_radius_m{1.0};
  bool lost{false}, brute_force{false};
  std::uint64_t frame_timeout_ns{0};
  FrameStats stats;
  simulation::NearField near;  // near field of the last frame; only its faces are filled
  simulation::Candidates candidates;

  Frame frame_constants{};  // constant part of every frame
  ClusterTree ball_tree, point_tree;
  std::unique_ptr<WorkList> work;
  std::vector<ClusterPairs> ball_cluster_pairs, point_cluster_pairs;
  std::vector<BallSweep> group_sweeps, ball_sweeps;

  // The lists on the device, in the state after the last frame that built them.
  struct Lists {
    bool made{false};
    float ball_reach_mm{0.0f}, point_reach_mm{0.0f};
    uint balls{0}, points{0}, shaft{0}, packed_pairs{0}, longest_pair_range{1};
    std::vector<Vector3> built_m;     // positions of the tool's balls when the lists were built
    std::vector<Vector3> measured_m;  // positions when the lists' packed pairs were last measured
  } lists;
  bool had_no_contact{true};  // the last frame had no contact
  Pose X_GT;                  // pose of the tool in this frame
  // positions of the tool's balls in this frame, at the proxy and at the tool's pose
  std::vector<Vector3> start_m, goal_m;
  std::vector<vec4> placed;  // both positions for the device: as floats, then their rounding remainders
  // volumes swept by the cutting balls; filled only if balls are split
  std::vector<simulation::Capsule> capsules;

  std::string Open(std::unique_ptr<Context> context, const simulation::Bone& bone,
                   const VulkanParams& vulkan);
  void Upload(const simulation::Bone& bone);
  void FillFrameConstants(const simulation::Bone& bone);
  void ListEverything();
  bool WarmUp(const simulation::Bone& bone);
  void PlaceToolBalls(const Pose& pose);
  [[nodiscard]] Frame PrepareFrame(const simulation::FrameInput& input);
  void FindWork(Frame& frame, FrameMode mode);
  bool RunFrame(const Frame& prepared, FrameMode mode);
  void SetUploads(Frame& frame) const;
  void EndSplits(const Frame& done, const simulation::FrameSolution& solution);
  // length of the device's list of balls
  [[nodiscard]] std::size_t AllBalls() const { return pool ? pool->ball_count() : ball_count; }
  // whether only the tool ball that touches first cuts
  [[nodiscard]] bool CutsAlone() const { return params.cutters == simulation::Cutters::kContactSphere; }
  void MeasureDisplacement(Frame& frame) const;
  [[nodiscard]] float MaxDisplacement_mm(const std::vector<Vector3>& was_m, const std::vector<Vector3>& is_m,
                                         bool cuts) const;
  [[nodiscard]] uint Chunk(std::size_t entries, std::size_t range) const;
  [[nodiscard]] DispatchArgs MakeDispatch(std::size_t entries, uint chunk, uint rows) const;
  void SetFlush(Frame& frame) const;
  // The buffer of packed pairs begins with one pair for each tool ball: cutting balls, then the others. Each
  // of the two ranges begins at a multiple of 4. Returns where the second range begins.
  [[nodiscard]] std::ptrdiff_t FirstShaftPackedPair() const {
    return static_cast<std::ptrdiff_t>((tool.cutter_count + 3) / 4 * 4);
  }
  [[nodiscard]] std::size_t AllPackedPairs() const {
    return (static_cast<std::size_t>(FirstShaftPackedPair()) + tool.balls.size() - tool.cutter_count + 3) /
           4 * 4;
  }
  [[nodiscard]] bool Flush() const;  // false if the device is lost
  void ReadState(simulation::CarvedState& state) const;
  void WriteState(const simulation::CarvedState& state);
  // Returns the device index of a tool ball, given its index in the tool's own list; tool_count if there is
  // no such ball.
  [[nodiscard]] uint DeviceTool(uint number) const {
    return number < device_tool.size() ? device_tool[number] : frame_constants.tool_count;
  }
  void ReadNearField(const Frame& done, double s);
  [[nodiscard]] simulation::FrameSolution Solution(const Frame& done);
  simulation::ContactModel Step(const simulation::FrameInput& input);
};
}  // namespace osteon::gpu
