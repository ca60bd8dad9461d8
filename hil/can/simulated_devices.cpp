#include "hil/can/simulated_devices.h"

namespace osteon::hil {
namespace {

// Makes the sensor of the make that the parameters are for.
struct MakeSensor {
  using Any = std::variant<RobotousDevice, AtiDevice>;
  Any operator()(const RobotousDeviceParams& params) const { return RobotousDevice(params); }
  Any operator()(const AtiDeviceParams& params) const { return AtiDevice(params); }
};

}  // namespace

SimulatedDevices::SimulatedDevices(const SimulatedDeviceParams& params)
    : sensor_(std::visit(MakeSensor{}, params.sensor)) {
  if (params.drive) drive_.emplace(*params.drive);
}

void SimulatedDevices::SetLoad(const Wrench& F_S) {
  std::visit([&](auto& device) { device.SetLoad(F_S); }, sensor_);
}

io::CanClient& SimulatedDevices::sensor() {
  return std::visit([](auto& device) -> io::CanClient& { return device; }, sensor_);
}

}  // namespace osteon::hil
