#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/contact/cutting_math.h"
#include "simulation/engine_cpu/engine_impl.h"
#include "simulation/engine_cpu/rounding.h"

// The passes of a frame that call the kernels.

namespace osteon::simulation {
namespace {

// Calls ShrinkBall of cutting_math.h for the kernels (type ShrinkOnAxis). c, r: bone ball; a, b: ends of the
// tool ball's path [m].
void ShrinkNearAxis(double* c, double* r, const double* a, const double* b, double tool_radius) {
  Vector3 center(c[0], c[1], c[2]);
  ShrinkBall(center, *r, Vector3(a[0], a[1], a[2]), Vector3(b[0], b[1], b[2]), tool_radius);
  c[0] = center.x(), c[1] = center.y(), c[2] = center.z();
}

float ToMillimetres(double metres) { return static_cast<float>(1e3 * metres); }

}  // namespace

// Largest distance [m] that any tool ball, or the tool's origin, moves between two placements.
double CpuEngine::Impl::LongestWay(const cpu::ToolPlacement& a, const cpu::ToolPlacement& b) const {
  return kernels.farthest(a.places(), b.places(), 0, balls.count() + 1);
}

// Makes the data for the kernels that search for first contact on a straight path. @param longest_m
// LongestWay(from, to)
cpu::ContactPass CpuEngine::Impl::MakeContactPass(const cpu::ToolPlacement& from,
                                                  const cpu::ToolPlacement& to, double tolerance_m,
                                                  double longest_m) {
  kernels.ways(from.places(), to.places(), balls.count(), way_x_mm.data(), way_y_mm.data(), way_z_mm.data());
  return {.balls = bone.blocks(),
          .rows = lists.ball_rows(),
          .tool = balls.view(),
          .from = from.places(),
          .to = to.places(),
          .way_x_mm = way_x_mm.data(),
          .way_y_mm = way_y_mm.data(),
          .way_z_mm = way_z_mm.data(),
          .tolerance_m = tolerance_m,
          .tolerance_mm = ToMillimetres(tolerance_m),
          .displacement_mm = lists.displacement_mm(),
          .longest_way_mm = ToMillimetres(longest_m),
          .rounding_mm = rounding_mm,
          .every_row = cpu.brute_force};
}

// Returns the fraction of the path at the first contact with any ball of the bone, not only with listed
// balls.
double CpuEngine::Impl::FirstContactOnWay(const cpu::ContactPass& pass) const {
  double first = kNoContact;
  const cpu::Places &a = pass.from, &b = pass.to;
  for (std::uint32_t t = 0; t < balls.count(); ++t) {
    const float from[3] = {a.x_mm[t], a.y_mm[t], a.z_mm[t]}, to[3] = {b.x_mm[t], b.y_mm[t], b.z_mm[t]};
    float low[3], high[3];
    for (int k = 0; k < 3; ++k) low[k] = std::min(from[k], to[k]), high[k] = std::max(from[k], to[k]);
    const float radius_mm = balls.view().r_mm[t] + cpu::kListSlack_mm;
    const auto visit = [&](std::uint32_t begin, std::uint32_t end_block) {
      for (std::uint32_t k = begin; k < end_block; ++k) first = kernels.block_contact(pass, k, t, first);
    };
    bone.ball_tree.Find(
        [&](const float(&boxes)[6][8]) { return kernels.boxes_near(boxes, low, high, radius_mm); },
        [&](std::uint32_t cluster) {
          visit(8 * cluster, 8 * cluster + 8);
          if (!split) return;
          split->EachIn(cluster, [&](std::uint32_t number) {
            visit(split->FirstBlock(number), split->FirstBlock(number) + split->stride());
          });
        });
  }
  return first;
}

// Slides the tool from first contact straight towards `to`, with the result of ReferenceEngine::Slide.
CpuEngine::Impl::Slid CpuEngine::Impl::SlideTo(const cpu::ToolPlacement& to, double tolerance_m,
                                               double max_m) {
  const double longest = LongestWay(contact, to);
  const double limit = longest > max_m ? max_m / longest : 1.0;
  const cpu::ContactPass pass = MakeContactPass(contact, to, tolerance_m, longest);
  // contacts beyond the limit do not matter, so do not search for them
  const double met = kernels.first_contact(pass, std::nextafter(limit, 2.0));
  const double fraction = std::min(limit, met);
  return {.fraction = fraction, .way_m = fraction * longest, .stopped = met < limit};
}

// Computes the pair of a bone ball and a tool ball at first contact, with the formulas of
// ReferenceEngine::FindNearField.
NearPair CpuEngine::Impl::PairOf(std::size_t ball, std::size_t tool_ball) const {
  const BallState state = bone.BallAt(ball);
  const ToolBall& tool_state = tool.balls[tool_ball];
  const Vector3 at = contact.At(tool_ball), from_bone = at - state.center_m;
  const double distance = from_bone.norm();
  NearPair pair{.pair = {static_cast<std::uint32_t>(ball), static_cast<std::uint32_t>(tool_ball)},
                .present = state.radius_m > 0.0 && distance > 0.0,
                .cutting = tool_state.cutting,
                .gap_m = distance - tool_state.radius_m - state.radius_m,
                .motion_m = goal.At(tool_ball) - at,
                .center_T_m = tool_state.center_m,
                .tool_radius_m = tool_state.radius_m};
  if (pair.present) pair.n = from_bone / distance;
  return pair;
}

// Computes `near`: the nearest pair of each bin, the sums about each face, and the remembered pairs
// (ReferenceEngine::FindNearField).
void CpuEngine::Impl::FindNearField(const Matrix3& R_GT) {
  const ContactMemory& known = memory.contact;
  const Matrix3 bin_axes = RoundToFloat(R_GT);  // rounded as on the GPU
  cpu::NearFieldPass pass{};
  pass.balls = bone.blocks(), pass.rows = lists.ball_rows(), pass.tool = balls.view(),
  pass.at = contact.places();
  pass.enlargement_m = params.normal_enlargement_m, pass.middle_worth_m = kBinCentreBias_m;
  pass.face_cosine = kFaceCosine, pass.max_lens_m3 = kMaxLensVolume;
  pass.enlargement_mm = ToMillimetres(params.normal_enlargement_m);
  pass.displacement_mm = lists.displacement_mm(), pass.rounding_mm = rounding_mm;
  pass.every_row = cpu.brute_force;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) pass.axes[3 * c + r] = bin_axes(r, c);
  pass.face_count = known.face_count;
  for (std::size_t f = 0; f < static_cast<std::size_t>(known.face_count); ++f) {
    const Vector3 n = known.face_n_G[f];
    for (int a = 0; a < 3; ++a) pass.face_n[f][a] = n[a];
  }
  pass.near_place = scratch.near_place.data(), pass.near_tool = scratch.near_tool.data();
  pass.near_score = scratch.near_score.data(), pass.near_bin = scratch.near_bin.data();
  pass.cone_place = scratch.cone_place.data(), pass.cone_tool = scratch.cone_tool.data();
  pass.block_place = scratch.block_place.data(), pass.block_tool = scratch.block_tool.data();
  std::ranges::fill(pass.score, std::numeric_limits<double>::infinity());
  kernels.near_field(pass, likely_place.data(), likely_tool.data(), likely_count);
  StoreNearField(pass);
}

