// Stability of loops with compliance (docs/theory/compliance.md): a massless link, and a bone on its mount,
// added to Model B. The rows are those of that page's tables: a hand of 3000 N/m, 60 N s/m and 3 kg, and an
// arm of 15 Hz.

#include <cmath>
#include <numbers>
#include <ostream>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "control/compliance/compliant_link.h"
#include "hil/loops/mount_rule.h"
#include "hil/operator/hand_grid.h"
#include "tests/studies/stability/compliant_loop.h"

namespace osteon::studies {
namespace {

const hil::GridHand kStiff{"stiff", 3000.0, 60.0, 3.0};

/// The tables' loop with a wall of this stiffness, and a virtual tool of mass m_v [kg] and drag b_v [N s/m],
/// without compliance.
hil::CompliantLoopParams LoopOf(double stiffness_N_per_m, double m_v, double b_v) {
  hil::CompliantLoopParams params;
  params.loop.hand = kStiff;
  params.loop.mass_kg = m_v;
  params.loop.damping_Ns_per_m = b_v;
  params.loop.wall.stiffness_N_per_m = stiffness_N_per_m;
  return params;
}

/// Expects a spectral radius of the tables: its logarithm within 1 %.
void ExpectRadius(double found, double expected) {
  const double log_rho = std::log(expected);
  EXPECT_NEAR(std::log(found), log_rho, 0.01 * std::abs(log_rho) + 6e-6) << "five digits are given";
}

/// A massless link of stiffness k in series with a wall of stiffness K [N/m]. Spectral radii: rigid without
/// the link; at_20ms with the link's time constant of 20 ms, at_20ms_mean also with the mean acceleration;
/// too_fast with the time constant fast_ms (0: not given). least_ms is the shortest stable time constant.
struct LinkRow {
  const char* name;
  double K, k, m_v, b_v, rigid, at_20ms, at_20ms_mean, fast_ms, too_fast, least_ms;
};
void PrintTo(const LinkRow& row, std::ostream* os) { *os << row.name; }

class MasslessLink : public testing::TestWithParam<LinkRow> {};

TEST_P(MasslessLink, HasTheDesignsRadiiAndBoundary) {
  const LinkRow& row = GetParam();
  hil::CompliantLoopParams params = LoopOf(row.K, row.m_v, row.b_v);
  ExpectRadius(hil::CompliantLoop(params).SpectralRadius(), row.rigid);
  params.link = hil::LoopLink{.compliance_m_per_N = 1.0 / row.k, .tau_s = 0.020};
  ExpectRadius(hil::CompliantLoop(params).SpectralRadius(), row.at_20ms);
  if (row.fast_ms > 0.0) {
    params.link->tau_s = 1e-3 * row.fast_ms;
    ExpectRadius(hil::CompliantLoop(params).SpectralRadius(), row.too_fast);
  }
  params.mean_acceleration = true;
  params.link->tau_s = 0.020;
  ExpectRadius(hil::CompliantLoop(params).SpectralRadius(), row.at_20ms_mean);
  params.mean_acceleration = false;
  const double least_ms = 1e3 * hil::MinLinkTime_s(params);
  EXPECT_NEAR(least_ms, row.least_ms, 0.01 * row.least_ms + 5e-3);
  // cells are checked by the rule 0.5 ms (K/k - 1); it must be within 3 % of the shortest stable time
  // constant
  EXPECT_NEAR(0.5 * (row.K / row.k - 1.0), least_ms, 0.03 * least_ms);
}

INSTANTIATE_TEST_SUITE_P(
    Design, MasslessLink,
    testing::Values(
        LinkRow{"drill_3_2", 80e3, 8.72e3, 3, 150, 0.97297, 0.97670, 0.97708, 3.0, 1.55780, 4.12},
        LinkRow{"drill_4", 80e3, 13.57e3, 3, 150, 0.97297, 0.97281, 0.97311, 2.0, 1.31105, 2.47},
        LinkRow{"drill_2", 80e3, 3.306e3, 3, 150, 0.97297, 0.98270, 0.98323, 10.0, 1.30487, 11.68},
        LinkRow{"canal_reamer", 60e3, 34.49e3, 1.7, 30, 0.99727, 0.96969, 0.97444, 0.0, 0.0, 0.38},
        LinkRow{"burr_2_3", 40e3, 9.552e3, 1.7, 30, 0.99035, 0.97558, 0.97590, 1.0, 1.60540, 1.61}),
    [](const auto& test) { return test.param.name; });

/// A bone on a mount of this frequency. Spectral radii for planes that follow the bone in the same tick, 4,
/// 12 and 20 ticks late; then in the same tick and 20 ticks late with the mean acceleration.
struct MountRow {
  const char* name;
  double mass_kg, hz;
  double in_tick, late_4, late_12, late_20, in_tick_mean, late_20_mean;
};
void PrintTo(const MountRow& row, std::ostream* os) { *os << row.name; }

class BoneOnItsMount : public testing::TestWithParam<MountRow> {};

TEST_P(BoneOnItsMount, HasTheDesignsRadii) {
  const MountRow& row = GetParam();
  hil::CompliantLoopParams params = LoopOf(20e3, 3, 20);
  ExpectRadius(hil::CompliantLoop(params).SpectralRadius(), 0.96536);
  params.mount = hil::LoopMount{.mass_kg = row.mass_kg, .frequency_hz = row.hz};
  for (const auto& [ticks, radius] :
       {std::pair{0, row.in_tick}, {4, row.late_4}, {12, row.late_12}, {20, row.late_20}}) {
    params.mount->late_ticks = ticks;
    ExpectRadius(hil::CompliantLoop(params).SpectralRadius(), radius);
  }
  params.mean_acceleration = true;
  for (const auto& [ticks, radius] : {std::pair{0, row.in_tick_mean}, {20, row.late_20_mean}}) {
    params.mount->late_ticks = ticks;
    ExpectRadius(hil::CompliantLoop(params).SpectralRadius(), radius);
  }
}

// The planes are late if the engine moves the bone, instead of the coupling. A bone of 12 kg at 15 Hz is then
// unstable from 12 ms on.
INSTANTIATE_TEST_SUITE_P(
    Design, BoneOnItsMount,
    testing::Values(MountRow{"12kg_6Hz", 12, 6, 0.99565, 0.99520, 0.99419, 0.99297, 0.99615, 0.99366},
                    MountRow{"12kg_10Hz", 12, 10, 0.98813, 0.98581, 0.98974, 0.99979, 0.98926, 0.99922},
                    MountRow{"12kg_15Hz", 12, 15, 0.98428, 0.99209, 1.00235, 1.00627, 0.98690, 1.00680},
                    MountRow{"3kg_10Hz", 3, 10, 0.99036, 1.00240, 1.01661, 1.01997, 0.99127, 1.02037}),
    [](const auto& test) { return test.param.name; });

// If a mount keeps the rules, the loop must be stable. The test tries random mounts and random hands. The
// hands are stable in free air and on rigid walls up to the stiffness K (1 + m_v / m), with the bone's mass
// m.
TEST(MountRules, HoldForRandomMountsAndHands) {
  std::mt19937_64 bits(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto log_between = [&](double low, double high) { return low * std::pow(high / low, unit(bits)); };
  constexpr double kK = 20e3, kT_s = 1e-3, kAge_s = 25.2e-3;
  int keeping_rules = 0, unstable = 0;
  for (int i = 0; i < 4000; ++i) {
    hil::CompliantLoopParams params = LoopOf(kK, 3.0, log_between(20.0, 150.0));
    params.loop.hand = {"any", log_between(50.0, 8000.0), log_between(2.0, 80.0), log_between(0.3, 4.0)};
    const hil::LoopMount mount{.mass_kg = log_between(1.0, 40.0),
                               .frequency_hz = log_between(4.0, 25.0),
                               .damping_ratio = log_between(0.005, 0.3)};
    hil::CompliantLoopParams rigid = params;
    rigid.loop.wall.stiffness_N_per_m = 0.0;
    if (!(hil::CompliantLoop(rigid).SpectralRadius() < 1.0 + 1e-9)) continue;
    rigid.loop.wall.stiffness_N_per_m = kK;
    if (!(hil::CompliantLoop(rigid).SpectralRadius() < 1.0)) continue;
    bool rigid_stable = true;
    for (int j = 1; j <= 8 && rigid_stable; ++j) {
      rigid.loop.wall.stiffness_N_per_m = kK * (1.0 + j / 8.0 * params.loop.mass_kg / mount.mass_kg);
      rigid_stable = hil::CompliantLoop(rigid).SpectralRadius() < 1.0;
    }
    const double w = 2.0 * std::numbers::pi * mount.frequency_hz, k = mount.mass_kg * w * w;
    const double damping = 2.0 * mount.damping_ratio * w * mount.mass_kg + params.loop.damping_Ns_per_m +
                           params.loop.hand.damping_Ns_per_m;
    const bool damped = mount.damping_ratio >= 0.05 && damping >= params.loop.hand.stiffness_N_per_m * kAge_s;
    const bool slow = std::sqrt((kK + k) / mount.mass_kg) * kT_s <= 0.4;
    params.mount = mount;
    const bool stable = hil::CompliantLoop(params).SpectralRadius() < 1.0;
    if (!damped || !slow || !rigid_stable) continue;
    ++keeping_rules;
    unstable += stable ? 0 : 1;
  }
  EXPECT_GT(keeping_rules, 300);
  EXPECT_EQ(unstable, 0) << "of " << keeping_rules;
}

// The loop of this firm grip is stable on a rigid wall. A mount with half the damping that the rule requires
// must make it unstable. A mount that keeps the rule must not.
TEST(MountRules, TellUnstableMountsFromStableOnes) {
  hil::CompliantLoopParams params = LoopOf(20e3, 3.0, 20.0);
  params.loop.hand = {"firm grip", 6000.0, 10.0, 1.0};
  EXPECT_LT(hil::CompliantLoop(params).SpectralRadius(), 0.996);
  params.mount = hil::LoopMount{.mass_kg = 12.0, .frequency_hz = 6.0, .damping_ratio = 0.05};
  EXPECT_GT(hil::CompliantLoop(params).SpectralRadius(), 1.0005);
  params.mount = hil::LoopMount{.mass_kg = 12.0, .frequency_hz = 15.0, .damping_ratio = 0.06};
  EXPECT_LT(hil::CompliantLoop(params).SpectralRadius(), 0.998) << "this mount keeps the rule";
}

// A force at a lever L also turns the bone, which lowers the effective mass: 1/m_eff = 1/m + L²/I, with the
// inertia I about the axis perpendicular to lever and force.
TEST(MassRule, IncludesTheRotationAboutTheMount) {
  control::BoneMountParams mount;
  mount.inertia_kg_m2 = {0.1, 0.2, 0.3};
  hil::AdmittanceLoopParams rigid;
  rigid.hand = {"operator", 2000.0, 60.0, 1.5};
  rigid.mass_kg = 1.7;
  rigid.damping_Ns_per_m = 30.0;
  const auto mass_kg = [&](const Vector3& site) {
    constexpr double kK = 20e3;
    return rigid.mass_kg / (hil::CheckMass(rigid, kK, mount, site).stiffness_N_per_m / kK - 1.0);
  };
  EXPECT_NEAR(mass_kg(mount.p_WMo_m), 12.0, 1e-10);
  EXPECT_NEAR(mass_kg({0.0, 0.0, 0.08}), 1.0 / (1.0 / 12.0 + 0.0064 / 0.1), 1e-10);
  EXPECT_NEAR(mass_kg({0.08, 0.0, 0.0}), 1.0 / (1.0 / 12.0 + 0.0064 / 0.2), 1e-10);
}

// With a stiff coupling, a light bone violates the rule. The stated least mass must be the boundary between
// keeping and violating it.
TEST(MassRule, StatesTheLeastMassThatKeepsIt) {
  hil::AdmittanceLoopParams rigid;
  rigid.hand = {"operator", 2000.0, 60.0, 1.5};
  rigid.mass_kg = 1.7;
  rigid.damping_Ns_per_m = 30.0;
  control::BoneMountParams mount;
  const Vector3 site(0.0, 0.0, 0.08);
  constexpr double kK = 100e3;
  EXPECT_TRUE(hil::CheckMass(rigid, kK, mount, site).kept);
  mount.mass_kg = 2.0;
  const hil::MassRule rule = hil::CheckMass(rigid, kK, mount, site);
  EXPECT_FALSE(rule.kept);
  EXPECT_NEAR(rule.stiffness_N_per_m, kK * (1.0 + 1.7 * (1.0 / 2.0 + 0.0064 / 0.12)), 1.0);
  rigid.wall.stiffness_N_per_m = 0.999 * rule.stable_up_to_N_per_m;
  EXPECT_LT(hil::AdmittanceLoop(rigid).SpectralRadius(), 1.0);
  rigid.wall.stiffness_N_per_m = 1.003 * rule.stable_up_to_N_per_m;
  EXPECT_GT(hil::AdmittanceLoop(rigid).SpectralRadius(), 1.0);
  ASSERT_GT(rule.min_mass_kg, 2.0);
  mount.mass_kg = 0.99 * rule.min_mass_kg;
  EXPECT_FALSE(hil::CheckMass(rigid, kK, mount, site).kept);
  mount.mass_kg = 1.01 * rule.min_mass_kg;
  EXPECT_TRUE(hil::CheckMass(rigid, kK, mount, site).kept);
  mount.inertia_kg_m2.setConstant(0.005);
  EXPECT_TRUE(std::isinf(hil::CheckMass(rigid, kK, mount, site).min_mass_kg))
      << "it turns away, whatever its mass";
}

// With the mean acceleration and a rigid wall, the loop must equal the shipped AdmittanceLoop.
TEST(CompliantLoop, EqualsTheAdmittanceLoopWithTheMeanAcceleration) {
  for (const double stiffness_N_per_m : {20e3, 80e3}) {
    hil::CompliantLoopParams params = LoopOf(stiffness_N_per_m, 3, 20);
    const double design = hil::CompliantLoop(params).SpectralRadius();
    params.mean_acceleration = true;
    const double mean = hil::CompliantLoop(params).SpectralRadius();
    EXPECT_NE(mean, design);
    hil::AdmittanceLoopParams rigid = params.loop;
    rigid.arm.dead_cycles += 1.0;  // AdmittanceLoop counts the sending tick too
    EXPECT_NEAR(mean, hil::AdmittanceLoop(rigid).SpectralRadius(), 1e-9);
  }
}

TEST(CompliantLoop, EqualsTheRigidLoopWithoutCompliance) {
  hil::CompliantLoopParams params = LoopOf(20e3, 3, 20);
  const double rigid = hil::CompliantLoop(params).SpectralRadius();
  params.link = hil::LoopLink{};
  EXPECT_NEAR(hil::CompliantLoop(params).SpectralRadius(), rigid, 1e-9);
  params.loop.wall.age_ticks = 1;
  EXPECT_THROW(hil::CompliantLoop{params}, std::invalid_argument) << "its planes are evaluated in the tick";
}

}  // namespace
}  // namespace osteon::studies
