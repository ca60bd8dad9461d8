#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "hil/can/ati_device.h"
#include "hil/can/drive_device.h"
#include "hil/can/robotous_device.h"

namespace osteon::hil {

using SensorDeviceParams = std::variant<RobotousDeviceParams, AtiDeviceParams>;

/// Parameters of the devices on a simulated cell's CAN buses.
struct SimulatedDeviceParams {
  SensorDeviceParams sensor;
  std::optional<DriveDeviceParams> drive;
};

/// The force sensor (ATI or Robotous) and the reamer drive.
class SimulatedDevices {
 public:
  /// @throws std::invalid_argument from the devices' constructors.
  explicit SimulatedDevices(const SimulatedDeviceParams& params);

  /// Sets the load on the sensor's tool side at S, in S, from now on.
  void SetLoad(const Wrench& F_S);

  [[nodiscard]] io::CanClient& sensor();
  /// Null if there is no drive.
  [[nodiscard]] DriveDevice* drive() { return drive_ ? &*drive_ : nullptr; }

 private:
  std::variant<RobotousDevice, AtiDevice> sensor_;
  std::optional<DriveDevice> drive_;
};

}  // namespace osteon::hil
