#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "io/can/wrench_sensor.h"
#include "tests/hil/can/virtual_can.h"
#include "tests/io/can/can_frames.h"

// A force sensor's client together with the simulated sensor. Each make of sensor uses this in its tests.

namespace osteon::hil {

/// A load as wrench: force [N] and torque [N·m].
inline Wrench Load(double fx, double fy, double fz, double tx, double ty, double tz) {
  return {.f = {fx, fy, fz}, .t = {tx, ty, tz}};
}

/// A client and a simulated force sensor on one bus, in virtual time, with steps of a millisecond.
template <class Device, class DeviceParams, class Sensor, class SensorParams>
struct SensorCell {
  explicit SensorCell(const DeviceParams& device_params = {}, const SensorParams& params = {},
                      const VirtualCanParams& can = {})
      : device(device_params), sensor(io::test::Made<Sensor>(params)), bus(can) {
    bus.Add(sensor);
    bus.Add(device);
  }
  void Run(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) bus.Step(now += io::test::kMs);
  }
  /// Runs until the client has started the sensor or has given up, at most 2 s.
  void Start() {
    for (int i = 0; i < 2000 && sensor.phase() == io::SensorPhase::kStarting; ++i) Run(1);
  }
  /// The client's latest reading.
  [[nodiscard]] Wrench F() const { return sensor.Latest().F_S; }

  /// Changes the loads in all axes, up to 300 N and `torque_Nm`. Expects that the client reads them within
  /// these errors, delayed by one period at most.
  void ExpectLoadsWithin(const Vector3& torque_Nm, double force_error_N, double torque_error_Nm) {
    for (int i = 0; i < 200; ++i) {
      const double a = 0.1 * i;
      const Wrench load =
          Load(200 * std::sin(a), 150 * std::cos(a), -300 * std::sin(2 * a), torque_Nm.x() * std::cos(3 * a),
               torque_Nm.y() * std::sin(a), torque_Nm.z() * std::cos(a));
      device.SetLoad(load);
      Run(1);
      EXPECT_LE((F().f - load.f).cwiseAbs().maxCoeff(), force_error_N);
      EXPECT_LE((F().t - load.t).cwiseAbs().maxCoeff(), torque_error_Nm);
      EXPECT_GT(sensor.Latest().stamp, now - io::test::kMs) << "this period's";
    }
    EXPECT_EQ(sensor.counters().halves, 0u);
  }

  Device device;
  Sensor sensor;
  VirtualCan bus;
  rt::Nanoseconds now{0};
};

}  // namespace osteon::hil
