#include "session/run/virtual_devices.h"

#include <utility>

namespace osteon::session {
namespace {

// The controller's heartbeat count rises by 1 in this time, in virtual time as in wall time.
constexpr rt::Nanoseconds kHeartbeat = 50 * rt::kMillisecond;

}  // namespace

tl::expected<std::unique_ptr<VirtualDevices>, std::string> VirtualDevices::Make(
    const config::CellConfig& cell) {
  auto clients = io::DeviceClients::Make(cell.devices);
  if (!clients) return tl::make_unexpected(clients.error());
  return std::unique_ptr<VirtualDevices>(new VirtualDevices(cell, std::move(*clients)));
}

VirtualDevices::VirtualDevices(const config::CellConfig& cell, std::unique_ptr<io::DeviceClients> clients)
    : clients_(std::move(clients)),
      devices_(cell.simulated_devices),
      plc_faults_(cell.injections, hil::Wire::kPlc, hil::Direction::kBoth) {
  const io::DeviceParams& wires = cell.devices;
  std::vector<io::CanBus*> bus_ends;  // the devices' ends of the buses
  pumps_.reserve(wires.buses.size());
  for (std::size_t i = 0; i < wires.buses.size(); ++i) {
    hil::MemoryCanBus &ours = controller_ends_.emplace_back(now_), &theirs = device_ends_.emplace_back(now_);
    hil::MemoryCanBus::Join(ours, theirs);
    bus_ends.push_back(&theirs);
    clients_->AddToPump(pumps_.emplace_back(ours), i);
  }
  wires_.emplace(bus_ends, devices_, wires, cell.injections, &now_);
  if (!cell.simulated_plc) return;
  logic_.emplace(cell.simulated_plc->logic);
  plc_cycle_ = cell.simulated_plc->cycle_ms * rt::kMillisecond;
}

void VirtualDevices::StartSchedule(rt::Nanoseconds now) {
  wires_->StartSchedule(now);
  plc_faults_.StartSchedule(now);
}

control::CellReadings VirtualDevices::Exchange(const control::CellCommands& commands,
                                               rt::Nanoseconds now) OSTEON_RT {
  now_ = now;
  clients_->Command(commands, now);
  wires_->Pump(now);
  for (io::CanPump& pump : pumps_) pump.Pump(now);
  if (logic_ && now >= plc_due_) StepPlc(commands, now);
  return clients_->Readings(plc_, now);
}

// Runs a cycle of the PLC's program. Then makes the block of registers that the client reads next, and
// applies the faults injected into the PLC's connection.
void VirtualDevices::StepPlc(const control::CellCommands& commands, rt::Nanoseconds now) {
  plc_due_ = now + plc_cycle_;
  const hil::PlcPanel panel = person_.Step(now, logic_->outputs(), 1);
  plc_inputs_.emergency_stop = panel.emergency_stop;
  plc_inputs_.enabling = panel.enabling;
  plc_inputs_.foot_pedal = panel.foot_pedal;
  plc_inputs_.mode = panel.mode;
  plc_inputs_.reset = panel.reset;
  plc_inputs_.brake_test_due = panel.brake_test_due;
  plc_inputs_.controller_heartbeat = static_cast<std::uint16_t>(now / kHeartbeat);
  plc_inputs_.guard_heartbeat = plc_inputs_.controller_heartbeat;  // no guard in virtual time
  plc_inputs_.motion_request = clients_->UpdateMotionRequest(commands, plc_, now);
  const hil::PlcLogicOutputs& outputs = logic_->Step(now, plc_inputs_);

  const hil::WireFaults faults = plc_faults_.At(now);
  if (faults.silence) return;
  plc_.link = faults.loss > 0.0 ? io::PlcLink::kConnecting : io::PlcLink::kConnected;
  plc_.stamp = plc_.heartbeat_changed = now - faults.delay - faults.jitter;
  plc_.inputs = {.mode = static_cast<io::PlcMode>(panel.mode),
                 .brake_test_requested = panel.brake_test_due,
                 .run_permitted = outputs.run_permitted,
                 .version = logic_->params().version,
                 .emergency_stop = outputs.emergency_stop,
                 .enabling = static_cast<io::PlcEnabling>(panel.enabling),
                 .foot_pedal = panel.foot_pedal,
                 .spindle_permitted = outputs.spindle_permitted,
                 .power_on = outputs.power_on,
                 .heartbeat = outputs.heartbeat};
}

}  // namespace osteon::session
