#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "control/ports.h"
#include "hil/can/memory_can_bus.h"
#include "hil/can/simulated_devices.h"
#include "hil/device_wires.h"
#include "hil/injection/fault_schedule.h"
#include "hil/plc/panel_operator.h"
#include "io/devices/device_clients.h"

namespace osteon::session {

/// The cell's devices in virtual time, on both sides of each connection. Clients and simulated devices are
/// the same as in wall time. CAN frames are passed in memory. The PLC's program runs without Modbus: its
/// register block is passed already decoded. A cell's injections act as in wall time. On the PLC's
/// connection, a silence keeps the last block, a loss ends the connection, and a delay makes the block older
/// by the delay plus the whole jitter.
class VirtualDevices final : public control::CellDevices {
 public:
  /// The error comes from a client; see DeviceClients.
  [[nodiscard]] static tl::expected<std::unique_ptr<VirtualDevices>, std::string> Make(
      const config::CellConfig& cell);

  /// Starts the injections, whose times count from `now`: the first tick of COMMANDING_ACTIVE. Later calls
  /// have no effect.
  void StartSchedule(rt::Nanoseconds now);

  /// Sets the load on the force sensor from now on, in the sensor's frame S.
  void SetLoad(const Wrench& F_S) { devices_.SetLoad(F_S); }
  /// Whether the PLC has the drives' power on; always on without a PLC.
  [[nodiscard]] bool power() const { return !logic_ || logic_->outputs().power_on; }

  [[nodiscard]] control::CellReadings Exchange(const control::CellCommands& commands,
                                               rt::Nanoseconds now) OSTEON_RT override;

  [[nodiscard]] hil::DeviceWireCounters counters() const { return wires_->counters(); }
  /// The PLC's decisions; nothing without a PLC.
  [[nodiscard]] hil::PlcLogicOutputs plc() const {
    return logic_ ? logic_->outputs() : hil::PlcLogicOutputs{};
  }
  [[nodiscard]] double tool_speed_rad_per_s() {
    return devices_.drive() ? devices_.drive()->tool_speed_rad_per_s() : 0.0;
  }

  /// Says which devices prevent a motion of the cell.
  [[nodiscard]] std::string Diagnosis() const { return clients_->Diagnosis(plc_, now_); }

 private:
  VirtualDevices(const config::CellConfig& cell, std::unique_ptr<io::DeviceClients> clients);
  // Runs a cycle of the PLC.
  void StepPlc(const control::CellCommands& commands, rt::Nanoseconds now);

  std::unique_ptr<io::DeviceClients> clients_;
  hil::SimulatedDevices devices_;
  rt::Nanoseconds now_{0};
  std::deque<hil::MemoryCanBus> controller_ends_, device_ends_;
  std::vector<io::CanPump> pumps_;  // pumps of the controller's ends of the buses
  std::optional<hil::DeviceWires> wires_;
  hil::FaultSchedule plc_faults_;
  std::optional<hil::PlcLogic> logic_;
  rt::Nanoseconds plc_cycle_{0}, plc_due_{0};
  hil::PanelOperator person_;  // operates the PLC's panel
  hil::PlcLogicInputs plc_inputs_;
  io::PlcReading plc_;  // the newest block of the PLC that the client has read
};

}  // namespace osteon::session
