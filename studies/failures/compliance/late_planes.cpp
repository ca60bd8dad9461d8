#include "studies/failures/compliance/late_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "control/compliance/bone_mount.h"
#include "studies/failures/arm_bench.h"
#include "studies/failures/compliance/law_trial.h"

namespace osteon::studies {
namespace {

constexpr double kPeriod_s = 1e-3, kMount_hz = 15.0, kHeldPush_N = 60.0, kRise_s = 0.1;
constexpr int kLateTicks = 20;  // delay of the baseline's planes [ticks]
constexpr int kTrialTicks = 2500, kJudgedTicks = 500;

// The result of one simulated run.
struct Swing {
  double swing_m{0.0};  // range of the tool's motion along its feed, in the last half second
  bool fault{false};
  FailureSeries series;
};

// An elastic mount of kMount_hz, whose centre is the place where the tool starts.
control::BoneMountParams Mount() {
  control::BoneMountParams mount;
  mount.p_WMo_m = StartOfLawTrial().translation();
  mount.stiffness_N_per_m.setConstant(mount.mass_kg * std::pow(2.0 * std::numbers::pi * kMount_hz, 2));
  mount.max_shift_m = 0.05;
  return mount;
}

// Simulates a hand that presses steadily on the bone.
// @param late  the planes follow the bone's motion 20 ms late (the baseline); false: the loop itself computes
// the mount's motion
Swing Press(control::Law law, bool late) {
  const double wall_N_per_m = law == control::Law::kAdmittance ? 20e3 : 10e3;
  const Vector3 feed_W = StartOfLawTrial().linear().col(2), p_W = StartOfLawTrial().translation();
  const control::BoneMountParams mount = Mount();
  LawTrialParams params{.loop = LoopOfLaw(law, wall_N_per_m), .seconds = kPeriod_s * kTrialTicks};
  params.loop.spindle_rad_per_s = 0.0;
  // the stability analysis does not count on this damping, since it is capped
  params.loop.coupling.damping_Ns_per_m = 0.0;
  if (!late) params.loop.compliance.mount = mount;
  control::BoneMountState bone;
  std::array<Vector3, kLateTicks> moved{};  // the bone's displacement in the last 20 frames, a ring
  moved.fill(Vector3::Zero());
  std::uint64_t frame = 0;
  std::vector<double> along_m;
  PushingHand hand;
  const LawScene scene{.hand =
                           [&](int tick, const Pose& X_WT, const Twist& V_WT) {
                             return hand.Step(RisingPush(kHeldPush_N, kPeriod_s * tick, kRise_s), X_WT, V_WT);
                           },
                       .bone =
                           [&](const simulation::ToolCommand& command) {
                             const Vector3 place = late ? Vector3(p_W + moved[frame % kLateTicks]) : p_W;
                             const simulation::Contact plane = PlaneAt(place, -feed_W, wall_N_per_m);
                             return FreshModel(++frame, command.stamp, {&plane, 1});
                           },
                       .seen =
                           [&](int, const LawTrialTick& tick) {
                             along_m.push_back(feed_W.dot(tick.X_WT.translation() - p_W));
                             control::StepMount(mount, {.f = tick.f_coupling_N, .t = Vector3::Zero()},
                                                kPeriod_s, bone);
                             moved[(frame - 1) % kLateTicks] = bone.d.head<3>();
                             return tick.renders;
                           }};
  Swing swing;
  swing.fault = RunLawTrial(params, scene).Any();
  const auto last = along_m.end() - std::min<std::ptrdiff_t>(kJudgedTicks, std::ssize(along_m));
  const auto [low, high] = std::minmax_element(last, along_m.end());
  if (last != along_m.end()) swing.swing_m = *high - *low;
  for (std::size_t i = 0; i < along_m.size(); i += 5) {
    swing.series.x.push_back(kPeriod_s * static_cast<double>(i));
    swing.series.y.push_back(1e3 * along_m[i]);
  }
  return swing;
}

}  // namespace

FailureResult RunLatePlanes(const FailureSetting& setting) {
  FailureResult result{.id = 39,
                       .name = "late planes",
                       .metric = "swing of the tool in the last half second",
                       .unit = "mm",
                       .baseline_name = "planes that follow the bone 20 ms late",
                       .bound = 0.1};
  bool complete = true, fault = false, stopped = false;
  // the baseline's swing with the impedance law: smaller, since the arm has damping of its own
  double impedance_mm = 0.0;
  for (const control::Law law : {control::Law::kImpedance, control::Law::kAdmittance}) {
    const bool is_admittance = law == control::Law::kAdmittance;
    Swing late = Press(law, true), ours = Press(law, false);
    fault = fault || ours.fault;
    result.ours = std::max(result.ours, 1e3 * ours.swing_m);
    complete = complete && setting.GoesOn(is_admittance ? 1.0 : 0.5);
    (is_admittance ? result.baseline : impedance_mm) = 1e3 * late.swing_m;
    if (!is_admittance) continue;
    stopped = late.fault;
    late.series.name = "20 ms late";
    ours.series.name = "ours";
    ours.series.ours = true;
    result.plot = {.x_label = "time [s]", .y_label = "tool below the bone's first place [mm]", .series = {}};
    result.plot.series = {std::move(late.series), std::move(ours.series)};
  }
  result.baseline_fails = result.baseline > 3.0 * result.bound;
  result.ours_passes = complete && !fault && result.ours <= result.bound;
  result.note = fmt::format(
      "bone of 12 kg on a mount of 15 Hz, a hand that pushes with {:g} N; the baseline is the admittance "
      "law's, "
      "whose swing grows{}; with the impedance law the arm's own damping leaves {:.2f} mm of it; ours with "
      "both "
      "laws{}",
      kHeldPush_N, stopped ? " until a fault ends the trial" : "", impedance_mm,
      fault ? "; a fault ended a trial" : "");
  return result;
}

}  // namespace osteon::studies
