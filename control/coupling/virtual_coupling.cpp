#include "control/coupling/virtual_coupling.h"

#include <algorithm>
#include <cmath>

#include "base/parameter_check.h"
#include "kinematics/half_spaces.h"
#include "safety/limits.h"
#include "safety/watchdog.h"

namespace osteon::control {
namespace {

using simulation::Contact;
using simulation::ContactModel;
using simulation::kMaxContacts;

// Bounds of plausible values. A value beyond them can only come from a defective sender.
constexpr double kMaxPosition_m = 10.0;
constexpr double kMaxStiffness_N_per_m = 1e7;
constexpr double kMaxAdvance_m_per_s = 1.0;
constexpr double kMaxTorque_Nm = 100.0;
// rounding error of a proxy's distance from a plane on which the proxy lies
constexpr double kRounding_m = 1e-9;
// longest time between ticks that counts as cutting: in a longer one the loop stood still
constexpr double kMaxTick_s = 0.005;

bool Within(double value, double low, double high) { return value >= low && value <= high; }  // false for NaN

// Whether each component is at most max_abs in magnitude; false for NaN.
bool Within(const Vector3& v, double max_abs) {
  return Within(v.x(), -max_abs, max_abs) && Within(v.y(), -max_abs, max_abs) &&
         Within(v.z(), -max_abs, max_abs);
}

// Finds the first defect of a model: a lost device, no frame, or an implausible value.
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

// Time spent cutting up to a stamp, by the newest sample that is not later than the stamp; if all are later,
// by the oldest sample.
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

// Adds the time since the last tick to the time spent cutting, if a contact pressed, and stores a sample for
// later frames. @returns the time since the last tick [s]
double AdvanceTime(CouplingState& state, rt::Nanoseconds now) {
  const double dt_s = state.last < 0 ? 0.0 : std::min(safety::AgeSeconds(now, state.last), kMaxTick_s);
  state.last = now;
  if (std::any_of(state.pressed.begin(), state.pressed.end(), [](bool p) { return p; })) state.cut_s += dt_s;
  state.history[static_cast<std::size_t>(state.next)] = {.stamp = now, .cut_s = state.cut_s};
  state.next = (state.next + 1) % CouplingState::kHistory;
  return dt_s;
}

bool AnyHeldBack(const CouplingState& state) {
  return std::any_of(state.held_back_m.begin(), state.held_back_m.end(), [](double h) { return h > 0.0; });
}

// Spring wrench, on T at To in W, of the previous frame's planes at a pose of the tool. The planes have their
// present recession and are held back as at present.
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

// A tick's input, and values derived from it that several steps of the tick use.
struct CouplingTick {
  const CouplingParams& params;
  const CouplingInput& input;
  double dt_s{0.0};              // time since the last tick
  bool fresh{false};             // the model is young enough for its planes to recede
  bool new_frame{false};         // the model's planes replace those of the last tick
  double cut_since_pose_s{0.0};  // for a new frame: time spent cutting since the pose of the frame
  Wrench F_before_T_W{};         // for a new frame: spring wrench of the previous planes at this tick's pose
};

// The planes at a tick's pose.
struct PlacedPlanes {
  std::array<HalfSpace, kMaxHalfSpaces> half_space;  // bounds on the displacement from tool to proxy
  std::array<Vector3, kMaxContacts> lever_W;         // vectors from To to the contact points
};

// Checks the model and the pose, and fades the coupling by the model's age. If the model or the pose is
// unusable, resets the contact's state and returns false: nothing is rendered then.
bool WeighModel(CouplingTick& tick, CouplingState& state, CouplingOutput& out) {
  const CouplingParams& params = tick.params;
  const CouplingInput& input = tick.input;
  out.status = CheckModel(input.model);
  out.age_s =
      input.model.frame == 0 ? safety::kNoAge_s : safety::AgeSeconds(input.now, input.model.pose_stamp);
  const double max_fade =
      out.status == ModelStatus::kOk ? safety::AgeFade(out.age_s, params.fresh_s, params.gone_s) : 0.0;
  state.fade = std::min(max_fade, state.fade + tick.dt_s / params.ramp_s);
  out.fade = state.fade;
  tick.fresh = out.age_s <= params.fresh_s;
  if (out.status == ModelStatus::kOk && safety::IsFinite(Vector3(input.X_WT.translation())) &&
      input.X_WT.linear().allFinite())
    return true;
  state.pressed.fill(false);
  state.has_proxy = false;
  state.hand_over = {};
  return false;
}

// Replaces the planes by the model's if the model has a new frame.
void AcceptFrame(CouplingTick& tick, CouplingState& state) {
  const ContactModel& model = tick.input.model;
  tick.new_frame = model.frame != state.frame || model.pose_stamp != state.pose_stamp;
  if (tick.new_frame)
    tick.cut_since_pose_s =
        std::min(state.cut_s - CuttingTimeAt(state, model.pose_stamp), tick.params.fresh_s);
  state.frame = model.frame;
  state.pose_stamp = model.pose_stamp;
  if (!tick.new_frame) return;
  if (state.has_proxy)
    tick.F_before_T_W = ApplyHandOver(state.hand_over, SpringOfFrame(state, tick.input.X_WT));
  StorePlanes(tick.params, model, state);
  if (!AnyHeldBack(state)) state.return_m_per_s = 0.0;
  state.held_back_m.fill(0.0);
}

// Computes the position of a plane in this tick: the frame's plane, moved by its recession and by the
// distance by which it is held back. @returns the gap between tool and plane [m]
double PlacePlane(const CouplingTick& tick, std::size_t i, const Vector3& n_W, const Vector3& lever_W,
                  CouplingState& state) {
  const Contact& c = tick.input.model.contacts[i];
  // The gap is that of the frame's plane, plus the distance by which the plane is held back, plus its
  // recession.
  double gap_m = n_W.dot(lever_W + tick.input.X_WT.translation() - Vector3(c.p_W_m));

  double& recession_m = state.recession_m[i];
  if (tick.new_frame) recession_m = 0.0;
  gap_m += state.held_back_m[i];
  const double since_s =
      tick.new_frame ? tick.cut_since_pose_s : (state.pressed[i] && tick.fresh ? tick.dt_s : 0.0);
  const double penetration_m = std::max(0.0, -(gap_m + recession_m));
  if (tick.input.spindle_turns) recession_m += std::min(c.advance_m_per_s * since_s, penetration_m);
  gap_m += recession_m;
  if (!tick.new_frame || !state.has_proxy) return gap_m;

  // If the last proxy would violate a new frame's plane, the plane is held back so that the proxy just
  // touches it.
  const double before_m = n_W.dot(state.X_WP * Vector3(c.p_TP_m) - Vector3(c.p_W_m)) + recession_m;
  const double beyond_m = -before_m - state.violation_m;
  if (beyond_m > kRounding_m) {
    state.held_back_m[i] = beyond_m;
    state.return_m_per_s = std::max(state.return_m_per_s, beyond_m / tick.params.return_s);
    gap_m += beyond_m;
  }
  return gap_m;
}

// Computes the positions of all planes. Then releases the held-back planes by the distance of one tick.
void PlacePlanes(const CouplingTick& tick, CouplingState& state, PlacedPlanes& placed, CouplingOutput& out) {
  const ContactModel& model = tick.input.model;
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.contact_count); ++i) {
    const Contact& c = model.contacts[i];
    const Vector3 n_W = Vector3(c.n_W).normalized();
    placed.lever_W[i] = tick.input.X_WT.linear() * Vector3(c.p_TP_m);
    placed.half_space[i] = {.n = n_W, .offset = -PlacePlane(tick, i, n_W, placed.lever_W[i], state)};
  }
  out.new_planes = tick.new_frame || AnyHeldBack(state);
  for (std::size_t i = 0; i < placed.half_space.size(); ++i) {
    const double way_m = std::min(state.held_back_m[i], state.return_m_per_s * tick.dt_s);
    state.held_back_m[i] -= way_m;
    placed.half_space[i].offset += way_m;
  }
}

