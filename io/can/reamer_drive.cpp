#include "io/can/reamer_drive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/can/byte_order.h"

namespace osteon::io {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;
using canopen::Object;

// Objects of CiA 301: index, sub-index, bytes.
constexpr Object kDeviceType{0x1000, 0, 4}, kConsumedHeartbeat{0x1016, 1, 4},
    kProducedHeartbeat{0x1017, 0, 2};
// Objects of CiA 402.
constexpr Object kAbortConnection{0x6007, 0, 2}, kControlword{0x6040, 0, 2}, kStatusword{0x6041, 0, 2},
    kQuickStopOption{0x605A, 0, 2}, kFaultReactionOption{0x605E, 0, 2}, kMode{0x6060, 0, 1},
    kModeShown{0x6061, 0, 1}, kVelocity{0x606C, 0, 4}, kRatedTorque{0x6076, 0, 4}, kTorque{0x6077, 0, 2},
    kErrorCode{0x603F, 0, 2}, kAcceleration{0x6083, 0, 4}, kDeceleration{0x6084, 0, 4},
    kQuickStopDeceleration{0x6085, 0, 4}, kTargetVelocity{0x60FF, 0, 4};

// Values of these objects; the object's index is in the comment.
constexpr std::uint32_t kDriveProfile = 402;   // 1000: low word of a CiA 402 drive's device type
constexpr std::uint32_t kStopAndStay = 6;      // 605A: brake along the quick-stop ramp, then stay in quick
                                               // stop
constexpr std::uint32_t kQuickStopRamp = 2;    // 605E: brake along the quick-stop ramp
constexpr std::uint32_t kFaultOnLoss = 1;      // 6007: a lost connection is a fault
constexpr std::uint32_t kPdoOff = 0x80000000;  // bit in a PDO's identifier (COB-ID) that switches the PDO off
constexpr std::uint32_t kAtSync = 1;           // a PDO's transmission type: every SYNC
// Number of controlwords sent for a fault reset: the first with bit 7 low, the others with bit 7 high.
constexpr int kResetCycles = 12;
constexpr double kRpmPerRadPerS = 60.0 / (2.0 * std::numbers::pi);
// Largest difference between the drive's rated torque and the parameter, as a share of the parameter.
constexpr double kRatedTorqueTolerance = 0.01;
// Pause between the NMT command "pre-operational" and the first SDO.
constexpr rt::Nanoseconds kSettle = 20 * rt::kMillisecond;

// Converts [ns] to [ms], the unit of the drive's objects.
std::uint32_t Milliseconds(rt::Nanoseconds t) { return static_cast<std::uint32_t>(t / rt::kMillisecond); }

}  // namespace

