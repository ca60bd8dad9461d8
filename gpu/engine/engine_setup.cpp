#include "gpu/engine/engine_impl.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace osteon::gpu {

// Opens the device and makes the buffers for this bone and tool; returns an error text if bone or tool are
// too large for it, otherwise an empty text.
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
  sizes.materials = std::max<std::size_t>(1, bone.materials.size());
  sizes.tool_refs = tool.balls.size() + kToolRefs;
  sizes.live = brute_force ? longest : std::min(longest, std::max<std::size_t>(1, vulkan.list_capacity));
  sizes.packed_pairs = AllPackedPairs() + kPackedPairs;
  sizes.contact_sphere = CutsAlone();
  if (pool) {
    sizes.blocks = pool->block_count();
    sizes.split_events = std::min(ball_count, sizes.live) + sizes.blocks;
    sizes.uploads = sizes.blocks * SplitPool::kUploadsPerSplit;
    frame_constants.split_event_capacity = static_cast<uint>(sizes.split_events);
  }
  if (std::string refusal = FrameProgram::Refusal(*context, sizes, vulkan.overrides); !refusal.empty())
    return refusal;
  program = std::make_unique<FrameProgram>(std::move(context), sizes, vulkan);
  // If the driver has just compiled the passes, open the device again: only a newly opened device gets the
  // faster code from the driver's cache.
  if (program->compiled()) {
    program.reset();  // also closes its device
    auto again = OpenContext(vulkan.device, vulkan.validation, vulkan.overrides.arithmetic);
    if (!again) return again.error();
    program = std::make_unique<FrameProgram>(std::move(*again), sizes, vulkan);
  }
  frame_constants.live_capacity = static_cast<uint>(sizes.live);
  frame_constants.packed_pair_capacity = static_cast<uint>(sizes.packed_pairs);
  frame_constants.max_workgroups = program->max_workgroups();
  work =
      std::make_unique<WorkList>(std::max(sizes.ball_clusters, sizes.point_clusters), tool, sizes.tool_refs);
  group_sweeps.resize(tool.groups.size());
  ball_sweeps.resize(tool.balls.size());
  ball_cluster_pairs.reserve(sizes.ball_clusters);
  point_cluster_pairs.reserve(sizes.point_clusters);
  lists.built_m.resize(tool.balls.size());
  lists.measured_m.resize(tool.balls.size());
  return "";
}

// Writes the bone's balls and points to the device, and builds the cluster trees.
void VulkanEngine::Impl::Upload(const simulation::Bone& bone) {
  std::vector<vec4> data;
  data.reserve(std::max(ball_count, point_count));
  for (const simulation::Ball& ball : bone.balls)
    data.push_back(ToMillimetres(ball.center_m, ball.radius_m * kMillimetres));
  ball_tree = ClusterTree(data);
  for (const simulation::Ball& ball : bone.balls)
    extent_m = std::max(extent_m, Vector3(ball.center_m).cwiseAbs().maxCoeff() + ball.radius_m);
  double largest_m = 0.0;
  for (const ToolLayout::Item& ball : tool.balls) {
    largest_m = std::max(largest_m, ball.radius_m);
    min_radius_m = std::min(min_radius_m, ball.radius_m);
  }
  extent_m += largest_m;
  data.resize(AllBalls(), vec4{0, 0, 0, 0});
  WriteBalls(*program, data.data(), data.size());

  // the integer unit of volume is as small as 32 bits allow
  double largest_mm3 = 1e-3;
  for (const simulation::MassPoint& point : bone.points)
    largest_mm3 = std::max(largest_mm3, point.volume_m3 * 1e9);
  unit_mm3 = largest_mm3 / 4.0e9;
  data.clear();
  std::vector<uint> states, units;
  states.reserve(point_count);
  units.reserve(point_count);
  for (const simulation::MassPoint& point : bone.points) {
    data.push_back(PointFloats(point));
    states.push_back(point.material);
    units.push_back(static_cast<uint>(std::llround(data.back().w / unit_mm3)));
  }
  program->Write(kBindPoints, data.data(), data.size() * sizeof(vec4));
  program->Write(kBindPointStates, states.data(), states.size() * sizeof(uint));
  program->Write(kBindPointUnits, units.data(), units.size() * sizeof(uint));
  for (vec4& point : data) point.w = 0.0f;  // a point has no radius
  point_tree = ClusterTree(data);

  // packed pairs of all tool balls (cutting balls, then the others), for brute force
  std::vector<uint> whole(AllPackedPairs());
  const auto middle = static_cast<std::ptrdiff_t>(tool.cutter_count);
  std::iota(whole.begin(), whole.begin() + middle, 0u);
  std::iota(whole.begin() + FirstShaftPackedPair(), whole.end(), static_cast<uint>(tool.cutter_count));
  program->Write(kBindPackedPairs, whole.data(), whole.size() * sizeof(uint));
}

