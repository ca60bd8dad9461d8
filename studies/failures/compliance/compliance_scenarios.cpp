#include "studies/failures/compliance/compliance_scenarios.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <fmt/format.h>

#include "control/compliance/compliance.h"
#include "control/coupling/virtual_coupling.h"
#include "control/laws/twist_parts.h"
#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kTick_s = 1e-3;
constexpr double kK_N_per_m = 20e3;  // stiffness of a hard plane

// A contact plane with weight 0.5: each of two equal planes has this weight.
simulation::Contact Plane(const Vector3& p_W, const Vector3& n_W, double stiffness_N_per_m) {
  simulation::Contact plane = PlaneAt(p_W, n_W, stiffness_N_per_m);
  plane.weight = 0.5;
  return plane;
}

// The shipped coupling with compliance, on planes that are renewed in every tick. Sums the work of the planes
// on the tool by the trapezoidal rule.
class ComplianceBench {
 public:
  // @param has_lever_arm  false: the torque on the tool ignores the lever arm of the displaced head
  explicit ComplianceBench(const control::ComplianceParams& params, bool has_lever_arm = true)
      : compliance_(params, kTick_s), has_lever_arm_(has_lever_arm) {
    coupling_.max_stiffness_N_per_m = 1e6;
    coupling_.damping_Ns_per_m = 0.0;
    state_.fade = 1.0;
  }
  /// Steps by one tick. @returns the force on the tool, in W
  Vector3 Step(const Pose& X_WT, std::span<const simulation::Contact> planes) {
    ++tick_;
    const auto now = static_cast<rt::Nanoseconds>(tick_) * rt::kMillisecond;
    simulation::ContactModel model = FreshModel(static_cast<std::uint64_t>(tick_), now, planes);
    model.engaged_area_m2 = 1.0;
    const control::CouplingOutput out = control::EvaluateCoupling(
        coupling_, {.model = model, .X_WT = compliance_.X_ME(X_WT), .now = now}, state_);
    Wrench F_T_W = compliance_.OnTool(out.F_contact_T_W, X_WT);
    if (!has_lever_arm_) F_T_W.t = compliance_.X_WM().linear() * out.F_contact_T_W.t;
    if (tick_ > 1) {
      const Twist dx = control::SmallStep(X_before_, X_WT);
      given_J_ += 0.5 * (control::Power(F_before_, dx) + control::Power(F_T_W, dx));
    }
    F_before_ = F_T_W;
    X_before_ = X_WT;
    compliance_.Step(out.F_contact_T_W, model, X_WT);
    return F_T_W.f;
  }
  /// Work that the planes have done on the tool so far.
  [[nodiscard]] double given_J() const { return given_J_; }

 private:
  control::Compliance compliance_;
  bool has_lever_arm_;
  control::CouplingParams coupling_;
  control::CouplingState state_;
  Wrench F_before_;
  Pose X_before_{Pose::Identity()};
  double given_J_{0.0};
  int tick_{0};
};

// A layer whose stiffness does not change with the force: its whole area is engaged at once.
control::SurfaceLayerParams LinearLayer(double stiffness_N_per_m) {
  control::SurfaceLayerParams layer;
  layer.engaged_layer_m = 1e-6;
  layer.touch_area_m2 = layer.max_area_m2 = 1e-3;
  layer.kappa_N_per_m3.fill(stiffness_N_per_m / layer.max_area_m2);
  layer.thickness_m = 0.05;
  layer.tau_s = 0.02;
  return layer;
}

// Returns the work that the planes do on the tool in the last of three rounds of a closed path.
// @param path    pose of the tool as a function of the number of rounds
// @param series  receives the work [mJ] over the last round
template <class Path>
double GivenInATurn_J(ComplianceBench& bench, std::span<const simulation::Contact> planes, double turn_s,
                      const Path& path, FailureSeries& series) {
  constexpr int kTurns = 3;
  const int ticks = static_cast<int>(std::lround(turn_s / kTick_s));
  double before_J = 0.0;
  for (int i = 0; i <= kTurns * ticks; ++i) {
    bench.Step(path(static_cast<double>(i) / ticks), planes);
    if (i == (kTurns - 1) * ticks) before_J = bench.given_J();
    if (i >= (kTurns - 1) * ticks && i % std::max(1, ticks / 100) == 0) {
      series.x.push_back(static_cast<double>(i) / ticks - (kTurns - 1));
      series.y.push_back(1e3 * (bench.given_J() - before_J));
    }
  }
  return bench.given_J() - before_J;
}

