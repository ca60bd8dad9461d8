#include "io/devices/device_clients.h"

#include <cmath>

#include <fmt/format.h>

#include "io/can/drive_fault_text.h"
#include "io/can/id_claims.h"

namespace osteon::io {
namespace {

// If the PLC has not granted a motion request after this time, the request is withdrawn and then made again.
constexpr rt::Nanoseconds kGrantTimeout = 400 * rt::kMillisecond;
// Duration of the withdrawal. It is longer than the 100 ms within which the PLC client writes the request
// with its heartbeat.
constexpr rt::Nanoseconds kWithdrawal = 150 * rt::kMillisecond;
// A device that has been silent for this long is set up again.
constexpr rt::Nanoseconds kSilenceBeforeRetry = rt::kSecond;
// below this speed the spindle counts as stopped and may be switched off
constexpr double kStandstill_rad_per_s = 0.5;

// Makes one manufacturer's sensor and returns it as WrenchSensor.
template <class Sensor, class Params>
tl::expected<std::unique_ptr<WrenchSensor>, std::string> MakeSensorOf(const Params& params) {
  auto made = Sensor::Make(params);
  if (!made) return tl::make_unexpected(made.error());
  return std::make_unique<Sensor>(std::move(*made));
}

// Visitor of WrenchSensorParams: makes the sensor of the manufacturer that the parameters are for.
struct SensorMaker {
  auto operator()(const RobotousParams& params) const { return MakeSensorOf<RobotousSensor>(params); }
  auto operator()(const AtiParams& params) const { return MakeSensorOf<AtiSensor>(params); }
};

// Returns a sentence that names the drive's faults and says what to do. @param resets number of resets
// attempted so far
std::string DriveFaultText(const DriveStatus& status, bool heard, int resets) {
  return fmt::format(
      "reamer drive: {}: {}; {}", Describe(status.state),
      DescribeDriveFaults({status.faults, status.nmt_state, status.emergency_code, status.error_code}),
      !heard        ? "check its supply and the wiring"
      : resets == 0 ? "it is reset before the first motion and in a recovery, never in between"
      : resets < DriveReset::kAttempts
          ? fmt::format("reset {} of {}", resets, DriveReset::kAttempts)
          : fmt::format("{} resets have not cleared it: see to its cause, begin a new run", resets));
}

}  // namespace

std::optional<std::string> FindOverlap(const DeviceParams& params) {
  for (std::size_t bus = 0; bus < params.buses.size(); ++bus) {
    std::vector<IdClaim> claims;
    const auto add = [&](const std::vector<IdClaim>& more) {
      claims.insert(claims.end(), more.begin(), more.end());
    };
    if (params.sensor_bus == bus) add(std::visit([](const auto& p) { return Claims(p); }, params.sensor));
    if (params.drive && params.drive_bus == bus) add(Claims(*params.drive));
    if (auto overlap = FindOverlap(claims)) return overlap;
  }
  return {};
}

tl::expected<std::unique_ptr<DeviceClients>, std::string> DeviceClients::Make(const DeviceParams& params) {
  if (auto overlap = FindOverlap(params)) return tl::make_unexpected(*overlap);
  auto sensor = std::visit(SensorMaker{}, params.sensor);
  if (!sensor) return tl::make_unexpected(sensor.error());
  std::unique_ptr<DeviceClients> clients(new DeviceClients(params, std::move(*sensor)));
  if (params.drive) {
    auto drive = ReamerDrive::Make(*params.drive);
    if (!drive) return tl::make_unexpected(drive.error());
    clients->drive_ = std::move(*drive);
  }
  return clients;
}

void DeviceClients::AddToPump(CanPump& pump, std::size_t bus) {
  if (bus == params_.sensor_bus) pump.Add(*sensor_);
  if (drive_ && bus == params_.drive_bus) pump.Add(*drive_);
}

bool DeviceClients::SilenceTimer::HasExpired(bool silent, rt::Nanoseconds now) OSTEON_RT {
  if (!silent) since_ = -1;
  if (silent && since_ < 0) since_ = now;
  if (!silent || now - since_ < kSilenceBeforeRetry) return false;
  since_ = -1;
  ++expired_count_;
  return true;
}

void DeviceClients::Command(const control::CellCommands& commands, rt::Nanoseconds now) OSTEON_RT {
  if (sensor_silence_.HasExpired(sensor_->silent(), now)) sensor_->Restart();
  if (!drive_) return;
  if (drive_silence_.HasExpired(drive_->silent(), now)) drive_->Restart();
  const bool turns = std::abs(drive_->status().speed_rad_per_s) > kStandstill_rad_per_s;
  // A quick stop continues until standstill, even if it is no longer commanded: a loop may recover within
  // milliseconds.
  quick_stops_ = commands.quick_stop || (quick_stops_ && turns);
  DriveCommand command;
  if (quick_stops_)
    command.goal = DriveGoal::kQuickStop;
  else if (commands.spindle_rad_per_s != 0.0 || turns)
    command = {DriveGoal::kEnabled, commands.spindle_rad_per_s};
  drive_->Command(command);
  const bool faulty =
      drive_->phase() == DrivePhase::kReady && drive_->status().faults != 0 && drive_->IsHeard(now);
  if (drive_reset_.IsDue(commands.clear_faults, faulty, now) && drive_->ResetFaults())
    drive_reset_.Count(now);
}

bool DeviceClients::UpdateMotionRequest(const control::CellCommands& commands, const PlcReading& plc,
                                        rt::Nanoseconds now) OSTEON_RT {
  if (commands.motion_requested && !was_requested_) asked_since_ = now;
  was_requested_ = commands.motion_requested;
  if (!was_requested_) return false;
  // while the request is granted, the waiting time stays 0
  if (plc.inputs.run_permitted) asked_since_ = now;
  const rt::Nanoseconds waited = now - asked_since_;
  if (waited > kGrantTimeout + kWithdrawal) asked_since_ = now;  // the withdrawal is over: request again
  return waited <= kGrantTimeout;
}

control::CellReadings DeviceClients::Readings(const PlcReading& plc, rt::Nanoseconds now) const OSTEON_RT {
  control::CellReadings readings;
  const SensorReading& load = sensor_->Latest();
  readings.force = {
      .stamp = load.stamp, .F_S = load.F_S, .trusted = (load.flags & (kSensorOverload | kSensorFault)) == 0};
  if (drive_) {
    const DriveStatus& status = drive_->status();
    readings.spindle = {.stamp = status.stamp,
                        .speed_rad_per_s = status.speed_rad_per_s,
                        .torque_Nm = status.torque_Nm,
                        .ready = drive_->phase() == DrivePhase::kReady,
                        .fault = drive_->faulty(),
                        .faults = static_cast<std::uint8_t>(status.faults),
                        .nmt_state = status.nmt_state,
                        .emergency_code = status.emergency_code,
                        .error_code = status.error_code};
  }
  if (params_.plc) {
    const PlcVerdict verdict = Judge(plc, now, params_.plc_max_age);
    const bool permitted = verdict == PlcVerdict::kRun;
    readings.interlock = {.stamp = plc.stamp,
                          .permitted = permitted,
                          .enabled = plc.inputs.enabling == PlcEnabling::kEnabled,
                          .spindle_permitted = permitted && plc.inputs.spindle_permitted,
                          .reason = static_cast<std::uint8_t>(verdict)};
  }
  return readings;
}

std::string DeviceClients::Diagnosis(const PlcReading& plc, rt::Nanoseconds now) const {
  std::string text;
  const auto append_sentence = [&text](const std::string& more) {
    text += (text.empty() ? "" : "; ") + more;
  };
  if (sensor_->phase() == SensorPhase::kFailed)
    append_sentence("force sensor: " + sensor_->failure());
  else if (sensor_->phase() == SensorPhase::kStarting)
    append_sentence(sensor_silence_.expired_count() == 0
                        ? "force sensor: no reading yet"
                        : "force sensor: no answer so far; check its supply, the wiring, the bit rate");
  else if ((sensor_->Latest().flags & (kSensorOverload | kSensorFault)) != 0)
    append_sentence("force sensor: overloaded or faulty");
  if (drive_ && drive_->phase() == DrivePhase::kFailed)
    append_sentence("reamer drive: " + drive_->failure());
  else if (drive_ && drive_->phase() == DrivePhase::kStarting)
    append_sentence(drive_silence_.expired_count() == 0
                        ? "reamer drive: not configured yet"
                        : "reamer drive: no answer so far; check its supply, the wiring, the bit rate");
  else if (drive_ && drive_->status().faults != 0)
    append_sentence(DriveFaultText(drive_->status(), drive_->IsHeard(now), drive_reset_.attempts()));
  if (params_.plc) {
    const PlcVerdict verdict = Judge(plc, now, params_.plc_max_age);
    if (verdict != PlcVerdict::kRun)
      append_sentence(Describe(*params_.plc, plc) + ", " + Describe(verdict));
    else if (plc.inputs.enabling != PlcEnabling::kEnabled)
      append_sentence(Describe(*params_.plc, plc) +
                      ", ENABLING_SWITCH (979) is not in its middle position: hold it; "
                      "squeezed through, let it go first");
  }
  return text;
}

}  // namespace osteon::io
