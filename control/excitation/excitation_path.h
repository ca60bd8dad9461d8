#pragma once

#include <cstdint>
#include <vector>

#include "base/marker.h"
#include "control/excitation/multisine.h"
#include "control/setup/pausable_clock.h"

namespace osteon::control {

struct ExcitationParams {
  std::uint64_t seed{1};            ///< draw d has seed + d
  int draws{4};                     ///< 1 … kMaxDraws; different phases
  int periods{3};                   ///< counted periods per draw, 1 … 100; one settling period comes before
  double peak_speed_m_per_s{0.05};  ///< > 0
  double max_travel_m{0.004};       ///< largest offset: if needed, all amplitudes are reduced; > 0
  double max_acceleration_m_per_s2{8.0};  ///< likewise; > 0
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
  bool at_rest{false};  ///< the path is paused or done, and stands
};

/// The offset along an axis over time. Each draw has a settling period and then the counted periods. The
/// offset is cross-faded from draw to draw within kFade_s, and likewise from zero at the beginning and to
/// zero at the end.
///
///     x(t) = (1 - s) x_before(t) + s x_draw(t)          s = quintic of the draw's first kFade_s
///
/// The time t runs on a PausableClock: without permission the motion comes to rest on its way within pause_s.
/// With permission again it goes on, and a new settling period begins, because periods cut by a pause do not
/// count. Set-up allocates; Step does not. Same inputs, same bits.
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
  void Count() OSTEON_RT;
  [[nodiscard]] double Offset() const OSTEON_RT;

  ExcitationParams params_;
  double period_s_;
  std::vector<Multisine> draws_;
  PausableClock clock_;
  int period_ticks_;
  double t_s_{0.0};      // the path's own time
  double faded_s_{0.0};  // since the present draw, or the end's fade, began
  ExcitationPart part_{ExcitationPart::kSettling};
  int ticks_{0};         // at full rate, in the present period
  std::size_t draw_{0};  // index of the present draw
  int period_{0};        // counted periods finished in this draw
};

}  // namespace osteon::control
