#include "control/coupling/virtual_coupling.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "kinematics/half_spaces.h"
#include "safety/limits.h"
#include "safety/watchdog.h"

namespace osteon::control {
namespace {

using simulation::Contact;
using simulation::ContactModel;
using simulation::kMaxContacts;

// Bounds of plausible values: beyond them a value comes from a broken sender, not from a bone in a cell.
constexpr double kMaxPosition_m = 10.0;
constexpr double kMaxStiffness_N_per_m = 1e7;
constexpr double kMaxAdvance_m_per_s = 1.0;
constexpr double kMaxTorque_Nm = 100.0;
constexpr double kRounding_m = 1e-9;      // of a proxy on its plane
constexpr double kLongestTick_s = 0.005;  // a longer gap between ticks was a stop of the loop, not cutting

bool Within(double value, double low, double high) { return value >= low && value <= high; }  // false for NaN

bool Within(const Vector3& v, double max_abs) {
  return Within(v.x(), -max_abs, max_abs) && Within(v.y(), -max_abs, max_abs) &&
         Within(v.z(), -max_abs, max_abs);
}

ModelStatus CheckModel(const ContactModel& model) {
  if (model.status == simulation::EngineStatus::kDeviceLost) return ModelStatus::kDeviceLost;
  if (model.status != simulation::EngineStatus::kOk) return ModelStatus::kNotCredible;
  if (model.frame == 0) return ModelStatus::kNone;
  if (model.contact_count < 0 || model.contact_count > kMaxContacts) return ModelStatus::kNotCredible;
  if (!Within(model.spindle_torque_Nm, 0.0, kMaxTorque_Nm) || !safety::IsFinite(Vector3(model.F_T_W.f)))
    return ModelStatus::kNotCredible;
  for (int j = 0; j < model.contact_count; ++j) {
    const Contact& c = model.contacts[static_cast<std::size_t>(j)];
    if (!Within(Vector3(c.p_TP_m), kMaxPosition_m) || !Within(Vector3(c.p_W_m), kMaxPosition_m) ||
        !Within(Vector3(c.n_W).norm(), 0.999, 1.001) ||
        !Within(c.stiffness_N_per_m, 0.0, kMaxStiffness_N_per_m) ||
        !Within(c.advance_m_per_s, 0.0, kMaxAdvance_m_per_s))
      return ModelStatus::kNotCredible;
  }
  return ModelStatus::kOk;
}

// Time spent cutting up to a stamp: the newest sample that is not after it, or else the oldest sample.
double CuttingTimeAt(const CouplingState& state, rt::Nanoseconds stamp) {
  double cut_s = state.cut_s;
  for (int back = 1; back <= CouplingState::kHistory; ++back) {
    const int i = (state.next - back + CouplingState::kHistory) % CouplingState::kHistory;
    const CouplingState::CutSample& sample = state.history[static_cast<std::size_t>(i)];
    if (sample.stamp < 0) break;
    cut_s = sample.cut_s;
    if (sample.stamp <= stamp) break;
  }
  return cut_s;
}

// Counts the time since the last tick as cutting or not, and stores it for the frames to come.
double AdvanceTime(CouplingState& state, rt::Nanoseconds now) {
  const double dt_s = state.last < 0 ? 0.0 : std::min(safety::AgeSeconds(now, state.last), kLongestTick_s);
  state.last = now;
  if (std::any_of(state.pressed.begin(), state.pressed.end(), [](bool p) { return p; })) state.cut_s += dt_s;
  state.history[static_cast<std::size_t>(state.next)] = {.stamp = now, .cut_s = state.cut_s};
  state.next = (state.next + 1) % CouplingState::kHistory;
  return dt_s;
}

bool AnyHeldBack(const CouplingState& state) {
  return std::any_of(state.held_back_m.begin(), state.held_back_m.end(), [](double h) { return h > 0.0; });
}

// Spring wrench of the previous frame's planes at a pose, with their present recession and return.
Wrench SpringOfFrame(const CouplingState& state, const Pose& X_WT) {
  std::array<HalfSpace, kMaxHalfSpaces> planes;
  std::array<Vector3, kMaxContacts> lever_W;
  const auto count = static_cast<std::size_t>(state.plane_count);
  for (std::size_t i = 0; i < count; ++i) {
    const FramePlane& plane = state.planes[i];
    lever_W[i] = X_WT.linear() * plane.p_T_m;
    const double gap_m = plane.n_W.dot(lever_W[i] + X_WT.translation() - plane.p_W_m);
    planes[i] = {.n = plane.n_W, .offset = -(gap_m + state.recession_m[i] + state.held_back_m[i])};
  }
  const HalfSpaceProjection proxy = ClosestInHalfSpaces(planes, state.plane_count);
  Wrench spring;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 f = state.planes[i].stiffness_N_per_m * proxy.multiplier[i] * planes[i].n;
    spring.f += f;
    spring.t += lever_W[i].cross(f);
  }
  return spring;
}

// Stores the planes of a frame for the hand-over to the next one.
void StorePlanes(const CouplingParams& params, const ContactModel& model, CouplingState& state) {
  state.plane_count = model.contact_count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.contact_count); ++i) {
    const Contact& c = model.contacts[i];
    state.planes[i] = {.p_T_m = Vector3(c.p_TP_m),
                       .p_W_m = Vector3(c.p_W_m),
                       .n_W = Vector3(c.n_W).normalized(),
                       .stiffness_N_per_m = std::min(c.stiffness_N_per_m, params.max_stiffness_N_per_m)};
  }
}

