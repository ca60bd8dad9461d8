#pragma once

#include <cstdint>

namespace osteon::safety {

/// Faults are latched bits: a fault stays set until it is cleared. After each cause, the comments give the
/// cell's reaction; "hold" keeps the last command.
enum class Fault : std::uint32_t {
  kNone = 0,
  kArmStale = 1u << 0,           ///< several arm messages in a row missed their deadline: hold; Stop 0
  kModelStale = 1u << 1,         ///< contact model too old: hold, then Stop 1
  kSensorStale = 1u << 2,        ///< force sensor too old: Stop 1
  kWrenchRate = 1u << 3,         ///< coupling force changes faster than 1.5 K v_max: Stop 1
  kSensorForce = 1u << 4,        ///< hand pushes beyond limit + margin: Stop 1
  kToolSpeed = 1u << 5,          ///< commanded tool speed beyond its limit despite scaling: Stop 1
  kWorkspace = 1u << 6,          ///< tool left its workspace: Stop 1
  kJointLimit = 1u << 7,         ///< joint position, speed, step or torque at its limit: Stop 1
  kInverseKinematics = 1u << 8,  ///< no joint solution for the commanded pose: hold; Stop 1
  kSession = 1u << 9,         ///< the arm left COMMANDING_ACTIVE: the command follows the arm's own position
  kDevice = 1u << 10,         ///< the simulation's device is lost: Stop 1
  kNotFinite = 1u << 11,      ///< a value from outside is not finite: Stop 1
  kTracking = 1u << 12,       ///< measured pose too far from the commanded one: Stop 1
  kPeriod = 1u << 13,         ///< the arm's period is not the loop's period: hold
  kInterlock = 1u << 14,      ///< the PLC does not permit motion, or is silent: Stop 1
  kSpindle = 1u << 15,        ///< the spindle's drive has a fault, or is silent: Stop 1
  kSensorFault = 1u << 16,    ///< the force sensor is beyond its range or broken: Stop 1
  kCommandMode = 1u << 17,    ///< the arm expects another kind of command than the law sends: hold
  kSpindleLimit = 1u << 18,   ///< the spindle's torque or speed is beyond its limit: Stop 1
  kRepeatDiffers = 1u << 19,  ///< computing a tick twice gave two results: Stop 1
  kRecorder = 1u << 20,       ///< the recorder has stalled, or its queue is full: Stop 1
  kToolInBone = 1u << 21,     ///< commanded tool too far from its collision-free pose (the proxy): Stop 1
  kArmSpeed = 1u << 22,       ///< the measured speed of the arm is beyond its limit: Stop 1
  /// the coupling stayed at its force limit, and the cell is configured to stop then: Stop 1
  kForceLimit = 1u << 23,
  kDeflection = 1u << 24,  ///< tool, tissue or bone's mount yielded beyond its limit: Stop 1
};

/// The set of latched faults.
class FaultSet {
 public:
  constexpr void Latch(Fault fault) noexcept { bits_ |= static_cast<std::uint32_t>(fault); }
  constexpr void Latch(FaultSet other) noexcept { bits_ |= other.bits_; }
  constexpr void Clear() noexcept { bits_ = 0; }
  [[nodiscard]] constexpr bool Has(Fault fault) const noexcept {
    return (bits_ & static_cast<std::uint32_t>(fault)) != 0;
  }
  [[nodiscard]] constexpr bool Any() const noexcept { return bits_ != 0; }
  [[nodiscard]] constexpr std::uint32_t bits() const noexcept { return bits_; }

 private:
  std::uint32_t bits_{0};
};

/// Faults are bits 0 … kFaultCount - 1.
inline constexpr int kFaultCount = 25;

struct FaultText {
  const char* name;      ///< as in the summary, e.g. "contact model stale"
  const char* cause;     ///< what was observed
  const char* reaction;  ///< what the cell does
  const char* clearing;  ///< how an operator clears it
};

/// Returns the texts for one fault, for screens and reports. Not to be called in the tick.
[[nodiscard]] FaultText Describe(Fault fault);

/// Stop categories, after IEC 60204-1 as far as a controller that does not switch the power can follow it. 0:
/// the arm is not under control, no command has an effect. 1: the commanded motion brakes to rest and the
/// request for motion is withdrawn. 2: the commanded motion brakes to rest and the arm stays under power (a
/// pause, no fault).
enum class StopCategory : std::uint8_t { kStop0 = 0, kStop1 = 1, kStop2 = 2 };

/// Stop category of a fault. After a fault of category 0 the loop brakes the motion as well if the arm still
/// takes commands.
[[nodiscard]] constexpr StopCategory StopOf(Fault fault) noexcept {
  switch (fault) {
    case Fault::kArmStale:
    case Fault::kSession:
    case Fault::kPeriod:
    case Fault::kCommandMode:
      return StopCategory::kStop0;
    default:
      return StopCategory::kStop1;
  }
}

/// Whether a recovery may clear the fault within the session. This is true only for faults of the connection
/// to the arm.
[[nodiscard]] constexpr bool AllowsRecovery(Fault fault) noexcept {
  return fault == Fault::kSession || fault == Fault::kArmStale;
}
/// Whether a recovery may clear a set of faults: the set is not empty, and each of its faults allows
/// recovery.
[[nodiscard]] constexpr bool AllowsRecovery(FaultSet faults) noexcept {
  for (int bit = 0; bit < kFaultCount; ++bit)
    if (const auto fault = static_cast<Fault>(1u << bit); faults.Has(fault) && !AllowsRecovery(fault))
      return false;
  return faults.Any();
}

}  // namespace osteon::safety
