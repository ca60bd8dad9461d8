#include "simulation/packing/ball_grid.h"

#include <algorithm>
#include <cmath>

namespace osteon::simulation {

std::array<std::int64_t, 3> BallGrid::CellOf(const Octave& octave, const Vector3& p_m) const {
  const Vector3 at = (p_m - origin_m_) / octave.cell_m;
  return {static_cast<std::int64_t>(std::floor(at.x())), static_cast<std::int64_t>(std::floor(at.y())),
          static_cast<std::int64_t>(std::floor(at.z()))};
}

std::uint64_t BallGrid::Key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kHalf = 1 << 20;
  constexpr std::uint64_t kMask = (1 << 21) - 1;
  return (static_cast<std::uint64_t>(x + kHalf) & kMask) << 42 |
         (static_cast<std::uint64_t>(y + kHalf) & kMask) << 21 |
         (static_cast<std::uint64_t>(z + kHalf) & kMask);
}

std::size_t BallGrid::Slot(const Octave& octave, std::uint64_t key) {
  const std::size_t mask = octave.keys.size() - 1;
  // Fibonacci hashing: the high bits of the product depend on all bits of the key
  std::uint64_t bits = key * 0x9e3779b97f4a7c15ULL;
  std::size_t slot = static_cast<std::size_t>(bits >> 24) & mask;
  while (octave.keys[slot] != key && octave.keys[slot] != kNoKey) slot = (slot + 1) & mask;
  return slot;
}

void BallGrid::Grow(Octave& octave) {
  const std::vector<std::uint64_t> keys = std::move(octave.keys);
  const std::vector<std::uint32_t> heads = std::move(octave.heads);
  const std::size_t size = std::max<std::size_t>(256, 2 * keys.size());
  octave.keys.assign(size, kNoKey);
  octave.heads.assign(size, kNoBall);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i] == kNoKey) continue;
    const std::size_t slot = Slot(octave, keys[i]);
    octave.keys[slot] = keys[i];
    octave.heads[slot] = heads[i];
  }
}

void BallGrid::Insert(const Ball& ball) {
  // find the octave of the radius, or add it
  int exponent = 0;
  std::frexp(ball.radius_m, &exponent);
  auto octave = std::find_if(octaves_.begin(), octaves_.end(),
                             [exponent](const Octave& o) { return o.exponent <= exponent; });
  if (octave == octaves_.end() || octave->exponent != exponent) {
    octave = octaves_.insert(octave, Octave{});
    octave->exponent = exponent;
    octave->cell_m = std::ldexp(4.0, exponent);
    Grow(*octave);
  }
  const auto index = static_cast<std::uint32_t>(balls_.size());
  balls_.push_back(ball);
  if (2 * (octave->cells + 1) > octave->keys.size()) Grow(*octave);
  const auto [x, y, z] = CellOf(*octave, ball.center_m);
  const std::uint64_t key = Key(x, y, z);
  const std::size_t slot = Slot(*octave, key);
  if (octave->keys[slot] == kNoKey) {
    octave->keys[slot] = key;
    ++octave->cells;
  }
  next_.push_back(octave->heads[slot]);
  octave->heads[slot] = index;
  octave->balls.push_back(index);
}

template <typename Visit>
void BallGrid::VisitNear(const Vector3& p_m, double reach_m, const Visit& visit) const {
  const auto visit_if_near = [&](const Ball& ball) {
    const double x = ball.center_m.x - p_m.x(), y = ball.center_m.y - p_m.y(), z = ball.center_m.z - p_m.z();
    const double squared = x * x + y * y + z * z, within = ball.radius_m + reach_m;
    if (squared < within * within) visit(ball, std::sqrt(squared) - ball.radius_m);
  };
  for (const Octave& octave : octaves_) {
    // a ball of this octave that comes within reach has its centre in this box of cells
    const Vector3 span = Vector3::Constant(reach_m + std::ldexp(1.0, octave.exponent));
    const auto low = CellOf(octave, p_m - span), high = CellOf(octave, p_m + span);
    double cells = 1.0;
    for (int axis = 0; axis < 3; ++axis) cells *= static_cast<double>(high[axis] - low[axis] + 1);
    if (octave.balls.size() <= kFewBalls || cells > static_cast<double>(octave.balls.size())) {
      for (const std::uint32_t i : octave.balls) visit_if_near(balls_[i]);
      continue;
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z)
          for (std::uint32_t i = octave.heads[Slot(octave, Key(x, y, z))]; i != kNoBall; i = next_[i])
            visit_if_near(balls_[i]);
  }
}

void BallGrid::Gather(const Vector3& p_m, double reach_m, std::vector<Ball>& found) const {
  VisitNear(p_m, reach_m, [&found](const Ball& ball, double) { found.push_back(ball); });
}

double BallGrid::Clearance(const Vector3& p_m, double reach_m) const {
  double clearance = reach_m;
  VisitNear(p_m, reach_m, [&clearance](const Ball&, double gap) { clearance = std::min(clearance, gap); });
  return clearance;
}

}  // namespace osteon::simulation
