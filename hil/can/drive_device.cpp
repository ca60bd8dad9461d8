#include "hil/can/drive_device.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "base/units.h"

namespace osteon::hil {
namespace {

constexpr int kPreOperational = 127, kOperational = 5, kStopped = 4;  // NMT states, as in a heartbeat
constexpr int kBlocked = 0x7121, kHeartbeatError = 0x8130;            // error codes of CiA 402 and CiA 301
constexpr int kGenericError = 0x01;  // bit 0 of the error register, which every device has
constexpr double kStep_s = 1e-4;     // integration step of the motor
// Longest time by which one call advances the motor. After a longer pause between calls, the additional time
// is skipped.
constexpr rt::Nanoseconds kLongest = 100 * rt::kMillisecond;
constexpr double kAtRest_rad_per_s = 0.1;  // below this speed the motor counts as at rest
constexpr int kProfileVelocity = 3;        // modes of operation (object 6060)
constexpr int kCyclicVelocity = 9;
// Option codes of objects 605A and 605E. Codes 5 and 6 brake like 1 and 2, and the drive then stays in quick
// stop active.
constexpr int kCoast = 0, kSlowDownRamp = 1, kQuickStopRamp = 2;
constexpr int kSlowDownAndStay = 5, kQuickStopAndStay = 6;

// The drive's objects with their values at power-on.
std::vector<DictionaryEntry> Dictionary(const DriveDeviceParams& params) {
  const auto node = static_cast<std::uint32_t>(params.node);
  std::vector<DictionaryEntry> list{
      {.index = 0x1000, .value = 0x00020192},  // servo drive, profile 402
      {.index = 0x1001, .bytes = 1},           // error register
      {.index = 0x1016, .sub = 0, .bytes = 1, .value = 1},
      {.index = 0x1016, .sub = 1, .writable = true},                // watched heartbeat: node and time [ms]
      {.index = 0x1017, .bytes = 2, .writable = true},              // period of its own heartbeat [ms]
      {.index = 0x1018, .sub = 0, .bytes = 1, .value = 4},          // identity; vendor 0: none
      {.index = 0x1018, .sub = 1},                                  // vendor
      {.index = 0x1018, .sub = 2, .value = 0x4F535444},             // product: "OSTD"
      {.index = 0x1018, .sub = 3, .value = 0x00010000},             // revision 1.0
      {.index = 0x1018, .sub = 4, .value = node},                   // serial number
      {.index = 0x6007, .bytes = 2, .writable = true, .value = 1},  // 1: a lost heartbeat is a fault
      {.index = 0x603F, .bytes = 2, .mappable = true},              // error code
      {.index = 0x6040, .bytes = 2, .writable = true, .mappable = true},  // controlword
      {.index = 0x6041, .bytes = 2, .mappable = true},                    // statusword
      {.index = 0x605A, .bytes = 2, .writable = true, .value = 2},        // option code of the quick stop
      {.index = 0x605E, .bytes = 2, .writable = true, .value = 2},        // option code of the fault reaction
      {.index = 0x6060, .bytes = 1, .writable = true, .mappable = true, .value = 3},  // mode
      {.index = 0x6061, .bytes = 1, .mappable = true, .value = 3},                    // mode in force
      {.index = 0x606C, .mappable = true},                                            // velocity [rpm]
      {.index = 0x606D, .bytes = 2, .writable = true, .value = 10},                   // velocity window [rpm]
      {.index = 0x606E, .bytes = 2, .writable = true, .value = 10},  // velocity window time [ms]
      {.index = 0x6076,                                              // rated torque [mN·m]
       .value = static_cast<std::uint32_t>(std::lround(1000 * params.motor.rated_torque_Nm))},
      {.index = 0x6077, .bytes = 2, .mappable = true},        // torque, in 1/1000 of the rated torque
      {.index = 0x6083, .writable = true, .value = 10000},    // acceleration [rpm/s]
      {.index = 0x6084, .writable = true, .value = 10000},    // deceleration [rpm/s]
      {.index = 0x6085, .writable = true, .value = 50000},    // deceleration of the quick stop [rpm/s]
      {.index = 0x60FF, .writable = true, .mappable = true},  // target velocity [rpm]
      {.index = 0x3201, .sub = 1, .bytes = 2, .mappable = true, .value = 250},  // temperature
  };
  // PDOs in their default state: enabled, mapped to statusword or controlword only, not synchronised by SYNC.
  const struct {
    int communication, mapping;
    std::uint32_t id, object;
  } pdos[]{{0x1400, 0x1600, 0x200 + node, 0x60400010},
           {0x1800, 0x1A00, 0x180 + node, 0x60410010},
           {0x1801, 0x1A01, 0x280 + node, 0x60410010}};
  for (const auto& pdo : pdos) {
    list.push_back({.index = pdo.communication, .sub = 1, .writable = true, .value = pdo.id});
    list.push_back({.index = pdo.communication, .sub = 2, .bytes = 1, .writable = true, .value = 255});
    list.push_back({.index = pdo.mapping, .sub = 0, .bytes = 1, .writable = true, .value = 1});
    for (int sub = 1; sub <= 8; ++sub)
      list.push_back(
          {.index = pdo.mapping, .sub = sub, .writable = true, .value = sub == 1 ? pdo.object : 0});
  }
  return list;
}

// Whether an object accepts a value; only modes and option codes are restricted.
bool Accepts(int index, std::uint32_t value) {
  if (index == 0x6060) return value == kProfileVelocity || value == kCyclicVelocity;
  if (index == 0x605E) return value <= kQuickStopRamp;
  if (index == 0x605A)
    return value <= kQuickStopRamp || value == kSlowDownAndStay || value == kQuickStopAndStay;
  return true;
}

}  // namespace

DriveDevice::DriveDevice(const DriveDeviceParams& params)
    : params_(params), motor_(params.motor), objects_(Dictionary(params)) {
  if (params.node < 1 || params.node > 127)
    throw std::invalid_argument("drive: node: found " + std::to_string(params.node) + ", accepted 1 … 127");
}

void DriveDevice::SetCuttingTorque(double at_the_tool_Nm) {
  cutting_Nm_ = std::isfinite(at_the_tool_Nm) ? std::abs(at_the_tool_Nm) : 0.0;
}

void DriveDevice::InjectFault(int error_code) {
  broken_ = error_code;
  Trip(error_code);
}

void DriveDevice::SetPower(bool on) {
  if (on == power_) return;
  power_ = on;
  Boot();
  queue_.Clear();
}

void DriveDevice::Boot() {
  objects_ = ObjectDictionary(Dictionary(params_));
  state_ = State::kNotReady;
  nmt_ = 0;
  last_control_ = error_ = 0;
  boot_due_ = 0;
  heartbeat_due_ = 0;
  master_heard_ = -1;
  rpdo_fresh_ = false;
}

int DriveDevice::statusword() const {
  constexpr int kVoltage = 0x10, kNoQuickStop = 0x20, kRemote = 0x200, kTargetReached = 0x400;
  switch (state_) {
    case State::kNotReady:
      return 0;
    case State::kDisabled:
      return kRemote + kVoltage + 0x40;
    case State::kReady:
      return kRemote + kVoltage + kNoQuickStop + 0x01;
    case State::kSwitchedOn:
      return kRemote + kVoltage + kNoQuickStop + 0x03;
    case State::kEnabled:
      return kRemote + kVoltage + kNoQuickStop + 0x07 + (TargetReached() ? kTargetReached : 0);
    case State::kQuickStop:
      return kRemote + kVoltage + 0x07 + (TargetReached() ? kTargetReached : 0);
    case State::kFaultReaction:
      return kRemote + kVoltage + 0x0F;
    case State::kFault:
      break;
  }
  return kRemote + kVoltage + 0x08;
}

bool DriveDevice::StaysInQuickStop() const noexcept {
  const int option = objects_.GetSigned(0x605A);
  return option == kSlowDownAndStay || option == kQuickStopAndStay;
}

bool DriveDevice::AtRest() const noexcept { return std::abs(motor_.speed_rad_per_s()) < kAtRest_rad_per_s; }

bool DriveDevice::InVelocityWindow() const noexcept {
  const long difference_rpm = objects_.GetSigned(0x60FF) - std::lround(motor_.speed_rad_per_s() / kRpm);
  return std::abs(difference_rpm) <= static_cast<long>(objects_.Get(0x606D));
}

// Returns bit 10 of the statusword. The velocity window is checked here too, because a new target must clear
// the bit at once.
bool DriveDevice::TargetReached() const noexcept {
  if (state_ == State::kQuickStop) return StaysInQuickStop() && AtRest();
  return state_ == State::kEnabled && objects_.GetSigned(0x6060) == kProfileVelocity && InVelocityWindow() &&
         in_window_ >= objects_.Get(0x606E) * rt::kMillisecond;
}

void DriveDevice::StartQuickStop() noexcept {
  state_ = objects_.GetSigned(0x605A) == kCoast ? State::kDisabled : State::kQuickStop;
}

// Advances the state machine of CiA 402 according to a received controlword.
void DriveDevice::HandleControlword(int word) noexcept {
  const bool on = word & 1, voltage = word & 2, no_quick_stop = word & 4, enable = word & 8;
  const bool reset_edge = (word & 0x80) != 0 && (last_control_ & 0x80) == 0;
  last_control_ = word;
  if (reset_edge) ++resets_;
  if (state_ == State::kNotReady || state_ == State::kFaultReaction) return;
  if (state_ == State::kFault) {
    if (!reset_edge || broken_ != 0) return;
    state_ = State::kDisabled;
    error_ = 0;
    queue_.Push(static_cast<std::uint16_t>(0x080 + params_.node), {0, 0, 0, 0, 0, 0, 0, 0});
    return;
  }
  if (!voltage) {
    state_ = State::kDisabled;
  } else if (!no_quick_stop) {
    if (state_ == State::kEnabled)
      StartQuickStop();
    else if (state_ != State::kQuickStop)
      state_ = State::kDisabled;
  } else if (!on) {
    if (state_ != State::kQuickStop) state_ = State::kReady;
  } else if (!enable) {
    if (state_ == State::kReady || state_ == State::kEnabled) state_ = State::kSwitchedOn;
  } else if (state_ == State::kReady) {
    state_ = State::kSwitchedOn;
  } else if (state_ == State::kSwitchedOn || (state_ == State::kQuickStop && StaysInQuickStop())) {
    state_ = State::kEnabled;
    ramp_rad_per_s_ = motor_.speed_rad_per_s();
    in_window_ = 0;
  }
}

// Enters the fault state: at once, or after braking if the motor is powered and 605E demands braking.
void DriveDevice::Trip(int error_code) noexcept {
  if (state_ == State::kFault || state_ == State::kFaultReaction || state_ == State::kNotReady) return;
  const bool powered = state_ == State::kEnabled || state_ == State::kQuickStop;
  const bool brakes = powered && objects_.GetSigned(0x605E) != kCoast;
  state_ = brakes ? State::kFaultReaction : State::kFault;
  error_ = error_code;
  SendEmergency(error_code);
}

void DriveDevice::SendEmergency(int error_code) {
  queue_.Push(static_cast<std::uint16_t>(0x080 + params_.node),
              {error_code % 256, error_code / 256, kGenericError, 0, 0, 0, 0, 0});
}

void DriveDevice::HandleNmtCommand(int command) noexcept {
  if (command == 0x01) nmt_ = kOperational;
  if (command == 0x02) nmt_ = kStopped;
  if (command == 0x80) nmt_ = kPreOperational;
  if (command == 0x81 || command == 0x82) Boot();
}

// Returns the SDO abort code if a write is not allowed in the present state or has an invalid value,
// otherwise 0. A mapped object is coded as index (16 bits), sub-index (8 bits) and length in bits (8 bits).
std::uint32_t DriveDevice::ValidateWrite(void* self, const DictionaryEntry& entry, std::uint32_t value) {
  constexpr std::uint32_t kNotNow = 0x08000022, kRange = 0x06090030, kNotMappable = 0x06040041,
                          kTooLong = 0x06040042;
  auto& drive = *static_cast<DriveDevice*>(self);
  const bool is_pdo_object = (entry.index >= 0x1400 && entry.index < 0x1C00);
  if (!is_pdo_object) return Accepts(entry.index, value) ? 0 : kRange;
  if (drive.nmt_ == kOperational) return kNotNow;
  const bool is_mapping = entry.index % 0x400 >= 0x200;
  const int communication = is_mapping ? entry.index - 0x200 : entry.index;
  const bool pdo_is_off = drive.objects_.Get(communication, 1) >= 0x80000000u;
  if (!is_mapping) return entry.sub == 2 && !pdo_is_off ? kNotNow : 0;
  if (!pdo_is_off) return kNotNow;
  if (entry.sub > 0) {
    if (drive.objects_.Get(entry.index, 0) != 0) return kNotNow;
    const DictionaryEntry* object =
        drive.objects_.Find(static_cast<int>(value / 65536), static_cast<int>(value / 256 % 256));
    if (value == 0) return 0;
    const bool fits = object != nullptr && object->mappable && value % 256 == 8u * object->bytes &&
                      (entry.index >= 0x1A00 || object->writable);
    return fits ? 0 : kNotMappable;
  }
  std::uint32_t bits = 0;
  for (std::uint32_t sub = 1; sub <= value; ++sub)
    bits += drive.objects_.Get(entry.index, static_cast<int>(sub)) % 256;
  return value > 8 ? kRange : bits > 64 ? kTooLong : 0;
}

void DriveDevice::Accept(const io::CanArrival& arrival) OSTEON_RT {
  if (!power_) return;
  AdvanceTo(arrival.stamp);
  if (nmt_ == 0) return;
  const io::CanFrame& frame = arrival.frame;
  if (frame.id == 0x000 && frame.size == 2 && (frame.data[1] == 0 || frame.data[1] == params_.node))
    return HandleNmtCommand(frame.data[0]);
  if (frame.id == 0x600 + params_.node && nmt_ != kStopped) {
    UpdateStatusObjects();
    if (objects_.Serve(frame, static_cast<std::uint16_t>(0x580 + params_.node), queue_, &ValidateWrite,
                       this) &&
        frame.data[1] == 0x40 && frame.data[2] == 0x60)
      HandleControlword(static_cast<int>(objects_.Get(0x6040)));
    return;
  }
  const std::uint32_t watched = objects_.Get(0x1016, 1);
  if (watched != 0 && frame.id == 0x700 + watched / 65536 && frame.size == 1) {
    master_heard_ = arrival.stamp;
    return;
  }
  if (nmt_ != kOperational) return;
  if (frame.id == objects_.Get(0x1400, 1)) {
    rpdo_ = frame;
    rpdo_fresh_ = true;
    // transmission type 254 or 255: event-driven, takes effect without SYNC
    if (objects_.Get(0x1400, 2) >= 254) HandleRpdo();
  } else if (frame.id == 0x080) {
    if (rpdo_fresh_) HandleRpdo();
    for (const int number : {0, 1}) SendTpdo(number);
  }
}

// Writes the received PDO to the objects that it maps. A PDO shorter than its mapping is refused (CiA 301:
// EMCY 8210).
void DriveDevice::HandleRpdo() noexcept {
  rpdo_fresh_ = false;
  const int count = static_cast<int>(objects_.Get(0x1600, 0));
  std::size_t offset = 0;
  bool has_controlword = false;
  for (int sub = 1; sub <= count; ++sub) {
    const std::uint32_t entry = objects_.Get(0x1600, sub);
    const std::size_t bytes = entry % 256 / 8;
    if (offset + bytes > rpdo_.size) {
      queue_.Push(static_cast<std::uint16_t>(0x080 + params_.node), {0x10, 0x82, 0x11, 0, 0, 0, 0, 0});
      return;
    }
    long value = 0;
    for (std::size_t i = bytes; i > 0; --i) value = 256 * value + rpdo_.data[offset + i - 1];
    offset += bytes;
    const int index = static_cast<int>(entry / 65536);
    objects_.Set(index, static_cast<int>(entry / 256 % 256), value);
    has_controlword = has_controlword || index == 0x6040;
  }
  if (has_controlword) HandleControlword(static_cast<int>(objects_.Get(0x6040)));
}

// Queues a PDO with the present values of its mapped objects, if the PDO is enabled and cyclic.
void DriveDevice::SendTpdo(int number) noexcept {
  const std::uint32_t id = objects_.Get(0x1800 + number, 1);
  if (id >= 0x80000000u || objects_.Get(0x1800 + number, 2) != 1) return;
  UpdateStatusObjects();
  const int count = static_cast<int>(objects_.Get(0x1A00 + number, 0));
  std::array<int, 8> bytes{};
  std::size_t size = 0;
  for (int sub = 1; sub <= count; ++sub) {
    const std::uint32_t entry = objects_.Get(0x1A00 + number, sub);
    std::uint32_t value = objects_.Get(static_cast<int>(entry / 65536), static_cast<int>(entry / 256 % 256));
    for (std::uint32_t i = 0; i < entry % 256 / 8 && size < 8; ++i, value /= 256)
      bytes[size++] = static_cast<int>(value % 256);
  }
  // FrameQueue::Push takes an initializer list, so each size that occurs needs its own call.
  const auto cob = static_cast<std::uint16_t>(id);
  const auto& b = bytes;
  if (size == 2) queue_.Push(cob, {b[0], b[1]});
  if (size == 6) queue_.Push(cob, {b[0], b[1], b[2], b[3], b[4], b[5]});
  if (size == 7) queue_.Push(cob, {b[0], b[1], b[2], b[3], b[4], b[5], b[6]});
}

// Copies the drive's state to the objects that report it.
void DriveDevice::UpdateStatusObjects() noexcept {
  objects_.Set(0x6041, 0, statusword());
  objects_.Set(0x6061, 0, objects_.GetSigned(0x6060));
  objects_.Set(0x606C, 0, std::lround(motor_.speed_rad_per_s() / kRpm));
  const double permille = 1000.0 * motor_.torque_Nm() / params_.motor.rated_torque_Nm;
  objects_.Set(0x6077, 0, std::lround(std::clamp(permille, -32768.0, 32767.0)));
  objects_.Set(0x603F, 0, error_);
  objects_.Set(0x1001, 0, error_ == 0 ? 0 : kGenericError);
}

bool DriveDevice::Next(rt::Nanoseconds now, io::CanFrame& frame) OSTEON_RT {
  AdvanceTo(now);
  if (!power_) return false;
  const auto heartbeat_id = static_cast<std::uint16_t>(0x700 + params_.node);
  if (nmt_ == 0) {
    if (boot_due_ == 0) boot_due_ = now + params_.boot;
    if (now < boot_due_) return false;
    nmt_ = kPreOperational;
    state_ = State::kDisabled;
    queue_.Push(heartbeat_id, {0});
    if (broken_ != 0 || boot_error_ != 0) Trip(broken_ != 0 ? broken_ : boot_error_);
  }
  const rt::Nanoseconds period = objects_.Get(0x1017) * rt::kMillisecond;
  if (period > 0 && now >= heartbeat_due_) {
    heartbeat_due_ = now + period;
    queue_.Push(heartbeat_id, {nmt_});
  }
  const rt::Nanoseconds master_timeout = objects_.Get(0x1016, 1) % 65536 * rt::kMillisecond;
  if (master_timeout > 0 && master_heard_ >= 0 && now - master_heard_ > master_timeout) {
    master_heard_ = -1;
    if (objects_.Get(0x6007) == 1) Trip(kHeartbeatError);
  }
  return queue_.Pop(frame);
}

void DriveDevice::AdvanceTo(rt::Nanoseconds now) noexcept {
  if (time_ < 0 || now - time_ > kLongest)
    time_ = now - std::min(now - std::max<rt::Nanoseconds>(time_, 0), kLongest);
  const auto step = static_cast<rt::Nanoseconds>(kStep_s * 1e9);
  for (; now - time_ >= step; time_ += step) StepMotor(kStep_s);
}

// Index of the object with the deceleration of the present stop: 6084 or 6085.
int DriveDevice::StopRamp() const noexcept {
  const int option = objects_.GetSigned(state_ == State::kQuickStop ? 0x605A : 0x605E);
  return option == kSlowDownRamp || option == kSlowDownAndStay ? 0x6084 : 0x6085;
}

void DriveDevice::StepMotor(double dt_s) noexcept {
  const double load_Nm = cutting_Nm_ / params_.motor.gear_ratio + params_.friction_Nm;
  const bool stopping = state_ == State::kQuickStop || state_ == State::kFaultReaction;
  if (!power_ || (state_ != State::kEnabled && !stopping)) {
    motor_.Coast(dt_s, load_Nm);
    ramp_rad_per_s_ = motor_.speed_rad_per_s();
    return;
  }
  const double target = stopping ? 0.0 : objects_.GetSigned(0x60FF) * kRpm;
  const bool faster = std::abs(target) > std::abs(ramp_rad_per_s_);
  const double slope = objects_.Get(stopping ? StopRamp() : faster ? 0x6083 : 0x6084) * kRpm * dt_s;
  ramp_rad_per_s_ += std::clamp(target - ramp_rad_per_s_, -slope, slope);
  motor_.Step(dt_s, ramp_rad_per_s_, load_Nm);

  stalled_s_ = AtRest() && motor_.limited() ? stalled_s_ + dt_s : 0.0;
  in_window_ = InVelocityWindow() ? in_window_ + std::lround(dt_s * 1e9) : 0;
  if (state_ == State::kEnabled && stalled_s_ > params_.stall_s) Trip(kBlocked);
  if (!AtRest()) return;
  if (state_ == State::kFaultReaction) state_ = State::kFault;
  if (state_ == State::kQuickStop && !StaysInQuickStop()) state_ = State::kDisabled;
}

}  // namespace osteon::hil