// Stores in `near` the pairs that the pass has found, and the pairs that held the tool in the previous frame.
void CpuEngine::Impl::StoreNearField(const cpu::NearFieldPass& pass) {
  likely_count = 0;
  for (std::size_t bin = 0; bin < near.nearest.size(); ++bin) {
    NearPair& nearest = near.nearest[bin];
    nearest = NearPair{};
    if (pass.score[bin] == std::numeric_limits<double>::infinity()) continue;
    nearest = PairOf(cpu::BallAtPlace(pass.best_place[bin]), pass.best_tool[bin]);
    nearest.score_m = pass.score[bin];
    likely_place[likely_count] = pass.best_place[bin], likely_tool[likely_count++] = pass.best_tool[bin];
  }
  // fill up to a multiple of eight, because kernels read eight pairs at a time
  for (std::size_t i = likely_count; i % cpu::kLanes != 0; ++i)
    likely_place[i] = likely_place[0], likely_tool[i] = likely_tool[0];
  for (std::size_t f = 0; f < near.faces.size(); ++f) {
    const double* s = pass.sums[f];
    near.faces[f] = {.weight = s[0],
                     .n = Vector3(s[1], s[2], s[3]),
                     .center_T = Vector3(s[4], s[5], s[6]),
                     .radius = s[7]};
  }
  const ContactMemory& known = memory.contact;
  near.held_count = known.held_count;
  for (NearPair& pair : near.remembered) pair = NearPair{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(known.pair_count); ++k) {
    NearPair& pair = near.remembered[k];
    pair = PairOf(known.pairs[k].bone_ball, known.pairs[k].tool_ball);
    // a remembered pair whose gap has become large no longer holds the tool
    pair.present = pair.present && pair.gap_m < params.normal_enlargement_m;
  }
}

