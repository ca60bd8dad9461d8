#include "gpu/vulkan_engine.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "gpu/cluster_tree.h"
#include "gpu/frame_program.h"
#include "gpu/split_pool.h"
#include "gpu/tool_layout.h"
#include "gpu/work_list.h"
#include "simulation/contact_law.h"
#include "simulation/cutting_math.h"
#include "simulation/frame_solution.h"

namespace osteon::gpu {
namespace {

static_assert(kMaxMaterials == simulation::kMaxMaterials && kBins == simulation::kContactBins &&
              kCuttingBinCount == simulation::kCuttingBins && kRemembered == simulation::kRememberedPairs &&
              kFaces == simulation::kMaxFaces && kCandidates == kBins + kRemembered);

constexpr double kMillimetres = 1e3;
constexpr double kLargestSummand = 4'194'304.0;  // 2^22 units: half of what a sum over a subgroup can take
// of a face's weights: the largest lens in the middle of its cone
constexpr double kLargestFaceWeight_mm3 =
    simulation::kLargestLensVolume * 1e9 * (1.0 - simulation::kFaceCosine) * (1.0 - simulation::kFaceCosine);
// The servo loop stops on the model's age long before; this ends a wait for a device that hangs.
constexpr std::uint64_t kFrameTimeout_ns = 20'000'000'000;
constexpr std::uint64_t kWarmUpTimeout_ns =
    120'000'000'000;  // software drivers compile a pass when it first runs
// How far the tool may move before the lists of live balls and points are made anew. Balls that do not cut
// are mostly far from bone, so a wide margin costs nothing.
constexpr double kCuttingMargin_m = 0.15e-3, kShaftMargin_m = 3e-3;
// Room for what the tool can meet: entries of a list, tool balls of all entries, groups of all clusters.
constexpr std::size_t kMostLive = 4'000'000, kSpans = 4'000'000, kGroupRefs = 1'000'000;

std::size_t ClusterCount(std::size_t count) { return (count + kGroupSize - 1) / kGroupSize; }

vec4 ToMillimetres(const Vector3& v, double w) {
  return {static_cast<float>(v.x() * kMillimetres), static_cast<float>(v.y() * kMillimetres),
          static_cast<float>(v.z() * kMillimetres), static_cast<float>(w)};
}
vec4 Unscaled(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0.0f};
}
Vector3 Direction(const vec4& v) { return {v.x, v.y, v.z}; }
Vector3 ToMetres(const vec4& v) { return Direction(v) / kMillimetres; }

double Total(const Sum& sum, double scale) {
  return (sum.high * 65536.0 + static_cast<double>(sum.low)) / scale;
}

// Balls lie in two buffers, since a binding holds so many only.
void WriteBalls(const FrameProgram& program, const void* data, std::size_t count) {
  const std::size_t first = std::min<std::size_t>(count, kBallsPerBuffer);
  program.Write(kBindBalls, data, first * sizeof(vec4));
  program.Write(kBindMoreBalls, static_cast<const vec4*>(data) + first, (count - first) * sizeof(vec4));
}
void ReadBalls(const FrameProgram& program, void* data, std::size_t count) {
  const std::size_t first = std::min<std::size_t>(count, kBallsPerBuffer);
  program.Read(kBindBalls, data, first * sizeof(vec4));
  program.Read(kBindMoreBalls, static_cast<vec4*>(data) + first, (count - first) * sizeof(vec4));
}

vec4 PointFloats(const simulation::MassPoint& point) {
  return ToMillimetres(point.p_m, point.volume_m3 * 1e9);
}

}  // namespace

struct VulkanEngine::Impl {
  std::unique_ptr<FrameProgram> program;
  ToolLayout tool;
  std::vector<uint> device_tool;  // by the tool's own numbers
  double lever_m{0.0};
  std::vector<simulation::Material> materials;
  Pose X_WG;
  simulation::CuttingParams params;
  simulation::FrameMemory memory;
  std::size_t ball_count{0}, point_count{0};
  std::optional<SplitPool> pool;  // of balls that are split
  std::size_t ball_clusters{0};   // with those of the pool
  double unit_mm3{1.0};
  bool lost{false}, brute_force{false};
  FrameStats stats;
  simulation::NearField near;  // of the last frame

  Frame still{};  // what does not change from frame to frame
  ClusterTree ball_tree, point_tree;
  std::unique_ptr<WorkList> work;
  std::vector<Item> ball_items, point_items;

  // the lists that lie on the device, as the last frame that made them left them
  struct Lists {
    bool made{false};
    float ball_reach_mm{0.0f}, point_reach_mm{0.0f};
    Groups pair_work{0, 2, 1}, all_work{0, 3, 1};
    uint balls{0}, points{0}, shaft{0}, spans{0};
    std::vector<Vector3> built_m;  // the tool's balls where they were made
  } lists;
  bool was_free{true};                   // the last frame met nothing
  std::vector<Vector3> start_m, goal_m;  // of the tool's balls, this frame