// Advances the return of the planes that are held back by one tick.
void ReleaseHeldPlanes(CouplingState& state, double dt_s, std::array<HalfSpace, kMaxHalfSpaces>& planes) {
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const double way_m = std::min(state.held_back_m[i], state.return_m_per_s * dt_s);
    state.held_back_m[i] -= way_m;
    planes[i].offset += way_m;
  }
}

}  // namespace

void Validate(const CouplingParams& params) {
  const auto require = [](const char* name, double value, double low, double high) {
    if (!Within(value, low, high))
      throw std::invalid_argument(std::string("coupling ") + name + ": found " + std::to_string(value) +
                                  ", accepted " + std::to_string(low) + " … " + std::to_string(high));
  };
  require("max_stiffness_N_per_m", params.max_stiffness_N_per_m, 1.0, kMaxStiffness_N_per_m);
  require("damping_Ns_per_m", params.damping_Ns_per_m, 0.0, 1e4);
  require("damping_share", params.damping_share, 0.0, 0.25);
  require("fresh_s", params.fresh_s, 1e-3, 10.0);
  require("gone_s", params.gone_s, params.fresh_s + 1e-3, 20.0);
  require("ramp_s", params.ramp_s, 1e-3, 10.0);
  require("return_s", params.return_s, 1e-3, 0.1);
  require("turn_m_per_s", params.turn_m_per_s, 1e-6, 10.0);
}

