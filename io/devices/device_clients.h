#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/ports.h"
#include "io/devices/device_params.h"
#include "io/devices/drive_reset.h"

namespace osteon::io {

/// The loop's clients of force sensor and reamer drive, and its motion request to the PLC, without the
/// connections. In wall time WiredDevices connects the clients to buses; in virtual time frames are passed in
/// memory. One thread at a time; no allocation after construction.
class DeviceClients {
 public:
  /// The error names the device, the parameter, the value found and what is accepted.
  [[nodiscard]] static tl::expected<std::unique_ptr<DeviceClients>, std::string> Make(
      const DeviceParams& params);

  /// Adds the clients of a bus's devices to the bus's pump. @param bus  index in DeviceParams::buses
  void AddToPump(CanPump& pump, std::size_t bus);

  /// Commands a speed or a quick stop to the drive. At speed 0 the drive ramps down and is then switched off.
  /// If the commands allow it, a drive with a fault is reset, at most DriveReset::kAttempts times. A device
  /// that has never answered is set up again each second, because it may be switched on later than the
  /// controller.
  void Command(const control::CellCommands& commands, rt::Nanoseconds now) OSTEON_RT;

  /// Returns MOTION_REQUEST for the PLC. Call once per tick. A request that is not granted within 0.4 s is
  /// withdrawn for 0.15 s and made again, because a PLC that was reset in the meantime needs a new request.
  [[nodiscard]] bool UpdateMotionRequest(const control::CellCommands& commands, const PlcReading& plc,
                                         rt::Nanoseconds now) OSTEON_RT;

  [[nodiscard]] control::CellReadings Readings(const PlcReading& plc, rt::Nanoseconds now) const OSTEON_RT;

  /// Returns what prevents the cell from moving, one sentence for each device; empty if nothing does. For
  /// screens and logs: allocates.
  [[nodiscard]] std::string Diagnosis(const PlcReading& plc, rt::Nanoseconds now) const;

 private:
  DeviceClients(const DeviceParams& params, std::unique_ptr<WrenchSensor> sensor)
      : params_(params), sensor_(std::move(sensor)) {}

  /// Determines when a device that has failed without any answer is set up again: after each second of
  /// silence.
  class SilenceTimer {
   public:
    /// Call once per tick. Returns true once after each second during which `silent` was true.
    [[nodiscard]] bool HasExpired(bool silent, rt::Nanoseconds now) OSTEON_RT;
    [[nodiscard]] int expired_count() const { return expired_count_; }

   private:
    rt::Nanoseconds since_{-1};  // beginning of the silence; negative: the device is not silent
    int expired_count_{0};
  };

  DeviceParams params_;
  std::unique_ptr<WrenchSensor> sensor_;
  std::optional<ReamerDrive> drive_;
  SilenceTimer sensor_silence_, drive_silence_;
  bool quick_stops_{false};  // a quick stop is in progress: the drive still turns
  DriveReset drive_reset_;
  // motion request: whether the loop made it in the last tick, and the time since which it waits for the
  // PLC's grant
  bool was_requested_{false};
  rt::Nanoseconds asked_since_{0};
};

}  // namespace osteon::io
