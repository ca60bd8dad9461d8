#include "control/compliance/compliant_link.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

// Tests the massless compliant element. Its deflection relaxes toward force × compliance with a time
// constant. The tests check the energy lost per cycle, the relaxation, and the smallest time constant with
// which the element is stable.

namespace osteon::control {
namespace {

using Scalar1 = Eigen::Matrix<double, 1, 1>;

constexpr double kT_s = 1e-3;

// The element's deflection one tick later, while it relaxes toward `rest`.
double Stepped(double x, double rest, double tau_s) {
  return StepMassless<1>(Scalar1(x), Scalar1(rest), kT_s, tau_s)[0];
}

// Energy [J] lost per cycle of a motion of ±1 mm, measured in the tenth cycle. A spring of 10 N/mm is in
// series with an element of 10 N/mm and a time constant of 0.3 s.
double LossPerCycle_J(double hz) {
  constexpr double kK = 1e4, kTau_s = 0.3;
  double e = 0.0, before_N = 0.0, x_before = 0.0, loss_J = 0.0;
  const int period = static_cast<int>(std::round(1.0 / (hz * kT_s)));
  for (int i = 0; i <= 10 * period; ++i) {
    const double x = 1e-3 * std::sin(2.0 * std::numbers::pi * hz * i * kT_s), f = kK * (x - e);
    if (i > 9 * period) loss_J += 0.5 * (f + before_N) * (x - x_before);
    before_N = f;
    x_before = x;
    e = Stepped(e, f / kK, kTau_s);
  }
  return loss_J;
}

TEST(CompliantLink, LosesTheEnergyOfTheClosedFormPerCycle) {
  EXPECT_NEAR(1e3 * LossPerCycle_J(0.5), 6.077, 0.01 * 6.077);
  EXPECT_NEAR(1e3 * LossPerCycle_J(2.0), 6.525, 0.01 * 6.525);
  // closed form of the loss: pi X² K' w tau / (1 + (w tau)²), with the amplitude X = 1 mm, the angular
  // frequency w, and stiffness K' = 5 N/mm and time constant tau of the series
  for (const double hz : {0.5, 2.0}) {
    // time constant of the series: 0.3 s / (1 + K / k)
    const double w = 2.0 * std::numbers::pi * hz, tau = 0.15;
    const double exact = std::numbers::pi * 1e-6 * 0.5e4 * w * tau / (1.0 + w * w * tau * tau);
    EXPECT_NEAR(LossPerCycle_J(hz), exact, 0.01 * exact) << hz;
  }
}

TEST(CompliantLink, RelaxesWithItsTimeConstant) {
  double x = 0.0;
  for (int i = 0; i < 200; ++i) x = Stepped(x, 1.0, 0.2);
  EXPECT_NEAR(x, 1.0 - std::exp(-1.0), 2e-3);
}

// The tool is held still; a spring K is in series with an element of compliance C. If the element's time
// constant is below the smallest one, T (K C - 1) / 2 with the period T, the deflection grows from tick to
// tick with alternating sign.
TEST(CompliantLink, AHeldToolIsStableAboveTheSmallestTimeConstant) {
  constexpr double kK = 80e3, kC = 1.0 / 8720.0;
  const double min_tau_s = 0.5 * kT_s * (kK * kC - 1.0);
  EXPECT_NEAR(1e3 * min_tau_s, 4.087, 1e-3);
  for (const double factor : {0.99, 1.01}) {
    double e = 1e-4;
    for (int i = 0; i < 2000; ++i) e = Stepped(e, -kK * e * kC, factor * min_tau_s);
    EXPECT_EQ(std::abs(e) < 1e-4, factor > 1.0) << factor;
  }
}

TEST(CompliantLink, RefusesAComplianceThatIsNotSymmetricAndPositive) {
  ToolLinkParams params;
  params.compliance_T.setIdentity();
  EXPECT_NO_THROW(Validate(params));
  params.compliance_T(0, 1) = 0.5;
  EXPECT_THROW(Validate(params), std::invalid_argument) << "not symmetric";
  params.compliance_T(1, 0) = 0.5;
  EXPECT_NO_THROW(Validate(params));
  params.compliance_T(0, 1) = params.compliance_T(1, 0) = 2.0;
  EXPECT_THROW(Validate(params), std::invalid_argument) << "a negative eigenvalue";
  params.compliance_T.setIdentity();
  params.tau_s = 0.0;
  EXPECT_THROW(Validate(params), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