  std::string Open(std::unique_ptr<Context> context, const simulation::Bone& bone,
                   const VulkanParams& vulkan);
  void Upload(const simulation::Bone& bone);
  void FillStill(const simulation::Bone& bone);
  void ListEverything();
  bool WarmUp(const simulation::Bone& bone);
  void Place(const Pose& X_GT);
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
  void MeasureDrift(Frame& f) const;
  [[nodiscard]] Groups FlushWork() const;
  void Flush() const;
  // a tool ball of the tool's own list; none for a number that is not in it
  [[nodiscard]] uint DeviceTool(uint number) const {
    return number < device_tool.size() ? device_tool[number] : still.tool_count;
  }
  void ReadNearField(const Frame& done, double s);
  [[nodiscard]] simulation::FrameSolution Solution(const Frame& done, const Pose& X_GT);
  simulation::ContactModel Step(const simulation::FrameInput& input);
};

// Buffers for this bone and tool; an error text where they are too large.
std::string VulkanEngine::Impl::Open(std::unique_ptr<Context> context, const simulation::Bone& bone,
                                     const VulkanParams& vulkan) {
  ball_count = bone.balls.size();
  point_count = bone.points.size();
  const std::size_t longest = std::max({AllBalls(), point_count, std::size_t{1}});
  ProgramSizes sizes;
  sizes.balls = AllBalls();
  sizes.points = point_count;
  sizes.ball_clusters = ball_clusters = ClusterCount(AllBalls());
  sizes.point_clusters = ClusterCount(point_count);
  sizes.tool_balls = tool.balls.size();
  sizes.cutters = tool.cutter_count;
  sizes.tool_groups = tool.groups.size();
  sizes.group_refs = tool.groups.size() + kGroupRefs;
  sizes.live = brute_force ? longest : std::min(longest, kMostLive);
  sizes.spans = tool.balls.size() + kSpans;
  if (pool) {
    sizes.requests = std::min(ball_count, sizes.live);
    sizes.blocks = pool->block_count();
    sizes.uploads = sizes.blocks * (kGroupSize + 1);
    still.request_capacity = static_cast<uint>(sizes.requests);
  }
  if (std::string refusal = FrameProgram::Refusal(*context, sizes); !refusal.empty()) return refusal;
  program = std::make_unique<FrameProgram>(std::move(context), sizes, vulkan);
  still.live_capacity = static_cast<uint>(sizes.live);
  still.span_capacity = static_cast<uint>(sizes.spans);
  work = std::make_unique<WorkList>(std::max(sizes.ball_clusters, sizes.point_clusters),
                                    static_cast<uint>(tool.groups.size()), sizes.group_refs);
  ball_items.reserve(sizes.ball_clusters);
  point_items.reserve(sizes.point_clusters);
  lists.built_m.resize(tool.balls.size());
  return "";
}

void VulkanEngine::Impl::Upload(const simulation::Bone& bone) {
  std::vector<vec4> data;
  data.reserve(std::max(ball_count, point_count));
  for (const simulation::Ball& ball : bone.balls)
    data.push_back(ToMillimetres(ball.center_m, ball.radius_m * kMillimetres));
  ball_tree = ClusterTree(data);
  data.resize(AllBalls(), vec4{0, 0, 0, 0});
  WriteBalls(*program, data.data(), data.size());

  // whole units of volume, so that the sum of all points still fits 32 bits
  double total_mm3 = 0.0;
  for (const simulation::MassPoint& point : bone.points) total_mm3 += point.volume_m3 * 1e9;
  unit_mm3 = std::max(total_mm3, 1.0) / 4.0e9;
  data.clear();
  std::vector<uint> states, units;
  states.reserve(point_count);
  units.reserve(point_count);
  for (const simulation::MassPoint& point : bone.points) {
    data.push_back(PointFloats(point));
    states.push_back(point.material);
    units.push_back(static_cast<uint>(std::llround(point.volume_m3 * 1e9 / unit_mm3)));
  }
  program->Write(kBindPoints, data.data(), data.size() * sizeof(vec4));
  program->Write(kBindPointStates, states.data(), states.size() * sizeof(uint));
  program->Write(kBindPointUnits, units.data(), units.size() * sizeof(uint));
  for (vec4& point : data) point.w = 0.0f;  // a point has no extent
  point_tree = ClusterTree(data);

  program->Write(kBindToolGroups, tool.groups.data(), tool.groups.size() * sizeof(ToolGroup));
  std::vector<uint> identity(tool.balls.size());
  std::iota(identity.begin(), identity.end(), 0u);
  program->Write(kBindSpans, identity.data(), identity.size() * sizeof(uint));
}

