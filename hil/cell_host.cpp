#include "hil/cell_host.h"

#include <stdexcept>
#include <utility>

#include "hil/plc/plc_injection.h"

namespace osteon::hil {

CellHost::CellHost(const CellHostParams& params, SimulatedCell cell)
    : params_(params), devices_(params.devices) {
  for (const io::CanBusParams& bus : params.wires.buses) {
    auto opened = io::UdpCanBus::Open({.bind_port = bus.device_port, .peer_port = bus.port});
    if (!opened) throw std::runtime_error("CAN bus " + bus.name + ", devices: " + opened.error());
    buses_.push_back(std::move(*opened));
  }
  if (params.plc) {
    plc_ = std::make_unique<PlcServer>(*params.plc);
    cell.SetPower(false);  // the power is off until the PLC switches it on
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
  const Devices& devices = published_.Load();
  state.devices = devices.wires;
  state.tool_speed_rad_per_s = devices.tool_speed_rad_per_s;
  return state;
}

void CellHost::RunDevices() {
  rt::SetUpRealtimeThread(params_.device_thread);
  std::vector<io::CanBus*> ends;
  for (const auto& bus : buses_) ends.push_back(bus.get());
  const InjectionParams& injections = params_.arm.injections;
  DeviceWires wires(ends, devices_, params_.wires, injections);
  std::optional<PlcInjection> plc_wire;
  if (plc_) plc_wire.emplace(*plc_, injections);
  PanelOperator person;
  rt::Nanoseconds due = rt::MonotonicNow();
  while (!stop_.load(std::memory_order_relaxed)) {
    const control::ForceReading load = arm_->Load();
    devices_.SetLoad(load.F_S);
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (arm_->commanded()) {
      wires.StartSchedule(now);
      if (plc_wire) plc_wire->StartSchedule(now);
    }
    wires.Pump(now);
    const DriveDevice* drive = devices_.drive();
    published_.Store(
        {.wires = wires.counters(), .tool_speed_rad_per_s = drive ? drive->tool_speed_rad_per_s() : 0.0});
    if (plc_) {
      plc_wire->Step(now);
      const PlcLogicOutputs outputs = plc_->outputs();
      plc_->SetPanel(person.Step(now, outputs, plc_->counters().connections));
      arm_->SetPower(outputs.power_on);
    }
    due = std::max(due + params_.device_period, now);  // skip missed periods
    rt::SleepUntil(due);
  }
}

}  // namespace osteon::hil
