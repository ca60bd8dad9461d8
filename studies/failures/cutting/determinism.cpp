#include "studies/failures/cutting/determinism.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/scramble.h"
#include "simulation/contact/cutting_math.h"
#include "simulation/engine/reference_engine.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kRadius_m = 4e-3;  // radius of the tool

/// The hand's pose: down, then along a figure of eight.
Pose HandAt(int frame, int frames) {
  const double share = static_cast<double>(frame) / frames, phase = 4.0 * M_PI * share;
  return Downwards({1.5e-3 * std::sin(phase), 0.8e-3 * std::sin(2.0 * phase),
                    0.2e-3 - 1.6e-3 * std::min(1.0, 3.0 * share)});
}

bool SameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool SameBits(const PlainVector3& a, const PlainVector3& b) {
  return SameBits(a.x, b.x) && SameBits(a.y, b.y) && SameBits(a.z, b.z);
}
bool SameBits(const simulation::ContactModel& a, const simulation::ContactModel& b) {
  bool same = a.contact_count == b.contact_count && SameBits(a.X_WP.p, b.X_WP.p) && SameBits(a.n_W, b.n_W) &&
              SameBits(a.F_T_W.f, b.F_T_W.f) && SameBits(a.F_T_W.t, b.F_T_W.t) &&
              SameBits(a.removed_mass_kg, b.removed_mass_kg) &&
              SameBits(a.engaged_area_m2, b.engaged_area_m2) &&
              SameBits(a.contact_fraction, b.contact_fraction);
  for (int i = 0; same && i < a.contact_count; ++i)
    same = SameBits(a.contacts[i].n_W, b.contacts[i].n_W) &&
           SameBits(a.contacts[i].p_W_m, b.contacts[i].p_W_m) &&
           SameBits(a.contacts[i].gap_m, b.contacts[i].gap_m);
  return same;
}

/// Runs the cut. @returns the contact model of every frame
std::vector<simulation::ContactModel> Play(simulation::CuttingEngine& engine, int frames) {
  std::vector<simulation::ContactModel> models;
  for (int i = 0; i <= frames; ++i)
    models.push_back(engine.Step(FrameAt(HandAt(i, frames), kScenarioSpindle_rad_per_s)));
  return models;
}

/// Sums the normal of the contact as a parallel engine might: in single precision, in groups of 64 balls that
/// come in a random order. Each ball near the tool is weighted by the volume of its overlap.
/// @param schedule  seed of the order
Eigen::Vector3f SumOnSchedule(const simulation::Bone& bone, const Vector3& center_m, std::uint64_t schedule) {
  constexpr std::size_t kGroup = 64;
  std::vector<std::size_t> groups((bone.balls.size() + kGroup - 1) / kGroup);
  std::iota(groups.begin(), groups.end(), std::size_t{0});
  std::uint64_t bits = schedule;
  for (std::size_t i = groups.size(); i > 1; --i) {
    bits = simulation::Scramble(bits);
    std::swap(groups[i - 1], groups[bits % i]);
  }
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const std::size_t group : groups)
    for (std::size_t i = group * kGroup; i < std::min((group + 1) * kGroup, bone.balls.size()); ++i) {
      const Vector3 out = center_m - Vector3(bone.balls[i].center_m);
      const double d = out.norm();
      const double volume_mm3 = 1e9 * simulation::LensVolume(kRadius_m + 0.24e-3, bone.balls[i].radius_m, d);
      if (volume_mm3 > 0.0 && d > 0.0) sum += (volume_mm3 / d * out).cast<float>();
    }
  return sum;
}

/// Largest differences of our engine from the reference engine; `mass` is relative.
struct Agreement {
  double contact_mm{0.0}, normal_deg{0.0}, ball_mm{0.0}, mass{0.0};
  /// Number of balls that were about to vanish and that only one of the two engines has removed.
  int exempt{0};
  [[nodiscard]] bool good() const {
    return contact_mm <= 1e-4 && normal_deg <= 0.05 && ball_mm <= 1e-4 && mass <= 1e-5;
  }
};