// Computes the part of a Frame that is the same in every frame.
void VulkanEngine::Impl::FillFrameConstants(const simulation::Bone& bone) {
  DoublePrecision& exact = frame_constants.exact;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    exact.cutting_energy[i] = materials[i].specific_cutting_energy_J_per_m3 * 1e-6;  // N/mm^2
    exact.force_ratio[i] = materials[i].cutting_force_ratio;
    exact.edge_force[i] = materials[i].edge_force_N_per_m / kMillimetres;
  }
  exact.stiffness = params.stiffness_N_per_m / kMillimetres;
  exact.max_force = params.max_force_N;
  exact.enlargement = params.normal_enlargement_m * kMillimetres;
  exact.tolerance = params.contact_tolerance_m * kMillimetres;
  exact.layer = params.engaged_layer_m * kMillimetres;
  exact.max_slide = params.max_slide_m * kMillimetres;
  frame_constants.enlargement_mm = static_cast<float>(params.normal_enlargement_m * kMillimetres);
  frame_constants.tolerance_mm = static_cast<float>(params.contact_tolerance_m * kMillimetres);
  frame_constants.layer_mm = static_cast<float>(params.engaged_layer_m * kMillimetres);
  frame_constants.cutting_skin_mm = static_cast<float>(kMillimetres * kCuttingSkin_m);
  frame_constants.shaft_skin_mm = static_cast<float>(kMillimetres * kShaftSkin_m);
  // Largest possible summands, for the scales of the sums: a contact at the tool's farthest point, and a
  // whole mass point in the engaged layer.
  double reach_mm = 1.0, largest_mm3 = 1e-3;
  for (const ToolLayout::Item& ball : tool.balls)
    reach_mm = std::max(reach_mm, kMillimetres * (ball.center_T_m.norm() + ball.radius_m));
  for (const simulation::MassPoint& point : bone.points)
    largest_mm3 = std::max(largest_mm3, point.volume_m3 * 1e9);
  const double largest_mm2 = largest_mm3 / (params.engaged_layer_m * kMillimetres);
  frame_constants.face_scale = static_cast<float>(kMaxSummand / kMaxFaceWeight_mm3);
  frame_constants.face_point_scale = static_cast<float>(kMaxSummand / (kMaxFaceWeight_mm3 * reach_mm));
  frame_constants.area_scale = static_cast<float>(kMaxSummand / largest_mm2);
  frame_constants.moment_scale = static_cast<float>(kMaxSummand / (largest_mm2 * reach_mm));
  frame_constants.tool_count = static_cast<uint>(tool.balls.size());
  frame_constants.cutter_count = static_cast<uint>(tool.cutter_count);
  frame_constants.ball_count = static_cast<uint>(AllBalls());
  frame_constants.first_child = pool ? static_cast<uint>(pool->FirstCluster() * kGroupSize) : 0;
  frame_constants.split_radius_mm = static_cast<float>(kMillimetres * params.split.min_radius_m);
  frame_constants.point_count = static_cast<uint>(point_count);
  frame_constants.material_count = static_cast<uint>(materials.size());
  frame_constants.immediate = params.law == simulation::RemovalLaw::kImmediate ? 1 : 0;
}

// For brute force: lists all balls and points once, for all frames.
void VulkanEngine::Impl::ListEverything() {
  std::vector<vec4> copies(ball_count);
  ReadBalls(*program, copies.data(), ball_count);
  std::vector<ListEntry> entries(std::max(ball_count, point_count));
  for (std::size_t i = 0; i < entries.size(); ++i)
    entries[i] = {
        .index = static_cast<uint>(i), .first = 0, .count = frame_constants.cutter_count, .more = 0};
  program->Write(kBindLiveBalls, copies.data(), ball_count * sizeof(vec4));
  std::vector<uint> slots(ball_count);
  std::iota(slots.begin(), slots.end(), 0u);
  program->Write(kBindSlots, slots.data(), slots.size() * sizeof(uint));
  program->Write(kBindLiveEntries, entries.data(), ball_count * sizeof(ListEntry));
  copies.resize(point_count);
  program->Read(kBindPoints, copies.data(), point_count * sizeof(vec4));
  std::vector<uint> states(point_count);
  program->Read(kBindPointStates, states.data(), point_count * sizeof(uint));
  for (std::size_t i = 0; i < point_count; ++i) {
    entries[i].more = states[i] & (kCleared - 1);
    if ((states[i] & kCleared) != 0) copies[i].w = -copies[i].w;
  }
  program->Write(kBindPointEntries, entries.data(), point_count * sizeof(ListEntry));
  program->Write(kBindLivePoints, copies.data(), point_count * sizeof(vec4));
  std::vector<ShaftPair> pairs;
  if (frame_constants.tool_count > frame_constants.cutter_count)
    for (std::size_t i = 0; i < ball_count; ++i)
      pairs.push_back({.slot = static_cast<uint>(i),
                       .first = static_cast<uint>(FirstShaftPackedPair()),
                       .count = frame_constants.tool_count - frame_constants.cutter_count,
                       .min_gap = 0});
  program->Write(kBindLiveEntries, pairs.data(), pairs.size() * sizeof(ShaftPair),
                 frame_constants.live_capacity * sizeof(ListEntry));
  lists.made = true;
  lists.ball_reach_mm = lists.point_reach_mm = std::numeric_limits<float>::max();
  lists.longest_pair_range =
      std::max(frame_constants.cutter_count, frame_constants.tool_count - frame_constants.cutter_count);
  lists.balls = static_cast<uint>(ball_count);
  lists.points = static_cast<uint>(point_count);
  lists.shaft = static_cast<uint>(pairs.size());
}

// Runs every pass once with the tool at the first ball and the spindle stopped, so that nothing is cut. Later
// frames then do not wait for the driver to compile a pass.
bool VulkanEngine::Impl::WarmUp(const simulation::Bone& bone) {
  simulation::FrameInput input;
  Pose at_ball = Pose::Identity();
  if (!bone.balls.empty()) at_ball.translation() = Vector3(bone.balls.front().center_m);
  input.X_WT = X_WG * at_ball;
  input.dt_s = 0.0;
  memory.X_GP = at_ball;
  const Frame f = PrepareFrame(input);
  const bool done = RunFrame(f, FrameMode::kListsAtContact) && RunFrame(f, FrameMode::kListsAtProxy) &&
                    RunFrame(f, FrameMode::kLists);
  memory = {};
  had_no_contact = true;
  if (brute_force) ListEverything();
  return done;
}

}  // namespace osteon::gpu
