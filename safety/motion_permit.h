#pragma once

#include <cstdint>

namespace osteon::safety {

/// What has to hold before anything is moved: all of it, in the same tick. The bits are the recording's.
enum class MotionPermit : std::uint32_t {
  kArmFresh = 1u << 0,          ///< this tick has a message of the arm, with finite joints
  kHandedOver = 1u << 1,        ///< COMMANDING_ACTIVE, and no safety stop: the enabling switch is held
  kRunPermitted = 1u << 2,      ///< by the PLC, freshly, the switch held; without a PLC always
  kSensorFresh = 1u << 3,       ///< the force sensor's reading is to be trusted and young enough
  kModelFresh = 1u << 4,        ///< so is the contact model
  kPosePlausible = 1u << 5,     ///< the arm is measured where it would be commanded
  kNoResidualWrench = 1u << 6,  ///< the coupling begins at nothing and fades in to what the cell may give
  kSpindleReady = 1u << 7,      ///< its drive is in order, freshly; of a cell without one always
  kWayLookedAt = 1u << 8,       ///< whoever looks at the way to the start has not forbidden it
  /// Before the first motion: the force sensor's reading at rest is its zero, not a hand that rests on the
  /// handle.
  kHandOff = 1u << 9,
};
inline constexpr int kMotionPermits = 10;

/// Those that hold.
class MotionPermits {
 public:
  static constexpr std::uint32_t kAll = (1u << kMotionPermits) - 1u;

  constexpr MotionPermits() noexcept = default;
  constexpr explicit MotionPermits(std::uint32_t bits) noexcept : bits_(bits & kAll) {}
  constexpr void Put(MotionPermit permit, bool holds) noexcept {
    const auto bit = static_cast<std::uint32_t>(permit);
    bits_ = holds ? bits_ | bit : bits_ & ~bit;
  }
  [[nodiscard]] constexpr bool Has(MotionPermit permit) const noexcept {
    return (bits_ & static_cast<std::uint32_t>(permit)) != 0;
  }
  [[nodiscard]] constexpr bool All() const noexcept { return bits_ == kAll; }
  /// Every one but that the arm is handed over.
  [[nodiscard]] constexpr bool InOrder() const noexcept {
    return (bits_ | static_cast<std::uint32_t>(MotionPermit::kHandedOver)) == kAll;
  }
  [[nodiscard]] constexpr std::uint32_t bits() const noexcept { return bits_; }

 private:
  std::uint32_t bits_{0};
};

/// What is missing where it does not hold, e.g. "a fresh force reading". For screens, not for the tick.
[[nodiscard]] const char* Missing(MotionPermit permit);

}  // namespace osteon::safety
