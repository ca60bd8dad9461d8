#include "control/coupling/coupling_pipeline.h"

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_parts.h"

// Tests the pipeline that computes the rendered wrench from the contact model: the coupling, the limits, and
// the report of the limits that act.

namespace osteon::control {
namespace {

using safety::Limit, safety::LimitSet;

// The pipeline with a tool that rests `depth_m` deep in bone.
struct Contact {
  explicit Contact(const ServoParams& p) : params(p), arm(Follower(params)), pipeline(params) {
    pipeline.Reset();
  }
  safety::LimitedWrench Tick(double depth_m, const Twist& V_WT = {}) {
    now += rt::kMillisecond;
    return Tick(PlaneBehind(depth_m, now), V_WT);
  }
  safety::LimitedWrench Tick(const simulation::ContactModel& model, const Twist& V_WT) {
    acting = {};
    static_cast<void>(pipeline.Evaluate(
        {.model = model, .X_WT = arm->X_WT(), .V_WT = V_WT, .now = now, .spindle_turns = false}, *arm,
        acting));
    return pipeline.Render(*arm, acting);
  }
  // Runs 500 ticks, long enough for the coupling to fade in.
  safety::LimitedWrench Settle(double depth_m) {
    safety::LimitedWrench rendered;
    for (int i = 0; i < 500; ++i) rendered = Tick(depth_m);
    return rendered;
  }

  ServoParams params;
  std::unique_ptr<ArmFollower> arm;
  CouplingPipeline pipeline;
  rt::Nanoseconds now{rt::kSecond};
  LimitSet acting;
};

TEST(CouplingPipeline, RendersDepthTimesStiffness) {
  Contact contact(ServoBench::Params());
  const safety::LimitedWrench rendered = contact.Settle(2e-3);
  EXPECT_TRUE(contact.pipeline.pressed());
  EXPECT_NEAR(rendered.F.f.norm(), 2e-3 * contact.params.coupling.max_stiffness_N_per_m,
              0.01 * rendered.F.f.norm());
  EXPECT_EQ(rendered.share, 1.0);
  EXPECT_FALSE(contact.acting.Has(Limit::kWrench));
}

TEST(CouplingPipeline, NeverRendersMoreThanTheCellsLimit) {
  ServoParams params = ServoBench::Params();
  params.wrench.max_force_N = 50.0;
  Contact contact(params);
  const safety::LimitedWrench rendered = contact.Settle(20e-3);
  EXPECT_LE(rendered.F.f.norm(), 50.0);
  EXPECT_GT(rendered.F.f.norm(), 49.0);
  EXPECT_LT(contact.pipeline.limited().share, 1.0);
  contact.pipeline.AddActing({.F = rendered.F, .share = contact.pipeline.limited().share}, contact.acting);
  EXPECT_TRUE(contact.acting.Has(Limit::kWrench));
  EXPECT_GT(contact.pipeline.force_limit_reaction().tool_in_bone_m(), 15e-3);
}

TEST(CouplingPipeline, TheStoredEnergyLimitBoundsTheForce) {
  ServoParams params = ServoBench::Params();
  params.energy.max_stored_J = 0.02;
  Contact contact(params);
  const safety::LimitedWrench rendered = contact.Settle(10e-3);
  const double K = contact.params.coupling.max_stiffness_N_per_m;
  EXPECT_NEAR(rendered.F.f.norm(), std::sqrt(2.0 * 0.02 * K), 1.0);
  EXPECT_TRUE(contact.acting.Has(Limit::kStoredEnergy));
}

TEST(CouplingPipeline, APowerLimitScalesTheWrenchAndIsReported) {
  Contact contact(ServoBench::Params());
  safety::LimitedWrench rendered = contact.Settle(2e-3);
  const Vector3 before = rendered.F.f;
  contact.acting = {};
  contact.pipeline.LimitPower(1.0, rendered, contact.acting);
  EXPECT_EQ(rendered.F.f, before);
  EXPECT_FALSE(contact.acting.Has(Limit::kPower));
  contact.pipeline.LimitPower(0.25, rendered, contact.acting);
  EXPECT_EQ(rendered.F.f, Vector3(0.25 * before));
  EXPECT_DOUBLE_EQ(rendered.share, 0.25);
  EXPECT_TRUE(contact.acting.Has(Limit::kPower));
}

TEST(CouplingPipeline, AfterAResetTheForceFadesInFromZero) {
  Contact contact(ServoBench::Params());
  EXPECT_GT(contact.Settle(2e-3).F.f.norm(), 10.0);
  contact.pipeline.Reset();
  EXPECT_FALSE(contact.pipeline.pressed());
  EXPECT_LT(contact.Tick(2e-3).F.f.norm(), 2.0) << "it fades in";
}

TEST(CouplingPipeline, ChangedGainsActFromTheNextTick) {
  Contact contact(ServoBench::Params());
  const double before_N = contact.Settle(2e-3).F.f.norm();
  // changes the stiffness in the pipeline as well, because it holds the parameters by reference
  contact.params.coupling.max_stiffness_N_per_m *= 0.5;
  contact.pipeline.OnGainsChanged();
  EXPECT_NEAR(contact.Settle(2e-3).F.f.norm(), 0.5 * before_N, 0.02 * before_N);
}

TEST(CouplingPipeline, DoesNotAllocate) {
  Contact contact(ServoBench::Params());
  contact.Tick(1e-3);
  const simulation::ContactModel model = PlaneBehind(2e-3, contact.now);
  const rt::CheckedNoAllocScope scope;
  contact.Tick(model, {});
}

}  // namespace
}  // namespace osteon::control
