#pragma once

#include <cstdint>
#include <vector>

#include "base/marker.h"
#include "control/excitation/multisine.h"
#include "control/setup/pausable_clock.h"

namespace osteon::control {

struct ExcitationParams {
  std::uint64_t seed{1};            ///< draw d has seed + d
  int draws{4};                     ///< number of multisines with different phases, 1 … kMaxDraws
  int periods{3};                   ///< counted periods per draw, 1 … 100; a settling period precedes them
  double peak_speed_m_per_s{0.05};  ///< > 0
  double max_travel_m{0.004};       ///< largest offset; all amplitudes are reduced to keep it; > 0
  double max_acceleration_m_per_s2{8.0};  ///< largest acceleration; kept in the same way; > 0
  double pause_s{0.5};                    ///< longest time from the switch's release to rest; 0.05 … 5

  static constexpr int kMaxDraws = 16;
};

/// The part of an excitation that a tick belongs to.
enum class ExcitationPart : std::uint8_t { kSettling, kCounted, kFading, kDone };

struct ExcitationStep {
  double x_m{0.0};  ///< offset along the axis
  ExcitationPart part{ExcitationPart::kSettling};
  int draw{0};
  int period{0};        ///< counted periods finished in this draw
  bool at_rest{false};  ///< the path is at rest, because it is paused or done
};

/// The offset along an axis over time. It consists of several multisines (draws), each with a settling period
/// and then the counted periods. From one draw x_before to the next, x_draw, the offset is cross-faded within
/// kFade_s. In the same way it begins from zero and ends at zero.
///
///     x(t) = (1 - s) x_before(t) + s x_draw(t)
///
/// s rises from 0 to 1 along a quintic in the draw's first kFade_s, and then stays 1.
///
/// The time t runs on a PausableClock. Without permission, the motion comes to rest on its path within
/// pause_s. When permission returns, it continues with a new settling period, because a period that a pause
/// has interrupted is not counted. Set-up allocates; Step does not. Same inputs, same bits.
class ExcitationPath {
 public:
  static constexpr double kFade_s = 0.5;  ///< duration of each cross-fade

  /// @throws std::invalid_argument naming the parameter, the value found and what is accepted.
  ExcitationPath(const ExcitationParams& params, double period_s);

  /// Advances by one tick. @param permitted  e.g. the enabling switch is held
  [[nodiscard]] ExcitationStep Step(bool permitted) OSTEON_RT;

  /// Duration without a pause [s].
  [[nodiscard]] double duration_s() const;
  [[nodiscard]] const std::vector<Multisine>& draws() const { return draws_; }
  /// Largest values of all draws.
  [[nodiscard]] MultisineState peak() const;
  /// Mean of the draws' RMS speeds.
  [[nodiscard]] double rms_speed_m_per_s() const;

 private:
  // Counts a tick of the present period; after the period's last tick, begins the next period or draw, or the
  // fade to zero.
  void Count() OSTEON_RT;
  [[nodiscard]] double Offset() const OSTEON_RT;

  ExcitationParams params_;
  double period_s_;
  std::vector<Multisine> draws_;
  PausableClock clock_;
  int period_ticks_;
  double t_s_{0.0};      // the path's own time
  double faded_s_{0.0};  // time since the present draw, or the final fade, began
  ExcitationPart part_{ExcitationPart::kSettling};
  int ticks_{0};         // ticks of the present period in which clock_ ran at full rate
  std::size_t draw_{0};  // index of the present draw
  int period_{0};        // counted periods finished in this draw
};

}  // namespace osteon::control
