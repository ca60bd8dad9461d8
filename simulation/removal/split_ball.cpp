#include "simulation/removal/split_ball.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "simulation/contact/cutting_math.h"

namespace osteon::simulation {
namespace {

/// Two consecutive capsules are joined into one if the point where they meet lies within this distance of the
/// straight line between their outer ends [m]. This is the rounding error of single precision 30 mm from the
/// origin. Children may overlap the sweep by this distance.
constexpr double kCollinear_m = 2e-8;

/// @throws std::invalid_argument naming the value that is not accepted.
const SplitParams& Checked(const SplitParams& p) {
  const auto refuse = [](const char* name, auto found, const char* accepted) {
    throw std::invalid_argument(fmt::format("split: {}: found {}, accepted {}", name, found, accepted));
  };
  if (!(p.min_radius_m >= 0.0)) refuse("least radius", p.min_radius_m, "0 m and more");
  if (!(p.min_child_share >= 0.0 && p.min_child_share <= 0.5))
    refuse("least child's share", p.min_child_share, "0 … 0.5");
  if (p.pool_blocks < 1 || p.pool_blocks > 1'000'000) refuse("pool", p.pool_blocks, "1 … 1000000 blocks");
  return p;
}

/// Depth by which a ball reaches into a capsule [m]; negative: the gap between them.
double Penetration(const BallState& ball, const Capsule& capsule) {
  const Vector3 q = ClosestOnSegment(ball.center_m, capsule.a, capsule.b);
  return ball.radius_m + capsule.radius_m - (ball.center_m - q).norm();
}

/// Appends a capsule to the list. If `next` continues the last capsule in a straight line, the last one is
/// lengthened instead.
void Append(const Capsule& next, std::vector<Capsule>& list) {
  if (!list.empty()) {
    Capsule& last = list.back();
    const Vector3 bend = last.b - ClosestOnSegment(last.b, last.a, next.b);
    if (last.radius_m == next.radius_m && (next.a - last.b).norm() <= kCollinear_m &&
        bend.norm() <= kCollinear_m) {
      last.b = next.b;
      return;
    }
  }
  list.push_back(next);
}

/// Shrinks `other` to the largest ball within both balls.
void ShrinkInto(const BallState& ball, BallState& other) {
  const Vector3 towards_ball = ball.center_m - other.center_m;
  const double distance = towards_ball.norm(), out = distance + other.radius_m - ball.radius_m;
  if (out <= 0.0) return;
  if (out >= 2.0 * other.radius_m) {
    other.radius_m = 0.0;
    return;
  }
  other.radius_m -= 0.5 * out;
  other.center_m += 0.5 * out / distance * towards_ball;
}

/// Stores centre and radius as four floats, in millimetres.
void ToFloats(const Vector3& p_m, double r_m, float* four) {
  for (int axis = 0; axis < 3; ++axis) four[axis] = static_cast<float>(p_m[axis] * 1e3);
  four[3] = static_cast<float>(r_m * 1e3);
}

BallState FromFloats(const float* four) {
  return {.center_m = 1e-3 * Vector3(four[0], four[1], four[2]), .radius_m = 1e-3 * four[3]};
}

}  // namespace

BallState RoundToStored(const BallState& ball) {
  float four[4];
  ToFloats(ball.center_m, ball.radius_m, four);
  // volatile, because GCC 12.2 at -O3 optimises the rounding away if it sees both conversions
  const volatile float* rounded = four;
  const float read[4] = {rounded[0], rounded[1], rounded[2], rounded[3]};
  return FromFloats(read);
}

void Shrink(BallState& ball, std::span<const Capsule> capsules) {
  for (const Capsule& capsule : capsules) {
    if (ball.radius_m <= 0.0) return;
    ShrinkBall(ball.center_m, ball.radius_m, capsule.a, capsule.b, capsule.radius_m);
  }
}

BallSplitter::BallSplitter(std::vector<Ball> uncut, const SplitParams& params)
    : params_(Checked(params)),
      template_(params.children),
      uncut_(std::move(uncut)),
      shape_(SplitShapes(uncut_, params.min_radius_m)) {}

bool BallSplitter::ShouldSplit(const BallState& ball, std::span<const Capsule> capsules) const {
  if (ball.radius_m <= params_.min_radius_m) return false;
  bool touched = false;
  for (const Capsule& capsule : capsules) {
    const double p = Penetration(ball, capsule);
    if (p >= 2.0 * ball.radius_m) return false;  // the capsule removes the whole ball
    touched = touched || p > 0.0;
  }
  return touched;
}

void BallSplitter::MakeChildren(const WaitingBall& waiting, std::span<BallState> children) const {
  const Ball& whole = uncut_[waiting.parent];
  int k = 0;
  for (BallState& child : children) {
    const SplitChild& unit = template_.child(shape_[waiting.parent], k++);
    child = {.center_m = Vector3(whole.center_m) + whole.radius_m * unit.x,
             .radius_m = whole.radius_m * unit.radius};
    ShrinkInto(waiting.root, child);
    Shrink(child, waiting.cuts);
  }
}

bool BallSplitter::CutChildren(std::uint32_t parent, std::span<const Capsule> capsules,
                               std::span<BallState> children) const {
  const double min_m = MinChildRadius_m(parent);
  bool any = false;
  for (BallState& child : children) {
    Shrink(child, capsules);
    if (child.radius_m < min_m) child.radius_m = 0.0;
    any = any || child.radius_m > 0.0;
  }
  return any;
}

void BallSplitter::StoreCuts(std::span<const Capsule> capsules, const BallState& shrunk,
                             WaitingBall& waiting) const {
  for (const Capsule& capsule : capsules)
    if (Penetration(waiting.root, capsule) > 0.0) Append(capsule, waiting.cuts);
  if (waiting.cuts.size() <= MaxCuts()) return;
  waiting.root = shrunk;
  waiting.cuts.clear();
}

void BallSplitter::Save(const WaitingBall& waiting, std::span<float> block) const {
  std::ranges::fill(block, 0.0f);
  float* slot = block.data();
  ToFloats(waiting.root.center_m, waiting.root.radius_m, slot);
  for (const Capsule& cut : waiting.cuts) {
    ToFloats(cut.a, cut.radius_m, slot += 4);
    ToFloats(cut.b, 0.0, slot += 4);
  }
}

void BallSplitter::Save(std::span<const BallState> children, std::span<float> block) {
  for (std::size_t k = 0; k < children.size(); ++k)
    ToFloats(children[k].center_m, children[k].radius_m, &block[4 * k]);
}

WaitingBall BallSplitter::LoadWaiting(std::uint32_t parent, std::uint32_t cuts,
                                      std::span<const float> block) {
  const float* slot = block.data();
  WaitingBall waiting{.parent = parent, .root = FromFloats(slot)};
  for (std::uint32_t n = 1; n < cuts; ++n) {
    const BallState a = FromFloats(slot += 4), b = FromFloats(slot += 4);
    waiting.cuts.push_back({.a = a.center_m, .b = b.center_m, .radius_m = a.radius_m});
  }
  return waiting;
}

void BallSplitter::Load(std::span<const float> block, std::span<BallState> children) {
  for (std::size_t k = 0; k < children.size(); ++k) children[k] = FromFloats(&block[4 * k]);
}

void BallSplitter::CheckState(const CarvedState& state) const {
  const std::size_t blocks = state.split_balls.size();
  if (state.split_cuts.size() != blocks || state.split_slots.size() != 4 * slots() * blocks)
    throw std::invalid_argument(fmt::format("carved state: not of {} children a split ball", slots()));
  if (blocks > params_.pool_blocks)
    throw std::invalid_argument(
        fmt::format("carved state: found {} split balls, accepted {} at most", blocks, params_.pool_blocks));
  for (std::size_t j = 0; j < blocks; ++j)
    if (state.split_balls[j] >= uncut_.size() ||
        (j > 0 && state.split_balls[j] <= state.split_balls[j - 1]) || state.split_cuts[j] > 1 + MaxCuts())
      throw std::invalid_argument(fmt::format("carved state: split ball {} of {} is none", j, blocks));
}

}  // namespace osteon::simulation