// Measures the area of the cutting surface in bone, by material (ReferenceEngine::MeasureEngagement).
void CpuEngine::Impl::MeasureEngagement(const Vector3& spindle_axis_G, FrameSolution& solution) {
  if (solution.cutting_m <= 0.0) return;
  const Vector3 origin = contact.Origin();
  std::vector<cpu::PointList>& point_lists = lists.point_lists();
  for (std::size_t m = 0; m < point_lists.size(); ++m) {
    cpu::EngagementPass pass{};
    pass.points = point_lists[m].blocks.data(), pass.rows = point_lists[m].rows.rows();
    pass.tool = balls.view(), pass.at = contact.places();
    pass.layer_m = params.engaged_layer_m, pass.layer_mm = ToMillimetres(params.engaged_layer_m);
    for (int a = 0; a < 3; ++a)
      pass.n[a] = solution.n[a], pass.origin[a] = origin[a], pass.axis[a] = spindle_axis_G[a];
    pass.displacement_mm = lists.displacement_mm(), pass.rounding_mm = rounding_mm;
    pass.every_row = cpu.brute_force;
    kernels.engagement(pass);
    solution.engaged_area_m2[m] = pass.area_m2;
    solution.engaged_moment_m3[m] = pass.moment_m3;
  }
}

// Returns the index of the tool ball that touches first (ReferenceEngine::FirstTouchingBall). The list is
// valid at first contact, so it holds all pairs that touch there.
std::size_t CpuEngine::Impl::TouchingBall(double first) {
  const double longest_m = LongestWay(start, goal), last = std::min(1.0, first + kTieTolerance_m / longest_m);
  const cpu::ContactPass pass = MakeContactPass(start, goal, 0.0, longest_m);
  // only rows whose bound is at most this limit can have a contact on the path; the factor covers rounding to
  // floats
  const float limit =
      cpu.brute_force ? cpu::kNever : pass.displacement_mm + 1.000001f * pass.longest_way_mm + rounding_mm;
  std::size_t touching = balls.count();
  for (std::uint32_t b = 0; b < pass.rows.block_count; ++b) {
    if (pass.rows.block_bound[b] > limit) continue;
    for (std::uint32_t k = pass.rows.first[b]; k < pass.rows.first[b + 1]; ++k) {
      const std::uint32_t t = pass.rows.tool[k];
      if (t >= touching || pass.rows.bound[k] > limit) continue;
      if (kernels.block_contact(pass, pass.rows.block[b], t, kNoContact) <= last) touching = t;
    }
  }
  return touching;
}

