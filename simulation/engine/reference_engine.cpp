#include "simulation/engine/reference_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "simulation/contact/contact_law.h"
#include "simulation/contact/cutting_math.h"

namespace osteon::simulation {

namespace {

// Value for the index of the only ball that cuts: all cutting balls cut.
constexpr std::size_t kEveryBall = std::numeric_limits<std::size_t>::max();

// Returns the balls of the uncut bone, rounded to the floats that engines store.
std::vector<BallState> InitialBallStates(const std::vector<Ball>& balls) {
  std::vector<BallState> states;
  states.reserve(balls.size());
  for (const Ball& ball : balls)
    states.push_back(RoundToStored({.center_m = ball.center_m, .radius_m = ball.radius_m}));
  return states;
}

// Rounds places and volumes of the mass points to the floats that engines store.
std::vector<MassPoint> RoundPoints(std::vector<MassPoint> points) {
  for (MassPoint& point : points) {
    point.p_m = RoundToStored({.center_m = point.p_m, .radius_m = 0.0}).center_m;
    point.volume_m3 = 1e-9 * static_cast<float>(point.volume_m3 * 1e9);
  }
  return points;
}

// Returns the path length of the tool point that moves farthest.
double LongestPath(const ToolPoints& from, const ToolPoints& to) {
  double longest = 0.0;
  for (std::size_t t = 0; t < to.size(); ++t) longest = std::max(longest, (to[t] - from[t]).norm());
  return longest;
}

}  // namespace

ReferenceEngine::ReferenceEngine(const Bone& bone, const Tool& tool, const Pose& X_WG,
                                 const CuttingParams& params, Loops loops)
    : tool_(tool),
      lever_m_(ToolLever(tool)),
      materials_(MaterialsUnderTool(bone, tool, params)),
      map_(bone),
      points_(RoundPoints(bone.points)),
      X_WG_(X_WG),
      params_(params),
      balls_(InitialBallStates(bone.balls)),
      removal_(balls_, params.split),
      cleared_(bone.points.size(), 0),
      loops_(loops) {
  if (materials_.size() > kMaxMaterials) throw std::invalid_argument("bone: more than 8 materials");
  if (tool_.balls.empty()) throw std::invalid_argument("tool: no ball");
}

ContactModel ReferenceEngine::Step(const FrameInput& input) {
  if (!IsUsable(input)) {
    ContactModel refused;
    refused.status = EngineStatus::kBadInput;
    return refused;
  }
  if (!memory_.has_proxy) memory_.X_GP = X_WG_.inverse() * Pose(input.X_WT);
  const Pose X_WP = X_WG_ * Pose(memory_.X_GP);
  return StepInParts(input, X_WP, SubframeCount(lever_m_, X_WP, Pose(input.X_WT)), memory_,
                     [this](const FrameInput& part) { return StepPart(part); });
}

// Computes one part of a frame (StepInParts) in the three passes that the header lists.
ContactModel ReferenceEngine::StepPart(const FrameInput& input) {
  const Pose X_GT = X_WG_.inverse() * Pose(input.X_WT);
  const bool cutting = input.spindle_rad_per_s != 0.0;
  FrameSolution solution;

  // pass 1: first contact on the straight path from the proxy's pose to the tool's pose
  const ToolPoints start = PlaceTool(tool_, memory_.X_GP), goal = PlaceTool(tool_, X_GT);
  FindNear(start, goal, 0.0, on_way_);
  solution.contact_fraction = std::min(1.0, FirstContact(on_way_, start, goal, 0.0));
  const ToolPoints contact = InterpolatePoints(start, goal, solution.contact_fraction);
  solution.origin_contact = contact.back();
  const double max_m = MaxSlide(params_, input);
  FindNear(contact, contact, std::max({max_m, params_.normal_enlargement_m, params_.engaged_layer_m}), near_);

  // pass 2: find the pairs near the tool at first contact, and the pose closest to the tool's pose that
  // violates none of their planes; then move the proxy towards it
  const ContactInput asked{.R_GT = X_GT.linear(),
                           .motion_G_m = goal.back() - contact.back(),
                           .turn_G = (1.0 - solution.contact_fraction) *
                                     LogRotation(X_GT.linear() * memory_.X_GP.linear().transpose()),
                           .friction = cutting ? 0.0 : memory_.contact.friction};
  const bool turning = asked.turn_G != Vector3::Zero();
  const NearField near = FindNearField(contact, goal, asked.R_GT);
  const Candidates candidates = FindCandidates(near, params_.contact_tolerance_m);
  const ContactSolution held = SolveContacts(candidates, asked, true);
  FillContacts(params_, near, candidates, held, turning ? SolveContacts(candidates, asked, false) : held,
               asked, memory_.contact, solution);
  // ends of the slide: target with the turn, straight without it
  ToolPoints target = goal, straight = contact;
  for (Vector3& point : target) point += solution.delta;
  for (Vector3& point : straight) point += solution.shift;
  const Slid full =
      Slide(contact, target, (turning ? kTurnToleranceShare : 1.0) * params_.contact_tolerance_m, max_m);
  const Slid unturned = turning ? Slide(contact, straight, params_.contact_tolerance_m, max_m) : full;
  // if bone prevents the turn, the tool still slides without turning
  const bool turns = SlidesTurning(full.stopped, full.way_m, unturned.way_m, kRotationBias_m);
  const Slid& chosen = turns ? full : unturned;
  solution.slide_fraction = chosen.fraction;
  solution.turn_fraction = turns ? chosen.fraction : 0.0;
  solution.slide_m = chosen.way_m;
  const ToolPoints slid = InterpolatePoints(contact, turns ? target : straight, chosen.fraction);
  solution.origin_slid = slid.back();

  // pass 3: compute how far the cutting edge advances into bone, and remove bone
  MeasureEngagement(contact, X_GT.linear().col(2), solution);
  const FrameAdvance advance = ComputeAdvance(params_, materials_, solution, input.spindle_rad_per_s,
                                              input.dt_s, memory_.energy_lead_J);
  solution.advance_m = advance.advance_m;
  solution.edge_work_J = advance.edge_work_J;
  solution.ploughing_work_J = advance.ploughing_work_J;
  solution.step = ComputeAdvanceStep(params_, input, solution, goal.back());
  solution.origin_end = ComputeAdvanceEnd(solution);
  if (cutting) {
    ToolPoints end = slid;
    for (Vector3& point : end) point += solution.origin_end - solution.origin_slid;
    const std::size_t only = params_.cutters == Cutters::kContactSphere
                                 ? FirstTouchingBall(start, goal, solution.contact_fraction)
                                 : kEveryBall;
    if (!near_.Holds(tool_, slid) || !near_.Holds(tool_, end))
      FindNear(slid, end, LongestPath(contact, slid), near_);
    Remove(SweptBy(contact, slid, end, only), solution);
  }
  ContactModel model = FinishFrame(params_, materials_, map_, X_WG_, input, solution, memory_);
  model.balls_not_split = removal_.refused();
  return model;
}

// Finds the balls and points that the tool can meet on a straight path. With splitting, the balls' indices
// change from frame to frame, so the balls and points are then found anew each time.
void ReferenceEngine::FindNear(const ToolPoints& from, const ToolPoints& to, double farther_m,
                               ToolReach& near) const {
  if (params_.split.on) near.Forget();
  near.Update(tool_, from, to, loops_ == Loops::kAll ? std::numeric_limits<double>::infinity() : farther_m,
              balls_, points_);
}

// Fraction of the motion at which the first pair of balls overlaps by the tolerance. Smaller overlaps are no
// contact yet.
double ReferenceEngine::FirstContact(const ToolReach& near, const ToolPoints& from, const ToolPoints& to,
                                     double tolerance_m) const {
  double first = kNoContact;
  for (std::size_t i = 0; i < near.balls().items.size(); ++i) {
    const BallState& ball = balls_[near.balls().items[i]];
    if (ball.radius_m <= 0.0) continue;
    for (const std::uint32_t t : near.balls().ToolBallsOf(i))
      first = std::min(first, FirstContactFraction(ball.center_m - from[t], to[t] - from[t],
                                                   tool_.balls[t].radius_m + ball.radius_m - tolerance_m));
  }
  return first;
}

// Slides the tool straight ahead, until a pair overlaps by the tolerance or a tool point has moved by max_m.
ReferenceEngine::Slid ReferenceEngine::Slide(const ToolPoints& from, const ToolPoints& to, double tolerance_m,
                                             double max_m) const {
  const double longest = LongestPath(from, to);
  const double limit = longest > max_m ? max_m / longest : 1.0;
  const double met = FirstContact(near_, from, to, tolerance_m);
  const double fraction = std::min(limit, met);
  return {.fraction = fraction, .way_m = fraction * longest, .stopped = met < limit};
}

// Finds, with the tool at `at`: the nearest pair of each bin of direction, the sums over the cone of each
// face of the previous frame, and the present gaps of the remembered pairs.
// @param goal  the tool's balls at the tool's pose X_GT
NearField ReferenceEngine::FindNearField(const ToolPoints& at, const ToolPoints& goal,
                                         const Matrix3& R_GT) const {
  NearField near;
  const Matrix3 bin_axes = RoundToFloat(R_GT);  // rounded as on the GPU
  const ContactMemory& memory = memory_.contact;
  const auto pair_of = [&](std::size_t b, std::size_t t) {
    const Vector3 from_bone = at[t] - balls_[b].center_m;
    const double distance = from_bone.norm();
    NearPair pair{.pair = {static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(t)},
                  .present = balls_[b].radius_m > 0.0 && distance > 0.0,
                  .cutting = tool_.balls[t].cutting,
                  .gap_m = distance - tool_.balls[t].radius_m - balls_[b].radius_m,
                  .motion_m = goal[t] - at[t],
                  .center_T_m = tool_.balls[t].center_m,
                  .tool_radius_m = tool_.balls[t].radius_m};
    if (pair.present) pair.n = from_bone / distance;
    return pair;
  };
  for (std::size_t i = 0; i < near_.balls().items.size(); ++i) {
    const std::size_t b = near_.balls().items[i];
    if (balls_[b].radius_m <= 0.0) continue;
    for (const std::uint32_t t : near_.balls().ToolBallsOf(i)) {
      NearPair pair = pair_of(b, t);
      if (!pair.present || pair.gap_m >= params_.normal_enlargement_m) continue;
      const ContactBin bin = FindBin(bin_axes.transpose() * pair.n, pair.cutting);
      pair.score_m = pair.gap_m + kBinCentreBias_m * bin.off_centre;
      NearPair& nearest = near.nearest[static_cast<std::size_t>(bin.number)];
      if (Nearer(pair, nearest)) nearest = pair;
      const double lens = std::min(LensVolume(pair.tool_radius_m + params_.normal_enlargement_m,
                                              balls_[b].radius_m, (at[t] - balls_[b].center_m).norm()),
                                   kMaxLensVolume);
      for (int f = 0; f < memory.face_count; ++f) {
        const auto face = static_cast<std::size_t>(f);
        near.faces[face].Add(lens, memory.face_n_G[face], pair);
      }
    }
  }
  near.held_count = memory.held_count;
  for (int k = 0; k < memory.pair_count; ++k) {
    const ContactPair& known = memory.pairs[static_cast<std::size_t>(k)];
    if (known.bone_ball < balls_.size() && known.tool_ball < tool_.balls.size())
      near.remembered[static_cast<std::size_t>(k)] = pair_of(known.bone_ball, known.tool_ball);
  }
  // remembered pairs whose gap has become large no longer constrain the tool
  for (NearPair& pair : near.remembered)
    pair.present = pair.present && pair.gap_m < params_.normal_enlargement_m;
  return near;
}

// Measures the area of the cutting surface in bone, by material: volume of the mass points within a layer at
// the surface, divided by the layer's depth and projected along the contact normal. The moment is area times
// distance from the spindle's axis.
void ReferenceEngine::MeasureEngagement(const ToolPoints& at, const Vector3& spindle_axis_G,
                                        FrameSolution& solution) const {
  if (solution.cutting_m <= 0.0) return;
  for (std::size_t k = 0; k < near_.points().items.size(); ++k) {
    const std::size_t i = near_.points().items[k];
    if (cleared_[i]) continue;
    const MassPoint& point = points_[i];
    const Vector3 p = point.p_m;
    double nearest = params_.engaged_layer_m, projection = 0.0;
    for (const std::uint32_t t : near_.points().ToolBallsOf(k)) {
      if (!tool_.balls[t].cutting) continue;
      const Vector3 out = p - at[t];
      const double distance = out.norm(), gap = distance - tool_.balls[t].radius_m;
      if (std::abs(gap) >= params_.engaged_layer_m || gap >= nearest) continue;
      nearest = gap;
      projection = distance > 0.0 ? std::max(0.0, -solution.n.dot(out) / distance) : 0.0;
    }
    if (projection <= 0.0) continue;
    const double area = point.volume_m3 / params_.engaged_layer_m * projection;
    const double arm = (p - at.back()).cross(spindle_axis_G).norm();
    solution.engaged_area_m2[point.material] += area;
    solution.engaged_moment_m3[point.material] += area * arm;
  }
}

// Index of the tool ball that touches first on this motion; if several touch at the same time, the lowest
// index. If none touches, the number of tool balls. @param first  fraction of the motion at first contact
std::size_t ReferenceEngine::FirstTouchingBall(const ToolPoints& from, const ToolPoints& to,
                                               double first) const {
  const double last = std::min(1.0, first + kTieTolerance_m / LongestPath(from, to));
  std::size_t touching = tool_.balls.size();
  for (std::size_t i = 0; i < on_way_.balls().items.size(); ++i) {
    const BallState& ball = balls_[on_way_.balls().items[i]];
    if (ball.radius_m <= 0.0) continue;
    for (const std::uint32_t t : on_way_.balls().ToolBallsOf(i))
      if (t < touching && FirstContactFraction(ball.center_m - from[t], to[t] - from[t],
                                               tool_.balls[t].radius_m + ball.radius_m) <= last)
        touching = t;
  }
  return touching;
}

// Computes the volumes that the cutting balls sweep on both pieces of the proxy's path (slide and advance),
// one ball after the other.
// @param only  index of the only ball that cuts, or kEveryBall
ReferenceEngine::Swept ReferenceEngine::SweptBy(const ToolPoints& contact, const ToolPoints& slid,
                                                const ToolPoints& end, std::size_t only) const {
  Swept swept{.capsules = {}, .first = std::vector<std::size_t>(tool_.balls.size() + 1, 0)};
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    if (tool_.balls[t].cutting && (only == kEveryBall || only == t)) {
      const double radius_m = tool_.balls[t].radius_m;
      swept.capsules.push_back({.a = contact[t], .b = slid[t], .radius_m = radius_m});
      swept.capsules.push_back({.a = slid[t], .b = end[t], .radius_m = radius_m});
    }
    swept.first[t + 1] = swept.capsules.size();
  }
  return swept;
}

