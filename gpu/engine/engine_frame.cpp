#include "gpu/engine/engine_impl.h"
#include "gpu/program/double_single.h"

#include <bit>
#include <cmath>
#include <limits>

namespace osteon::gpu {

// Number of a cluster's tool balls up to which one workgroup handles the cluster. The workgroup visits each
// tool ball four times for each bone ball; with more tool balls, llvmpipe would end its loops early.
constexpr uint kMaxRefsOfAWorkgroup = 1'800;

// Computes the tool balls' positions at the proxy and at the tool's pose; stores them for the host and writes
// them to the device.
void VulkanEngine::Impl::PlaceToolBalls(const Pose& pose) {
  X_GT = pose;
  const std::size_t count = tool.balls.size();
  start_m.resize(count);
  goal_m.resize(count);
  // `placed` is filled on the host and then copied to the device's memory in one write. The host does not
  // read that memory: reading is slow and may return an older value.
  placed.resize(4 * count);
  for (std::size_t t = 0; t < count; ++t) {
    start_m[t] = memory.X_GP * tool.balls[t].center_T_m;
    goal_m[t] = X_GT * tool.balls[t].center_T_m;
    placed[2 * t] = ToMillimetres(start_m[t], tool.balls[t].radius_m * kMillimetres);
    placed[2 * t + 1] = ToMillimetres(goal_m[t], 0.0);
    placed[2 * (count + t)] = FloatRemainder(start_m[t], tool.balls[t].radius_m, placed[2 * t]);
    placed[2 * (count + t) + 1] = FloatRemainder(goal_m[t], 0.0, placed[2 * t + 1]);
    placed[2 * t + 1].w = static_cast<float>(tool.number[t]);
  }
  std::memcpy(program->host<vec4>(kBindTool), placed.data(), placed.size() * sizeof(vec4));
}

// Returns a frame with its inputs: the tool's poses, the contact memory, and the reaches of the lists. Sets
// X_GT to the tool's new pose.
Frame VulkanEngine::Impl::PrepareFrame(const simulation::FrameInput& input) {
  PlaceToolBalls(X_WG.inverse() * Pose(input.X_WT));
  Frame frame = frame_constants;
  frame.start = ToMillimetres(memory.X_GP.translation(), 0.0);
  frame.goal = ToMillimetres(X_GT.translation(), 0.0);
  frame.axis_x = Unscaled(X_GT.linear().col(0));
  frame.axis_y = Unscaled(X_GT.linear().col(1));
  frame.axis_z = Unscaled(X_GT.linear().col(2));
  const Vector3 turn = LogRotation(X_GT.linear() * memory.X_GP.linear().transpose());
  frame.turn = Unscaled(turn);
  frame.turning = turn != Vector3::Zero() ? 1 : 0;
  frame.spindle_rad_per_s = static_cast<float>(input.spindle_rad_per_s);
  frame.exact.start = Exactly(memory.X_GP.translation());
  frame.exact.goal = Exactly(X_GT.translation());
  frame.exact.axis = {X_GT(0, 2), X_GT(1, 2), X_GT(2, 2)};
  frame.exact.spindle_rad_per_s = input.spindle_rad_per_s;
  frame.exact.dt_s = input.dt_s;
  frame.exact.work_held_back =
      memory.energy_lead_J * std::min(1.0, input.dt_s / simulation::kEnergyLeadSeconds) * kMillimetres;
  // longest path of the tool's origin or of a ball's centre; it bounds the rounding of distances
  double way_m = (X_GT.translation() - memory.X_GP.translation()).norm();
  for (std::size_t t = 0; t < start_m.size(); ++t) {
    way_m = std::max(way_m, (goal_m[t] - start_m[t]).norm());
  }
  frame.rounding_mm = static_cast<float>(
      kMillimetres * (kPlaceRounding * (extent_m + way_m) + kWayRounding * way_m * way_m / min_radius_m));
  frame.path_mm = static_cast<float>(way_m * kMillimetres);
  if (lists.made && !brute_force) MeasureDisplacement(frame);
  // Largest motion after first contact: slide and advance together are at most max_slide; the immediate law
  // moves the tool along its whole path in addition.
  const double step_m = params.max_slide_m + (params.law == simulation::RemovalLaw::kImmediate ? way_m : 0.0);
  frame.ball_reach_mm = static_cast<float>(kMillimetres * std::max(params.normal_enlargement_m, step_m));
  frame.point_reach_mm = static_cast<float>(kMillimetres * std::max(params.engaged_layer_m, step_m));
  frame.contact_key = frame.slide_key = frame.straight_key = kNoContactKey;
  frame.bin_keys.fill(std::numeric_limits<Key64>::max());
  frame.touching = kNoToolBall;
  const simulation::ContactMemory& contact = memory.contact;
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact.face_count); ++i) {
    frame.face_n[i] = Unscaled(contact.face_n_G[i]);
    frame.exact.face_n[i] = {contact.face_n_G[i].x, contact.face_n_G[i].y, contact.face_n_G[i].z};
  }
  frame.remembered_count = static_cast<uint>(contact.pair_count);
  frame.held_count = static_cast<uint>(contact.held_count);
  for (std::size_t i = 0; i < frame.remembered_count; ++i) {
    frame.remembered_bone[i] = contact.pairs[i].bone_ball;
    frame.remembered_tool[i] = DeviceTool(contact.pairs[i].tool_ball);
  }
  frame.friction = input.spindle_rad_per_s != 0.0 ? 0.0f : static_cast<float>(contact.friction);
  return frame;
}