void VulkanEngine::Impl::FillStill(const simulation::Bone& bone) {
  for (std::size_t i = 0; i < materials.size(); ++i)
    still.material[i] = {
        .x = static_cast<float>(materials[i].specific_cutting_energy_J_per_m3 * 1e-6),  // N/mm^2
        .y = static_cast<float>(materials[i].cutting_force_ratio),
        .z = 0.0f,
        .w = 0.0f};
  still.stiffness_N_per_mm = static_cast<float>(params.stiffness_N_per_m / kMillimetres);
  still.max_force_N = static_cast<float>(params.max_force_N);
  still.enlargement_mm = static_cast<float>(params.normal_enlargement_m * kMillimetres);
  still.tolerance_mm = static_cast<float>(params.contact_tolerance_m * kMillimetres);
  still.layer_mm = static_cast<float>(params.engaged_layer_m * kMillimetres);
  still.max_slide_mm = static_cast<float>(params.max_slide_m * kMillimetres);
  still.cutting_margin_mm = static_cast<float>(kMillimetres * kCuttingMargin_m);
  still.shaft_margin_mm = static_cast<float>(kMillimetres * kShaftMargin_m);
  // the largest summands: a touching point as far out as the tool reaches, a whole mass point in the engaged
  // layer
  double reach_mm = 1.0, largest_mm3 = 1e-3;
  for (const ToolLayout::Item& ball : tool.balls)
    reach_mm = std::max(reach_mm, kMillimetres * (ball.center_T_m.norm() + ball.radius_m));
  for (const simulation::MassPoint& point : bone.points)
    largest_mm3 = std::max(largest_mm3, point.volume_m3 * 1e9);
  const double largest_mm2 = largest_mm3 / (params.engaged_layer_m * kMillimetres);
  still.face_scale = static_cast<float>(kLargestSummand / kLargestFaceWeight_mm3);
  still.face_point_scale = static_cast<float>(kLargestSummand / (kLargestFaceWeight_mm3 * reach_mm));
  still.area_scale = static_cast<float>(kLargestSummand / largest_mm2);
  still.moment_scale = static_cast<float>(kLargestSummand / (largest_mm2 * reach_mm));
  still.tool_count = static_cast<uint>(tool.balls.size());
  still.cutter_count = static_cast<uint>(tool.cutter_count);
  still.ball_count = static_cast<uint>(AllBalls());
  still.parent_count = static_cast<uint>(ball_count);
  still.first_child = pool ? static_cast<uint>(pool->FirstCluster() * kGroupSize) : 0;
  still.split_radius_mm = static_cast<float>(kMillimetres * params.split.least_radius_m);
  still.point_count = static_cast<uint>(point_count);
  still.material_count = static_cast<uint>(materials.size());
  still.immediate = params.law == simulation::RemovalLaw::kImmediate ? 1 : 0;
}

// Brute force: everything in the lists, for good.
void VulkanEngine::Impl::ListEverything() {
  std::vector<vec4> copies(ball_count);
  ReadBalls(*program, copies.data(), ball_count);
  std::vector<Live> entries(std::max(ball_count, point_count));
  for (std::size_t i = 0; i < entries.size(); ++i)
    entries[i] = {.index = static_cast<uint>(i), .first = 0, .count = still.cutter_count};
  program->Write(kBindLiveBalls, copies.data(), ball_count * sizeof(vec4));
  std::vector<uint> slots(ball_count);
  std::iota(slots.begin(), slots.end(), 0u);
  program->Write(kBindSlots, slots.data(), slots.size() * sizeof(uint));
  program->Write(kBindLiveEntries, entries.data(), ball_count * sizeof(Live));
  program->Write(kBindPointEntries, entries.data(), point_count * sizeof(Live));
  copies.resize(point_count);
  program->Read(kBindPoints, copies.data(), point_count * sizeof(vec4));
  std::vector<uint> states(point_count);
  program->Read(kBindPointStates, states.data(), point_count * sizeof(uint));
  for (std::size_t i = 0; i < point_count; ++i)
    if ((states[i] & kCleared) != 0) copies[i].w = -copies[i].w;
  program->Write(kBindLivePoints, copies.data(), point_count * sizeof(vec4));
  std::vector<ShaftPair> pairs;
  if (still.tool_count > still.cutter_count)
    for (std::size_t i = 0; i < ball_count; ++i)
      pairs.push_back({.slot = static_cast<uint>(i),
                       .first = still.cutter_count,
                       .count = still.tool_count - still.cutter_count});
  program->Write(kBindShaftPairs, pairs.data(), pairs.size() * sizeof(ShaftPair));
  const std::size_t longest = std::max(ball_count, point_count), chunk = program->lanes() * program->chunk();
  lists.made = true;
  lists.ball_reach_mm = lists.point_reach_mm = std::numeric_limits<float>::max();
  lists.pair_work.x = lists.all_work.x = static_cast<uint>((longest + chunk - 1) / chunk);
  lists.balls = static_cast<uint>(ball_count);
  lists.points = static_cast<uint>(point_count);
  lists.shaft = static_cast<uint>(pairs.size());
}

