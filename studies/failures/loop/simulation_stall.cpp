#include "studies/failures/loop/simulation_stall.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/operator/quintic.h"
#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

// Period of ticks; stiffness and radius of the bowl; force with which the hand presses.
constexpr double kDt_s = 1e-3, kWall_N_per_m = 20e3, kBowl_m = 0.025, kPush_N = 80.0;
// The tool is at rest in the bowl until this time, when the motion begins.
constexpr double kPressed_s = 0.6;
constexpr double kStalls_s = 0.65;   // the stall begins: 50 ms after the motion began
constexpr double kResumed_s = 0.15;  // time after the stall at which the force has its full size again
// Bound on a change of the force in a tick, as a share of the force before the stall.
constexpr double kMaxStep = 0.10;

enum class Motion { kOut, kDeeper, kAlong };
// A motion of the hand during which no frames come.
struct Case {
  Motion motion;
  const char* name;
  double speed_m_per_s, way_m;
};
constexpr std::array<Case, 3> kMotions{{{Motion::kOut, "out of the bone", 0.25, 0.05},
                                        {Motion::kDeeper, "deeper", 0.1, 0.02},
                                        {Motion::kAlong, "along it", 0.1, 0.02}}};

// Judged results of one run.
struct StallResult {
  // largest energy that the virtual side has given in excess of the energy that it took
  double returned_J{0.0};
  // largest change of the force in a tick after frames come again, divided by the force before the stall
  double step_share{0.0};
  bool fault{false};
  std::vector<double> given_J;  // energy given so far, for each tick
};

// @param held  true (the baseline): the force of the last frame is held during the stall; false: its plane is
// held
StallResult MeasureStall(const Case& c, double stall_s, bool held) {
  ArmTrialParams params = ScenarioTrial();
  const double moves_s = c.way_m / c.speed_m_per_s;
  const double leaves_s = kStalls_s + std::max(moves_s, stall_s) + 0.6;
  params.seconds = leaves_s + 0.6;
  params.loop.coupling.damping_Ns_per_m = 0.0;
  if (held) params.loop.stabilisers = control::NoStabilisers();
  const Pose X_start = kinematics::LbrArm(params.arm).FlangePose(params.q_start) * params.X_FT;
  const Vector3 down = X_start.linear().col(2), along = X_start.linear().col(0);
  const Vector3 center = X_start.translation() - kBowl_m * down;

  // A cycle: press in, move, rest, and leave the bone, so that every cycle ends without contact.
  const double pressed_m = kPush_N * (1.0 / params.hand.stiffness_N_per_m + 1.0 / kWall_N_per_m);
  const auto led = [](double t_s, double takes_s) {
    return hil::Quintic(std::clamp(t_s / takes_s, 0.0, 1.0)).s;
  };
  const HandPath path = [&](double t) {
    HandGoal goal{.X_WT = X_start};
    const double moved_m = std::clamp(c.speed_m_per_s * (t - kPressed_s), 0.0, c.way_m);
    const double moving_m_per_s = moved_m > 0.0 && moved_m < c.way_m ? c.speed_m_per_s : 0.0;
    const Vector3 way = c.motion == Motion::kAlong    ? along
                        : c.motion == Motion::kDeeper ? down
                                                      : Vector3(-down);
    const double lifted_m = 0.05 * led(t - leaves_s, 0.4);
    goal.X_WT.translation() += (pressed_m * led(t, 0.4) - lifted_m) * down + moved_m * way;
    goal.V_WT.v = moving_m_per_s * way;
    return goal;
  };

  hil::HandImpedance hand(params.hand);
  simulation::ContactModel last;
  double last_N = 0.0;
  const auto stalls = [stall_s](int tick) {
    const double since_s = tick * kDt_s - kStalls_s;
    return since_s >= 0.0 && since_s < stall_s;
  };
  const ArmScene scene{.hand =
                           [&](int tick, const Pose& X_WT, const Twist& V_WT) {
                             const HandGoal goal = path(tick * kDt_s);
                             return hand.Step(kDt_s, X_WT, V_WT, goal.X_WT, goal.V_WT);
                           },
                       .bone =
                           [&](int tick, rt::Nanoseconds now, const Pose& X_WT) {
                             const Vector3 out = X_WT.translation() - center;
                             const Vector3 n = -out.normalized();
                             simulation::Contact plane = PlaneAt(center - kBowl_m * n, n, kWall_N_per_m);
                             if (!stalls(tick)) {
                               last = FreshModel(static_cast<std::uint64_t>(tick + 1), now, {&plane, 1});
                               last_N = kWall_N_per_m * std::max(0.0, out.norm() - kBowl_m);
                             } else if (held) {
                               // Hold the last force at any position of the tool, by a plane that moves with
                               // the tool.
                               const Vector3 n_last = last.contacts[0].n_W;
                               plane = PlaneAt(X_WT.translation() + last_N / kWall_N_per_m * n_last, n_last,
                                               kWall_N_per_m);
                               return FreshModel(static_cast<std::uint64_t>(tick + 1), now, {&plane, 1});
                             }
                             return last;
                           }};
  const std::vector<ArmTrialTick> trial = RunLoopTrial(params, scene);

  StallResult result;
  double given_J = 0.0;
  const auto resumes = static_cast<std::size_t>(std::lround((kStalls_s + stall_s) / kDt_s));
  const auto begins = static_cast<std::size_t>(std::lround(kStalls_s / kDt_s));
  const double before_N = trial[begins - 1].f_coupling_N.norm();
  for (std::size_t i = 1; i + 1 < trial.size(); ++i) {
    // Use the mean force of both ends of the step, so that a spring returns exactly the energy that it took.
    given_J += 0.5 * (trial[i].f_coupling_N + trial[i + 1].f_coupling_N)
                         .dot(trial[i].X_WT.translation() - trial[i - 1].X_WT.translation());
    result.returned_J = std::max(result.returned_J, given_J);
    result.given_J.push_back(given_J);
    if (i >= resumes && i < resumes + static_cast<std::size_t>(kResumed_s / kDt_s))
      result.step_share =
          std::max(result.step_share, (trial[i].f_coupling_N - trial[i - 1].f_coupling_N).norm() / before_N);
    result.fault |= trial[i].fault;
  }
  return result;
}

