#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/ports.h"
#include "io/devices/device_params.h"
#include "io/devices/drive_reset.h"

namespace osteon::io {

/// Force sensor and reamer drive as the loop wants them, and what it asks of the PLC: all of it but the
/// wires. Wall time puts it on buses (WiredDevices), virtual time hands frames over in memory. One thread at
/// a time; nothing allocates once made.
class DeviceClients {
 public:
  /// The error names the device, the parameter, the value found and what is accepted.
  [[nodiscard]] static tl::expected<std::unique_ptr<DeviceClients>, std::string> Make(
      const DeviceParams& params);

  /// Adds those of a bus (in DeviceParams::buses) to the pump of its end.
  void PutOn(CanPump& pump, std::size_t bus);

  /// To the drive: turning as told; ramped down and then off with speed 0. One with a fault is reset where
  /// the command allows it, DriveReset::kAttempts times at most. A device that never answered is begun anew
  /// each second: it may be switched on later than the controller.
  void Command(const control::CellCommands& commands, rt::Nanoseconds now) OSTEON_RT;

  /// MOTION_REQUEST for the PLC. A request that is not granted within .4 s is withdrawn for a moment and
  /// made anew: a PLC that was reset meanwhile wants to see it made.
  [[nodiscard]] bool MotionRequest(const control::CellCommands& commands, const PlcReading& plc,
                                   rt::Nanoseconds now) OSTEON_RT;

  [[nodiscard]] control::CellReadings Readings(const PlcReading& plc, rt::Nanoseconds now) const OSTEON_RT;

  /// What keeps the cell from moving, in a sentence for each device; empty where nothing does. For screens
  /// and logs: allocates.
  [[nodiscard]] std::string Diagnosis(const PlcReading& plc, rt::Nanoseconds now) const;

 private:
  DeviceClients(const DeviceParams& params, std::unique_ptr<WrenchSensor> sensor)
      : params_(params), sensor_(std::move(sensor)) {}

  /// One that has been silent for a second is to be begun anew.
  class Silence {
   public:
    [[nodiscard]] bool Lasts(bool silent, rt::Nanoseconds now) OSTEON_RT;
    [[nodiscard]] int times() const { return times_; }

   private:
    rt::Nanoseconds since_{-1};
    int times_{0};
  };

  DeviceParams params_;
  std::unique_ptr<WrenchSensor> sensor_;
  std::optional<ReamerDrive> drive_;
  Silence sensor_silence_, drive_silence_;
  DriveReset drive_reset_;
  bool was_wanted_{false};
  rt::Nanoseconds asked_since_{0};
};

}  // namespace osteon::io
