#pragma once

#include <cstdint>

namespace osteon::safety {

/// Conditions that have to hold, all in the same tick, before anything is moved. The bits are recorded.
enum class MotionPermit : std::uint32_t {
  kArmFresh = 1u << 0,  ///< this tick has a message of the arm, with finite joints
  /// the arm is in COMMANDING_ACTIVE without a safety stop, so the enabling switch is held
  kHandedOver = 1u << 1,
  kRunPermitted = 1u << 2,  ///< the PLC's fresh status permits motion and shows the enabling switch held;
                            ///< always true without a PLC
  kSensorFresh = 1u << 3,   ///< the force sensor's reading is trusted and young enough
  kModelFresh = 1u << 4,    ///< the contact model is young enough
  /// the measured position of the arm is plausible as the first commanded position
  kPosePlausible = 1u << 5,
  kNoResidualWrench = 1u << 6,  ///< the coupling begins at zero and fades in up to the cell's limits
  /// the spindle's drive has no fault and its status is fresh; always true without a drive
  kSpindleReady = 1u << 7,
  kPathChecked = 1u << 8,  ///< the check of the path to the start has found no obstacle
  /// Before the first motion: no hand rests on the handle, so the force sensor's reading at rest can be taken
  /// as its bias.
  kHandOff = 1u << 9,
};
inline constexpr int kMotionPermits = 10;

/// The set of conditions that hold.
class MotionPermits {
 public:
  static constexpr std::uint32_t kAll = (1u << kMotionPermits) - 1u;

  constexpr MotionPermits() noexcept = default;
  constexpr explicit MotionPermits(std::uint32_t bits) noexcept : bits_(bits & kAll) {}
  constexpr void Set(MotionPermit permit, bool holds) noexcept {
    const auto bit = static_cast<std::uint32_t>(permit);
    bits_ = holds ? bits_ | bit : bits_ & ~bit;
  }
  [[nodiscard]] constexpr bool Has(MotionPermit permit) const noexcept {
    return (bits_ & static_cast<std::uint32_t>(permit)) != 0;
  }
  [[nodiscard]] constexpr bool All() const noexcept { return bits_ == kAll; }
  /// Whether every condition except kHandedOver holds; kHandedOver itself does not matter.
  [[nodiscard]] constexpr bool AllButHandedOver() const noexcept {
    return (bits_ | static_cast<std::uint32_t>(MotionPermit::kHandedOver)) == kAll;
  }
  [[nodiscard]] constexpr std::uint32_t bits() const noexcept { return bits_; }

 private:
  std::uint32_t bits_{0};
};

/// Text for a missing condition, e.g. "a fresh reading of the force sensor". For screens, not for the tick.
[[nodiscard]] const char* DescribeMissing(MotionPermit permit);

}  // namespace osteon::safety
