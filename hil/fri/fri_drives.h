#pragma once

#include <cstdint>

namespace osteon::hil {

/// The arm's safety state and drives. A stop switches the drives off at once. After the stop is acknowledged,
/// the drives take start_s to become active.
///
///     ACTIVE ──Stop(level)──▶ OFF ──Acknowledge()──▶ TRANSITIONING ──start_s──▶ ACTIVE
///
/// Enumerators and levels have the numbers that FRI uses.
class FriDrives {
 public:
  enum class State : std::uint8_t { kOff = 0, kTransitioning = 1, kActive = 2 };

  explicit FriDrives(double start_s) : start_s_(start_s) {}

  /// @param level 0 … 2: FRI's STOP_LEVEL_0 … 2.
  void Stop(int level) {
    safety_ = static_cast<std::uint8_t>(level + 1);
    state_ = State::kOff;
  }
  void Acknowledge() {
    if (safety_ == 0) return;
    safety_ = 0;
    state_ = State::kTransitioning;
    left_s_ = start_s_;
  }
  void Step(double period_s) {
    if (state_ != State::kTransitioning) return;
    left_s_ -= period_s;
    if (left_s_ < 0.5 * period_s) state_ = State::kActive;
  }

  [[nodiscard]] std::uint8_t safety() const { return safety_; }  ///< 0 normal, 1 … 3 stop level 0 … 2
  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] bool ready() const { return safety_ == 0 && state_ == State::kActive; }

 private:
  double start_s_;
  double left_s_{0.0};
  std::uint8_t safety_{0};
  State state_{State::kActive};
};

}  // namespace osteon::hil
