#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "hil/can/ati_device.h"
#include "hil/can/drive_device.h"
#include "hil/can/robotous_device.h"

namespace osteon::hil {

using SensorDeviceParams = std::variant<RobotousDeviceParams, AtiDeviceParams>;

/// What a simulated cell has on its CAN buses.
struct SimulatedDeviceParams {
  SensorDeviceParams sensor;
  std::optional<DriveDeviceParams> drive;
};

/// Force sensor, of whichever make, and reamer drive.
class SimulatedDevices {
 public:
  /// @throws std::invalid_argument from the devices.
  explicit SimulatedDevices(const SimulatedDeviceParams& params);

  /// On the sensor's tool side at S, in S, from now on.
  void SetLoad(const Wrench& F_S);

  [[nodiscard]] io::CanClient& sensor();
  /// Null where there is none.
  [[nodiscard]] DriveDevice* drive() { return drive_ ? &*drive_ : nullptr; }

 private:
  std::variant<RobotousDevice, AtiDevice> sensor_;
  std::optional<DriveDevice> drive_;
};

}  // namespace osteon::hil