// Returns the number of list entries that one invocation handles; each entry has at most `range` tool balls.
// On a GPU: one. A processor computes shared values once for each workgroup, so it gets few, long workgroups,
// but several for each core. The number is bounded because llvmpipe ends the loops of an invocation after 65
// 535 iterations in total; no pass needs more than thirty iterations per pair.
uint VulkanEngine::Impl::Chunk(std::size_t entries, std::size_t range) const {
  constexpr std::size_t kMaxPairs = 2'000, kMaxEntries = 4096, kWorkgroups = 4;
  const std::size_t lanes = program->lanes();
  if (program->for_gpu()) return 1;
  const std::size_t max_entries =
      std::clamp<std::size_t>(kMaxPairs / std::max<std::size_t>(1, range), 1, kMaxEntries);
  const std::size_t share = entries / (kWorkgroups * lanes) + 1;
  return static_cast<uint>(std::clamp(share, std::min<std::size_t>(16, max_entries), max_entries));
}

// Returns the numbers of workgroups for a list of `entries` of which each invocation handles `chunk`, in
// `rows` rows.
DispatchArgs VulkanEngine::Impl::MakeDispatch(std::size_t entries, uint chunk, uint rows) const {
  const std::size_t share = std::size_t{program->lanes()} * chunk;
  // on a GPU the pass's last workgroup also does the next step of the frame, so there must be at least one
  const std::size_t min_groups = program->for_gpu() ? 1 : 0;
  return {.x = program->WithinLimit(std::max(min_groups, (entries + share - 1) / share)), .y = rows, .z = 1};
}

// Prepares writing the balls of the present lists back to the list of all balls; the frame's chunk must be
// set.
void VulkanEngine::Impl::SetFlush(Frame& frame) const {
  frame.flush_count = lists.made ? lists.balls : 0;
  frame.flush_work = MakeDispatch(frame.flush_count, frame.chunk, 1);
}

// Writes the balls of the present lists back to the buffers that Snapshot reads.
bool VulkanEngine::Impl::Flush() const {
  Frame frame = frame_constants;
  frame.chunk = Chunk(lists.balls, 1);
  SetFlush(frame);
  SetUploads(frame);
  return program->Run(frame, FrameMode::kFlush, frame_timeout_ns);
}

// Prepares the upload of the children of balls that were split after the previous frame.
void VulkanEngine::Impl::SetUploads(Frame& frame) const {
  if (!pool) return;
  const std::vector<SplitUpload>& uploads = pool->uploads();
  std::ranges::copy(uploads, program->host<SplitUpload>(kBindUploads));
  frame.upload_count = static_cast<uint>(uploads.size());
  frame.upload_work = {
      .x = program->WithinLimit((uploads.size() + program->lanes() - 1) / program->lanes()), .y = 1, .z = 1};
}

// Passes the frame's events and the capsules of its cutting balls to the split pool.
void VulkanEngine::Impl::EndSplits(const Frame& done, const simulation::FrameSolution& solution) {
  const std::span<const SplitEvent> events = program->split_events();
  if (events.empty() && pool->IsIdle()) return;
  capsules.clear();
  for (std::size_t t = 0; t < tool.cutter_count; ++t) {
    if (CutsAlone() && t != (done.touching & ((1u << kToolBits) - 1u))) continue;
    const Vector3 contact_m = start_m[t] + solution.contact_fraction * (goal_m[t] - start_m[t]);
    const Vector3 target_m =
        done.turns != 0 ? Vector3(goal_m[t] + solution.delta) : Vector3(contact_m + solution.shift);
    const Vector3 slid_m = contact_m + solution.slide_fraction * (target_m - contact_m);
    const double radius_m = tool.balls[t].radius_m;
    const Vector3 end_m = slid_m + solution.origin_end - solution.origin_slid;
    capsules.push_back({.a = contact_m, .b = slid_m, .radius_m = radius_m});
    capsules.push_back({.a = slid_m, .b = end_m, .radius_m = radius_m});
  }
  pool->EndFrame(events, capsules);
}