/// Compares contact, normal and removed mass of every frame, and the balls at the end.
Agreement Compare(const std::vector<simulation::ContactModel>& ours, const simulation::CarvedState& our_state,
                  const std::vector<simulation::ContactModel>& reference,
                  const simulation::CarvedState& reference_state, int frames) {
  Agreement agreement;
  for (std::size_t i = 1; i < ours.size(); ++i) {
    const Vector3 way =  // from the proxy of the previous frame to the hand
        Pose(HandAt(static_cast<int>(i), frames)).translation() - Pose(reference[i - 1].X_WP).translation();
    agreement.contact_mm =
        std::max(agreement.contact_mm,
                 1e3 * std::abs(ours[i].contact_fraction - reference[i].contact_fraction) * way.norm());
    const Vector3 a = ours[i].n_W, b = reference[i].n_W;
    // skip near-zero forces: their direction is undefined
    if (a.isZero() || b.isZero() || Vector3(reference[i].F_T_W.f).norm() < 1.0) continue;
    agreement.normal_deg =
        std::max(agreement.normal_deg, std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI);
  }
  constexpr float kGone_mm = 1e-3f + 1e-5f;  // smaller balls count as gone (kMinBallRadius)
  for (std::size_t i = 0; i + 3 < our_state.balls.size(); i += 4) {
    const float *a = &our_state.balls[i], *b = &reference_state.balls[i];
    if ((a[3] == 0.0f) != (b[3] == 0.0f)) {
      if (std::max(a[3], b[3]) <= kGone_mm)
        ++agreement.exempt;
      else
        agreement.ball_mm = std::max(agreement.ball_mm, static_cast<double>(std::max(a[3], b[3])));
      continue;
    }
    if (a[3] == 0.0f) continue;
    for (int k = 0; k < 4; ++k)
      agreement.ball_mm =
          std::max(agreement.ball_mm, std::abs(static_cast<double>(a[k]) - static_cast<double>(b[k])));
  }
  agreement.mass = std::abs(ours.back().removed_mass_kg / reference.back().removed_mass_kg - 1.0);
  return agreement;
}

}  // namespace

FailureResult RunDeterminism(const FailureSetting& setting) {
  FailureResult result{.id = 21,
                       .name = "determinism",
                       .metric = "frames whose bits differ between two runs",
                       .unit = "1",
                       .baseline_name = "sums in the order of the threads",
                       .bound = 0.0};
  const int frames = setting.full() ? 2000 : 200;
  const simulation::Bone block = MakeBlock({.low_m = {-7e-3, -6e-3, -3e-3},
                                            .high_m = {7e-3, 6e-3, 0.0},
                                            .ball_radius_m = setting.full() ? 0.4e-3 : 0.6e-3,
                                            .point_spacing_m = setting.full() ? 0.25e-3 : 0.4e-3,
                                            .specific_cutting_energy_J_per_m3 = setting.full() ? 30e6 : 3e6});
  const simulation::Tool tool = MakeBallTool(kRadius_m);
  const auto first = setting.make_engine(block, tool, Pose::Identity(), {});
  const auto models = Play(*first, frames);
  bool complete = setting.GoesOn(0.2);
  const auto second = setting.make_engine(block, tool, Pose::Identity(), {});
  const auto again = Play(*second, frames);
  complete = setting.GoesOn(0.4) && complete;
  simulation::ReferenceEngine reference(block, tool, Pose::Identity(), {});
  const auto expected = Play(reference, frames);
  complete = setting.GoesOn(0.9) && complete;

  FailureSeries theirs{.name = "order of threads", .x = {}, .y = {}},
      mine{.name = "ours", .x = {}, .y = {}, .ours = true};
  int differ = 0, baseline = 0;
  for (std::size_t i = 0; i < models.size(); ++i) {
    differ += SameBits(models[i], again[i]) ? 0 : 1;
    const Vector3 center = Pose(expected[i].X_WP) * Vector3(tool.balls[0].center_m);
    const Eigen::Vector3f a = SumOnSchedule(block, center, 2 * i),
                          b = SumOnSchedule(block, center, 2 * i + 1);
    baseline += a == b ? 0 : 1;
    theirs.x.push_back(static_cast<double>(i));
    theirs.y.push_back(baseline);
    mine.x.push_back(static_cast<double>(i));
    mine.y.push_back(differ);
  }
  const simulation::CarvedState state = first->Snapshot();
  if (simulation::HashState(state) != simulation::HashState(second->Snapshot())) ++differ;
  const Agreement agreement = Compare(models, state, expected, reference.Snapshot(), frames);
  result.baseline = baseline;
  result.ours = differ;
  result.baseline_fails = baseline > 0;
  result.ours_passes = complete && differ == 0 && agreement.good() && models.back().removed_mass_kg > 0.0;
  result.note = fmt::format(
      "{} frames; against the reference engine: contact {:.2g} mm, normal {:.2g} deg, balls {:.2g} mm ({} "
      "exempt), mass {:.2g}",
      frames, agreement.contact_mm, agreement.normal_deg, agreement.ball_mm, agreement.exempt,
      agreement.mass);
  result.plot = {.x_label = "frame",
                 .y_label = "frames that differed so far",
                 .series = {std::move(theirs), std::move(mine)}};
  return result;
}

}  // namespace osteon::studies