// Shrinks or splits the bone balls in the swept volume, clears the mass points in it, and adds up their
// volume.
void ReferenceEngine::Remove(const Swept& swept, FrameSolution& solution) {
  if (params_.split.on) {  // only BallRemoval can split; without splitting, each ball simply shrinks
    removal_.Remove(swept.capsules, balls_);
    for (BallState& ball : balls_) ball = RoundToStored(ball);
  } else {
    for (std::size_t i = 0; i < near_.balls().items.size(); ++i) {
      BallState& ball = balls_[near_.balls().items[i]];
      for (const std::uint32_t t : near_.balls().ToolBallsOf(i)) Shrink(ball, swept.Of(t));
      ball = RoundToStored(ball);
    }
  }
  for (std::size_t k = 0; k < near_.points().items.size(); ++k) {
    const std::size_t i = near_.points().items[k];
    const Vector3 p = points_[i].p_m;
    for (const std::uint32_t t : near_.points().ToolBallsOf(k))
      for (const Capsule& capsule : swept.Of(t)) {
        if (cleared_[i] || (p - ClosestOnSegment(p, capsule.a, capsule.b)).norm() >= capsule.radius_m)
          continue;
        cleared_[i] = 1;
        solution.removed_m3[points_[i].material] += points_[i].volume_m3;
      }
  }
}

