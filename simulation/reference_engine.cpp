#include "simulation/reference_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "simulation/cutting_math.h"

namespace osteon::simulation {

namespace {

constexpr std::size_t kEveryBall = std::numeric_limits<std::size_t>::max();

std::vector<BallState> StatesOf(const std::vector<Ball>& balls) {
  std::vector<BallState> states;
  states.reserve(balls.size());
  for (const Ball& ball : balls) states.push_back({.center_m = ball.center_m, .radius_m = ball.radius_m});
  return states;
}

}  // namespace

ReferenceEngine::ReferenceEngine(const Bone& bone, const Tool& tool, const Pose& X_WG,
                                 const CuttingParams& params)
    : tool_(tool),
      materials_(bone.materials),
      points_(bone.points),
      X_WG_(X_WG),
      params_(params),
      balls_(StatesOf(bone.balls)),
      removal_(balls_, params.split),
      cleared_(bone.points.size(), 0) {
  if (materials_.size() > kMaxMaterials) throw std::invalid_argument("bone: more than 8 materials");
  if (tool_.balls.empty()) throw std::invalid_argument("tool: no ball");
}

ContactModel ReferenceEngine::Step(const FrameInput& input) {
  if (!IsUsable(input)) {
    ContactModel refused;
    refused.status = EngineStatus::kBadInput;
    return refused;
  }
  const Pose X_GT = X_WG_.inverse() * Pose(input.X_WT);
  if (!memory_.has_proxy) memory_.X_GP = X_GT;
  const bool cutting = input.spindle_rad_per_s != 0.0;
  FrameSolution solution;

  // pass 1: how far the tool gets on its way from the last free pose
  const ToolPoints start = PlaceTool(tool_, memory_.X_GP), goal = PlaceTool(tool_, X_GT);
  solution.contact_fraction = std::min(1.0, FirstContact(start, goal, 0.0));
  const ToolPoints contact = Between(start, goal, solution.contact_fraction);
  solution.origin_contact = contact.back();

  // pass 2: planes around it there; the closest target that keeps them; and the way to it, ball by ball
  FindPlanes(contact, X_GT.linear(), solution);
  const Vector3 turn =
      (1.0 - solution.contact_fraction) * LogRotation(X_GT.linear() * memory_.X_GP.linear().transpose());
  SolveTarget(goal.back(), turn, solution);
  ToolPoints target = goal;
  for (Vector3& point : target) point += solution.delta;
  double longest = 0.0;
  for (std::size_t t = 0; t < target.size(); ++t)
    longest = std::max(longest, (target[t] - contact[t]).norm());
  solution.slide_fraction = std::min(longest > params_.max_slide_m ? params_.max_slide_m / longest : 1.0,
                                     FirstContact(contact, target, params_.contact_tolerance_m));
  solution.slide_m = solution.slide_fraction * longest;
  const ToolPoints slid = Between(contact, target, solution.slide_fraction);
  solution.origin_slid = slid.back();

  // pass 3: how far bone gives way, and what goes with it
  MeasureEngagement(contact, X_GT.linear().col(2), solution);
  const FrameAdvance advance =
      AdvanceOfFrame(params_, materials_, solution, input.spindle_rad_per_s, input.dt_s, memory_.debt_J);
  solution.advance_m = advance.advance_m;
  solution.edge_work_J = advance.edge_work_J;
  solution.origin_end = EndOfAdvance(solution);
  if (cutting) {
    ToolPoints end = slid;
    for (Vector3& point : end) point += solution.origin_end - solution.origin_slid;
    const std::size_t only =
        params_.cutters == Cutters::kContactSphere ? TouchingBall(start, goal) : kEveryBall;
    std::vector<Capsule> capsules;
    AddCapsules(contact, slid, only, capsules);
    AddCapsules(slid, end, only, capsules);
    Remove(capsules, solution);
  }
  ContactModel model = FinishFrame(params_, materials_, X_WG_, input, solution, memory_);
  model.balls_not_split = removal_.refused();
  return model;
}

// Smallest fraction over all pairs. Pairs that overlap by less than the tolerance may overlap up to it.
double ReferenceEngine::FirstContact(const ToolPoints& from, const ToolPoints& to, double tolerance_m) const {
  double first = kNoContact;
  for (const BallState& ball : balls_) {
    if (ball.radius_m <= 0.0) continue;
    for (std::size_t t = 0; t < tool_.balls.size(); ++t)
      first = std::min(first, FirstContactFraction(ball.center_m - from[t], to[t] - from[t],
                                                   tool_.balls[t].radius_m + ball.radius_m - tolerance_m));
  }
  return first;
}

void ReferenceEngine::FindPlanes(const ToolPoints& at, const Matrix3& R_GT, FrameSolution& solution) const {
  for (SolutionPlane& plane : solution.planes) plane.gap_m = std::numeric_limits<double>::infinity();
  for (const BallState& ball : balls_) {
    if (ball.radius_m <= 0.0) continue;
    for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
      const double r_t = tool_.balls[t].radius_m;
      const Vector3 from_bone = at[t] - ball.center_m;
      const double distance = from_bone.norm();
      const double weight = std::min(LensVolume(r_t + params_.normal_enlargement_m, ball.radius_m, distance),
                                     kLargestLensVolume);
      if (weight <= 0.0 || distance <= 0.0) continue;
      const Vector3 u = from_bone / distance;
      const int group = tool_.balls[t].cutting ? PlaneGroup(R_GT.transpose() * u) : kShaftPlane;
      SolutionPlane& plane = solution.planes[static_cast<std::size_t>(group)];
      plane.present = true;
      plane.n += weight * u;
      plane.point_m += weight * (at[t] - r_t * u);
      plane.weight += weight;
      plane.gap_m = std::min(plane.gap_m, distance - r_t - ball.radius_m);
    }
  }
  for (SolutionPlane& plane : solution.planes) {
    const double size = plane.n.norm();
    plane.present = plane.present && size > 1e-6 * plane.weight;  // opposite sides that cancel have no normal
    if (!plane.present) continue;
    plane.n /= size;
    plane.point_m /= plane.weight;
  }
}

