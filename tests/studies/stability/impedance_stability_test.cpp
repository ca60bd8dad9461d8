// Model A of docs/theory/stability.md: an impedance device at a virtual wall.

#include <cmath>
#include <ostream>

#include <gtest/gtest.h>

#include "tests/oracles/impedance_loop.h"
#include "tests/oracles/loop_growth.h"

namespace osteon::studies {
namespace {

// A case that a prototype of this model computed: mass m [kg], drag b and wall damping B [N s/m], delay d
// [ticks].
struct Row {
  const char* name;
  double m, b, B;
  int d;
  double K_max, approximate;  // stiffest wall: by eigenvalues; by (b + B) / (T/2 + t_d)
};
void PrintTo(const Row& row, std::ostream* os) { *os << row.name; }

ImpedanceLoopParams LoopOf(const Row& row) {
  return {.mass_kg = row.m, .damping_Ns_per_m = row.b, .wall_damping_Ns_per_m = row.B, .delay = row.d};
}

class ModelA : public testing::TestWithParam<Row> {};

TEST_P(ModelA, StiffestWallEqualsTheDesigns) {
  const hil::Boundary found = MaxWallStiffness(LoopOf(GetParam()));
  ASSERT_TRUE(found.crossed);
  EXPECT_NEAR(found.value, GetParam().K_max, 2e-4 * GetParam().K_max) << "four or five digits are given";
}

TEST_P(ModelA, GrowthInTimeEqualsTheSpectralRadiusOnBothSidesOfTheLimit) {
  for (const double share : {0.8, 1.2}) {
    ImpedanceLoopParams params = LoopOf(GetParam());
    params.wall_stiffness_N_per_m = share * GetParam().K_max;
    const ImpedanceLoop loop(params);
    const double log_rho = std::log(loop.SpectralRadius());
    EXPECT_LT((1.0 - share) * log_rho, 0.0);
    const double grown =
        GrowthPerPeriod([&](const Eigen::VectorXd& s) { return loop.Step(s); }, loop.size(), 20'000, 400'000);
    EXPECT_NEAR(grown, log_rho, 0.05 * std::abs(log_rho) + 2e-5);
  }
}

// The rule of thumb for the stiffest wall is (b + B) / (T/2 + t_d), with the period T and the delay t_d. It
// must hold if the wall has no damping B.
TEST_P(ModelA, RuleOfThumbGivesTheLimitWithoutWallDamping) {
  const Row& row = GetParam();
  const double rule = (row.b + row.B) / (0.5e-3 + 1e-3 * row.d);
  EXPECT_NEAR(rule, row.approximate, 2e-4 * row.approximate);
  if (row.B > 0.0) return;
  EXPECT_NEAR(MaxWallStiffness(LoopOf(row)).value, rule, 0.01 * rule);
}

INSTANTIATE_TEST_SUITE_P(Design, ModelA,
                         testing::Values(Row{"prompt", .5, 2, 0, 0, 4002.7, 4000},
                                         Row{"two_late", .5, 2, 0, 2, 801.4, 800},
                                         Row{"five_late", .5, 2, 0, 5, 365.0, 363.6},
                                         Row{"damped_wall", .5, 2, 50, 2, 17818, 20800},
                                         Row{"heavy_damped_wall", 5, 20, 50, 5, 12472, 12727}),
                         [](const auto& test) { return test.param.name; });

// A stable loop need not be passive: some hand may still excite it.
TEST(ModelA, PassivityNeedsMoreDampingThanStability) {
  ImpedanceLoopParams wall{.wall_stiffness_N_per_m = 700.0, .delay = 2};
  EXPECT_LT(ImpedanceLoop(wall).SpectralRadius(), 1.0);
  EXPECT_GT(PassiveDamping(wall), wall.damping_Ns_per_m * 0.8);
  wall.wall_damping_Ns_per_m = 50.0;
  EXPECT_LT(ImpedanceLoop(wall).SpectralRadius(), 1.0) << "damping in the wall makes it more stable";
  EXPECT_GT(PassiveDamping(wall), 20.0 * wall.damping_Ns_per_m) << "and, late, far from passive";
}

// Without a delay, the closed form is Colgate and Schenkel's: b > K T / 2 + |B|.
TEST(ModelA, PassiveDampingEqualsColgatesWithoutDelay) {
  const ImpedanceLoopParams wall{.wall_stiffness_N_per_m = 3000.0, .wall_damping_Ns_per_m = 4.0};
  EXPECT_NEAR(PassiveDamping(wall), 0.5 * 3000.0 * 1e-3 + 4.0, 1e-6);
  ImpedanceLoopParams late = wall;
  late.delay = 4;
  EXPECT_LE(PassiveDamping(late), 3000.0 * (0.5e-3 + 4e-3) + 4.0);
}

}  // namespace
}  // namespace osteon::studies
