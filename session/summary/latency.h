#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "control/tick_record.h"

namespace osteon::config {
struct CellConfig;
}

namespace osteon::session {

/// One part of a cell's latency.
struct LatencyPart {
  std::string name;      ///< "sensor", "link", "tick", "arm", "model"
  double mean_s{0.0};    ///< mean over the ticks in which the arm was commanded
  double max_s{0.0};     ///< maximum; for the arm, which has none, the mean
  bool measured{false};  ///< false: assumed, see `how`
  std::string how;       ///< how it was measured, or why it is assumed
};

/// Latency of a run: the time until a change of the hand's force moves the arm, and the time until a contact
/// with the bone reaches the hand.
struct LatencyFigures {
  std::vector<LatencyPart> parts;  ///< empty: the arm was never commanded
  double hand_to_arm_s{0.0};       ///< sensor + link + tick + arm; 0 if the hand moves the arm directly
  double bone_to_hand_s{0.0};      ///< model + link + tick + arm
  bool hand_moves_arm{false};      ///< impedance law: the hand moves the arm directly, without the loop
  /// Whether every part was measured; false without parts.
  [[nodiscard]] bool Measured() const;
};

/// The facts that a run's latency depends on and that its recording does not contain.
struct LatencyContext {
  bool virtual_time{false};    ///< the run was in virtual time, in which scheduling takes no time
  double sensor_delay_s{0.0};  ///< delay from the force to the reading's stamp; 0 if not known
  bool sensor_known{false};    ///< sensor_delay_s was identified
  /// Impedance law: the arm controls itself, and the loop's forces are added. The arm's part of the latency
  /// is then the dead time until these forces act.
  bool overlay{false};
  double arm_dead_time_s{0.0};  ///< dead time of the added forces
  bool arm_known{false};        ///< arm_dead_time_s was identified; false: assumed
};

/// Makes the context from the cell and its identification of sensor and arm. @param virtual_time  whether the
/// run was in virtual time
[[nodiscard]] LatencyContext LatencyContextOf(const config::CellConfig& cell, bool virtual_time);

/// Measures the parts of the latency from recorded ticks, taken one by one. Its memory does not grow. k is
/// the index of a tick, d a number of ticks.
///
///     sensor   age of the reading that the tick used, by its stamp, and the sensor's own delay
///     link     from the arrival of the arm's message to the loop's wake-up
///     tick     from the wake-up to the answer
///     arm      the delay d that minimises |q_meas[k] - q_cmd[k - d]|^2 over all joints while they move: dead time
///              and the servo's lag in slow motion, by what came back; for forces added to the
///              arm's impedance: their dead time
///     model    age of the pose that the contact model was computed for, while rendering
class LatencyMeter {
 public:
  void Add(const control::TickRecord& tick);

  /// @param period_s  time of a tick
  [[nodiscard]] LatencyFigures Figures(double period_s, const LatencyContext& context) const;

 private:
  static constexpr std::size_t kTicks = 128;  // longest delay in ticks: 128 ms at 1 kHz
  struct Mean {
    void Add(double value_s);
    [[nodiscard]] double Value() const { return count == 0 ? 0.0 : sum_s / static_cast<double>(count); }
    std::uint64_t count{0};
    double sum_s{0.0}, max_s{0.0};
  };
  // Adds a tick's commanded and measured positions to the search for the arm's delay.
  void AddMotion(const control::TickRecord& tick);
  [[nodiscard]] double ArmDelay_ticks() const;  // negative: not known, for example because nothing moved

  Mean sensor_, link_, tick_, model_;
  std::array<std::array<double, 7>, kTicks> sent_{};  // commands, in a ring
  std::size_t next_{0}, kept_{0};       // index of the next command in the ring; number of commands in it
  std::array<double, kTicks> error_{};  // sum of squares of measured minus commanded, for each delay
  double moved_{0.0};                   // sum of squares of the commands' steps
};

/// {hand_to_arm (null if the hand moves the arm itself), bone_to_hand, measured, parts: {NAME: {mean, max,
/// measured, how}}} in ms; null without parts.
[[nodiscard]] nlohmann::json ToJson(const LatencyFigures& latency);
/// One line: "26.3 ms from the hand's force to the arm, 30.2 ms from the bone to the hand (sensor 1.00, link
/// 0.10, … ms); assumed: …".
[[nodiscard]] std::string LatencyText(const LatencyFigures& latency);

}  // namespace osteon::session
