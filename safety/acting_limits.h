#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace osteon::safety {

/// What may take something from the motion or from the wrench in a tick. The numbers are recorded.
enum class Limit : std::uint8_t {
  kWrench = 0,        ///< the coupling's force or torque, by any bound of it
  kArmTorque = 1,     ///< of that, or of what is sent: what the arm's joints hold
  kStoredEnergy = 2,  ///< of that: what the coupling's spring may store
  kPower = 3,         ///< of that: what it may give to the hand
  kToolSpeed = 4,     ///< tool's speed or turn, by any bound of it
  kWorkspace = 5,     ///< the apex's bounds
  kZones = 6,         ///< flange's or elbow's
  kJoints = 7,        ///< joint position, speed or step, reach, a singular posture
  kElbowSpeed = 8,
  kDepth = 9,       ///< the reamer's depth limit resisted
  kModelAge = 10,   ///< the contact model's age slowed the tool
  kSensorAge = 11,  ///< the sensor's age took of the hand's force
  kAgeGovernor = 12,
  kPassivity = 13,
  kTank = 14,
  kBoneEntry = 15,  ///< the coupling at its force limit: the tool's speed into bone
};
inline constexpr std::size_t kLimitCount = 16;
/// By number, as in summaries: `tool_speed`.
inline constexpr std::array<std::string_view, kLimitCount> kLimitNames{
    "wrench",       "arm_torque", "stored_energy", "power",     "tool_speed", "workspace",
    "zones",        "joints",     "elbow_speed",   "depth",     "model_age",  "sensor_age",
    "age_governor", "passivity",  "tank",          "bone_entry"};

/// Those that act.
class LimitSet {
 public:
  constexpr LimitSet() = default;
  explicit constexpr LimitSet(std::uint32_t bits) noexcept : bits_(bits) {}
  constexpr void Add(Limit limit, bool acts = true) noexcept {
    if (acts) bits_ |= 1u << static_cast<unsigned>(limit);
  }
  [[nodiscard]] constexpr bool Has(Limit limit) const noexcept {
    return (bits_ >> static_cast<unsigned>(limit) & 1u) != 0;
  }
  [[nodiscard]] constexpr std::uint32_t bits() const noexcept { return bits_; }

 private:
  std::uint32_t bits_{0};
};

/// How often a limit acted.
struct LimitCount {
  std::uint64_t ticks{0};
  std::uint64_t events{0};   ///< runs of such ticks
  std::uint64_t longest{0};  ///< ticks of the longest run
};

/// Counts each limit's ticks and runs.
class LimitCounts {
 public:
  void Count(LimitSet acting) noexcept {
    for (std::uint32_t bits = acting.bits(); bits != 0; bits &= bits - 1) {
      const auto at = static_cast<std::size_t>(std::countr_zero(bits));
      LimitCount& count = counts_[at];
      ++count.ticks;
      if (!before_.Has(static_cast<Limit>(at))) {
        ++count.events;
        run_[at] = 0;
      }
      if (++run_[at] > count.longest) count.longest = run_[at];
    }
    before_ = acting;
  }
  [[nodiscard]] const LimitCount& Of(Limit limit) const noexcept {
    return counts_[static_cast<std::size_t>(limit)];
  }

 private:
  std::array<LimitCount, kLimitCount> counts_{};
  std::array<std::uint64_t, kLimitCount> run_{};  // the run under way
  LimitSet before_;
};

}  // namespace osteon::safety