Pose PoseAt(const Vector3& p, const Vector3& turn = Vector3::Zero()) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(turn);
  X.translation() = p;
  return X;
}

}  // namespace

FailureResult RunTwoSprings(const FailureSetting& setting) {
  FailureResult result{.id = 36,
                       .name = "two springs",
                       .metric = "work that the planes give in a turn",
                       .unit = "mJ",
                       .baseline_name = "series stiffness in the soft plane's contact",
                       .bound = 0.0};
  constexpr double kLayer_N_per_m = 5e3;
  const double third = std::numbers::pi / 3.0;
  const Vector3 n_1 = Vector3::UnitZ(), n_2(std::sin(third), 0.0, std::cos(third));
  const Vector3 centre = -3e-3 * (n_1 + n_2).normalized();
  // the circle's direction is that in which the curl of the force field does positive work on the tool
  const auto circle = [&](double turn) {
    return PoseAt(centre + 1e-3 * Vector3(std::cos(kTwoPi * turn), 0.0, std::sin(kTwoPi * turn)));
  };
  FailureSeries baseline{.name = "series stiffness"}, ours{.name = "ours", .ours = true};
  const double soft_N_per_m = 1.0 / (1.0 / kK_N_per_m + 1.0 / kLayer_N_per_m);
  const simulation::Contact uneven[]{Plane(Vector3::Zero(), n_1, kK_N_per_m),
                                     Plane(Vector3::Zero(), n_2, soft_N_per_m)};
  const simulation::Contact even[]{Plane(Vector3::Zero(), n_1, kK_N_per_m),
                                   Plane(Vector3::Zero(), n_2, kK_N_per_m)};
  ComplianceBench without_layer({});
  result.baseline = 1e3 * GivenInATurn_J(without_layer, uneven, 1.0, circle, baseline);
  const bool complete = setting.GoesOn(0.5);
  ComplianceBench with_layer({.layer = LinearLayer(kLayer_N_per_m)});
  result.ours = 1e3 * GivenInATurn_J(with_layer, even, 1.0, circle, ours);
  result.baseline_fails = result.baseline > 1.0;
  result.ours_passes = complete && result.ours <= result.bound;
  result.note =
      fmt::format("a circle of 1 mm, 3 mm deep; a layer of 5 N/mm: ours takes {:.2f} mJ", -result.ours);
  result.plot = {.x_label = "turn", .y_label = "work given [mJ]", .series = {baseline, ours}};
  return result;
}

FailureResult RunStaleStiffness(const FailureSetting& setting) {
  FailureResult result{.id = 37,
                       .name = "stale stiffness",
                       .metric = "work that the layer gives in a cycle",
                       .unit = "mJ",
                       .baseline_name = "the layer's secant stiffness by frames 20 ms apart",
                       .bound = 0.0};
  constexpr double kHz = 8.0, kRadius_m = 25e-3;
  constexpr int kFrameTicks = 20;
  control::SurfaceLayerParams layer;
  layer.kappa_N_per_m3.fill(0.06e9);
  layer.thickness_m = 0.02;
  layer.touch_area_m2 = std::numbers::pi * kRadius_m * layer.engaged_layer_m;
  layer.max_area_m2 = std::numbers::pi * kRadius_m * kRadius_m;
  const control::LayerContact touch{.kappa_N_per_m3 = 0.06e9, .share = 1.0, .area_m2 = layer.touch_area_m2};
  const auto depth_m = [&](double cycle) { return 2e-3 + 1.5e-3 * std::sin(kTwoPi * cycle); };
  // the force at rest of the coupling's spring and the layer in series, found by bisection
  const auto rest_N = [&](double deep_m) {
    double low_N = 0.0, high_N = kK_N_per_m * deep_m;
    for (int i = 0; i < 60; ++i) {
      const double f = 0.5 * (low_N + high_N);
      (f / kK_N_per_m + control::LayerIndentation(layer, touch, f) < deep_m ? low_N : high_N) = f;
    }
    return low_N;
  };
  // ticks of 8 cycles, a whole number of frames
  const int ticks = static_cast<int>(std::lround(8.0 / (kHz * kTick_s)));
  FailureSeries baseline{.name = "secant by frames"}, ours{.name = "ours", .ours = true};
  double secant_N_per_m = 0.0, layer_m = 0.0;  // layer_m: displacement of our layer
  double baseline_J = 0.0, ours_J = 0.0, baseline_before_N = 0.0, ours_before_N = 0.0;
  for (int i = 0; i <= 2 * ticks; ++i) {  // the first 8 cycles let the transient decay, the next 8 are judged
    const double cycle = kHz * kTick_s * i, deep_m = depth_m(cycle);
    const double deeper_m = deep_m - depth_m(cycle - kHz * kTick_s);
    if (i % kFrameTicks == 0) secant_N_per_m = rest_N(deep_m) / deep_m;
    const double baseline_N = secant_N_per_m * deep_m, ours_N = kK_N_per_m * std::max(0.0, deep_m - layer_m);
    if (i > ticks) {
      baseline_J -= 0.5 * (baseline_N + baseline_before_N) * deeper_m;
      ours_J -= 0.5 * (ours_N + ours_before_N) * deeper_m;
      baseline.x.push_back(cycle - kHz * kTick_s * ticks);
      baseline.y.push_back(1e3 * baseline_J);
      ours.x.push_back(baseline.x.back());
      ours.y.push_back(1e3 * ours_J);
    }
    baseline_before_N = baseline_N;
    ours_before_N = ours_N;
    layer_m = -control::StepLayer(layer, touch, {0.0, 0.0, ours_N}, kTick_s, {0.0, 0.0, -layer_m}).z();
  }
  result.baseline = 1e3 * baseline_J / 8.0;
  result.ours = 1e3 * ours_J / 8.0;
  const bool complete = setting.GoesOn(1.0);
  result.baseline_fails = result.baseline > 1.0;
  result.ours_passes = complete && result.ours <= result.bound;
  result.note =
      fmt::format("tissue of 0.3 MPa over 5 mm under a ball of 25 mm; ours takes {:.2f} mJ", -result.ours);
  result.plot = {.x_label = "cycles", .y_label = "work given [mJ]", .series = {baseline, ours}};
  return result;
}