tl::expected<ReamerDrive, std::string> ReamerDrive::Make(const ReamerDriveParams& p) {
  const auto refuse = [](const std::string& text) { return tl::unexpected("Reamer drive: " + text); };
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  if (p.node < 1 || p.node > 127) return refuse(fmt::format("node: found {}, accepted 1 … 127", p.node));
  if (p.master_node < 1 || p.master_node > 127 || p.master_node == p.node)
    return refuse(fmt::format("master_node: found {}, accepted 1 … 127, and not the drive's {}",
                              p.master_node, p.node));
  if (p.mode != 3 && p.mode != 9)
    return refuse(
        fmt::format("mode: found {}, accepted 3 (profile velocity) and 9 (cyclic velocity)", p.mode));
  if (!positive(p.gear_ratio))
    return refuse(fmt::format("gear_ratio: found {}, accepted: more than 0", p.gear_ratio));
  if (!positive(p.rated_torque_Nm))
    return refuse(fmt::format("rated_torque_Nm: found {}, accepted: more than 0 (the motor's data sheet)",
                              p.rated_torque_Nm));
  if (p.direction != 1 && p.direction != -1)
    return refuse(fmt::format("direction: found {}, accepted 1 and -1", p.direction));
  const double largest_rad_per_s = 1e6 / kRpmPerRadPerS / p.gear_ratio;
  if (!positive(p.max_speed_rad_per_s) || p.max_speed_rad_per_s > largest_rad_per_s)
    return refuse(fmt::format(
        "max_speed_rad_per_s: found {}, accepted: more than 0, to {:.0f} (a million rpm of the motor)",
        p.max_speed_rad_per_s, largest_rad_per_s));
  for (const double ramp : {p.acceleration_rad_per_s2, p.quick_stop_rad_per_s2})
    if (!positive(ramp) || ramp * p.gear_ratio * kRpmPerRadPerS > 4e9 ||
        ramp * p.gear_ratio * kRpmPerRadPerS < 1.0)
      return refuse(
          fmt::format("ramp: found {} rad/s² of the tool, accepted: 1 to 4e9 rpm/s of the motor", ramp));
  if (p.cycle < rt::kMillisecond || p.cycle > rt::kSecond)
    return refuse(fmt::format("cycle: found {} ns, accepted 1 ms … 1 s", p.cycle));
  if (p.missed_heartbeats < 1 || p.heartbeat < rt::kMillisecond || p.heartbeat % rt::kMillisecond != 0 ||
      p.heartbeat * p.missed_heartbeats > 60 * rt::kSecond)
    return refuse(fmt::format(
        "heartbeat: found {} ns, {} missed; accepted: whole milliseconds, at least one missed, 60 s in all",
        p.heartbeat, p.missed_heartbeats));
  if (p.missed_cycles < 1 || p.attempts < 1 || p.answer_timeout <= 0)
    return refuse("missed_cycles, attempts and answer_timeout must be positive");
  if (p.temperature.size != 2)
    return refuse(fmt::format("temperature: found an object of {} bytes, accepted 2", p.temperature.size));
  return ReamerDrive(p);
}

ReamerDrive::ReamerDrive(const ReamerDriveParams& p) : params_(p) {
  // adds a set-up step that reads an object and compares the value (see Step::mask)
  const auto read = [this](const Object& object, std::uint32_t value, std::uint32_t mask) {
    steps_.push_back({Step::Kind::kRead, object, value, mask});
  };
  // adds a set-up step that writes an object
  const auto write = [this](const Object& object, std::uint32_t value) {
    steps_.push_back({Step::Kind::kWrite, object, value, 0});
  };
  // adds the steps that map objects into a PDO: switch it off, list its objects, switch it on
  const auto map = [&](std::uint16_t communication, std::uint16_t mapping, std::uint32_t id,
                       std::initializer_list<Object> objects) {
    const Object identifier{communication, 1, 4}, count{mapping, 0, 1};
    write(identifier, id | kPdoOff);
    write(count, 0);
    std::uint8_t sub = 0;
    for (const Object& object : objects) write({mapping, ++sub, 4}, canopen::Mapped(object));
    write(count, sub);
    write({communication, 2, 1}, kAtSync);
    write(identifier, id);
  };
  // [rad/s²] of the tool to [rpm/s] of the motor
  const auto ramp = [&p](double rad_per_s2) {
    return static_cast<std::uint32_t>(std::lround(rad_per_s2 * p.gear_ratio * kRpmPerRadPerS));
  };

  read(kDeviceType, kDriveProfile, 0xFFFF);
  read(kRatedTorque, static_cast<std::uint32_t>(std::lround(1000.0 * p.rated_torque_Nm)), 0);
  write(kProducedHeartbeat, Milliseconds(p.heartbeat));
  write(kConsumedHeartbeat,
        std::uint32_t{p.master_node} << 16 | Milliseconds(p.heartbeat * p.missed_heartbeats));
  write(kAbortConnection, kFaultOnLoss);
  write(kFaultReactionOption, kQuickStopRamp);
  write(kQuickStopOption, kStopAndStay);
  write(kAcceleration, ramp(p.acceleration_rad_per_s2));
  write(kDeceleration, ramp(p.acceleration_rad_per_s2));
  write(kQuickStopDeceleration, ramp(p.quick_stop_rad_per_s2));
  map(0x1400, 0x1600, canopen::kRpdo1 + p.node, {kControlword, kMode, kTargetVelocity});
  map(0x1800, 0x1A00, canopen::kTpdo1 + p.node, {kStatusword, kModeShown, kVelocity});
  map(0x1801, 0x1A01, canopen::kTpdo2 + p.node, {kTorque, kErrorCode, p.temperature});
}