// Measures the displacement of the tool's balls since the lists were built and since their packed pairs were
// measured.
void VulkanEngine::Impl::MeasureDisplacement(Frame& frame) const {
  frame.cutting_displacement_start_mm = MaxDisplacement_mm(lists.built_m, start_m, true);
  frame.cutting_displacement_goal_mm = MaxDisplacement_mm(lists.built_m, goal_m, true);
  frame.shaft_displacement_start_mm = MaxDisplacement_mm(lists.built_m, start_m, false);
  frame.shaft_displacement_goal_mm = MaxDisplacement_mm(lists.built_m, goal_m, false);
  frame.cutting_measured_start_mm = MaxDisplacement_mm(lists.measured_m, start_m, true);
  frame.cutting_measured_goal_mm = MaxDisplacement_mm(lists.measured_m, goal_m, true);
  frame.shaft_measured_start_mm = MaxDisplacement_mm(lists.measured_m, start_m, false);
  frame.shaft_measured_goal_mm = MaxDisplacement_mm(lists.measured_m, goal_m, false);
}

// Largest distance [mm] between is_m and was_m of the cutting balls (`cuts`), or of the others.
float VulkanEngine::Impl::MaxDisplacement_mm(const std::vector<Vector3>& was_m,
                                             const std::vector<Vector3>& is_m, bool cuts) const {
  double max_m2 = 0.0;
  for (std::size_t t = cuts ? 0 : tool.cutter_count, end = cuts ? tool.cutter_count : is_m.size(); t < end;
       ++t)
    max_m2 = std::max(max_m2, (is_m[t] - was_m[t]).squaredNorm());
  return static_cast<float>(kMillimetres * std::sqrt(max_m2));
}

// Finds the clusters that come within the tool's reach, on its path (kListsAtContact) or at the proxy.
void VulkanEngine::Impl::FindWork(Frame& frame, FrameMode mode) {
  const bool whole_way = mode == FrameMode::kListsAtContact;
  // the sweep of a ball whose radius is enlarged by the reach
  const auto sweep = [&](const Vector3& start, const Vector3& goal, double radius_m, float reach_mm) {
    const vec4 a = ToMillimetres(start, radius_m * kMillimetres), b = ToMillimetres(goal, 0.0);
    const Eigen::Vector3f from(a.x, a.y, a.z), to(b.x, b.y, b.z);
    return BallSweep{.a = from, .b = whole_way ? to : from, .radius_mm = a.w + reach_mm};
  };
  // fills `items` with the clusters of a tree that come within reach of tool balls
  const auto find = [&](const ClusterTree& tree, float reach_mm, bool cutting_only,
                        std::vector<ClusterPairs>& items) {
    const auto sweep_of = [&](const Vector3& start, const Vector3& goal, double radius_m, bool cuts) {
      if (cutting_only && !cuts) return BallSweep{};
      return sweep(start, goal, radius_m,
                   reach_mm + (cuts ? frame_constants.cutting_skin_mm : frame_constants.shaft_skin_mm));
    };
    for (std::size_t g = 0; g < tool.groups.size(); ++g) {
      const ToolLayout::Item& bound = tool.group_bounds[g];
      group_sweeps[g] = sweep_of(memory.X_GP * bound.center_T_m, X_GT * bound.center_T_m, bound.radius_m,
                                 tool.Cuts(tool.groups[g].front()));
    }
    for (std::size_t t = 0; t < start_m.size(); ++t)
      ball_sweeps[t] = sweep_of(start_m[t], goal_m[t], tool.balls[t].radius_m, tool.Cuts(t));
    work->Add(tree, group_sweeps, ball_sweeps, items);
  };
  work->Clear();
  find(ball_tree, frame.ball_reach_mm, false, ball_cluster_pairs);
  // a block of children is listed wherever its parent's cluster is
  for (std::size_t i = 0, clusters = pool ? ball_cluster_pairs.size() : 0; i < clusters; ++i) {
    const ClusterPairs parents = ball_cluster_pairs[i];
    for (const uint block : pool->BlocksIn(parents.cluster))
      ball_cluster_pairs.push_back({.cluster = static_cast<uint>(pool->FirstCluster()) + block,
                                    .first = parents.first,
                                    .cutters = parents.cutters,
                                    .count = parents.count});
  }
  find(point_tree, frame.point_reach_mm, true, point_cluster_pairs);
  ClusterPairs* items = program->host<ClusterPairs>(kBindClusterPairs);
  std::copy(ball_cluster_pairs.begin(), ball_cluster_pairs.end(), items);
  std::copy(point_cluster_pairs.begin(), point_cluster_pairs.end(), items + ball_clusters);
  std::copy(work->refs().begin(), work->refs().end(), program->host<uint>(kBindToolRefs));
  // largest number of tool balls of any cluster; a list entry has no more
  uint longest = 1;
  for (const auto* list : {&ball_cluster_pairs, &point_cluster_pairs})
    for (const ClusterPairs& item : *list) longest = std::max(longest, item.count);
  frame.chunk = Chunk(std::numeric_limits<std::size_t>::max(), longest);
  const uint parts = longest < kMaxRefsOfAWorkgroup ? 1 : kGroupSize / program->lanes();
  frame.near_ball_clusters = static_cast<uint>(ball_cluster_pairs.size());
  frame.near_point_clusters = static_cast<uint>(point_cluster_pairs.size());
  frame.path_work = {.x = program->WithinLimit(ball_cluster_pairs.size()), .y = parts, .z = 1};
  frame.point_work = {.x = program->WithinLimit(point_cluster_pairs.size()), .y = parts, .z = 1};
}