// Runs every pass once, with a still spindle at the first ball: nothing changes, and no later frame waits for
// a compiler.
bool VulkanEngine::Impl::WarmUp(const simulation::Bone& bone) {
  simulation::FrameInput input;
  Pose X_GT = Pose::Identity();
  if (!bone.balls.empty()) X_GT.translation() = Vector3(bone.balls.front().center_m);
  input.X_WT = X_WG * X_GT;
  input.dt_s = 0.0;
  memory.X_GP = X_GT;
  const Frame f = Prepare(input);
  const bool done = RunFrame(f, FrameMode::kListsAtContact) && RunFrame(f, FrameMode::kListsAtProxy) &&
                    RunFrame(f, FrameMode::kLists);
  memory = {};
  was_free = true;
  if (brute_force) ListEverything();
  return done;
}

// The tool's balls and their groups at the proxy and at the tool's pose, for the device and for Prepare.
void VulkanEngine::Impl::Place(const Pose& X_GT) {
  vec4* placed = program->host<vec4>(kBindTool);
  start_m.resize(tool.balls.size());
  goal_m.resize(tool.balls.size());
  for (std::size_t t = 0; t < tool.balls.size(); ++t) {
    start_m[t] = memory.X_GP * tool.balls[t].center_T_m;
    goal_m[t] = X_GT * tool.balls[t].center_T_m;
    *placed++ = ToMillimetres(start_m[t], tool.balls[t].radius_m * kMillimetres);
    *placed++ = ToMillimetres(goal_m[t], 0.0);
  }
  for (const ToolLayout::Item& bound : tool.group_bounds) {
    *placed++ = ToMillimetres(memory.X_GP * bound.center_T_m, bound.radius_m * kMillimetres);
    *placed++ = ToMillimetres(X_GT * bound.center_T_m, 0.0);
  }
}

Frame VulkanEngine::Impl::Prepare(const simulation::FrameInput& input) {
  const Pose X_GT = X_WG.inverse() * Pose(input.X_WT);
  Place(X_GT);
  Frame f = still;
  f.start = ToMillimetres(memory.X_GP.translation(), 0.0);
  f.goal = ToMillimetres(X_GT.translation(), 0.0);
  f.axis_x = Unscaled(X_GT.linear().col(0));
  f.axis_y = Unscaled(X_GT.linear().col(1));
  f.axis_z = Unscaled(X_GT.linear().col(2));
  const Vector3 turn = LogRotation(X_GT.linear() * memory.X_GP.linear().transpose());
  f.turn = Unscaled(turn);
  f.turning = turn != Vector3::Zero() ? 1 : 0;
  f.spindle_rad_per_s = static_cast<float>(input.spindle_rad_per_s);
  f.dt_s = static_cast<float>(input.dt_s);
  f.work_held_back_Nmm =
      static_cast<float>(memory.debt_J * std::min(1.0, input.dt_s / simulation::kDebtSeconds) * kMillimetres);
  double way_m = (X_GT.translation() - memory.X_GP.translation()).norm();
  for (std::size_t t = 0; t < start_m.size(); ++t) {
    way_m = std::max(way_m, (goal_m[t] - start_m[t]).norm());
  }
  if (lists.made && !brute_force) MeasureDrift(f);
  // slide and advance together: at most max_slide, but for the immediate law, which goes all the way
  const double step_m = params.max_slide_m + (params.law == simulation::RemovalLaw::kImmediate ? way_m : 0.0);
  f.ball_reach_mm = static_cast<float>(kMillimetres * std::max(params.normal_enlargement_m, step_m));
  f.point_reach_mm = static_cast<float>(kMillimetres * std::max(params.engaged_layer_m, step_m));
  f.contact_bits = f.slide_bits = f.straight_bits =
      std::bit_cast<uint>(static_cast<float>(simulation::kNoContact));
  f.bin_keys.fill(std::numeric_limits<std::uint64_t>::max());
  const simulation::ContactMemory& contact = memory.contact;
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact.face_count); ++i)
    f.face_n[i] = Unscaled(contact.face_n_G[i]);
  f.face_count = static_cast<uint>(contact.face_count);
  f.remembered_count = static_cast<uint>(contact.pair_count);
  f.held_count = static_cast<uint>(contact.held_count);
  for (std::size_t i = 0; i < f.remembered_count; ++i) {
    f.remembered_bone[i] = contact.pairs[i].bone_ball;
    f.remembered_tool[i] = DeviceTool(contact.pairs[i].tool_ball);
  }
  f.friction = input.spindle_rad_per_s != 0.0 ? 0.0f : static_cast<float>(contact.friction);
  return f;
}

Groups VulkanEngine::Impl::FlushWork() const {
  const uint share = program->lanes() * program->chunk();
  return {.x = lists.made ? (lists.balls + share - 1) / share : 0, .y = 1, .z = 1};
}

// The balls of the lists back to where Snapshot reads them.
void VulkanEngine::Impl::Flush() const {
  Frame f = still;
  f.flush_count = lists.balls;
  f.flush_work = FlushWork();
  SetUploads(f);
  std::memcpy(&program->frame(), &f, sizeof(Frame));
  program->Run(FrameMode::kFlush, kFrameTimeout_ns);
}

