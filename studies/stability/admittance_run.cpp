#include "studies/stability/admittance_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace osteon::studies {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDied = 1e-9;  // a motion below this share of the largest motion is only rounding
// The motion counts as growing if the wall's force changes by more than this share of the preload. A tool
// that leaves the wall is no longer on a linear spring.
constexpr double kOutgrown = 0.5;
// Without a wall, the motion counts as growing if it gets this large; its initial velocity was 0.1 mm/s.
constexpr double kFarFree_m = 0.1;

// Growth of |x| over a run's second half. An oscillation is measured from its first to its last turning
// point, a motion without turning points from the middle to the end of the run.
class Envelope {
 public:
  explicit Envelope(int ticks) : middle_(ticks / 2), end_(ticks - 1) {}

  void Add(int tick, double x) {
    const double size = std::abs(x);
    max_size_ = std::max(max_size_, size);
    if (tick == middle_) first_ = {tick, size};
    if (tick == end_) last_ = {tick, size};
    if (tick > middle_ && last_size_ > second_last_size_ && last_size_ >= size) {
      if (turns_++ == 0) first_turn_ = {tick - 1, last_size_};
      last_turn_ = {tick - 1, last_size_};
    }
    second_last_size_ = std::exchange(last_size_, size);
  }
  // Logarithm of the growth per tick; -infinity if the motion has died out.
  [[nodiscard]] double Growth() const {
    const auto [from, to] = turns_ >= 2 ? std::pair(first_turn_, last_turn_) : std::pair(first_, last_);
    if (!(to.size > kDied * max_size_)) return -kInfinity;
    return std::log(to.size / from.size) / (to.tick - from.tick);
  }

 private:
  struct Point {
    int tick{0};
    double size{0.0};
  };
  int middle_, end_, turns_{0};
  double last_size_{0.0}, second_last_size_{0.0}, max_size_{0.0};
  Point first_, last_, first_turn_, last_turn_;  // middle and end of the run; turning points between them
};

}  // namespace

double SimulatedGrowth(const AdmittanceRunParams& params) {
  AdmittanceAxis axis(params);
  const bool wall = params.loop.wall.stiffness_N_per_m > 0.0;
  const int ticks = static_cast<int>(params.seconds / params.loop.period_s);
  Envelope envelope(ticks);
  double x_m = 0.0;
  for (int k = 0; k < ticks; ++k) {
    if (!wall && std::abs(x_m) > kFarFree_m) return kInfinity;
    const AxisTick tick = axis.Step();
    if (wall && std::abs(tick.wall_N - params.preload_N) > kOutgrown * params.preload_N) return kInfinity;
    if (!tick.valid) return kInfinity;
    x_m = tick.x_m;
    envelope.Add(k, x_m);
  }
  return envelope.Growth();
}

hil::Boundary SimulatedMaxWallStiffness(AdmittanceRunParams params, const hil::BoundaryScan& scan) {
  return hil::FirstCrossing(
      [&](double stiffness) {
        params.loop.wall.stiffness_N_per_m = stiffness;
        return SimulatedGrowth(params) < 0.0;
      },
      scan);
}

}  // namespace osteon::studies