FailureResult RunBentArm(const FailureSetting& setting) {
  FailureResult result{.id = 38,
                       .name = "bent arm",
                       .metric = "work given in a turn",
                       .unit = "mJ",
                       .baseline_name = "torque by the rigid tool's arm",
                       .bound = 0.01};
  control::ToolLinkParams drill;  // diameter 3.2 mm: 8.72 N/mm across the feed at its apex
  drill.compliance_T(0, 0) = drill.compliance_T(1, 1) = 1.1468e-4;
  drill.compliance_T(0, 4) = drill.compliance_T(4, 0) = 3.065e-3;
  drill.compliance_T(1, 3) = drill.compliance_T(3, 1) = -3.065e-3;
  drill.compliance_T(3, 3) = drill.compliance_T(4, 4) = 0.1023;
  drill.tau_s = 0.02;
  drill.max_bend_m = 0.1;
  const double tilt = std::numbers::pi / 9.0;
  const Vector3 n(std::sin(tilt), 0.0, std::cos(tilt));
  const simulation::Contact plane[]{Plane(Vector3::Zero(), n, 60e3)};
  // The depth oscillates, and the rotation about the plane's slope follows with a delay of a quarter of a
  // period.
  const auto path = [&](double turn) {
    return PoseAt((-1.5e-3 + 0.7e-3 * std::sin(kTwoPi * turn)) * n,
                  {0.0, 0.05 * std::cos(kTwoPi * turn), 0.0});
  };
  // Slow, as a hand moves: the work that the tool's own damping takes decreases with the speed, whereas the
  // work of the missing lever arm does not.
  const double turn_s = setting.full() ? 200.0 : 100.0;
  FailureSeries baseline{.name = "rigid arm"}, ours{.name = "ours", .ours = true};
  ComplianceBench rigid_arm({.tool = drill}, false);
  result.baseline = 1e3 * GivenInATurn_J(rigid_arm, plane, turn_s, path, baseline);
  const bool complete = setting.GoesOn(0.5);
  ComplianceBench bent_arm({.tool = drill});
  result.ours = 1e3 * GivenInATurn_J(bent_arm, plane, turn_s, path, ours);
  result.baseline_fails = result.baseline > 10.0 * result.bound;
  result.ours_passes = complete && result.ours <= result.bound;
  result.note =
      "a drill of 3.2 mm on a plane at 20 deg, 0.8 to 2.2 mm deep, turned by 2.9 deg to either side";
  result.plot = {.x_label = "turn", .y_label = "work given [mJ]", .series = {baseline, ours}};
  return result;
}

}  // namespace osteon::studies
