#include "gpu/engine_impl.h"

#include <bit>
#include <limits>

namespace osteon::gpu {

// The tool's balls and their groups at the proxy and at the tool's pose, for the device and for Prepare.
void VulkanEngine::Impl::Place(const Pose& X_GT) {
  vec4* placed = program->host<vec4>(kBindTool);
  const vec4* whole = placed;
  start_m.resize(tool.balls.size());
  goal_m.resize(tool.balls.size());
  for (std::size_t t = 0; t < tool.balls.size(); ++t) {
    start_m[t] = memory.X_GP * tool.balls[t].center_T_m;
    goal_m[t] = X_GT * tool.balls[t].center_T_m;
    *placed++ = ToMillimetres(start_m[t], tool.balls[t].radius_m * kMillimetres);
    *placed++ = ToMillimetres(goal_m[t], 0.0);
  }
  vec4* rest = placed + 2 * tool.group_bounds.size();
  for (std::size_t t = 0; t < tool.balls.size(); ++t) {
    *rest++ = Rest(start_m[t], tool.balls[t].radius_m, whole[2 * t]);
    *rest++ = Rest(goal_m[t], 0.0, whole[2 * t + 1]);
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
  f.exact.start = Exactly(memory.X_GP.translation());
  f.exact.goal = Exactly(X_GT.translation());
  f.exact.axis = {X_GT(0, 2), X_GT(1, 2), X_GT(2, 2)};
  f.exact.spindle_rad_per_s = input.spindle_rad_per_s;
  f.exact.dt_s = input.dt_s;
  f.exact.work_held_back =
      memory.debt_J * std::min(1.0, input.dt_s / simulation::kDebtSeconds) * kMillimetres;
  double way_m = (X_GT.translation() - memory.X_GP.translation()).norm();
  for (std::size_t t = 0; t < start_m.size(); ++t) {
    way_m = std::max(way_m, (goal_m[t] - start_m[t]).norm());
  }
  f.rounding_mm = static_cast<float>(
      kMillimetres * (kPlaceRounding * (extent_m + way_m) + kWayRounding * way_m * way_m / least_radius_m));
  if (lists.made && !brute_force) MeasureDrift(f);
  // slide and advance together: at most max_slide, but for the immediate law, which goes all the way
  const double step_m = params.max_slide_m + (params.law == simulation::RemovalLaw::kImmediate ? way_m : 0.0);
  f.ball_reach_mm = static_cast<float>(kMillimetres * std::max(params.normal_enlargement_m, step_m));
  f.point_reach_mm = static_cast<float>(kMillimetres * std::max(params.engaged_layer_m, step_m));
  f.contact_key = f.slide_key = f.straight_key = std::bit_cast<std::uint64_t>(simulation::kNoContact);
  f.bin_keys.fill(std::numeric_limits<std::uint64_t>::max());
  const simulation::ContactMemory& contact = memory.contact;
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact.face_count); ++i) {
    f.face_n[i] = Unscaled(contact.face_n_G[i]);
    f.exact.face_n[i] = {contact.face_n_G[i].x, contact.face_n_G[i].y, contact.face_n_G[i].z};
  }
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
  capsules.resize(2 * tool.cutter_count);
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
    f.frame_work = {.x = program->GroupsOfOneDispatch(std::max({lists.balls, lists.points, lists.shaft})),
                    .y = 1,
                    .z = 1};
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
  const bool at_once = f.frame_work.x > 0;
  std::memcpy(&program->frame(), &f, sizeof(Frame));
  if (!program->Run(at_once ? FrameMode::kOneDispatch : mode, brute_force         ? kBruteTimeout_ns
                                                              : memory.frame == 0 ? kWarmUpTimeout_ns
                                                                                  : kFrameTimeout_ns))
    return false;
  const Frame& done = program->result();
  if (at_once && done.gave_up != 0) {
    program->GiveUpOneDispatch();
    return RunFrame(prepared, mode);
  }
  stats = {.active_balls = done.live_ball_count,
           .active_points = done.live_point_count,
           .lists_made = mode != FrameMode::kLists,
           .one_dispatch = at_once};
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
  const double s = std::min(1.0, std::bit_cast<double>(done.contact_key));
  for (std::size_t t = 0; t < start_m.size(); ++t)
    lists.built_m[t] = start_m[t] + s * (goal_m[t] - start_m[t]);
  return true;
}

}  // namespace osteon::gpu
