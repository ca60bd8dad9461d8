#include "studies/failures/loop/grip_step.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/operator/hand_grid.h"
#include "studies/failures/loop/grip_trial.h"

namespace osteon::studies {
namespace {

constexpr double kStep_s = 1.3;  // time at which the grip stiffens

// Light fixed gains: virtual mass 2 kg, drag 10 N s/m, rotation in the same proportion, no vibration index.
control::ServoParams Baseline() {
  control::ServoParams loop;
  control::AdmittanceParams& law = loop.admittance;
  const Vector3 mass_ratio = Vector3::Constant(2.0).cwiseQuotient(law.mass_kg);
  const Vector3 damping_ratio = Vector3::Constant(10.0).cwiseQuotient(law.damping_Ns_per_m);
  law.mass_kg = Vector3::Constant(2.0);
  law.damping_Ns_per_m = Vector3::Constant(10.0);
  law.inertia_kg_m2 = law.inertia_kg_m2.cwiseProduct(mass_ratio);
  law.damping_Nms_per_rad = law.damping_Nms_per_rad.cwiseProduct(damping_ratio);
  loop.vibration.acts = false;
  return loop;
}

// Returns the force of each window over the time from the step to the window's middle, as a line of the
// picture.
FailureSeries Drawn(const char* name, const GripTrial& gripped, bool ours) {
  FailureSeries series{.name = name, .ours = ours};
  for (std::size_t i = 0; i < gripped.window_N.size(); ++i) {
    series.x.push_back(GripTrial::kEvery_s * static_cast<double>(i) + 0.5 * GripTrial::kWindow_s - kStep_s);
    series.y.push_back(std::max(1e-3, gripped.window_N[i]));
  }
  return series;
}

}  // namespace

FailureResult RunGripStep(const FailureSetting& setting) {
  FailureResult result{.id = 16,
                       .name = "grip",
                       .metric = "force between 5 and 40 Hz, from 0.5 s after the grip stiffens on",
                       .unit = "N",
                       .baseline_name = "m_v = 2 kg, b_v = 10 N s/m, fixed",
                       .bound = 0.5};
  struct Case {
    hil::GridHand hand;
    bool clamp;
  };
  std::vector<Case> cases{{{"6000 N/m, 13 N s/m, 1.1 kg", 6000.0, 13.0, 1.1}, false}};
  if (setting.full())
    cases.insert(cases.end(), {{{"6000 N/m, 2 N s/m, 0.3 kg", 6000.0, 2.0, 0.3}, false},
                               {{"6000 N/m, 2 N s/m, 4 kg", 6000.0, 2.0, 4.0}, false},
                               {{"10000 N/m, 13 N s/m, 1.1 kg", 10000.0, 13.0, 1.1}, false}});
  for (const hil::GridHand& hand : hil::NamedHands())
    if (hand.name == "clamp") cases.push_back({hand, true});
  const double seconds = setting.full() ? 4.0 : 2.0;

  result.baseline = 1e9;
  bool complete = true, faulted = false, baselines_fail = true;
  double max_N = 0.0, index = 0.0, end_index = 0.0;
  std::string worst;
  for (std::size_t i = 0; i < cases.size() && complete; ++i) {
    GripTrialParams trial{
        .after = cases[i].hand, .clamp = cases[i].clamp, .step_s = kStep_s, .seconds = seconds};
    const GripTrial ours = RunGripTrial(trial);
    trial.loop = Baseline();
    const GripTrial fixed = RunGripTrial(trial);
    // If the cell stopped, take the largest force: a stopped cell does not vibrate, but it cannot be used
    // either.
    const double fixed_N = fixed.fault ? fixed.max_N : fixed.calm_N;
    baselines_fail &= fixed_N > result.bound;
    result.baseline = std::min(result.baseline, fixed_N);
    if (ours.calm_N >= result.ours) worst = cases[i].hand.name;
    result.ours = std::max(result.ours, ours.calm_N);
    max_N = std::max(max_N, ours.max_N);
    index = std::max(index, ours.index);
    end_index = std::max(end_index, ours.indices.back());
    faulted |= ours.fault;
    if (i + 1 == cases.size())
      result.plot = {.x_label = "time since the clamp of 50 kN/m closed [s]",
                     .y_label = "force between 5 and 40 Hz, effective over 0.2 s [N]",
                     .log_y = true,
                     .series = {Drawn("fixed", fixed, false), Drawn("ours", ours, true)},
                     .bound_is_on_y = true};
    complete = setting.GoesOn(static_cast<double>(i + 1) / static_cast<double>(cases.size()));
  }
  result.baseline_fails = baselines_fail;
  result.ours_passes = complete && !faulted && result.ours <= result.bound;
  result.note = fmt::format(
      "{} grips, the baseline's least shown; with ours \"{}\" is the worst, right after the step the force "
      "reaches {:.1f} N in 0.2 s, the index {:.2f} at most and {:.2f} at the end",
      cases.size(), worst, max_N, index, end_index);
  return result;
}

}  // namespace osteon::studies