// Returns the energy given so far over the time, as a line of the picture.
FailureSeries Drawn(const char* name, const StallResult& stalled, bool ours) {
  FailureSeries series{.name = name, .ours = ours};
  for (std::size_t i = 0; i < stalled.given_J.size(); i += 4) {
    series.x.push_back(1e-3 * static_cast<double>(i));
    series.y.push_back(stalled.given_J[i]);
  }
  return series;
}

}  // namespace

FailureResult RunSimulationStall(const FailureSetting& setting) {
  FailureResult result{.id = 10,
                       .name = "simulation stalls",
                       .metric = "energy given back beyond what was taken, through a stall",
                       .unit = "J",
                       .baseline_name = "force of the last frame, held",
                       .bound = 0.02};
  const std::vector<double> stalls_s =
      setting.full() ? std::vector{0.02, 0.05, 0.1, 0.15, 0.2} : std::vector{0.02, 0.2};
  double step = 0.0, held_step = 0.0;
  int done = 0, held_fails = 0;
  bool complete = true, faulted = false;
  std::string worst;
  for (const Case& c : kMotions) {
    for (const double stall_s : stalls_s) {
      if (!complete) break;
      const StallResult ours = MeasureStall(c, stall_s, false), held = MeasureStall(c, stall_s, true);
      if (ours.step_share >= step) worst = fmt::format("{}, {:.0f} ms", c.name, 1e3 * stall_s);
      result.ours = std::max(result.ours, ours.returned_J);
      step = std::max(step, ours.step_share);
      faulted |= ours.fault;
      held_fails += held.returned_J > result.bound ? 1 : 0;
      held_step = std::max(held_step, held.step_share);
      if (held.returned_J > result.baseline) {
        result.baseline = held.returned_J;
        result.plot = {.x_label = fmt::format("time [s]; {}, no frame for {:.0f} ms from {:g} s on", c.name,
                                              1e3 * stall_s, kStalls_s),
                       .y_label = "energy that the virtual side has given [J]",
                       .series = {Drawn("held force", held, false), Drawn("ours", ours, true)},
                       .bound_is_on_y = true};
      }
      complete = setting.GoesOn(++done / static_cast<double>(kMotions.size() * stalls_s.size()));
    }
  }
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && !faulted && result.ours <= result.bound && step < kMaxStep;
  result.note = fmt::format(
      "{} stalls, the held force gives energy in {} of them; where frames come again the force changes by "
      "{:.1f} % in a millisecond at most with ours ({}; bound 10 %), by {:.0f} % with the held one",
      done, held_fails, 100.0 * step, worst, 100.0 * held_step);
  return result;
}

}  // namespace osteon::studies
