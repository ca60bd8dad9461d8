#include <cstring>
#include <limits>
#include <vector>

#include "tests/simulation/engine/engine_bench.h"

// Tests of an engine's state: repeatable runs, saved and restored states, and the states and inputs that it
// refuses.

namespace osteon::simulation {
namespace {

using EngineState = Engine;
OSTEON_ON_EVERY_ENGINE(EngineState);

/// Frame i of a cut that moves down and along and turns a little; the spindle stands still in each 37th
/// frame.
FrameInput Frame(int i) {
  return At(Down({0.01e-3 * i, 0.2e-3 * std::sin(0.1 * i), 0.2e-3 - 0.02e-3 * i}, {0, 0.001 * i, 0}),
            i % 37 == 36 ? 0.0 : kSpindle_rad_per_s);
}

/// Whether two models are equal bit for bit.
bool Identical(const ContactModel& a, const ContactModel& b) {
  bool same = std::memcmp(&a.X_WP, &b.X_WP, sizeof a.X_WP) == 0 && a.contact_count == b.contact_count &&
              a.status == b.status && std::memcmp(&a.n_W, &b.n_W, sizeof a.n_W) == 0 &&
              std::memcmp(&a.F_T_W, &b.F_T_W, sizeof a.F_T_W) == 0 &&
              a.contact_fraction == b.contact_fraction && a.advance_m_per_s == b.advance_m_per_s &&
              a.engaged_area_m2 == b.engaged_area_m2 && a.spindle_torque_Nm == b.spindle_torque_Nm &&
              a.removed_volume_m3 == b.removed_volume_m3 && a.removed_mass_kg == b.removed_mass_kg &&
              a.cutting_work_J == b.cutting_work_J && a.frame == b.frame;
  for (int i = 0; same && i < a.contact_count; ++i) {
    const Contact &p = a.contacts[static_cast<std::size_t>(i)], &q = b.contacts[static_cast<std::size_t>(i)];
    same = std::memcmp(&p.p_TP_m, &q.p_TP_m, sizeof p.p_TP_m) == 0 &&
           std::memcmp(&p.p_W_m, &q.p_W_m, sizeof p.p_W_m) == 0 &&
           std::memcmp(&p.n_W, &q.n_W, sizeof p.n_W) == 0 && p.gap_m == q.gap_m && p.weight == q.weight &&
           p.material == q.material && p.advance_m_per_s == q.advance_m_per_s;
  }
  return same;
}

Bone SoftSlab() { return Slab(14e-3, 3e-3, true, kSoft); }

TEST_P(EngineState, EqualRunsGiveEqualBits) {
  const auto one = Make(SoftSlab(), BallTool(4e-3)), two = Make(SoftSlab(), BallTool(4e-3));
  for (int i = 0; i < 120; ++i) ASSERT_TRUE(Identical(one->Step(Frame(i)), two->Step(Frame(i)))) << i;
  EXPECT_EQ(HashState(one->Snapshot()), HashState(two->Snapshot()));
}

TEST_P(EngineState, ContinuesFromARestoredStateBitForBit) {
  const auto one = Make(SoftSlab(), BallTool(4e-3)), two = Make(SoftSlab(), BallTool(4e-3));
  for (int i = 0; i < 60; ++i) one->Step(Frame(i));
  const CarvedState middle = one->Snapshot();
  EXPECT_GT(middle.removed_volume_m3, 0.0);
  two->Restore(middle);  // engine `one` continues without an interruption
  for (int i = 60; i < 120; ++i) ASSERT_TRUE(Identical(one->Step(Frame(i)), two->Step(Frame(i)))) << i;
  EXPECT_EQ(HashState(one->Snapshot()), HashState(two->Snapshot()));
}

TEST_P(EngineState, ContinuesFromTheRestoredUncutBoneLikeANewEngine) {
  // deep enough that whole clusters of 64 balls are gone before the bone is restored
  const auto engine = Make(SoftSlab(), BallTool(6e-3), {.law = RemovalLaw::kImmediate}),
             fresh = Make(SoftSlab(), BallTool(6e-3), {.law = RemovalLaw::kImmediate});
  const CarvedState uncut = engine->Snapshot();
  engine->Step(At(Down({0, 0, 1e-3}), kSpindle_rad_per_s));
  for (int i = 0; i < 100; ++i) engine->Step(At(Down({0, 0, -0.05e-3 * i}), kSpindle_rad_per_s));
  const CarvedState cut = engine->Snapshot();
  std::size_t gone = 0;
  for (std::size_t i = 3; i < cut.balls.size(); i += 4) gone += cut.balls[i] == 0.0f ? 1 : 0;
  ASSERT_GT(gone, 500u);
  engine->Restore(uncut);
  fresh->Restore(uncut);  // rounds the reference engine's doubles to the state's floats, as in `engine`
  EXPECT_EQ(HashState(engine->Snapshot()), HashState(uncut));
  for (int i = 0; i < 120; ++i) ASSERT_TRUE(Identical(engine->Step(Frame(i)), fresh->Step(Frame(i)))) << i;
  EXPECT_EQ(HashState(engine->Snapshot()), HashState(fresh->Snapshot()));
}

TEST_P(EngineState, AStateOfAnotherBoneIsRefused) {
  const auto engine = Make(SoftSlab(), BallTool(4e-3));
  CarvedState state = engine->Snapshot();
  state.balls.pop_back();
  EXPECT_THROW(engine->Restore(state), std::invalid_argument);
  state = engine->Snapshot();
  state.cleared.push_back(0);
  EXPECT_THROW(engine->Restore(state), std::invalid_argument);
}

// A state's counts must be checked before its items are copied to arrays of fixed size.
TEST_P(EngineState, AStateWithInvalidCountsIndicesOrNumbersIsRefusedAndChangesNothing) {
  const auto engine = Make(SoftSlab(), BallTool(4e-3));
  for (int i = 0; i < 30; ++i) engine->Step(Frame(i));
  const CarvedState good = engine->Snapshot();
  ASSERT_GT(good.contact.pair_count, 0);
  ASSERT_GT(good.contact.face_count, 0);
  const auto with = [&](auto change) {
    CarvedState bad = good;
    change(bad);
    return bad;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<CarvedState> bad = {
      with([](CarvedState& s) { s.contact.pair_count = kRememberedPairs + 1; }),
      with([](CarvedState& s) { s.contact.pair_count = -1; }),
      with([](CarvedState& s) { s.contact.held_count = 5; }),
      with([](CarvedState& s) { s.contact.held_count = -1; }),
      with([](CarvedState& s) { s.contact.held_count = s.contact.pair_count = 1, ++s.contact.held_count; }),
      with([](CarvedState& s) { s.contact.face_count = kMaxFaces + 1; }),
      with([](CarvedState& s) { s.contact.face_count = -1; }),
      with([](CarvedState& s) {
        s.contact.pairs[0].bone_ball = static_cast<std::uint32_t>(s.balls.size() / 4);
      }),
      with([](CarvedState& s) { s.contact.pairs[0].tool_ball = 1; }),
      with([&](CarvedState& s) { s.contact.face_n_G[0].y = nan; }),
      with([&](CarvedState& s) { s.contact.friction = nan; }),
      with([&](CarvedState& s) { s.X_GP.p.x = nan; }),
      with([](CarvedState& s) { s.X_GP.R[0] = 2.0; }),
      with([&](CarvedState& s) { s.cutting_debt_J = nan; }),
  };
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_THROW(engine->Restore(bad[i]), std::invalid_argument) << i;
    const CarvedState now = engine->Snapshot();
    EXPECT_EQ(HashState(now), HashState(good)) << i;
    EXPECT_EQ(now.frame, good.frame) << i;
    EXPECT_EQ(now.contact.pair_count, good.contact.pair_count) << i;
  }
}

TEST_P(EngineState, BadInputChangesNothingAndTheNextFrameWorks) {
  const auto engine = Make(SoftSlab(), BallTool(4e-3)), other = Make(SoftSlab(), BallTool(4e-3));
  for (int i = 0; i < 40; ++i) {
    FrameInput bad = Frame(i);
    switch (i % 4) {
      case 0:
        bad.X_WT.p.x = std::numeric_limits<double>::quiet_NaN();
        break;
      case 1:
        bad.X_WT.R[0] = std::numeric_limits<double>::infinity();
        break;
      case 2:
        bad.dt_s = -1e-3;
        break;
      default:
        bad.X_WT.R[8] *= -1.0;
    }
    const ContactModel refused = engine->Step(bad);
    ASSERT_EQ(refused.status, EngineStatus::kBadInput);
    ASSERT_EQ(refused.contact_count, 0);
    ASSERT_TRUE(Identical(engine->Step(Frame(i)), other->Step(Frame(i)))) << i;
  }
  EXPECT_EQ(HashState(engine->Snapshot()), HashState(other->Snapshot()));
}

TEST_P(EngineState, NamesItselfAndItsDevice) {
  const auto engine = Make(SoftSlab(), BallTool(4e-3));
  const bool is_cpu = GetParam() != EngineKind::kReference && GetParam() != EngineKind::kVulkan;
  EXPECT_EQ(engine->name(), is_cpu ? "cpu" : GetParam() == EngineKind::kReference ? "reference" : "vulkan");
  EXPECT_FALSE(engine->device().empty());
}

TEST(HashState, DiffersForAnyChangeOfABallOrPoint) {
  CarvedState state;
  state.balls = {1, 2, 3, 4, 5, 6, 7, 8};
  state.cleared = {0, 1, 0};
  EXPECT_EQ(HashState(state), HashState(CarvedState(state)));
  for (std::size_t i = 0; i < 8; ++i) {
    CarvedState other = state;
    other.balls[i] = std::nextafter(other.balls[i], 100.0f);
    EXPECT_NE(HashState(other), HashState(state)) << i;
  }
  CarvedState other = state;
  other.cleared[2] = 1;
  EXPECT_NE(HashState(other), HashState(state));
  // published value: the FNV-1a hash of empty input is its offset basis
  EXPECT_EQ(HashState({}), 14695981039346656037ull);
}

TEST(ReferenceEngine, RefusesABoneOrToolThatItCannotServe) {
  Bone bone = SoftSlab();
  EXPECT_THROW(ReferenceEngine(bone, Tool{}, Pose::Identity(), {}), std::invalid_argument);
  bone.materials.resize(9);
  EXPECT_THROW(ReferenceEngine(bone, BallTool(4e-3), Pose::Identity(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