// What the frame before has split.
void VulkanEngine::Impl::SetUploads(Frame& f) const {
  if (!pool) return;
  const std::vector<SplitUpload>& uploads = pool->uploads();
  std::ranges::copy(uploads, program->host<SplitUpload>(kBindUploads));
  f.upload_count = static_cast<uint>(uploads.size());
  f.upload_work = {.x = (f.upload_count + program->lanes() - 1) / program->lanes(), .y = 1, .z = 1};
}

// The frame's requests, with what its cutting balls have swept.
void VulkanEngine::Impl::EndSplits(const Frame& done, const simulation::FrameSolution& solution) {
  std::vector<simulation::Capsule> capsules(2 * tool.cutter_count);
  for (std::size_t t = 0; t < tool.cutter_count; ++t) {
    const Vector3 contact_m = start_m[t] + solution.contact_fraction * (goal_m[t] - start_m[t]);
    const Vector3 target_m =
        done.turns != 0 ? Vector3(goal_m[t] + solution.delta) : Vector3(contact_m + solution.shift);
    const Vector3 slid_m = contact_m + solution.slide_fraction * (target_m - contact_m);
    const double radius_m = tool.balls[t].radius_m;
    capsules[t] = {.a = contact_m, .b = slid_m, .radius_m = radius_m};
    capsules[tool.cutter_count + t] = {
        .a = slid_m, .b = slid_m + solution.origin_end - solution.origin_slid, .radius_m = radius_m};
  }
  const std::size_t count = std::min(done.request_count, still.request_capacity);
  pool->EndFrame({program->host<SplitRequest>(kBindRequests), count}, capsules, Blocks());
}

// How far the tool's balls are from where the lists were made.
void VulkanEngine::Impl::MeasureDrift(Frame& f) const {
  f.cutting_drift_start_mm = f.cutting_drift_goal_mm = f.shaft_drift_start_mm = f.shaft_drift_goal_mm = 0.0f;
  for (std::size_t t = 0; t < start_m.size(); ++t) {
    const bool cuts = t < tool.cutter_count;
    float& at_start = cuts ? f.cutting_drift_start_mm : f.shaft_drift_start_mm;
    float& at_goal = cuts ? f.cutting_drift_goal_mm : f.shaft_drift_goal_mm;
    at_start = std::max(at_start, static_cast<float>(kMillimetres * (start_m[t] - lists.built_m[t]).norm()));
    at_goal = std::max(at_goal, static_cast<float>(kMillimetres * (goal_m[t] - lists.built_m[t]).norm()));
  }
}

// The clusters that the tool can meet, with its reach, on its way or where it stands.
void VulkanEngine::Impl::FindWork(Frame& f, FrameMode mode) {
  const vec4* bounds = program->host<vec4>(kBindTool) + 2 * tool.balls.size();
  const auto sweep = [&](float reach_mm, bool cutting_only) {
    return [&, reach_mm, cutting_only](uint g, const auto& meet) {
      const bool cuts = tool.Cuts(tool.groups[g]);
      if (cutting_only && !cuts) return;
      const vec4 a = bounds[2 * g], b = bounds[2 * g + (mode == FrameMode::kListsAtContact ? 1 : 0)];
      meet(Eigen::Vector3f(a.x, a.y, a.z), Eigen::Vector3f(b.x, b.y, b.z),
           a.w + reach_mm + (cuts ? still.cutting_margin_mm : still.shaft_margin_mm));
    };
  };
  work->Clear();
  work->Add(ball_tree, ball_items, sweep(f.ball_reach_mm, false));
  // a block lies where its parent does
  for (std::size_t i = 0, clusters = pool ? ball_items.size() : 0; i < clusters; ++i) {
    const Item parents = ball_items[i];
    for (const uint block : pool->BlocksIn(parents.cluster))
      ball_items.push_back({.cluster = static_cast<uint>(pool->FirstCluster()) + block,
                            .first = parents.first,
                            .count = parents.count});
  }
  work->Add(point_tree, point_items, sweep(f.point_reach_mm, true));
  Item* items = program->host<Item>(kBindItems);
  std::copy(ball_items.begin(), ball_items.end(), items);
  std::copy(point_items.begin(), point_items.end(), items + ball_clusters);
  std::copy(work->refs().begin(), work->refs().end(), program->host<uint>(kBindGroupRefs));
  f.path_work = {.x = static_cast<uint>(ball_items.size()), .y = 1, .z = 1};
  f.point_work = {.x = static_cast<uint>(point_items.size()), .y = 1, .z = 1};
}