std::vector<CanFilter> Filters(const ReamerDriveParams& params) {
  std::vector<CanFilter> filters;
  for (const int base :
       {canopen::kEmergency, canopen::kTpdo1, canopen::kTpdo2, canopen::kSdoAnswer, canopen::kHeartbeat})
    filters.push_back({.id = static_cast<std::uint16_t>(base + params.node)});
  return filters;
}

void ReamerDrive::Accept(const CanArrival& arrival) OSTEON_RT {
  const CanFrame& frame = arrival.frame;
  if (phase_ == DrivePhase::kFailed) return;
  switch (frame.id - params_.node) {
    case canopen::kSdoAnswer:
      return HandleSdo(frame);
    case canopen::kHeartbeat:
      return HandleHeartbeat(frame, arrival.stamp);
    case canopen::kTpdo1:
    case canopen::kTpdo2:
      if (phase_ == DrivePhase::kReady) HandleStatus(frame, arrival.stamp);
      return;
    case canopen::kEmergency:
      if (frame.size != 8) {
        ++rejected_;
      } else if (const auto code = GetLittle<std::uint16_t>(frame.data.data()); code != 0) {
        status_.emergency_code = code;
        if (phase_ == DrivePhase::kReady) Latch(kDriveEmergency);
      } else if ((status_.faults & kDriveEmergency) == 0) {
        status_.emergency_code = 0;  // "error reset"
      }
      return;
    default:
      return;
  }
}

void ReamerDrive::HandleSdo(const CanFrame& frame) OSTEON_RT {
  const auto answer = canopen::DecodeSdo(frame);
  if (!answer) {
    ++rejected_;
    return;
  }
  if (phase_ != DrivePhase::kStarting || step_ >= steps_.size() || attempts_ == 0) return;
  const Step& step = steps_[step_];
  // answer to an earlier request
  if (answer->index != step.object.index || answer->sub != step.object.sub) return;
  if (answer->kind == canopen::SdoAnswer::Kind::kAbort) return Fail(Failure::kAborted, answer->value);
  if ((step.kind == Step::Kind::kRead) != (answer->kind == canopen::SdoAnswer::Kind::kValue)) return;
  if (step.kind == Step::Kind::kRead) {
    const bool accepted =
        step.mask != 0 ? (answer->value & step.mask) == step.value
                       : std::abs(static_cast<double>(answer->value) - static_cast<double>(step.value)) <=
                             kRatedTorqueTolerance * static_cast<double>(step.value);
    if (!accepted) return Fail(Failure::kValue, answer->value);
  }
  ++step_;
  attempts_ = 0;
  due_ = 0;
}

void ReamerDrive::HandleHeartbeat(const CanFrame& frame, rt::Nanoseconds stamp) OSTEON_RT {
  if (frame.size != 1) {
    ++rejected_;
    return;
  }
  heard_ = stamp;
  const std::uint8_t state = frame.data[0] & 0x7F;
  status_.nmt_state = state;
  const bool operational = state == static_cast<std::uint8_t>(NmtState::kOperational);
  if (phase_ == DrivePhase::kReady) {
    if (operational) return;
    set_up_lost_ = true;
    if (state != static_cast<std::uint8_t>(NmtState::kBootUp)) return Latch(kDriveLeftOperational);
    Latch(kDriveRestarted);
    status_.state = DriveState::kNotReady;  // the state known so far is from before the boot
    status_.speed_rad_per_s = status_.torque_Nm = 0.0;
    was_enabled_ = false;
  } else if (frame.data[0] == static_cast<std::uint8_t>(NmtState::kBootUp)) {
    Restart();  // the boot cleared the configuration
  } else if (step_ > steps_.size() && operational) {
    // the drive has executed the NMT command "start"
    phase_ = DrivePhase::kReady;
    ready_since_ = stamp;
    next_cycle_ = 0;
  }
}

