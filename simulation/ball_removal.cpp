#include "simulation/ball_removal.h"

#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "simulation/cutting_math.h"

namespace osteon::simulation {
namespace {

/// Two capsules whose joint lies this near to the straight way are one [m]: a tenth of what single precision
/// leaves as overlap anyway.
constexpr double kCollinear_m = 1e-9;

void Check(const SplitParams& p) {
  const auto refuse = [](const char* name, auto found, const char* accepted) {
    throw std::invalid_argument(fmt::format("split: {}: found {}, accepted {}", name, found, accepted));
  };
  if (!(p.least_radius_m >= 0.0)) refuse("least radius", p.least_radius_m, "0 m and more");
  if (!(p.least_child_share >= 0.0 && p.least_child_share <= 0.5))
    refuse("least child's share", p.least_child_share, "0 … 0.5");
  if (p.pool_blocks < 1 || p.pool_blocks > 1'000'000) refuse("pool", p.pool_blocks, "1 … 1000000 blocks");
}

double Penetration(const BallState& ball, const Capsule& capsule) {
  const Vector3 q = ClosestOnSegment(ball.center_m, capsule.a, capsule.b);
  return ball.radius_m + capsule.radius_m - (ball.center_m - q).norm();
}

void Shrink(BallState& ball, std::span<const Capsule> capsules) {
  for (const Capsule& capsule : capsules) {
    if (ball.radius_m <= 0.0) return;
    ShrinkBall(ball.center_m, ball.radius_m, capsule.a, capsule.b, capsule.radius_m);
  }
}

/// Appends a capsule, or lengthens the last one where this goes straight on from it.
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

void PushFloats(const Vector3& p_m, double r_m, std::vector<float>& out) {
  for (int axis = 0; axis < 3; ++axis) out.push_back(static_cast<float>(p_m[axis] * 1e3));
  out.push_back(static_cast<float>(r_m * 1e3));
}

/// The largest ball in both of two balls.
void ShrinkInto(const BallState& ball, BallState& other) {
  const Vector3 way = ball.center_m - other.center_m;
  const double distance = way.norm(), out = distance + other.radius_m - ball.radius_m;
  if (out <= 0.0) return;
  if (out >= 2.0 * other.radius_m) {
    other.radius_m = 0.0;
    return;
  }
  other.radius_m -= 0.5 * out;
  other.center_m += 0.5 * out / distance * way;
}

BallState FromFloats(const float* four) {
  return {.center_m = 1e-3 * Vector3(four[0], four[1], four[2]), .radius_m = 1e-3 * four[3]};
}

}  // namespace

BallRemoval::BallRemoval(std::span<const BallState> parents, const SplitParams& params)
    : parents_(parents.size()), params_(params) {
  if (!params.on) return;
  Check(params);
  template_.emplace(params.children);
  block_.assign(parents_, kNone);
  std::vector<Ball> balls;
  balls.reserve(parents_);
  for (const BallState& ball : parents)
    balls.push_back({.center_m = ball.center_m, .radius_m = ball.radius_m});
  shape_ = SplitShapes(balls, params.least_radius_m);
  whole_.assign(parents.begin(), parents.end());
}

bool BallRemoval::IsTooLarge(const BallState& ball, std::span<const Capsule> capsules) const {
  if (ball.radius_m <= params_.least_radius_m) return false;
  bool touched = false;
  for (const Capsule& capsule : capsules) {
    const double p = Penetration(ball, capsule);
    if (p >= 2.0 * ball.radius_m) return false;  // it goes as a whole
    touched = touched || p > 0.0;
  }
  return touched;
}

void BallRemoval::Remove(std::span<const Capsule> capsules, std::vector<BallState>& balls) {
  if (!template_) {
    for (BallState& ball : balls) Shrink(ball, capsules);
    return;
  }
  std::size_t free =
      params_.pool_blocks - blocks_in_use();  // blocks emptied in this frame are not among them
  std::size_t may_split =
      params_.blocks_per_frame > 0 ? params_.blocks_per_frame : std::numeric_limits<std::size_t>::max();
  std::vector<Waiting> waited;
  waited.swap(waiting_);
  auto next = waited.begin();
  std::vector<std::uint32_t> emptied;

  for (std::uint32_t i = 0; i < parents_; ++i) {
    std::optional<Waiting> waiting;
    if (next != waited.end() && next->parent == i) {
      waiting = std::move(*next++);
    } else if (block_[i] == kNone) {
      const bool wanted = IsTooLarge(balls[i], capsules);
      if (wanted && free > 0) {
        --free;
        TakeBlock(i, balls);
        waiting = Waiting{.parent = i, .root = balls[i], .cuts = {}};
      } else {
        if (wanted) ++refused_;
        Shrink(balls[i], capsules);
        continue;
      }
    }
    if (waiting && may_split == 0) {
      Shrink(balls[i], capsules);
      Keep(capsules, balls[i], *waiting);
      waiting_.push_back(std::move(*waiting));
      continue;
    }
    if (waiting) {
      --may_split;
      MakeChildren(*waiting, balls);
    }
    if (!CutChildren(i, capsules, balls)) emptied.push_back(i);
  }
  for (const std::uint32_t parent : emptied) FreeBlock(parent);
}

void BallRemoval::TakeBlock(std::uint32_t parent, std::vector<BallState>& balls) {
  std::uint32_t block = 0;
  if (free_.empty()) {
    block = static_cast<std::uint32_t>(blocks_++);
    balls.resize(ChildAt(static_cast<std::uint32_t>(blocks_)));
  } else {
    block = *free_.begin();
    free_.erase(free_.begin());
  }
  block_[parent] = static_cast<std::int32_t>(block);
}

void BallRemoval::FreeBlock(std::uint32_t parent) {
  free_.insert(static_cast<std::uint32_t>(block_[parent]));
  block_[parent] = kNone;
}

std::span<BallState> BallRemoval::ChildrenOf(std::uint32_t parent, std::vector<BallState>& balls) const {
  return std::span(balls).subspan(ChildAt(static_cast<std::uint32_t>(block_[parent])), Slots());
}

// Each child as large as it may be within the template's and within what was left of the ball when it got its
// block, cut by what has hit it since.
void BallRemoval::MakeChildren(const Waiting& waiting, std::vector<BallState>& balls) const {
  int k = 0;
  for (BallState& child : ChildrenOf(waiting.parent, balls)) {
    child = TemplateChild(waiting.parent, k++);
    ShrinkInto(waiting.root, child);
    Shrink(child, waiting.cuts);
  }
  balls[waiting.parent].radius_m = 0.0;
}

bool BallRemoval::CutChildren(std::uint32_t parent, std::span<const Capsule> capsules,
                              std::vector<BallState>& balls) const {
  const double least_m = params_.least_child_share * whole_[parent].radius_m;
  bool any = false;
  for (BallState& child : ChildrenOf(parent, balls)) {
    Shrink(child, capsules);
    if (child.radius_m < least_m) child.radius_m = 0.0;
    any = any || child.radius_m > 0.0;
  }
  return any;
}

BallState BallRemoval::TemplateChild(std::uint32_t parent, int k) const {
  const SplitChild& unit = template_->child(shape_[parent], k);
  const BallState& whole = whole_[parent];
  return {.center_m = whole.center_m + whole.radius_m * unit.x, .radius_m = whole.radius_m * unit.radius};
}

void BallRemoval::Keep(std::span<const Capsule> capsules, const BallState& shrunk, Waiting& waiting) const {
  for (const Capsule& capsule : capsules)
    if (Penetration(waiting.root, capsule) > 0.0) Append(capsule, waiting.cuts);
  if (waiting.cuts.size() <= MostCuts()) return;
  // no room: what the capsules have left of the ball stands for them
  waiting.root = shrunk;
  waiting.cuts.clear();
}

void BallRemoval::Save(const std::vector<BallState>& balls, CarvedState& state) const {
  state.balls.clear();
  state.balls.reserve(4 * parents_);
  for (std::size_t i = 0; i < parents_; ++i) PushFloats(balls[i].center_m, balls[i].radius_m, state.balls);
  state.split_balls.clear();
  state.split_cuts.clear();
  state.split_slots.clear();
  if (!template_) return;
  auto waiting = waiting_.begin();
  for (std::uint32_t i = 0; i < parents_; ++i) {
    if (block_[i] == kNone) continue;
    state.split_balls.push_back(i);
    const std::size_t end = state.split_slots.size() + 4 * Slots();
    if (waiting != waiting_.end() && waiting->parent == i) {
      state.split_cuts.push_back(static_cast<std::uint32_t>(1 + waiting->cuts.size()));
      PushFloats(waiting->root.center_m, waiting->root.radius_m, state.split_slots);
      for (const Capsule& cut : waiting->cuts) {
        PushFloats(cut.a, cut.radius_m, state.split_slots);
        PushFloats(cut.b, 0.0, state.split_slots);
      }
      ++waiting;
    } else {
      state.split_cuts.push_back(0);
      const std::size_t first = ChildAt(static_cast<std::uint32_t>(block_[i]));
      for (std::size_t k = 0; k < Slots(); ++k) {
        const BallState& child = balls[first + k];
        PushFloats(child.center_m, child.radius_m, state.split_slots);
      }
    }
    state.split_slots.resize(end, 0.0f);
  }
}

std::optional<std::uint32_t> BallRemoval::SavedIndex(std::uint32_t ball) const {
  if (ball < parents_) return ball;
  const auto slots = static_cast<std::uint32_t>(Slots());
  const std::uint32_t block = (ball - static_cast<std::uint32_t>(parents_)) / slots;
  std::uint32_t before = 0;
  for (const std::int32_t other : block_) {
    if (other == static_cast<std::int32_t>(block)) return ball + slots * before - slots * block;
    if (other != kNone) ++before;
  }
  return {};
}

void BallRemoval::Load(const CarvedState& state, std::vector<BallState>& balls) {
  const std::size_t blocks = state.split_balls.size(), K = template_ ? Slots() : 0;
  if (state.balls.size() != 4 * parents_) throw std::invalid_argument("carved state: not of this bone");
  if (blocks > 0 && !template_) throw std::invalid_argument("carved state: has split balls, split is off");
  if (state.split_cuts.size() != blocks || state.split_slots.size() != 4 * K * blocks)
    throw std::invalid_argument(fmt::format("carved state: not of {} children a split ball", K));
  if (blocks > params_.pool_blocks)
    throw std::invalid_argument(
        fmt::format("carved state: found {} split balls, accepted {} at most", blocks, params_.pool_blocks));
  for (std::size_t j = 0; j < blocks; ++j)
    if (state.split_balls[j] >= parents_ || (j > 0 && state.split_balls[j] <= state.split_balls[j - 1]) ||
        state.split_cuts[j] > 1 + MostCuts())
      throw std::invalid_argument(fmt::format("carved state: split ball {} of {} is none", j, blocks));

  balls.assign(parents_ + K * blocks, BallState{});
  for (std::size_t i = 0; i < parents_; ++i) balls[i] = FromFloats(&state.balls[4 * i]);
  waiting_.clear();
  free_.clear();
  blocks_ = blocks;
  block_.assign(template_ ? parents_ : 0, kNone);
  for (std::size_t j = 0; j < blocks; ++j) {
    const std::uint32_t parent = state.split_balls[j];
    block_[parent] = static_cast<std::int32_t>(j);
    const float* slot = &state.split_slots[4 * K * j];
    if (state.split_cuts[j] == 0) {
      for (std::size_t k = 0; k < K; ++k) balls[parents_ + K * j + k] = FromFloats(slot + 4 * k);
      continue;
    }
    Waiting waiting{.parent = parent, .root = FromFloats(slot), .cuts = {}};
    for (std::uint32_t n = 1; n < state.split_cuts[j]; ++n) {
      const BallState a = FromFloats(slot += 4), b = FromFloats(slot += 4);
      waiting.cuts.push_back({.a = a.center_m, .b = b.center_m, .radius_m = a.radius_m});
    }
    waiting_.push_back(std::move(waiting));
  }
}

}  // namespace osteon::simulation
