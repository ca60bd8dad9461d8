#include "studies/failures/procedure/guidance_scenarios.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "studies/failures/procedure/guidance_bench.h"
#include "studies/stability/force_band.h"

namespace osteon::studies {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kTick_s = GuidanceBench::kPeriod_s;
constexpr int kEvery = 20;  // ticks from one point of a picture to the next

int Ticks(double seconds) { return static_cast<int>(std::lround(seconds / kTick_s)); }

// Goal of a hand that moves aside by 2 × half_m and back, once every 2 s.
HandOffset Aside(int tick, double half_m) {
  return {.p_W = {half_m * (1.0 - std::cos(0.5 * kTwoPi * kTick_s * tick)), 0.0, 0.0}};
}

}  // namespace

FailureResult RunGuidedCycles(const FailureSetting& setting) {
  FailureResult result{.id = 27,
                       .name = "guided cycles",
                       .metric = "energy that the guidance has given after 20 cycles",
                       .unit = "J",
                       .baseline_name = "the same springs at the measured pose, undamped",
                       .bound = 0.0};
  constexpr int kCycles = 20;
  // Simulates all cycles; returns the energy that the guidance has given [J].
  const auto run = [&](GuidanceBenchParams params, FailureSeries& series) {
    params.hand = {"stiff", 3000.0, 60.0, 3.0};
    GuidanceBench bench(params);
    for (int i = 0; i < Ticks(2.0 * kCycles); ++i) {
      bench.Step(Aside(i, 6e-3));
      if (i % kEvery == 0) {
        series.x.push_back(kTick_s * i);
        series.y.push_back(bench.energy_J());
      }
    }
    return bench.energy_J();
  };
  FailureSeries baseline{.name = "measured pose"}, ours{.name = "ours", .ours = true};
  GuidanceBenchParams late{.method = GuidanceMethod::kMeasuredPose};
  late.guidance.return_m_per_s = late.guidance.return_rad_per_s = 1e9;
  late.guidance.damping_Ns_per_m = late.guidance.damping_Nms_per_rad = 0.0;
  result.baseline = run(late, baseline);
  const bool complete = setting.GoesOn(0.5);
  result.ours = run({}, ours);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours <= result.bound;
  result.note = "a stiff hand of 3 kN/m leads the tool 12 mm aside and back once in 2 s";
  result.plot = {.x_label = "time [s]", .y_label = "energy given [J]", .series = {baseline, ours}};
  return result;
}

FailureResult RunSwitchedOnOutside(const FailureSetting& setting) {
  FailureResult result{.id = 28,
                       .name = "switched on outside",
                       .metric = "growth of the guidance's force within a tick",
                       .unit = "N",
                       .baseline_name = "full share at once",
                       .bound = 1.0};
  double given_J[2]{};   // largest energy that the guidance has given: baseline, ours
  bool came_on = false;  // whether our guidance has rendered a force
  // Returns the largest growth of the guidance's force within a tick [N]. @param given  receives the largest
  // energy given
  const auto run = [&](GuidanceMethod method, double& given, FailureSeries& series) {
    GuidanceBench bench({.method = method});
    bench.SwitchOnAside(10e-3);
    double growth_N = 0.0, before_N = 0.0;
    for (int i = 0; i < Ticks(4.0); ++i) {
      // The hand holds the tool aside for a second, leads it back to the axis, then out again.
      const double at_s = kTick_s * i;
      const double aside_mm = at_s < 1.0 ? 10.0 : at_s < 2.0 ? 10.0 * (2.0 - at_s) : 4.0 * (at_s - 2.0);
      const GuidanceTick tick = bench.Step({.p_W = {1e-3 * aside_mm, 0.0, 0.0}});
      const double now_N = tick.F_guidance_T_W.f.norm();
      growth_N = std::max(growth_N, now_N - before_N);
      before_N = now_N;
      given = std::max(given, bench.energy_J());
      came_on |= method == GuidanceMethod::kOurs && now_N > 1.0;
      if (i % kEvery == 0) {
        series.x.push_back(at_s);
        series.y.push_back(now_N);
      }
    }
    return growth_N;
  };
  FailureSeries baseline{.name = "at once"}, ours{.name = "ours", .ours = true};
  result.baseline = run(GuidanceMethod::kAtOnce, given_J[0], baseline);
  const bool complete = setting.GoesOn(0.5);
  result.ours = run(GuidanceMethod::kOurs, given_J[1], ours);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && came_on && result.ours <= result.bound && given_J[1] <= 0.0;
  result.note = fmt::format(
      "energy given, at most: {:.2g} J by the baseline, {:.2g} J by ours, which begins once "
      "the tool has been inside",
      given_J[0], given_J[1]);
  result.plot = {.x_label = "time [s]", .y_label = "guidance's force [N]", .series = {baseline, ours}};
  return result;
}