// Finds the constrained proxy. @returns the spring's wrench, on T at To, in W; neither damped nor faded
Wrench ComputeSpring(const CouplingTick& tick, const PlacedPlanes& placed, CouplingState& state,
                     CouplingOutput& out) {
  const ContactModel& model = tick.input.model;
  const HalfSpaceProjection proxy = ClosestInHalfSpaces(placed.half_space, model.contact_count);
  out.displacement_W = proxy.point;
  state.has_proxy = true;
  state.X_WP = tick.input.X_WT;
  state.X_WP.translation() += proxy.point;
  state.violation_m = proxy.violation;
  Wrench spring;
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.contact_count); ++i) {
    const double k = std::min(model.contacts[i].stiffness_N_per_m, tick.params.max_stiffness_N_per_m);
    out.normal_force_N[i] = k * proxy.multiplier[i];
    const Vector3 f = out.normal_force_N[i] * placed.half_space[i].n;
    spring.f += f;
    spring.t += placed.lever_W[i].cross(f);
    if (proxy.multiplier[i] > 0.0 && out.active_planes < CouplingOutput::kMaxActive)
      out.active[static_cast<std::size_t>(out.active_planes++)] = {
          .n_W = placed.half_space[i].n,
          .lever_W = placed.lever_W[i],
          .stiffness_N_per_m = k,
          .force_N = state.fade * out.normal_force_N[i]};
  }
  out.potential_J = 0.5 * state.fade * spring.f.dot(proxy.point);
  return spring;
}