void ReamerDrive::HandleStatus(const CanFrame& frame, rt::Nanoseconds stamp) OSTEON_RT {
  const std::uint8_t* data = frame.data.data();
  if (frame.id == canopen::kTpdo2 + params_.node) {
    if (frame.size != 6) {
      ++rejected_;
      return;
    }
    status_.torque_Nm = params_.direction * GetLittle<std::int16_t>(data) / 1000.0 * params_.rated_torque_Nm *
                        params_.gear_ratio;
    status_.error_code = GetLittle<std::uint16_t>(data + 2);
    status_.temperature = GetLittle<std::int16_t>(data + 4);
    return;
  }
  if (frame.size != 7) {
    ++rejected_;
    return;
  }
  status_.stamp = stamp;
  status_.statusword = GetLittle<std::uint16_t>(data);
  status_.state = StateOf(status_.statusword);
  status_.speed_rad_per_s =
      params_.direction * GetLittle<std::int32_t>(data + 3) / (kRpmPerRadPerS * params_.gear_ratio);

  const bool fault = status_.state == DriveState::kFault || status_.state == DriveState::kFaultReaction;
  if (!fault) reset_cycles_ = 0;  // the reset was successful
  if (fault && reset_cycles_ == 0) Latch(kDriveInFault);
  const bool enabled = status_.state == DriveState::kEnabled;
  if (was_enabled_ && !enabled && command_.goal == DriveGoal::kEnabled && status_.faults == 0)
    Latch(kDriveLeftEnabled);
  was_enabled_ = enabled && command_.goal == DriveGoal::kEnabled;
}

void ReamerDrive::Latch(DriveFault fault) OSTEON_RT { status_.faults |= fault; }

bool ReamerDrive::HeartbeatIsLost(rt::Nanoseconds now) const OSTEON_RT {
  return now - heard_ > params_.heartbeat * params_.missed_heartbeats;
}

bool ReamerDrive::StatusIsLost(rt::Nanoseconds now) const OSTEON_RT {
  return now - std::max(status_.stamp, ready_since_) > params_.cycle * params_.missed_cycles;
}

void ReamerDrive::LatchTimeouts(rt::Nanoseconds now) OSTEON_RT {
  if (HeartbeatIsLost(now)) Latch(kDriveHeartbeatLost);
  if (StatusIsLost(now)) Latch(kDriveStatusLost);
}

bool ReamerDrive::ResetFaults() OSTEON_RT {
  if (command_.goal != DriveGoal::kOff || status_.state == DriveState::kFaultReaction) return false;
  status_.faults = 0;
  status_.emergency_code = 0;
  if (set_up_lost_)
    Restart();
  else if (status_.state == DriveState::kFault)
    reset_cycles_ = kResetCycles;
  return true;
}

void ReamerDrive::Restart() OSTEON_RT {
  phase_ = DrivePhase::kStarting;
  step_ = 0;
  quiet_ = false;
  attempts_ = 0;
  due_ = 0;
  wrong_ = Failure::kNothing;
  was_enabled_ = false;
  set_up_lost_ = false;
  reset_cycles_ = 0;
  sync_due_ = false;
}

void ReamerDrive::Fail(Failure wrong, std::uint32_t found) OSTEON_RT {
  wrong_ = wrong;
  found_ = found;
  phase_ = DrivePhase::kFailed;
}

bool ReamerDrive::Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT {
  // nothing is sent: a drive that still turns stops because it misses the controller's heartbeat
  if (phase_ == DrivePhase::kFailed) return false;
  if (now >= next_heartbeat_) {
    next_heartbeat_ = now + params_.heartbeat;
    frame = canopen::Heartbeat(params_.master_node, NmtState::kOperational);
    return true;
  }
  if (phase_ == DrivePhase::kStarting) return NextSetUpFrame(now, frame);
  LatchTimeouts(now);
  if (sync_due_) {
    sync_due_ = false;
    frame = canopen::Sync();
    return true;
  }
  if (now < next_cycle_) return false;
  // if late by more than a cycle, restart the schedule at `now`: missed cycles are skipped
  next_cycle_ = now - next_cycle_ > params_.cycle ? now + params_.cycle : next_cycle_ + params_.cycle;
  frame = CommandFrame();
  sync_due_ = true;
  return true;
}