CarvedState ReferenceEngine::Snapshot() const {
  CarvedState state;
  removal_.Save(balls_, state);
  state.cleared = cleared_;
  ToState(memory_, state);
  // Renumber the bone balls of the remembered pairs: a saved state numbers the children of split balls in
  // another way. Pairs whose ball is not saved are dropped.
  ContactMemory& contact = state.contact;
  const std::int32_t count = std::exchange(contact.pair_count, 0),
                     held = std::exchange(contact.held_count, 0);
  for (std::int32_t i = 0; i < count; ++i) {
    const ContactPair pair = contact.pairs[static_cast<std::size_t>(i)];
    const auto saved = removal_.SavedIndex(pair.bone_ball);
    if (!saved) continue;
    contact.pairs[static_cast<std::size_t>(contact.pair_count++)] = {*saved, pair.tool_ball};
    if (i < held) ++contact.held_count;
  }
  return state;
}

void ReferenceEngine::Restore(const CarvedState& state) {
  if (state.cleared.size() != cleared_.size()) throw std::invalid_argument("carved state: not of this bone");
  CheckMemory(state, tool_.balls.size());
  removal_.Load(state, balls_);
  on_way_.Forget();
  near_.Forget();
  cleared_ = state.cleared;
  memory_ = ToMemory(state);
}

}  // namespace osteon::simulation