// Runs a frame. False where the device is lost.
bool VulkanEngine::Impl::RunFrame(const Frame& prepared, FrameMode mode) {
  Frame frame = prepared;
  frame.lists_at_contact = mode == FrameMode::kListsAtContact ? 1 : 0;
  if (mode == FrameMode::kLists && !program->for_gpu() && !brute_force && tool.cutter_count > 1 &&
      frame.cutting_measured_start_mm > kRemeasureDisplacement_mm) {
    mode = FrameMode::kListsRefreshed;
    lists.measured_m = start_m;
    MeasureDisplacement(frame);
  }
  const bool keeps_lists = mode == FrameMode::kLists || mode == FrameMode::kListsRefreshed;
  if (keeps_lists) {
    const std::size_t pairs = std::max(lists.balls, lists.shaft),
                      all = std::max<std::size_t>(pairs, lists.points);
    frame.chunk = Chunk(all, lists.longest_pair_range);
    const uint shaft = lists.shaft > 0 ? 1 : 0;
    frame.pair_work = MakeDispatch(pairs, frame.chunk, 1 + shaft);
    frame.all_work = MakeDispatch(all, frame.chunk, 2 + shaft);
    frame.clear_work = MakeDispatch(all, frame.chunk, 2);
    frame.live_ball_count = lists.balls;
    frame.live_point_count = lists.points;
    frame.shaft_count = lists.shaft;
    frame.packed_pair_count = lists.packed_pairs;
  } else {
    FindWork(frame, mode);
    SetUploads(frame);
    SetFlush(frame);
    // at least one workgroup on a GPU, where the last one also does the next step of the frame
    const uint min_groups = program->for_gpu() ? 1 : 0;
    frame.pair_work = {.x = min_groups, .y = 2, .z = 1};
    frame.all_work = {.x = min_groups, .y = 3, .z = 1};
    frame.clear_work = {.x = min_groups, .y = 2, .z = 1};
    frame.packed_pair_count = static_cast<uint>(AllPackedPairs());
    lists.built_m = lists.measured_m = start_m;
    if (!brute_force) MeasureDisplacement(frame);
  }
  if (!program->Run(frame, mode,
                    brute_force         ? kBruteTimeout_ns
                    : memory.frame == 0 ? kWarmUpTimeout_ns
                                        : frame_timeout_ns))
    return false;
  const Frame& done = program->result();
  stats = {.active_balls = done.live_ball_count};
  if (keeps_lists) return true;
  if (pool) pool->Uploaded();
  // here the frame has built new lists
  lists.made = done.list_overflow == 0;
  lists.ball_reach_mm = done.ball_reach_mm;
  lists.point_reach_mm = done.point_reach_mm;
  lists.longest_pair_range = done.longest_pair_range;
  lists.balls = done.live_ball_count;
  lists.points = done.live_point_count;
  lists.shaft = done.shaft_count;
  lists.packed_pairs = done.packed_pair_count;
  if (mode == FrameMode::kListsAtProxy) return true;
  // kListsAtContact builds the lists at fraction s of the tool's path
  const double s = std::min(1.0, std::bit_cast<double>(done.contact_key));
  for (std::size_t t = 0; t < start_m.size(); ++t)
    lists.built_m[t] = lists.measured_m[t] = start_m[t] + s * (goal_m[t] - start_m[t]);
  return true;
}

}  // namespace osteon::gpu
