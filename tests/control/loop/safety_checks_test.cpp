#include "control/loop/safety_checks.h"

#include <limits>

#include <gtest/gtest.h>

// Tests the checks of devices, hand force and coupling that may raise faults.

namespace osteon::control {
namespace {

using safety::Fault;

constexpr rt::Nanoseconds kNow = 10 * rt::kSecond;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

ServoParams WithDevices() {
  ServoParams params;
  params.has_spindle = params.has_interlock = true;
  return params;
}

// Fresh readings of all devices. No device reports a fault.
CellReadings GoodReadings() {
  CellReadings readings;
  readings.force.stamp = kNow;
  readings.spindle = {.stamp = kNow, .ready = true};
  readings.interlock = {.stamp = kNow, .permitted = true, .enabled = true, .spindle_permitted = true};
  return readings;
}

// The checks of a loop that has rendered for a long time, so that every device must have reported.
SafetyChecks Checks(const ServoParams& params) {
  SafetyChecks checks(params, 200.0);
  checks.OnRenderingStarted(0);
  return checks;
}

TEST(SafetyChecks, GoodReadingsGiveNoFault) {
  const ServoParams params = WithDevices();
  SafetyChecks checks = Checks(params);
  EXPECT_EQ(checks.CheckDevices(GoodReadings(), {}, kNow).bits(), 0u);
  EXPECT_TRUE(checks.IsMotionPermitted(GoodReadings().interlock, kNow));
  EXPECT_TRUE(checks.IsSensorReady(GoodReadings().force, kNow));
  EXPECT_TRUE(checks.IsSpindleReady(GoodReadings().spindle, kNow));
}

TEST(SafetyChecks, EachDefectOfADeviceGivesItsFault) {
  const ServoParams params = WithDevices();
  const auto faults = [&](auto&& change, InputAges ages = {}) {
    SafetyChecks checks = Checks(params);
    CellReadings readings = GoodReadings();
    change(readings);
    return checks.CheckDevices(readings, ages, kNow).bits();
  };
  const auto bits_of = [](Fault fault) { return static_cast<std::uint32_t>(fault); };
  EXPECT_EQ(faults([](CellReadings& r) { r.interlock.permitted = false; }), bits_of(Fault::kInterlock));
  EXPECT_EQ(faults([](CellReadings& r) { r.interlock.enabled = false; }), bits_of(Fault::kInterlock));
  EXPECT_EQ(faults([](CellReadings& r) { r.interlock.stamp -= rt::kSecond; }), bits_of(Fault::kInterlock));
  EXPECT_EQ(faults([](CellReadings& r) { r.spindle.ready = false; }), bits_of(Fault::kSpindle));
  EXPECT_EQ(faults([](CellReadings& r) { r.spindle.fault = true; }), bits_of(Fault::kSpindle));
  EXPECT_EQ(faults([](CellReadings& r) { r.spindle.stamp -= rt::kSecond; }), bits_of(Fault::kSpindle));
  EXPECT_EQ(faults([](CellReadings& r) { r.force.trusted = false; }), bits_of(Fault::kSensorFault));
  EXPECT_EQ(faults([](CellReadings&) {}, {.sensor_s = 0.2}), bits_of(Fault::kSensorStale));
  EXPECT_EQ(faults([](CellReadings&) {}, {.model_s = 0.3}), bits_of(Fault::kModelStale));
}

TEST(SafetyChecks, ACellWithoutSpindleAndPlcNeedsNoReadingsOfThem) {
  const ServoParams params;
  SafetyChecks checks = Checks(params);
  CellReadings readings;
  readings.force.stamp = kNow;
  EXPECT_EQ(checks.CheckDevices(readings, {}, kNow).bits(), 0u);
  EXPECT_TRUE(checks.IsMotionPermitted({}, kNow));
  EXPECT_TRUE(checks.IsSpindleReady({}, kNow));
}

TEST(SafetyChecks, AHandForceAboveTheLimitForSomeTicksIsAFault) {
  const ServoParams params;
  SafetyChecks checks = Checks(params);
  const Wrench hard{.f = Vector3(checks.max_hand_N() + 1.0, 0.0, 0.0), .t = Vector3::Zero()};
  for (int i = 1; i < params.sensor_force.ticks; ++i) EXPECT_FALSE(checks.CheckHand(hard).Any()) << i;
  EXPECT_TRUE(checks.CheckHand(hard).Has(Fault::kSensorForce));
  EXPECT_DOUBLE_EQ(checks.hand_N(), checks.max_hand_N() + 1.0);
  EXPECT_TRUE(checks.CheckHand({.f = Vector3(kNaN, 0.0, 0.0), .t = Vector3::Zero()}).Has(Fault::kNotFinite));
  EXPECT_DOUBLE_EQ(checks.hand_N(), checks.max_hand_N() + 1.0) << "a force that is not known is none";
}

TEST(SafetyChecks, AJumpOfTheWrenchOrABadModelIsAFault) {
  const ServoParams params;
  SafetyChecks checks = Checks(params);
  CouplingOutput coupling;
  coupling.status = ModelStatus::kOk;
  coupling.F_T_W.f = Vector3(0.9 * checks.max_wrench_growth_N(1e-3), 0.0, 0.0);
  EXPECT_FALSE(checks.CheckCoupling(coupling, 1e-3).Any());
  coupling.F_T_W.f = Vector3(-1.2 * checks.max_wrench_growth_N(1e-3), 0.0, 0.0);
  EXPECT_TRUE(checks.CheckCoupling(coupling, 1e-3).Has(Fault::kWrenchRate)) << "it has turned round";
  coupling = {};
  coupling.status = ModelStatus::kDeviceLost;
  EXPECT_TRUE(checks.CheckCoupling(coupling, 1e-3).Has(Fault::kDevice));
  coupling.status = ModelStatus::kNotCredible;
  EXPECT_TRUE(checks.CheckCoupling(coupling, 1e-3).Has(Fault::kNotFinite));
}

}  // namespace
}  // namespace osteon::control