// False where the device is lost.
bool VulkanEngine::Impl::RunFrame(const Frame& prepared, FrameMode mode) {
  Frame f = prepared;
  f.lists_at_contact = mode == FrameMode::kListsAtContact ? 1 : 0;
  if (mode == FrameMode::kLists) {
    f.pair_work = lists.pair_work;
    f.all_work = lists.all_work;
    f.live_ball_count = lists.balls;
    f.live_point_count = lists.points;
    f.shaft_count = lists.shaft;
    f.span_count = lists.spans;
  } else {
    FindWork(f, mode);
    SetUploads(f);
    f.flush_count = lists.made ? lists.balls : 0;
    f.flush_work = FlushWork();
    f.pair_work = {.x = 0, .y = 2, .z = 1};
    f.all_work = {.x = 0, .y = 3, .z = 1};
    f.span_count = static_cast<uint>(tool.balls.size());
    lists.built_m = start_m;
    if (!brute_force) MeasureDrift(f);
  }
  std::memcpy(&program->frame(), &f, sizeof(Frame));
  if (!program->Run(mode, memory.frame == 0 ? kWarmUpTimeout_ns : kFrameTimeout_ns)) return false;
  const Frame& done = program->result();
  stats = {.active_balls = done.live_ball_count,
           .active_points = done.live_point_count,
           .lists_made = mode != FrameMode::kLists};
  if (mode == FrameMode::kLists) return true;
  if (pool) pool->Uploaded();
  lists.made = done.too_many == 0;
  lists.ball_reach_mm = done.ball_reach_mm;
  lists.point_reach_mm = done.point_reach_mm;
  lists.pair_work = done.pair_work;
  lists.all_work = done.all_work;
  lists.balls = done.live_ball_count;
  lists.points = done.live_point_count;
  lists.shaft = done.shaft_count;
  lists.spans = done.span_count;
  if (mode == FrameMode::kListsAtProxy) return true;
  const double s = std::min(1.0f, std::bit_cast<float>(done.contact_bits));
  for (std::size_t t = 0; t < start_m.size(); ++t)
    lists.built_m[t] = start_m[t] + s * (goal_m[t] - start_m[t]);
  return true;
}

// What the device has found near the tool at first contact, a share s of the way.
void VulkanEngine::Impl::ReadNearField(const Frame& done, double s) {
  for (simulation::NearPair& pair : near.nearest) pair.present = false;
  for (simulation::NearPair& pair : near.remembered) pair.present = false;
  near.held_count = 0;  // what held is known already
  for (std::size_t c = 0; c < done.candidate_count; ++c) {
    const Candidate& found = done.candidates[c];
    simulation::NearPair& pair =
        found.source < kBins ? near.nearest[found.source] : near.remembered[found.source - kBins];
    pair.present = true;
    const std::size_t t = found.tool_ball;
    pair.pair = {.bone_ball = found.bone_ball, .tool_ball = tool.number[t]};
    pair.cutting = t < tool.cutter_count;
    pair.n = Vector3(found.n_x, found.n_y, found.n_z).normalized();
    pair.gap_m = found.gap_mm / kMillimetres;
    pair.motion_m = (1.0 - s) * (goal_m[t] - start_m[t]);
    pair.center_T_m = tool.balls[t].center_T_m;
    pair.tool_radius_m = tool.balls[t].radius_m;
  }
  for (std::size_t f = 0; f < kFaces; ++f) {
    const auto sum = [&](std::size_t row, std::size_t column, double scale) {
      return Total(done.face_sums[(row * kFaces + f) * kFaceColumns + column], scale);
    };
    const auto vector = [&](std::size_t row, std::size_t column, double scale) {
      return Vector3(sum(row, column, scale), sum(row, column + 1, scale), sum(row, column + 2, scale));
    };
    const double weight = done.face_scale, place = done.face_point_scale;
    simulation::FaceSums& face = near.faces[f];
    const double cutters = sum(0, 0, weight);
    face.weight = cutters + sum(1, 0, weight);
    face.n = vector(0, 1, weight) + vector(1, 1, weight);
    face.center_T = vector(0, 4, place) / kMillimetres + vector(1, 4, place) / kMillimetres;
    face.radius = (sum(0, 7, place) + sum(1, 7, place)) / kMillimetres;
    if (tool.cutter_count == 1) {  // the same for all
      face.center_T += cutters * tool.balls[0].center_T_m;
      face.radius += cutters * tool.balls[0].radius_m;
    }
  }
}

