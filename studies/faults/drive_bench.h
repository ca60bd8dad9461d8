#pragma once

#include <functional>
#include <memory>

#include "control/ports.h"
#include "hil/can/drive_device.h"
#include "hil/can/memory_can_bus.h"
#include "io/devices/device_clients.h"

namespace osteon::studies {

/// The reamer's drive on its CAN bus as in a cell, in virtual time: io::DeviceClients at one end, the
/// simulated drive at the other. Frames between the two ends can be withheld or forged.
class DriveBench {
 public:
  /// Switches the drive on at `now`.
  /// @throws std::logic_error if the clients refuse the bench's parameters.
  explicit DriveBench(rt::Nanoseconds now);

  /// Runs until `now` in steps of a millisecond, with the same commands.
  control::SpindleReading RunTo(rt::Nanoseconds now, const control::CellCommands& commands);

  /// Inserts a frame that the drive never sent.
  void Forge(const io::CanFrame& frame) { forged_ = {true, frame}; }

  [[nodiscard]] hil::DriveDevice& device() { return device_; }
  [[nodiscard]] io::DeviceClients& clients() { return *clients_; }

  /// Returns whether a frame from the drive reaches the controller; empty: every frame does.
  std::function<bool(const io::CanFrame&)> passes{};

 private:
  /// Exchanges one step's frames at `now_`: the commands to the drive, those answers of the drive that pass,
  /// and a forged frame.
  void Step(const control::CellCommands& commands);

  struct Forged {
    bool waits{false};  ///< the frame is to be sent in the next step
    io::CanFrame frame{};
  };
  rt::Nanoseconds now_{0};
  hil::DriveDevice device_;
  hil::MemoryCanBus controller_end_{now_}, drive_end_{now_};
  std::unique_ptr<io::DeviceClients> clients_;
  std::unique_ptr<io::CanPump> pump_;
  Forged forged_;
};

}  // namespace osteon::studies