// Area of the cutting surface that lies in bone: volume of the mass points within a layer of it over the
// layer's depth.
void ReferenceEngine::MeasureEngagement(const ToolPoints& at, const Vector3& spindle_axis_G,
                                        FrameSolution& solution) const {
  if (solution.cutting_m <= 0.0) return;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (cleared_[i]) continue;
    const MassPoint& point = points_[i];
    const Vector3 p = point.p_m;
    double nearest = params_.engaged_layer_m, projection = 0.0;
    for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
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

// The tool ball that touches first on this way, the first of several; past the last one where none does.
std::size_t ReferenceEngine::TouchingBall(const ToolPoints& from, const ToolPoints& to) const {
  double first = kNoContact;
  std::size_t touching = tool_.balls.size();
  for (std::size_t t = 0; t < tool_.balls.size(); ++t)
    for (const BallState& ball : balls_) {
      if (ball.radius_m <= 0.0) continue;
      const double s = FirstContactFraction(ball.center_m - from[t], to[t] - from[t],
                                            tool_.balls[t].radius_m + ball.radius_m);
      if (s >= first) continue;
      first = s;
      touching = t;
    }
  return touching;
}

// What the cutting balls sweep along one straight piece of the proxy's way, in their order.
void ReferenceEngine::AddCapsules(const ToolPoints& a, const ToolPoints& b, std::size_t only,
                                  std::vector<Capsule>& capsules) const {
  for (std::size_t t = 0; t < tool_.balls.size(); ++t)
    if (tool_.balls[t].cutting && (only == kEveryBall || only == t))
      capsules.push_back({.a = a[t], .b = b[t], .radius_m = tool_.balls[t].radius_m});
}

void ReferenceEngine::Remove(const std::vector<Capsule>& capsules, FrameSolution& solution) {
  removal_.Remove(capsules, balls_);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vector3 p = points_[i].p_m;
    for (const Capsule& capsule : capsules) {
      if (cleared_[i] || (p - ClosestOnSegment(p, capsule.a, capsule.b)).norm() >= capsule.radius_m) continue;
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
  return state;
}

void ReferenceEngine::Restore(const CarvedState& state) {
  if (state.cleared.size() != cleared_.size()) throw std::invalid_argument("carved state: not of this bone");
  removal_.Load(state, balls_);
  cleared_ = state.cleared;
  memory_ = ToMemory(state);
}

}  // namespace osteon::simulation