simulation::FrameSolution VulkanEngine::Impl::Solution(const Frame& done, const Pose& X_GT) {
  simulation::FrameSolution s;
  s.contact_fraction = std::min(1.0f, std::bit_cast<float>(done.contact_bits));

  ReadNearField(done, s.contact_fraction);
  const simulation::Candidates candidates = simulation::FindCandidates(near, params.contact_tolerance_m);
  simulation::ContactHold held;
  held.hold.count = static_cast<int>(done.hold_count);
  for (std::size_t k = 0; k < done.hold_count; ++k) {
    held.hold.plane[k] = done.hold_candidate[k];  // the same list as FindCandidates makes
    held.hold.multiplier_m[k] = done.hold_mm[k] / kMillimetres;
  }
  held.friction_m = ToMetres(done.friction_mm);
  held.hold.point_m = ToMetres(done.delta) - held.friction_m;
  held.hold.slack_m = done.friction_mm.w / kMillimetres;
  WeighHold(held);
  const Vector3 from_m = memory.X_GP.translation(), to_m = X_GT.translation();
  s.origin_contact = from_m + s.contact_fraction * (to_m - from_m);
  const simulation::ContactInput asked{
      .R_GT = X_GT.linear(),
      .motion_G_m = to_m - s.origin_contact,
      .turn_G = (1.0 - s.contact_fraction) * LogRotation(X_GT.linear() * memory.X_GP.linear().transpose()),
      .friction = done.friction};
  simulation::ContactHold unturned;
  unturned.friction_m = ToMetres(done.shift_mm) - asked.motion_G_m;
  ReportContacts(params, near, candidates, held, unturned, asked, memory.contact, s);
  s.cutting_m = done.delta.w / kMillimetres;
  s.n = s.cutting_m > 0.0 ? Vector3(Direction(done.n).normalized()) : Vector3::Zero();
  s.advance_m = done.advance_mm / kMillimetres;
  s.edge_work_J = done.edge_work_Nmm / kMillimetres;
  s.slide_fraction = done.slid_share;
  s.turn_fraction = done.turns != 0 ? s.slide_fraction : 0.0;
  s.origin_slid =
      s.origin_contact + s.slide_fraction * (done.turns != 0 ? Vector3(asked.motion_G_m + s.delta) : s.shift);
  s.origin_end = s.origin_slid + ToMetres(done.step_mm);
  for (std::size_t m = 0; m < materials.size(); ++m) {
    s.engaged_area_m2[m] = Total(done.engaged_sums[2 * m], done.area_scale) * 1e-6;
    s.engaged_moment_m3[m] = Total(done.engaged_sums[2 * m + 1], done.moment_scale) * 1e-9;
    s.removed_m3[m] = done.removed[m] * unit_mm3 * 1e-9;
  }
  return s;
}

tl::expected<std::unique_ptr<VulkanEngine>, std::string> VulkanEngine::Create(
    const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
    const simulation::CuttingParams& params, const VulkanParams& vulkan) {
  if (tool.balls.empty() || tool.balls.size() > kMaxToolBalls)
    return tl::make_unexpected("tool: " + std::to_string(tool.balls.size()) + " balls, accepted 1 … " +
                               std::to_string(kMaxToolBalls));
  if (bone.materials.size() > kMaxMaterials)
    return tl::make_unexpected("bone: " + std::to_string(bone.materials.size()) +
                               " materials, accepted 1 … " + std::to_string(kMaxMaterials));
  if (params.cutters != simulation::Cutters::kAll)
    return tl::make_unexpected(
        "cutters: the contact sphere alone: the reference engine and the paper's method have that");
  if (params.split.on && vulkan.brute_force)
    return tl::make_unexpected("brute force: accepted without splitting");
  auto context = OpenContext(vulkan.device, vulkan.validation);
  if (!context) return tl::make_unexpected(context.error());
  try {
    auto impl = std::make_unique<Impl>();
    impl->tool = LayOutTool(tool);
    impl->lever_m = simulation::ToolLever(tool);
    impl->device_tool.resize(tool.balls.size());
    for (std::size_t t = 0; t < tool.balls.size(); ++t)
      impl->device_tool[impl->tool.number[t]] = static_cast<uint>(t);
    impl->materials = bone.materials;
    impl->X_WG = X_WG;
    impl->params = params;
    impl->brute_force = vulkan.brute_force;
    if (params.split.on) impl->pool.emplace(bone.balls, params.split);
    if (const std::string refusal = impl->Open(std::move(*context), bone, vulkan); !refusal.empty())
      return tl::make_unexpected(refusal);
    impl->Upload(bone);
    impl->FillStill(bone);
    if (!impl->WarmUp(bone))
      return tl::make_unexpected(std::string("the Vulkan device did not finish a frame"));
    return std::unique_ptr<VulkanEngine>(new VulkanEngine(std::move(impl)));
  } catch (const vk::OutOfDeviceMemoryError&) {
    return tl::make_unexpected("not enough memory on the Vulkan device for " +
                               std::to_string(bone.balls.size()) + " balls and " +
                               std::to_string(bone.points.size()) + " mass points");
  } catch (const std::exception& error) {
    return tl::make_unexpected(std::string("Vulkan: ") + error.what());
  }
}

