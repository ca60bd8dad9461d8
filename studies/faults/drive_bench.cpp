#include "studies/faults/drive_bench.h"

#include <algorithm>
#include <stdexcept>

namespace osteon::studies {
namespace {

// Parameters as a cell's file would state them, for a tool that turns at 26 rad/s (as in FaultRig).
io::DeviceParams BenchDevices() {
  io::DeviceParams devices;
  devices.buses = {{.name = "tool", .interface = "", .port = 1, .device_port = 2}};
  devices.sensor = io::RobotousParams{};
  devices.drive = io::ReamerDriveParams{.gear_ratio = hil::DriveMotorParams{}.gear_ratio,
                                        .rated_torque_Nm = hil::DriveMotorParams{}.rated_torque_Nm,
                                        .max_speed_rad_per_s = 40.0,
                                        .acceleration_rad_per_s2 = 50.0};
  return devices;
}

}  // namespace

DriveBench::DriveBench(rt::Nanoseconds now) : now_(now), device_(hil::DriveDeviceParams{}) {
  auto made = io::DeviceClients::Make(BenchDevices());
  if (!made) throw std::logic_error(made.error());
  clients_ = std::move(*made);
  hil::MemoryCanBus::Join(controller_end_, drive_end_);
  pump_ = std::make_unique<io::CanPump>(controller_end_);
  clients_->AddToPump(*pump_, 0);
}

control::SpindleReading DriveBench::RunTo(rt::Nanoseconds now, const control::CellCommands& commands) {
  while (now_ < now) {
    now_ = std::min(now, now_ + rt::kMillisecond);
    Step(commands);
  }
  return clients_->Readings({}, now_).spindle;
}

void DriveBench::Step(const control::CellCommands& commands) {
  clients_->Command(commands, now_);
  io::CanArrival arrival;
  while (drive_end_.TryReceive(arrival) == io::CanResult::kOk) device_.Accept(arrival);
  io::CanFrame frame;
  while (device_.Next(now_, frame))
    if (!passes || passes(frame)) drive_end_.Send(frame);
  if (forged_.waits) drive_end_.Send(forged_.frame);
  forged_.waits = false;
  pump_->Pump(now_);
}

}  // namespace osteon::studies
