#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <gtest/gtest.h>

#include "simulation/cutting_math.h"
#include "simulation/reference_engine.h"
#include "tests/gpu/contract_bench.h"

// What the Vulkan engine promises: the reference's results, the same bits each time, and nothing for the
// validation layers to say.

namespace osteon::gpu {
namespace {

using simulation::CarvedState;
using simulation::Contact;
using simulation::ContactModel;
using simulation::FrameInput;

constexpr int kFrames = 500;

/// How far apart the engines are, at most, over the frames of a run.
struct Apart {
  double contact_mm{0.0};  ///< of the place of first contact on the frame's path
  double normal_deg{0.0};  ///< where there is a force of 1 N
  double proxy_mm{0.0}, force_N{0.0}, torque_Nm{0.0}, most_N{0.0};
  int touching{0}, counts{0};  ///< frames in contact; with another number of contacts

  /// One frame. @param path_m  from the proxy of the frame before to the pose
  void Add(double path_m, const ContactModel& a, const ContactModel& b) {
    const Vector3 f = a.F_T_W.f, n = a.n_W, m = b.n_W;
    contact_mm = std::max(contact_mm, 1e3 * path_m * std::abs(a.contact_fraction - b.contact_fraction));
    if (f.norm() > 1.0)
      normal_deg = std::max(normal_deg, std::atan2(n.cross(m).norm(), n.dot(m)) * 180.0 / M_PI);
    proxy_mm = std::max(proxy_mm, 1e3 * (Vector3(a.X_WP.p) - Vector3(b.X_WP.p)).norm());
    force_N = std::max(force_N, (f - Vector3(b.F_T_W.f)).norm());
    torque_Nm = std::max(torque_Nm, (Vector3(a.F_T_W.t) - Vector3(b.F_T_W.t)).norm());
    most_N = std::max(most_N, f.norm());
    touching += a.contact_count > 0 ? 1 : 0;
    counts += a.contact_count != b.contact_count ? 1 : 0;
  }
};

/// How far apart their carved states are.
struct BonesApart {
  double ball_mm{0.0};  ///< centre or radius, the worst of all balls
  int exempt{0};        ///< gone in one only, and within 1e-5 mm of the radius where a ball goes in the other
  int points{0}, changed{0}, cleared{0};
};
BonesApart Compare(const simulation::Bone& uncut, const CarvedState& a, const CarvedState& b) {
  constexpr double kGone_mm = 1e3 * simulation::kLeastBallRadius + 1e-5;
  BonesApart apart;
  for (std::size_t i = 0; i < a.balls.size(); i += 4) {
    const float r = a.balls[i + 3], s = b.balls[i + 3];
    apart.changed += r < static_cast<float>(uncut.balls[i / 4].radius_m * 1e3) ? 1 : 0;
    if (r == 0.0f && s == 0.0f) continue;
    if ((r == 0.0f || s == 0.0f) && std::max(r, s) <= kGone_mm) {
      ++apart.exempt;
      continue;
    }
    for (std::size_t k = i; k < i + 4; ++k)
      apart.ball_mm = std::max(apart.ball_mm, std::abs(static_cast<double>(a.balls[k]) - b.balls[k]));
  }
  for (std::size_t i = 0; i < a.cleared.size(); ++i) {
    apart.points += a.cleared[i] != b.cleared[i] ? 1 : 0;
    apart.cleared += a.cleared[i];
  }
  return apart;
}

/// The bars.
void ExpectWithinTheBars(const Apart& frames, const BonesApart& bones, const ContactModel& a,
                         const ContactModel& b) {
  std::printf(
      "up to %.1f N, %d frames in contact, %d balls cut, %d points cleared, %.1f mm^3\n"
      "worst: contact %.1e mm, normal %.1e deg, force %.1e N, torque %.1e Nm, proxy %.1e mm, contacts %d "
      "frames\nballs: worst %.1e mm, %d exempt; points %d; mass %.1e\n",
      frames.most_N, frames.touching, bones.changed, bones.cleared, a.removed_volume_m3 * 1e9,
      frames.contact_mm, frames.normal_deg, frames.force_N, frames.torque_Nm, frames.proxy_mm, frames.counts,
      bones.ball_mm, bones.exempt, bones.points, std::abs(b.removed_mass_kg / a.removed_mass_kg - 1.0));
  EXPECT_LE(frames.contact_mm, 1e-4);
  EXPECT_LE(frames.normal_deg, 0.05);
  EXPECT_LE(bones.ball_mm, 1e-4);
  EXPECT_LE(bones.exempt, 3);
  EXPECT_NEAR(b.removed_mass_kg, a.removed_mass_kg, 1e-5 * a.removed_mass_kg);
  // what hangs on these: the coupling's force on the proxy (20 N/mm), the torque at 150 mm
  EXPECT_LE(frames.proxy_mm, 1e-3);
  EXPECT_LE(frames.force_N, 0.02);
  EXPECT_LE(frames.torque_Nm, 3e-3);
  EXPECT_LE(frames.counts, 20);
  EXPECT_EQ(bones.points, 0);
  EXPECT_NEAR(b.cutting_work_J, a.cutting_work_J, 1e-5 * a.cutting_work_J);
  EXPECT_NEAR(b.spindle_torque_Nm, a.spindle_torque_Nm, 1e-4 * a.spindle_torque_Nm);
  EXPECT_NEAR(b.engaged_area_m2, a.engaged_area_m2, 1e-4 * a.engaged_area_m2);
}

TEST(VulkanEngine, ReamsLikeTheReferenceForTwoThousandFrames) {
  const simulation::Bone bone = DefaultBone();
  const simulation::Tool tool = DefaultReamer();
  simulation::ReferenceEngine reference(bone, tool, Pose::Identity(), {});
  const auto vulkan = Open(bone, tool);
  Hand hand;
  Apart apart;
  ContactModel a, b;
  for (int i = 0; i < 2000; ++i) {
    const FrameInput input = hand.Next(a.F_T_W.f);
    const double path_m = i > 0 ? (Vector3(input.X_WT.p) - Vector3(a.X_WP.p)).norm() : 0.0;
    a = reference.Step(input);
    b = vulkan->Step(input);
    ASSERT_EQ(b.status, simulation::EngineStatus::kOk);
    ASSERT_EQ(b.frame, a.frame);
    ASSERT_EQ(Vector3(a.n_W).norm() > 0.0, Vector3(b.n_W).norm() > 0.0) << i;
    apart.Add(path_m, a, b);
  }
  const BonesApart bones = Compare(bone, reference.Snapshot(), vulkan->Snapshot());
  // the run is worth comparing
  EXPECT_GT(apart.most_N, 100.0);
  EXPECT_GT(apart.touching, 1980);
  EXPECT_GT(bones.changed, 500);
  EXPECT_GT(bones.cleared, 500);
  ExpectWithinTheBars(apart, bones, a, b);
}

// A burr in bone of balls not much smaller than itself: which of them holds it is decided anew all the time.
TEST(VulkanEngine, BurrsLikeTheReferenceForTwoThousandFrames) {
  const simulation::Bone bone = DefaultBone();
  simulation::Tool tool;
  tool.balls.push_back({.center_m = Vector3(0, 0, 4e-3), .radius_m = 4e-3, .cutting = true});
  simulation::ReferenceEngine reference(bone, tool, Pose::Identity(), {});
  const auto vulkan = Open(bone, tool);
  Apart apart;
  ContactModel a, b;
  for (int i = 0; i < 2000; ++i) {
    // down into the rim, then along a figure of eight
    const double phase = 4.0 * M_PI * i / 2000.0, down = std::min(1.0, 3.0 * i / 2000.0);
    FrameInput input{.X_WT = Pose::Identity(), .spindle_rad_per_s = kSpindle_rad_per_s, .dt_s = Hand::kDt};
    input.X_WT.p =
        Vector3(0.029 + 1.5e-3 * std::sin(phase), 0.8e-3 * std::sin(2.0 * phase), 0.4e-3 - 2e-3 * down);
    const double path_m = i > 0 ? (Vector3(input.X_WT.p) - Vector3(a.X_WP.p)).norm() : 0.0;
    a = reference.Step(input);
    b = vulkan->Step(input);
    apart.Add(path_m, a, b);
  }
  const BonesApart bones = Compare(bone, reference.Snapshot(), vulkan->Snapshot());
  EXPECT_GT(apart.most_N, 5.0);
  EXPECT_GT(apart.touching, 1500);
  EXPECT_GT(bones.changed, 50);
  EXPECT_GT(bones.cleared, 5);
  ExpectWithinTheBars(apart, bones, a, b);
}

TEST(VulkanEngine, GivesAHandTheForceThatTheReferenceGives) {
  const simulation::Bone bone = DefaultBone();
  const simulation::Tool tool = DefaultReamer();
  simulation::ReferenceEngine reference(bone, tool, Pose::Identity(), {});
  const auto vulkan = Open(bone, tool);
  Hand hand, other;  // each follows its own engine's force
  ContactModel a, b;
  double worst = 0.0, most_N = 0.0;
  for (int i = 0; i < 300; ++i) {
    a = reference.Step(hand.Next(a.F_T_W.f));
    b = vulkan->Step(other.Next(b.F_T_W.f));
    const Vector3 f = a.F_T_W.f, g = b.F_T_W.f;
    most_N = std::max(most_N, f.norm());
    if (f.norm() > 1.0) worst = std::max(worst, (f - g).norm() / f.norm());
  }
  std::printf("closed loop, up to %.1f N: force %.1e of it\n", most_N, worst);
  EXPECT_GT(most_N, 100.0);
  EXPECT_LE(worst, 0.005);
}

/// Every number of a model but its padding.
bool Identical(const ContactModel& a, const ContactModel& b) {
  const auto same = [](const auto& x, const auto& y) { return std::memcmp(&x, &y, sizeof x) == 0; };
  bool equal = same(a.X_WP, b.X_WP) && a.contact_count == b.contact_count && a.status == b.status &&
               same(a.n_W, b.n_W) && same(a.contact_fraction, b.contact_fraction) && same(a.F_T_W, b.F_T_W) &&
               same(a.advance_m_per_s, b.advance_m_per_s) && same(a.engaged_area_m2, b.engaged_area_m2) &&
               same(a.spindle_torque_Nm, b.spindle_torque_Nm) &&
               same(a.removed_volume_m3, b.removed_volume_m3) && same(a.removed_mass_kg, b.removed_mass_kg) &&
               same(a.cutting_work_J, b.cutting_work_J) && a.pose_stamp == b.pose_stamp && a.frame == b.frame;
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    const Contact &p = a.contacts[i], &q = b.contacts[i];
    equal = equal && same(p.p_TP_m, q.p_TP_m) && same(p.p_W_m, q.p_W_m) && same(p.n_W, q.n_W) &&
            same(p.gap_m, q.gap_m) && same(p.stiffness_N_per_m, q.stiffness_N_per_m) && same(p.mu, q.mu) &&
            same(p.advance_m_per_s, q.advance_m_per_s) && same(p.weight, q.weight) &&
            p.material == q.material;
  }
  return equal;
}

TEST(VulkanEngine, TwoRunsAreBitIdentical) {
  const simulation::Bone bone = DefaultBone();
  const auto one = Open(bone, DefaultReamer()), two = Open(bone, DefaultReamer());
  Hand hand;
  ContactModel model;
  for (int i = 0; i < kFrames; ++i) {
    const FrameInput input = hand.Next(model.F_T_W.f);
    model = one->Step(input);
    ASSERT_TRUE(Identical(model, two->Step(input))) << i;
  }
  EXPECT_GT(model.removed_volume_m3, 0.0);
  EXPECT_EQ(simulation::HashState(one->Snapshot()), simulation::HashState(two->Snapshot()));
}

// Sums over thousands of contacts at once: who adds with whom is the scheduler's, the sum must not be.
TEST(VulkanEngine, TwoSeatedRunsAreBitIdentical) {
  const simulation::Bone bone = DefaultBone();
  const simulation::Tool fits = simulation::MakeReamer(0.0238, 0.008, 0.12, 0.9, Vector3::Zero());
  const auto one = Open(bone, fits), two = Open(bone, fits);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = Eigen::DiagonalMatrix<double, 3>(1, -1, -1);
  for (int i = 0; i < 80; ++i) {
    // from just above the floor to 6 mm into it, and a little aside
    X_WT.translation() = Vector3(2e-4 * std::sin(0.1 * i), 0, -0.0236 - std::min(6e-3, 2e-4 * i));
    const FrameInput input{
        .X_WT = X_WT, .spindle_rad_per_s = 26.0, .dt_s = i == 0 ? 0.0 : 2e-3, .stamp = i * 2'000'000};
    ASSERT_TRUE(Identical(one->Step(input), two->Step(input))) << i;
  }
  EXPECT_EQ(simulation::HashState(one->Snapshot()), simulation::HashState(two->Snapshot()));
}

TEST(VulkanEngine, ResultsDoNotDependOnTheListsKeptBetweenFrames) {
  const simulation::Bone bone = DefaultBone();
  const auto keeping = Open(bone, DefaultReamer()), dropping = Open(bone, DefaultReamer());
  Hand hand;
  ContactModel model;
  for (int i = 0; i < kFrames / 2; ++i) {
    const FrameInput input = hand.Next(model.F_T_W.f);
    if (i % 7 == 6)
      dropping->Restore(dropping->Snapshot());  // a state of its own changes nothing but the lists
    model = keeping->Step(input);
    ASSERT_TRUE(Identical(model, dropping->Step(input))) << i;
  }
  EXPECT_EQ(simulation::HashState(keeping->Snapshot()), simulation::HashState(dropping->Snapshot()));
}

TEST(VulkanEngine, HasNothingForTheValidationLayersToSay) {
  auto opened = VulkanEngine::Create(DefaultBone(), DefaultReamer(), Pose::Identity(), {},
                                     {.device = "", .validation = true, .time_passes = true});
  if (!opened && opened.error().find("vulkan-validationlayers") != std::string::npos)
    GTEST_SKIP() << opened.error();
  ASSERT_TRUE(opened.has_value()) << opened.error();
  VulkanEngine& engine = **opened;
  Hand hand;
  ContactModel model;
  for (int i = 0; i < 120; ++i) model = engine.Step(hand.Next(model.F_T_W.f));
  EXPECT_GT(model.contact_count, 0);
  // taken out, and laid on its side over the block, so that the shaft is what touches
  simulation::CarvedState state = engine.Snapshot();
  state.has_proxy = false;
  engine.Restore(state);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = ExpRotation({0, 0.5 * M_PI, 0});
  for (int i = 0; i < 60; ++i) {
    X_WT.translation() = Vector3(0.115, 0, 0.10 - 0.0016 * i);
    model = engine.Step({.X_WT = X_WT, .spindle_rad_per_s = kSpindle_rad_per_s});
  }
  EXPECT_GT(model.contact_count, 0);
  EXPECT_EQ(model.spindle_torque_Nm, 0.0) << "it was the head that touched";
  EXPECT_FALSE(engine.LastPassTimes().empty());
  EXPECT_EQ(engine.validation_messages(), 0);
}

}  // namespace
}  // namespace osteon::gpu
