#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/ports.h"
#include "io/devices/device_params.h"
#include "io/devices/drive_reset.h"

namespace osteon::io {

/// Force sensor and reamer drive as the loop sees them, and its request to the PLC, without the connections.
/// In wall time WiredDevices connects them to buses; in virtual time frames are passed in memory. One thread
/// at a time; no allocation after construction.
class DeviceClients {
 public:
  /// The error names the device, the parameter, the value found and what is accepted.
  [[nodiscard]] static tl::expected<std::unique_ptr<DeviceClients>, std::string> Make(
      const DeviceParams& params);

  /// Adds the devices of a bus to the pump that moves its frames. @param bus  index in DeviceParams::buses
  void AddToPump(CanPump& pump, std::size_t bus);

  /// Commands the speed, or a quick stop, to the drive; at speed 0 it ramps down, then is off. A drive with
  /// a fault is reset if the command allows it, at most DriveReset::kAttempts times. A device that never
  /// answered is set up again each second: it may be switched on later than the controller.
  void Command(const control::CellCommands& commands, rt::Nanoseconds now) OSTEON_RT;

  /// Returns MOTION_REQUEST for the PLC. Call once per tick. A request that is not granted within 0.4 s is
  /// withdrawn for a moment and made again, because a PLC that was reset meanwhile needs a new request.
  [[nodiscard]] bool UpdateMotionRequest(const control::CellCommands& commands, const PlcReading& plc,
                                         rt::Nanoseconds now) OSTEON_RT;

  [[nodiscard]] control::CellReadings Readings(const PlcReading& plc, rt::Nanoseconds now) const OSTEON_RT;

  /// Says what keeps the cell from moving, one sentence for each device; empty if nothing does. For screens
  /// and logs: allocates.
  [[nodiscard]] std::string Diagnosis(const PlcReading& plc, rt::Nanoseconds now) const;

 private:
  DeviceClients(const DeviceParams& params, std::unique_ptr<WrenchSensor> sensor)
      : params_(params), sensor_(std::move(sensor)) {}

  /// Tells when a device that has failed without any answer is set up again: after each second of silence.
  class SilenceTimer {
   public:
    /// Call once a tick. True once after each second in which `silent` was true.
    [[nodiscard]] bool HasExpired(bool silent, rt::Nanoseconds now) OSTEON_RT;
    [[nodiscard]] int expired_count() const { return expired_count_; }

   private:
    rt::Nanoseconds since_{-1};  // beginning of the silence; negative: none
    int expired_count_{0};
  };

  DeviceParams params_;
  std::unique_ptr<WrenchSensor> sensor_;
  std::optional<ReamerDrive> drive_;
  SilenceTimer sensor_silence_, drive_silence_;
  bool quick_stops_{false};  // the drive brakes, and still turns
  DriveReset drive_reset_;
  // the motion request: whether the loop wanted it in the last tick, and since when it waits for the PLC's
  // grant
  bool was_requested_{false};
  rt::Nanoseconds asked_since_{0};
};

}  // namespace osteon::io