// Pass 3, second half: shrinks or splits the balls in the swept volume, and clears the points in it.
// @param only  index of the only tool ball that cuts; -1: all cutting balls cut
// @param way_m  longest path of a tool ball from first contact to the frame's end
void CpuEngine::Impl::Remove(std::int32_t only, double way_m, FrameSolution& solution) {
  const cpu::SweepView sweep{.tool = balls.view(),
                             .contact = contact.places(),
                             .slid = slid.places(),
                             .end = end.places(),
                             .displacement_mm = lists.displacement_mm(),
                             .way_mm = ToMillimetres(way_m),
                             .rounding_mm = rounding_mm,
                             .only = only,
                             .every_row = cpu.brute_force};
  if (split) BeginSplits(sweep);
  cpu::RemovalPass pass{};
  pass.sweep = sweep, pass.balls = bone.blocks(), pass.rows = lists.ball_rows();
  pass.min_radius_m = kMinBallRadius, pass.on_axis_share = kOnAxis, pass.shrink_on_axis = ShrinkNearAxis;
  pass.scratch = scratch.rows.data(), pass.scratch_capacity = static_cast<std::uint32_t>(scratch.rows.size());
  if (split) {
    pass.first_child = bone.first_child_block(), pass.child_stride = split->stride();
    pass.min_child_m = split->min_child_m(), pass.touched_children = scratch.touched_children.data();
  }
  kernels.removal(pass);
  stats.balls_changed += pass.balls_changed;
  if (split)
    for (const std::uint32_t number :
         split->End(std::span(scratch.touched_children).first(pass.touched_count)))
      lists.AddChildren(number);
  EndStage(CpuStage::kRemoval);
  ClearPoints(sweep, solution);
  EndStage(CpuStage::kClearing);
}

// Writes the capsules that the cutting balls sweep to the scratch memory, for the splitter.
void CpuEngine::Impl::FindCapsules(std::int32_t only) {
  scratch.capsules.clear();
  for (std::uint32_t t = 0; t < balls.count(); ++t) {
    if (!tool.balls[t].cutting || (only >= 0 && only != static_cast<std::int32_t>(t))) continue;
    const double radius_m = tool.balls[t].radius_m;
    scratch.capsules.push_back({.a = contact.At(t), .b = slid.At(t), .radius_m = radius_m});
    scratch.capsules.push_back({.a = slid.At(t), .b = end.At(t), .radius_m = radius_m});
  }
}

// Finds the large balls that the sweep may touch, and lets the splitter decide which of them to split.
void CpuEngine::Impl::BeginSplits(const cpu::SweepView& sweep) {
  cpu::LargeBallPass pass{};
  pass.sweep = sweep, pass.balls = bone.blocks(), pass.rows = lists.ball_rows();
  // slightly smaller, because this value is rounded; BallSplitter then decides exactly
  pass.larger_than_mm = std::nextafter(ToMillimetres(split->params().min_radius_m), 0.0f);
  pass.end_block = bone.first_child_block();
  pass.ball = scratch.large.data();
  kernels.large_balls(pass);
  if (pass.count > 0 || split->any_waiting()) FindCapsules(sweep.only);
  split->Begin(std::span(scratch.large).first(pass.count), scratch.capsules);
}

// Clears the points in the swept volume, also in the lists, and adds up their volume.
void CpuEngine::Impl::ClearPoints(const cpu::SweepView& sweep, FrameSolution& solution) {
  for (cpu::PointList& list : lists.point_lists()) {
    cpu::ClearingPass pass{.sweep = sweep,
                           .points = list.blocks.data(),
                           .rows = list.rows.rows(),
                           .cleared = scratch.cleared.data(),
                           .count = 0};
    kernels.clearing(pass);
    for (std::size_t i = 0; i < pass.count; ++i) {
      cpu::PointBlock& block = list.blocks[scratch.cleared[i] / 8];
      const std::size_t k = scratch.cleared[i] % 8, point = block.index[k];
      bone.Clear(point);
      lists.NoteCleared(static_cast<std::uint32_t>(point));
      solution.removed_m3[bone.material(point)] += bone.volume_m3(point);
      block.x[k] = block.y[k] = block.z[k] = cpu::kFarAway_mm;
      block.area_m2[k] = 0.0;
    }
    stats.points_cleared += pass.count;
  }
}

}  // namespace osteon::simulation