VulkanEngine::VulkanEngine(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VulkanEngine::~VulkanEngine() = default;

simulation::ContactModel VulkanEngine::Step(const simulation::FrameInput& input) {
  Impl& it = *impl_;
  if (it.lost || !IsUsable(input)) {
    simulation::ContactModel refused;
    refused.status = it.lost ? simulation::EngineStatus::kDeviceLost : simulation::EngineStatus::kBadInput;
    return refused;
  }
  if (!it.memory.has_proxy) it.memory.X_GP = it.X_WG.inverse() * Pose(input.X_WT);
  const Pose X_WP = it.X_WG * it.memory.X_GP;
  return StepInParts(input, X_WP, simulation::SubframeCount(it.lever_m, X_WP, Pose(input.X_WT)), it.memory,
                     [&it](const simulation::FrameInput& part) { return it.Step(part); });
}

simulation::ContactModel VulkanEngine::Impl::Step(const simulation::FrameInput& input) {
  simulation::ContactModel refused;
  const Frame prepared = Prepare(input);
  const bool reach =
      prepared.ball_reach_mm <= lists.ball_reach_mm && prepared.point_reach_mm <= lists.point_reach_mm;
  const auto beyond = [&](float cutting_mm, float shaft_mm) {
    return cutting_mm > still.cutting_margin_mm || shaft_mm > still.shaft_margin_mm;
  };
  // lists serve as long as first contact is near where they were made; where that is likely is known, and the
  // device finds out
  FrameMode mode = FrameMode::kLists;
  const bool was_split = pool && !pool->uploads().empty();
  if (was_free &&
      (!lists.made || was_split || beyond(prepared.cutting_drift_goal_mm, prepared.shaft_drift_goal_mm)))
    mode = FrameMode::kListsAtContact;
  else if (!lists.made || was_split || !reach ||
           beyond(prepared.cutting_drift_start_mm, prepared.shaft_drift_start_mm))
    mode = FrameMode::kListsAtProxy;
  bool done = RunFrame(prepared, mode);
  if (done && program->result().is_void != 0 && mode != FrameMode::kListsAtContact)
    done = RunFrame(prepared, FrameMode::kListsAtContact);
  if (!done) {
    lost = true;
    refused.status = simulation::EngineStatus::kDeviceLost;
    return refused;
  }
  const Frame& found = program->result();
  if (found.is_void != 0) {
    refused.status = simulation::EngineStatus::kOverloaded;
    return refused;
  }
  const simulation::FrameSolution solution = Solution(found, X_WG.inverse() * Pose(input.X_WT));
  was_free = solution.contact_fraction >= 1.0;
  if (pool && input.spindle_rad_per_s != 0.0) EndSplits(found, solution);
  simulation::ContactModel model = FinishFrame(params, materials, X_WG, input, solution, memory);
  if (pool) model.balls_not_split = pool->refused();
  return model;
}

simulation::CarvedState VulkanEngine::Snapshot() const {
  simulation::CarvedState state;
  ToState(impl_->memory, state);
  if (impl_->lost) return state;  // the books alone: what lay on the device is gone
  impl_->Flush();
  if (impl_->pool) {
    std::vector<vec4> balls(impl_->AllBalls());
    ReadBalls(*impl_->program, balls.data(), balls.size());
    impl_->pool->Save(balls, state);
    impl_->pool->ToSaved(state.contact);
  } else {
    state.balls.resize(impl_->ball_count * 4);
    ReadBalls(*impl_->program, state.balls.data(), impl_->ball_count);
  }
  std::vector<uint> states(impl_->point_count);
  impl_->program->Read(kBindPointStates, states.data(), states.size() * sizeof(uint));
  state.cleared.reserve(states.size());
  for (const uint point : states) state.cleared.push_back((point & kCleared) != 0 ? 1 : 0);
  return state;
}

void VulkanEngine::Restore(const simulation::CarvedState& state) {
  if (state.balls.size() != impl_->ball_count * 4 || state.cleared.size() != impl_->point_count)
    throw std::invalid_argument("carved state: not of this bone");
  if (!impl_->pool && !state.split_balls.empty())
    throw std::invalid_argument("carved state: has split balls, split is off");
  if (impl_->pool) {
    const std::vector<vec4> balls = impl_->pool->Load(state, impl_->Blocks());
    WriteBalls(*impl_->program, balls.data(), balls.size());
  } else {
    WriteBalls(*impl_->program, state.balls.data(), impl_->ball_count);
  }
  std::vector<uint> states(impl_->point_count);
  impl_->program->Read(kBindPointStates, states.data(), states.size() * sizeof(uint));
  for (std::size_t i = 0; i < states.size(); ++i)
    states[i] = (states[i] & (kCleared - 1)) | (state.cleared[i] != 0 ? kCleared : 0);
  impl_->program->Write(kBindPointStates, states.data(), states.size() * sizeof(uint));
  impl_->memory = simulation::ToMemory(state);
  if (impl_->pool) impl_->pool->FromSaved(impl_->memory.contact);
  impl_->lists.made = false;
  impl_->was_free = true;
  if (impl_->brute_force) impl_->ListEverything();
}

std::string VulkanEngine::device() const { return impl_->program->context().info.name; }

std::vector<PassTime> VulkanEngine::LastPassTimes() const {
  return impl_->memory.frame == 0 ? std::vector<PassTime>{} : impl_->program->PassTimes();
}

FrameStats VulkanEngine::LastFrameStats() const { return impl_->stats; }

int VulkanEngine::validation_messages() const {
  const Context& context = impl_->program->context();
  return context.validation ? context.validation->messages.load() : 0;
}

}  // namespace osteon::gpu