bool ReamerDrive::NextSetUpFrame(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT {
  if (now < due_) return false;
  if (!quiet_) {
    quiet_ = true;
    due_ = now + kSettle;
    frame = canopen::Nmt(NmtCommand::kPreOperational, params_.node);
    return true;
  }
  if (attempts_ == params_.attempts) {
    Fail(step_ < steps_.size() ? Failure::kSilent : Failure::kNotStarted, 0);
    return false;
  }
  ++attempts_;
  // all steps are done: send NMT start, and wait until the heartbeat confirms it
  if (step_ >= steps_.size()) {
    step_ = steps_.size() + 1;
    due_ = now + params_.answer_timeout + 2 * params_.heartbeat;
    frame = canopen::Nmt(NmtCommand::kStart, params_.node);
    return true;
  }
  due_ = now + params_.answer_timeout;
  const Step& step = steps_[step_];
  frame = step.kind == Step::Kind::kRead ? canopen::SdoRead(params_.node, step.object)
                                         : canopen::SdoWrite(params_.node, step.object, step.value);
  return true;
}

std::uint16_t ReamerDrive::Controlword() OSTEON_RT {
  if (reset_cycles_ > 0) {
    // Bit 7 is low once so that a rising edge follows, then high until the state changes.
    const bool low = reset_cycles_ == kResetCycles;
    --reset_cycles_;
    return low ? kControlDisableVoltage : kControlFaultReset;
  }
  // while a fault is latched, every goal except kOff is replaced by kQuickStop
  return ControlToward(status_.faults == 0                ? command_.goal
                       : command_.goal == DriveGoal::kOff ? DriveGoal::kOff
                                                          : DriveGoal::kQuickStop,
                       status_.state);
}

CanFrame ReamerDrive::CommandFrame() OSTEON_RT {
  CanFrame frame{.id = static_cast<std::uint16_t>(canopen::kRpdo1 + params_.node), .size = 7};
  const std::uint16_t control = Controlword();
  double speed = 0.0;
  if (control == kControlEnable && std::isfinite(command_.speed_rad_per_s))
    speed = std::clamp(command_.speed_rad_per_s, -params_.max_speed_rad_per_s, params_.max_speed_rad_per_s);
  PutLittle(control, &frame.data[0]);
  PutLittle(params_.mode, &frame.data[2]);
  PutLittle(
      static_cast<std::int32_t>(std::lround(params_.direction * speed * params_.gear_ratio * kRpmPerRadPerS)),
      &frame.data[3]);
  return frame;
}

std::string ReamerDrive::failure() const {
  if (phase_ != DrivePhase::kFailed) return {};
  const std::string place = fmt::format("Reamer drive (node {}): ", params_.node);
  const Step& step = steps_[std::min(step_, steps_.size() - 1)];
  const std::string object = fmt::format("object {:04X}:{:02X}", step.object.index, step.object.sub);
  switch (wrong_) {
    case Failure::kNothing:
      break;
    case Failure::kSilent:
      return place + fmt::format(
                         "no answer about {} in {} attempts; check its supply, the wiring, the bit rate "
                         "(1 Mbit/s) and its node number",
                         object, params_.attempts);
    case Failure::kAborted:
      return place +
             fmt::format("{} {} with 0x{:08X} ({})", object,
                         step.kind == Step::Kind::kRead ? "cannot be read: aborted" : "refused: aborted",
                         found_, canopen::DescribeAbort(found_));
    case Failure::kValue:
      if (step.mask == 0)
        return place +
               fmt::format("its rated torque ({}) is {} mN·m, accepted {} mN·m within 1 % (rated_torque_Nm)",
                           object, found_, step.value);
      return place + fmt::format("its device type ({}) is 0x{:08X}, accepted: profile {}", object, found_,
                                 step.value);
    case Failure::kNotStarted:
      return place + "configured, but its heartbeat never says operational";
  }
  return place + "failed";
}

}  // namespace osteon::io
