#include "control/loop/gain_requests.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_bench.h"

// Tests gain requests. Another thread makes a request, and a tick of the loop takes it over.

namespace osteon::control {
namespace {

constexpr double kPeriod_s = 1e-3;

// The gains of the bench's loop.
Gains Own() { return GainsOf(ServoBench::Params().admittance, ServoBench::Params().coupling); }

TEST(GainRequests, ATickTakesTheLastRequestOnceAndRampsTheGains) {
  GainRequests requests(Own(), kPeriod_s);
  Gains softer = Own(), softest = Own();
  softer.max_stiffness_N_per_m = 15e3;
  softest.max_stiffness_N_per_m = 10e3;
  requests.Request(softer);
  requests.Request(softest);
  TickInput input, later;
  bool changed = false;
  {
    const rt::CheckedNoAllocScope scope;
    changed = requests.Step(false, input);
  }
  EXPECT_TRUE(changed);
  EXPECT_TRUE(input.has_gains);
  EXPECT_EQ(input.gains.max_stiffness_N_per_m, 10e3);
  EXPECT_LT(requests.gains().max_stiffness_N_per_m, 20e3);
  EXPECT_GT(requests.gains().max_stiffness_N_per_m, 10e3) << "on a ramp";
  for (int i = 0; i < 1100; ++i) changed = requests.Step(false, later);
  EXPECT_FALSE(changed);
  EXPECT_FALSE(later.has_gains);
  EXPECT_EQ(requests.gains().max_stiffness_N_per_m, 10e3);
}

TEST(GainRequests, RefusesAStiffnessAboveTheInitialOne) {
  GainRequests requests(Own(), kPeriod_s);
  Gains stiffer = Own();
  stiffer.max_stiffness_N_per_m *= 1.01;
  EXPECT_THROW(requests.Request(stiffer), std::invalid_argument);
  TickInput input;
  EXPECT_FALSE(requests.Step(false, input));
  EXPECT_FALSE(input.has_gains);
}

}  // namespace
}  // namespace osteon::control
