#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <gtest/gtest.h>

#include "simulation/contact/cutting_math.h"
#include "simulation/engine/reference_engine.h"
#include "tests/gpu/engine/contract_bench.h"

// Runs two engines with the same poses. Measures how far the Vulkan engine's results are from the reference
// engine's, or checks that two engines agree to the last bit.

namespace osteon::gpu {

/// Largest differences between two engines' models over the frames of a run.
struct FrameDifferences {
  double contact_mm{0.0};  ///< difference of the first contact's place along the frame's path
  double normal_deg{0.0};  ///< angle between the normals, in frames with more than 1 N
  double proxy_mm{0.0}, force_N{0.0}, torque_Nm{0.0};
  double max_N{0.0};  ///< largest force of the first engine; this is not a difference
  int touching{0},
      different_counts{0};  ///< number of frames in contact, and of frames with different numbers of contacts
  int mismatched{0};        ///< number of frames in which status or frame number differ, or in which only one
                            ///< engine has a force

  /// Adds one frame. @param path_m  distance from the previous frame's proxy to this frame's pose
  void Add(double path_m, const simulation::ContactModel& a, const simulation::ContactModel& b) {
    const Vector3 f = a.F_T_W.f, n = a.n_W, m = b.n_W;
    contact_mm = std::max(contact_mm, 1e3 * path_m * std::abs(a.contact_fraction - b.contact_fraction));
    if (f.norm() > 1.0)
      normal_deg = std::max(normal_deg, std::atan2(n.cross(m).norm(), n.dot(m)) * 180.0 / M_PI);
    proxy_mm = std::max(proxy_mm, 1e3 * (Vector3(a.X_WP.p) - Vector3(b.X_WP.p)).norm());
    force_N = std::max(force_N, (f - Vector3(b.F_T_W.f)).norm());
    torque_Nm = std::max(torque_Nm, (Vector3(a.F_T_W.t) - Vector3(b.F_T_W.t)).norm());
    max_N = std::max(max_N, f.norm());
    touching += a.contact_count > 0 ? 1 : 0;
    different_counts += a.contact_count != b.contact_count ? 1 : 0;
    const bool alike = a.status == b.status && a.frame == b.frame && (n.norm() > 0.0) == (m.norm() > 0.0);
    mismatched += alike ? 0 : 1;
  }
};

/// Differences between two engines' carved states.
struct BoneDifferences {
  double ball_mm{0.0};  ///< largest difference of a centre's coordinate or radius
  int exempt{0};  ///< number of balls that only one engine has removed, with a radius within 1e-5 mm of the
                  ///< radius at which a ball is removed
  int points{0};  ///< number of mass points that only one engine has cleared
  int changed{0},
      cleared{0};  ///< number of balls that the first engine has cut, and of points that it has cleared
};
/// @param uncut  the bone before the run
inline BoneDifferences Compare(const simulation::Bone& uncut, const simulation::CarvedState& a,
                               const simulation::CarvedState& b) {
  constexpr double kGone_mm = 1e3 * simulation::kMinBallRadius + 1e-5;
  BoneDifferences differences;
  for (std::size_t i = 0; i < a.balls.size(); i += 4) {
    const float r = a.balls[i + 3], s = b.balls[i + 3];
    differences.changed += r < static_cast<float>(uncut.balls[i / 4].radius_m * 1e3) ? 1 : 0;
    if (r == 0.0f && s == 0.0f) continue;
    if ((r == 0.0f || s == 0.0f) && std::max(r, s) <= kGone_mm) {
      ++differences.exempt;
      continue;
    }
    for (std::size_t k = i; k < i + 4; ++k)
      differences.ball_mm =
          std::max(differences.ball_mm, std::abs(static_cast<double>(a.balls[k]) - b.balls[k]));
  }
  for (std::size_t i = 0; i < a.cleared.size(); ++i) {
    differences.points += a.cleared[i] != b.cleared[i] ? 1 : 0;
    differences.cleared += a.cleared[i];
  }
  return differences;
}

/// Prints the differences, then expects that they are within the contract's tolerances.
/// @param a, b  the models of both engines in the last frame
inline void ExpectWithinTolerances(const FrameDifferences& frames, const BoneDifferences& bones,
                                   const simulation::ContactModel& a, const simulation::ContactModel& b) {
  std::printf(
      "up to %.1f N, %d frames in contact, %d balls cut, %d points cleared, %.1f mm^3\n"
      "worst: contact %.1e mm, normal %.1e deg, force %.1e N, torque %.1e Nm, proxy %.1e mm, contacts %d "
      "frames\nballs: worst %.1e mm, %d exempt; points %d; mass %.1e\n",
      frames.max_N, frames.touching, bones.changed, bones.cleared, a.removed_volume_m3 * 1e9,
      frames.contact_mm, frames.normal_deg, frames.force_N, frames.torque_Nm, frames.proxy_mm,
      frames.different_counts, bones.ball_mm, bones.exempt, bones.points,
      std::abs(b.removed_mass_kg / a.removed_mass_kg - 1.0));
  EXPECT_EQ(frames.mismatched, 0);
  EXPECT_LE(frames.contact_mm, 1e-4);
  EXPECT_LE(frames.normal_deg, 0.05);
  EXPECT_LE(bones.ball_mm, 1e-4);
  EXPECT_LE(bones.exempt, 3);
  EXPECT_NEAR(b.removed_mass_kg, a.removed_mass_kg, 1e-5 * a.removed_mass_kg);
  // tolerances that follow from those above: the force by the coupling's 20 N/mm, the torque by a lever of
  // 150 mm
  EXPECT_LE(frames.proxy_mm, 1e-3);
  EXPECT_LE(frames.force_N, 0.02);
  EXPECT_LE(frames.torque_Nm, 3e-3);
  EXPECT_LE(frames.different_counts, 20);
  EXPECT_EQ(bones.points, 0);
  EXPECT_NEAR(b.cutting_work_J, a.cutting_work_J, 1e-5 * a.cutting_work_J);
  EXPECT_NEAR(b.spindle_torque_Nm, a.spindle_torque_Nm, 1e-4 * a.spindle_torque_Nm);
  EXPECT_NEAR(b.engaged_area_m2, a.engaged_area_m2, 1e-4 * a.engaged_area_m2);
}

/// The reference and the Vulkan engine, stepped with the same inputs.
class EnginePair {
 public:
  EnginePair(simulation::Bone bone, const simulation::Tool& tool, const VulkanParams& vulkan = {},
             const simulation::CuttingParams& params = {})
      : bone_(std::move(bone)),
        reference_(bone_, tool, Pose::Identity(), params),
        vulkan_(Open(bone_, tool, vulkan, params)) {}

