#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace osteon::safety {

/// Limits that may reduce the motion or the wrench in a tick. The numbers are recorded.
enum class Limit : std::uint8_t {
  kWrench = 0,     ///< a bound on the coupling's force or torque
  kArmTorque = 1,  ///< the torque limits of the arm's joints reduced the coupling, or the wrench that is sent
  kStoredEnergy = 2,  ///< energy stored by the coupling's spring
  kPower = 3,         ///< power from the coupling to the hand
  kToolSpeed = 4,     ///< a bound on the tool's linear or angular speed
  kWorkspace = 5,     ///< the sphere, plane or zones that bound the apex
  kZones = 6,         ///< the zones that bound flange or elbow
  kJoints = 7,        ///< a limit of joint position, speed or step; the end of the reach; a singular posture
  kElbowSpeed = 8,
  kDepth = 9,       ///< the resistance of the reamer's depth limit
  kModelAge = 10,   ///< the contact model's age slowed the tool
  kSensorAge = 11,  ///< the sensor's age reduced the hand's force
  kAgeGovernor = 12,
  kPassivity = 13,
  kTank = 14,
  /// the bound on the tool's speed into bone that applies while the coupling is at its force limit
  kBoneEntry = 15,
  kGuidance = 16,    ///< guidance along the surgical plan gave a force or torque
  kDeflection = 17,  ///< the tool, the tissue or the bone's mount yielded by more than the cell's error bound
};
inline constexpr std::size_t kLimitCount = 18;
/// Names of the limits by number, as in summaries, e.g. `tool_speed`.
inline constexpr std::array<std::string_view, kLimitCount> kLimitNames{
    "wrench",       "arm_torque", "stored_energy", "power",      "tool_speed", "workspace",
    "zones",        "joints",     "elbow_speed",   "depth",      "model_age",  "sensor_age",
    "age_governor", "passivity",  "tank",          "bone_entry", "guidance",   "deflection"};

/// The set of limits that acted in a tick.
class LimitSet {
 public:
  constexpr LimitSet() = default;
  explicit constexpr LimitSet(std::uint32_t bits) noexcept : bits_(bits) {}
  constexpr void Add(Limit limit, bool acts = true) noexcept {
    if (acts) bits_ |= 1u << static_cast<unsigned>(limit);
  }
  constexpr void Add(LimitSet others) noexcept { bits_ |= others.bits_; }
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
  std::uint64_t events{0};   ///< how often the limit acted: number of runs of consecutive ticks
  std::uint64_t longest{0};  ///< ticks of the longest run
};

/// Counts each limit's ticks and runs.
class LimitCounts {
 public:
  void Count(LimitSet acting) noexcept {
    for (std::uint32_t bits = acting.bits(); bits != 0; bits &= bits - 1) {
      const auto at = static_cast<std::size_t>(std::countr_zero(bits));  // the limit's number
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
  std::array<std::uint64_t, kLimitCount> run_{};  // length of the current run
  LimitSet before_;                               // the limits that acted in the previous tick
};

}  // namespace osteon::safety
