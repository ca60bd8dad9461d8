#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/latest_value.h"
#include "hil/can/simulated_devices.h"
#include "hil/device_wires.h"
#include "hil/plc/panel_operator.h"
#include "hil/plc/plc_server.h"
#include "hil/simulated_cell_thread.h"
#include "io/can/udp_can_bus.h"
#include "io/devices/device_params.h"

namespace osteon::hil {

struct CellHostParams {
  CellThreadParams arm;    ///< its injections apply to all wires, not only to the arm's
  io::DeviceParams wires;  ///< the controller's parameters; the host opens the devices' ends of the buses and
                           ///< tunnels that they name
  SimulatedDeviceParams devices;
  std::optional<PlcServerParams> plc;
  rt::Nanoseconds device_period{rt::kMillisecond / 2};  ///< interval at which buses and panel are served
  rt::RealtimeThreadParams device_thread{.priority = 75};
};

/// State of the cell, now or at its end. Plain data.
struct CellHostState {
  CellThreadStatistics arm;
  DeviceWireCounters devices;
  PlcLogicOutputs plc;
  PlcServerCounters plc_counters;
  double tool_speed_rad_per_s{0.0};  ///< speed of the tool on the reamer drive
};

/// The whole simulated cell in wall time, with the protocols of the real devices: arm, operator, force
/// sensor, reamer drive, PLC with its panel. It has three threads: arm, devices, PLC server.
class CellHost {
 public:
  /// Starts at once. @throws std::system_error, std::runtime_error or std::invalid_argument naming what could
  /// not be opened or is out of range.
  CellHost(const CellHostParams& params, SimulatedCell cell);
  ~CellHost();
  CellHost(const CellHost&) = delete;
  CellHost& operator=(const CellHost&) = delete;

  /// Returns the present state. Call from one reader thread only. After Stop() the state is final.
  [[nodiscard]] CellHostState State();

  /// Ends all threads and closes all sockets. May be called twice.
  void Stop();

 private:
  void RunDevices();  // the devices' thread

  CellHostParams params_;
  SimulatedDevices devices_;
  std::vector<std::unique_ptr<io::UdpCanBus>> buses_;
  std::unique_ptr<PlcServer> plc_;
  std::unique_ptr<SimulatedCellThread> arm_;
  struct Devices {
    DeviceWireCounters wires;
    double tool_speed_rad_per_s{0.0};
  };
  rt::LatestValue<Devices> published_;  // writer: thread_
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::hil