  /// Steps both engines. @returns the reference engine's model.
  const simulation::ContactModel& Step(const simulation::FrameInput& input) {
    const double path_m = a_.frame > 0 ? (Vector3(input.X_WT.p) - Vector3(a_.X_WP.p)).norm() : 0.0;
    a_ = reference_.Step(input);
    b_ = vulkan_->Step(input);
    frames_.Add(path_m, a_, b_);
    return a_;
  }
  /// Least activity of a run, without which a comparison would prove nothing: force, frames in contact, balls
  /// cut, points cleared.
  struct MinActivity {
    double force_N;
    int touching, balls, points;
  };
  /// Ends the run: expects that the differences are within the contract's tolerances, and that the run had
  /// the required activity.
  void ExpectWithinTolerances(const MinActivity& required) const {
    const BoneDifferences bones = Compare(bone_, reference_.Snapshot(), vulkan_->Snapshot());
    EXPECT_GT(frames_.max_N, required.force_N);
    EXPECT_GT(frames_.touching, required.touching);
    EXPECT_GT(bones.changed, required.balls);
    EXPECT_GT(bones.cleared, required.points);
    gpu::ExpectWithinTolerances(frames_, bones, a_, b_);
  }

 private:
  simulation::Bone bone_;
  simulation::ReferenceEngine reference_;
  std::unique_ptr<VulkanEngine> vulkan_;
  FrameDifferences frames_;
  simulation::ContactModel a_, b_;
};

/// Whether two models agree in every bit of every number. Their padding bytes may differ.
inline bool Identical(const simulation::ContactModel& a, const simulation::ContactModel& b) {
  const auto same = [](const auto& x, const auto& y) { return std::memcmp(&x, &y, sizeof x) == 0; };
  bool equal = same(a.X_WP, b.X_WP) && a.contact_count == b.contact_count && a.status == b.status &&
               same(a.n_W, b.n_W) && same(a.contact_fraction, b.contact_fraction) && same(a.F_T_W, b.F_T_W) &&
               same(a.advance_m_per_s, b.advance_m_per_s) && same(a.engaged_area_m2, b.engaged_area_m2) &&
               same(a.spindle_torque_Nm, b.spindle_torque_Nm) &&
               same(a.removed_volume_m3, b.removed_volume_m3) && same(a.removed_mass_kg, b.removed_mass_kg) &&
               same(a.cutting_work_J, b.cutting_work_J) && a.pose_stamp == b.pose_stamp && a.frame == b.frame;
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    const simulation::Contact &p = a.contacts[i], &q = b.contacts[i];
    equal = equal && same(p.p_TP_m, q.p_TP_m) && same(p.p_W_m, q.p_W_m) && same(p.n_W, q.n_W) &&
            same(p.gap_m, q.gap_m) && same(p.stiffness_N_per_m, q.stiffness_N_per_m) && same(p.mu, q.mu) &&
            same(p.advance_m_per_s, q.advance_m_per_s) && same(p.weight, q.weight) &&
            p.material == q.material;
  }
  return equal;
}

/// Steps two engines with the input `input_of(i, model of the previous frame)`. Expects that every number of
/// every model and the carved states agree. The tool must touch and cut, because two idle engines would agree
/// as well. @returns the last model.
template <class InputOf>
simulation::ContactModel ExpectSameBits(simulation::CuttingEngine& one, simulation::CuttingEngine& two,
                                        int frames, InputOf&& input_of) {
  simulation::ContactModel model;
  int touching = 0;
  for (int i = 0; i < frames; ++i) {
    const simulation::FrameInput input = input_of(i, model);
    model = one.Step(input);
    touching += model.contact_count > 0 ? 1 : 0;
    if (Identical(model, two.Step(input))) continue;
    ADD_FAILURE() << "frame " << i;
    return model;
  }
  EXPECT_EQ(simulation::HashState(one.Snapshot()), simulation::HashState(two.Snapshot()));
  EXPECT_GT(touching, frames / 2);
  EXPECT_GT(model.removed_volume_m3, 0.0);
  return model;
}

}  // namespace osteon::gpu
