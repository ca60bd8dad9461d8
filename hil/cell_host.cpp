#include "hil/cell_host.h"

#include <stdexcept>
#include <utility>

#include "io/can/can_pump.h"

namespace osteon::hil {

CellHost::CellHost(const CellHostParams& params, SimulatedCell cell)
    : params_(params), devices_(params.devices) {
  for (const io::CanBusParams& bus : params.buses) {
    auto opened = io::UdpCanBus::Open({.bind_port = bus.device_port, .peer_port = bus.port});
    if (!opened) throw std::runtime_error("CAN bus " + bus.name + ", devices: " + opened.error());
    buses_.push_back(std::move(*opened));
  }
  if (params.plc) {
    plc_ = std::make_unique<PlcServer>(*params.plc);
    cell.SetPower(false);  // until the PLC gives it
  }
  arm_ = std::make_unique<SimulatedCellThread>(params.arm, std::move(cell));
  if (plc_) arm_->SetPower(false);
  thread_ = std::thread([this] { RunDevices(); });
}

CellHost::~CellHost() { Stop(); }

void CellHost::Stop() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  arm_->Stop();
  if (plc_) plc_->Stop();
}

CellHostState CellHost::State() {
  CellHostState state;
  state.arm = arm_->statistics();
  if (plc_) {
    state.plc = plc_->outputs();
    state.plc_counters = plc_->counters();
  }
  state.tool_speed_rad_per_s = tool_speed_rad_per_s_.load(std::memory_order_relaxed);
  return state;
}

void CellHost::RunDevices() {
  static_cast<void>(params_.device_priority > 0 && rt::RequestRealtimePriority(params_.device_priority));
  std::vector<io::CanPump> pumps;
  pumps.reserve(buses_.size());
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    io::CanPump& pump = pumps.emplace_back(*buses_[i]);
    if (i == params_.sensor_bus) pump.Add(devices_.sensor());
    if (i == params_.drive_bus && devices_.drive()) pump.Add(*devices_.drive());
  }
  PanelOperator person;
  rt::Nanoseconds due = rt::MonotonicNow();
  while (!stop_.load(std::memory_order_relaxed)) {
    devices_.SetLoad(arm_->Load().F_S);
    const rt::Nanoseconds now = rt::MonotonicNow();
    for (io::CanPump& pump : pumps) pump.Pump(now);
    if (const DriveDevice* drive = devices_.drive())
      tool_speed_rad_per_s_.store(drive->tool_speed_rad_per_s(), std::memory_order_relaxed);
    if (plc_) {
      const PlcLogicOutputs outputs = plc_->outputs();
      plc_->SetPanel(person.Step(now, outputs));
      arm_->SetPower(outputs.power_on);
    }
    due = std::max(due + params_.device_period, now);  // what was slept over is not made up for
    rt::SleepUntil(due);
  }
}

}  // namespace osteon::hil