CouplingOutput EvaluateCoupling(const CouplingParams& params, const ContactModel& model, const Pose& X_WT,
                                const Twist& V_WT, rt::Nanoseconds now, bool spindle_on,
                                CouplingState& state) OSTEON_RT {
  CouplingOutput out;
  const double dt_s = AdvanceTime(state, now);

  // weight of this model by its age
  out.status = CheckModel(model);
  out.age_s = model.frame == 0 ? safety::kNoAge_s : safety::AgeSeconds(now, model.pose_stamp);
  const double max_fade =
      out.status == ModelStatus::kOk ? safety::AgeShare(out.age_s, params.fresh_s, params.gone_s) : 0.0;
  state.fade = std::min(max_fade, state.fade + dt_s / params.ramp_s);
  out.fade = state.fade;
  const bool fresh = out.age_s <= params.fresh_s;
  if (out.status != ModelStatus::kOk || !safety::IsFinite(Vector3(X_WT.translation())) ||
      !X_WT.linear().allFinite()) {
    state.pressed.fill(false);
    state.has_proxy = false;
    state.hand_over = {};
    return out;
  }

  // present positions of the planes: the frame's, receded
  const bool new_frame = model.frame != state.frame || model.pose_stamp != state.pose_stamp;
  const double cut_since_pose_s =
      new_frame ? std::min(state.cut_s - CuttingTimeAt(state, model.pose_stamp), params.fresh_s) : 0.0;
  state.frame = model.frame;
  state.pose_stamp = model.pose_stamp;
  Wrench before;  // spring of the previous planes at this pose
  if (new_frame) {
    if (state.has_proxy) before = ApplyHandOver(state.hand_over, SpringOfFrame(state, X_WT));
    StorePlanes(params, model, state);
    if (!AnyHeldBack(state)) state.return_m_per_s = 0.0;
    state.held_back_m.fill(0.0);
  }
  std::array<HalfSpace, kMaxHalfSpaces> planes;
  std::array<Vector3, kMaxContacts> lever_W;  // from To to the contact point
  for (int j = 0; j < model.contact_count; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const Contact& c = model.contacts[i];
    const Vector3 n_W = Vector3(c.n_W).normalized();
    lever_W[i] = X_WT.linear() * Vector3(c.p_TP_m);
    double gap_m = n_W.dot(lever_W[i] + X_WT.translation() - Vector3(c.p_W_m));

    double& recession_m = state.recession_m[i];
    if (new_frame) recession_m = 0.0;
    gap_m += state.held_back_m[i];
    const double since_s = new_frame ? cut_since_pose_s : (state.pressed[i] && fresh ? dt_s : 0.0);
    const double penetration_m = std::max(0.0, -(gap_m + recession_m));
    if (spindle_on) recession_m += std::min(c.advance_m_per_s * since_s, penetration_m);
    gap_m += recession_m;
    if (new_frame && state.has_proxy) {
      const double before_m = n_W.dot(state.X_WP * Vector3(c.p_TP_m) - Vector3(c.p_W_m)) + recession_m;
      const double beyond_m = -before_m - state.violation_m;
      if (beyond_m > kRounding_m) {
        state.held_back_m[i] = beyond_m;
        state.return_m_per_s = std::max(state.return_m_per_s, beyond_m / params.return_s);
        gap_m += beyond_m;
      }
    }
    planes[i] = {.n = n_W, .offset = -gap_m};
  }
  out.new_planes = new_frame || AnyHeldBack(state);
  ReleaseHeldPlanes(state, dt_s, planes);

  // spring: the constrained proxy
  const HalfSpaceProjection proxy = ClosestInHalfSpaces(planes, model.contact_count);
  out.displacement_W = proxy.point;
  state.has_proxy = true;
  state.X_WP = X_WT;
  state.X_WP.translation() += proxy.point;
  state.violation_m = proxy.violation;
  Wrench spring;
  for (int j = 0; j < model.contact_count; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double k = std::min(model.contacts[i].stiffness_N_per_m, params.max_stiffness_N_per_m);
    out.normal_force_N[i] = k * proxy.multiplier[i];
    const Vector3 f = out.normal_force_N[i] * planes[i].n;
    spring.f += f;
    spring.t += lever_W[i].cross(f);
    if (proxy.multiplier[i] > 0.0 && out.active_planes < CouplingOutput::kMaxActive)
      out.active[static_cast<std::size_t>(out.active_planes++)] = {
          .n_W = planes[i].n,
          .lever_W = lever_W[i],
          .stiffness_N_per_m = k,
          .force_N = state.fade * out.normal_force_N[i]};
  }
  out.potential_J = 0.5 * state.fade * spring.f.dot(proxy.point);

  // the planes of a new frame turn the force over several ticks
  if (new_frame)
    BeginHandOver(
        state.hand_over,
        {.return_s = params.return_s, .min_turn_N_per_s = params.max_stiffness_N_per_m * params.turn_m_per_s},
        before, spring);
  const Wrench of_planes = spring;
  spring = StepHandOver(state.hand_over, of_planes, dt_s);
  out.hand_over_s = TimeLeft_s(state.hand_over);

  // damping along the resultant, limited to a share of the spring; then the fade by age
  const double spring_N = spring.f.norm();
  double scale = 0.0;
  if (spring_N > 0.0) {
    const double approach_m_per_s = -(spring.f.dot(V_WT.v) + spring.t.dot(V_WT.w)) / spring_N;
    const double damping = params.damping_Ns_per_m * approach_m_per_s / spring_N;
    scale = state.fade * (1.0 + (damping > -1.0 ? std::min(damping, params.damping_share) : -1.0));
  }
  out.F_T_W = {.f = scale * spring.f, .t = scale * spring.t};
  out.F_contact_T_W = out.F_T_W;
  out.F_hand_over_T_W = {.f = scale * (spring.f - of_planes.f), .t = scale * (spring.t - of_planes.t)};
  for (int j = 0; j < kMaxContacts; ++j) {
    const auto i = static_cast<std::size_t>(j);
    out.normal_force_N[i] *= scale;
    const bool presses = out.normal_force_N[i] > 0.0;
    if (presses) ++out.active_count;
    state.pressed[i] = presses && spindle_on;
  }

  // axial torque of the cut, scaled to this tick's force
  const double frame_N = Vector3(model.F_T_W.f).norm();
  const double force_N = scale * spring_N;
  if (spindle_on && force_N > 0.0 && frame_N > 0.0)
    out.F_T_W.t -= model.spindle_torque_Nm * std::min(1.0, force_N / frame_N) * X_WT.linear().col(2);
  return out;
}

}  // namespace osteon::control