// After a change of frame, distributes the turn of the spring's wrench over several ticks. @returns the
// wrench of this tick
Wrench TurnSpring(const CouplingTick& tick, const Wrench& spring, CouplingState& state, CouplingOutput& out) {
  if (tick.new_frame)
    BeginHandOver(state.hand_over,
                  {.return_s = tick.params.return_s,
                   .min_turn_N_per_s = tick.params.max_stiffness_N_per_m * tick.params.turn_m_per_s},
                  tick.F_before_T_W, spring);
  const Wrench turned = StepHandOver(state.hand_over, spring, tick.dt_s);
  out.hand_over_s = TimeLeft_s(state.hand_over);
  return turned;
}

// Factor on the spring's wrench, c in the header: damping along the resultant, at most damping_share of the
// spring's force, times the fade by age. @param spring_N  |spring.f|
double DampingScale(const CouplingTick& tick, const Wrench& spring, double spring_N, double fade) {
  if (!(spring_N > 0.0)) return 0.0;
  const Twist& V_WT = tick.input.V_WT;
  const double approach_m_per_s = -(spring.f.dot(V_WT.v) + spring.t.dot(V_WT.w)) / spring_N;
  const double damping = tick.params.damping_Ns_per_m * approach_m_per_s / spring_N;
  return fade * (1.0 + (damping > -1.0 ? std::min(damping, tick.params.damping_share) : -1.0));
}

// Scales the contacts' forces, and stores which contacts press while the spindle turns.
void ScaleContacts(double scale, bool spindle_turns, CouplingState& state, CouplingOutput& out) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(kMaxContacts); ++i) {
    out.normal_force_N[i] *= scale;
    const bool presses = out.normal_force_N[i] > 0.0;
    if (presses) ++out.active_count;
    state.pressed[i] = presses && spindle_turns;
  }
}

// Adds the axial torque of the cut, scaled to this tick's force.
void AddSpindleTorque(const CouplingInput& input, double force_N, Wrench& F_T_W) {
  const double frame_N = Vector3(input.model.F_T_W.f).norm();
  if (input.spindle_turns && force_N > 0.0 && frame_N > 0.0)
    F_T_W.t -= input.model.spindle_torque_Nm * std::min(1.0, force_N / frame_N) * input.X_WT.linear().col(2);
}

}  // namespace

void Validate(const CouplingParams& params) {
  const base::ParameterCheck require("coupling ");
  require("max_stiffness_N_per_m", params.max_stiffness_N_per_m, 1.0, kMaxStiffness_N_per_m);
  require("damping_Ns_per_m", params.damping_Ns_per_m, 0.0, 1e4);
  require("damping_share", params.damping_share, 0.0, 0.25);
  require("fresh_s", params.fresh_s, 1e-3, 10.0);
  require("gone_s", params.gone_s, params.fresh_s + 1e-3, 20.0);
  require("ramp_s", params.ramp_s, 1e-3, 10.0);
  require("return_s", params.return_s, 1e-3, 0.1);
  require("turn_m_per_s", params.turn_m_per_s, 1e-6, 10.0);
}

CouplingOutput EvaluateCoupling(const CouplingParams& params, const CouplingInput& input,
                                CouplingState& state) OSTEON_RT {
  CouplingOutput out;
  CouplingTick tick{.params = params, .input = input, .dt_s = AdvanceTime(state, input.now)};
  if (!WeighModel(tick, state, out)) return out;
  AcceptFrame(tick, state);
  PlacedPlanes placed;
  PlacePlanes(tick, state, placed, out);

  const Wrench of_planes = ComputeSpring(tick, placed, state, out);
  const Wrench spring = TurnSpring(tick, of_planes, state, out);
  const double spring_N = spring.f.norm();
  const double scale = DampingScale(tick, spring, spring_N, state.fade);
  out.F_T_W = {.f = scale * spring.f, .t = scale * spring.t};
  out.F_contact_T_W = out.F_T_W;
  out.F_hand_over_T_W = {.f = scale * (spring.f - of_planes.f), .t = scale * (spring.t - of_planes.t)};
  ScaleContacts(scale, input.spindle_turns, state, out);
  AddSpindleTorque(input, scale * spring_N, out.F_T_W);
  return out;
}

}  // namespace osteon::control