FailureResult RunGuidanceAtCeiling(const FailureSetting& setting) {
  const int cycles = setting.full() ? 200 : 20;
  FailureResult result{.id = 29,
                       .name = "guidance at the ceiling",
                       .metric = fmt::format("energy that the guidance has given after {} cycles", cycles),
                       .unit = "J",
                       .baseline_name = "its share is what the bone leaves, at once",
                       .bound = 0.0};
  // Simulates all cycles; returns the energy that the guidance has given [J].
  const auto run = [&](GuidanceMethod method, FailureSeries& series) {
    GuidanceBench bench({.method = method, .hand = {"stiff", 3000.0, 60.0, 3.0}});
    for (int i = 0; i < Ticks(2.0 * cycles); ++i) {
      // The bone pushes with the most force while the tool leaves the corridor; the hand resists it.
      const double bone_N = 100.0 * (1.0 + std::sin(0.5 * kTwoPi * kTick_s * i));
      HandOffset goal = Aside(i, 6e-3);
      goal.push_W = {0.0, 0.0, -bone_N};
      bench.Step(goal, {.f = {0.0, 0.0, bone_N}});
      if (i % (kEvery * cycles / 10) == 0) {
        series.x.push_back(kTick_s * i);
        series.y.push_back(bench.energy_J());
      }
    }
    return bench.energy_J();
  };
  FailureSeries baseline{.name = "share at once"}, ours{.name = "ours", .ours = true};
  result.baseline = run(GuidanceMethod::kAtOnce, baseline);
  const bool complete = setting.GoesOn(0.5);
  result.ours = run(GuidanceMethod::kOurs, ours);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours <= result.bound;
  result.note = "the bone's force and the hand's way have the same period, a quarter of it apart";
  result.plot = {.x_label = "time [s]", .y_label = "energy given [J]", .series = {baseline, ours}};
  return result;
}

FailureResult RunFirmHandAtEdge(const FailureSetting& setting) {
  FailureResult result{.id = 30,
                       .name = "firm hand at the edge",
                       .metric = "force of the hand between 5 and 40 Hz, in the last second",
                       .unit = "N",
                       .baseline_name = "20 N/mm at the measured pose",
                       .bound = 0.05};
  const double seconds = setting.full() ? 6.0 : 3.0;
  double lean_N = 0.0;  // force of the guidance at the end
  // Leads the tool aside within a second and holds it; returns the RMS value of the hand's force between 5
  // and 40 Hz in the last second [N].
  const auto run = [&](const GuidanceBenchParams& params, FailureSeries& series) {
    GuidanceBench bench(params);
    std::vector<Vector3> hand_N;
    for (int i = 0; i < Ticks(seconds); ++i) {
      const double aside_m = 30e-3 * std::min(1.0, kTick_s * i / 1.0);
      const GuidanceTick tick = bench.Step({.p_W = {aside_m, 0.0, 0.0}});
      hand_N.push_back(tick.hand_W);
      lean_N = tick.F_guidance_T_W.f.norm();
      if (i % 4 == 0) {
        series.x.push_back(kTick_s * i);
        series.y.push_back(tick.hand_N);
      }
    }
    const std::size_t last = hand_N.size() - static_cast<std::size_t>(Ticks(1.0));
    return RmsInBand(hand_N, last, hand_N.size() - last, 5.0, 40.0, kTick_s);
  };
  GuidanceBenchParams stiff{.method = GuidanceMethod::kMeasuredPose};
  stiff.guidance.lateral.stiffness = 20e3;
  FailureSeries baseline{.name = "measured pose, 20 N/mm"}, ours{.name = "ours", .ours = true};
  result.baseline = run(stiff, baseline);
  const bool complete = setting.GoesOn(0.5);
  result.ours = run({}, ours);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours <= result.bound && lean_N > 2.0;
  result.note = fmt::format("a firm hand of 500 N/m leans on the funnel with {:.1f} N", lean_N);
  result.plot = {.x_label = "time [s]", .y_label = "force of the hand [N]", .series = {baseline, ours}};
  return result;
}

FailureResult RunLetGoAside(const FailureSetting& setting) {
  FailureResult result{.id = 31,
                       .name = "let go aside",
                       .metric = "speed of the tool after the hand has let go",
                       .unit = "mm/s",
                       .baseline_name = "springs that do not fade on the way back",
                       .bound = 60.0};
  bool is_inside = false;  // the tool is back in the corridor at the end
  // Leads the tool aside and lets go; returns the largest speed of the tool in the 2 s after the release
  // [mm/s].
  const auto run = [&](const GuidanceBenchParams& params, FailureSeries& series) {
    GuidanceBench bench(params);
    double max_mm_per_s = 0.0, aside_m = 0.0;
    int released = -1;
    for (int i = 0; i < Ticks(8.0) && (released < 0 || i < released + Ticks(2.0)); ++i) {
      if (released < 0) aside_m += 0.04 * kTick_s;  // until the tool is 17 mm beyond the funnel
      const GuidanceTick tick =
          bench.Step({.p_W = {aside_m, 0.0, 0.0}, .push_W = {0.0, 0.0, 0.0}, .holds = released < 0});
      if (released < 0 && tick.excess_m >= 17e-3) released = i;
      if (released < 0) continue;
      max_mm_per_s = std::max(max_mm_per_s, 1e3 * tick.speed_m_per_s);
      is_inside = tick.excess_m <= 0.0;
      if ((i - released) % 4 == 0) {
        series.x.push_back(kTick_s * (i - released));
        series.y.push_back(1e3 * tick.speed_m_per_s);
      }
    }
    return max_mm_per_s;
  };
  GuidanceBenchParams springs{.method = GuidanceMethod::kAtOnce, .hand = {"stiff", 3000.0, 60.0, 3.0}};
  springs.guidance.return_m_per_s = springs.guidance.return_rad_per_s = 1e9;
  FailureSeries baseline{.name = "no fade"}, ours{.name = "ours", .ours = true};
  result.baseline = run(springs, baseline);
  const bool complete = setting.GoesOn(0.5);
  result.ours = run({.hand = springs.hand}, ours);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours > 0.0 && result.ours <= result.bound;
  result.note = is_inside ? "the tool comes back into the corridor within 2 s"
                          : "the tool is not yet back in the corridor after 2 s";
  result.plot = {.x_label = "time since the hand let go [s]",
                 .y_label = "speed [mm/s]",
                 .series = {baseline, ours},
                 .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
