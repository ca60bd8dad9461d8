#include "simulation/removal/ball_removal.h"

#include <limits>
#include <stdexcept>
#include <utility>

namespace osteon::simulation {

BallRemoval::BallRemoval(std::span<const BallState> parents, const SplitParams& params)
    : parents_(parents.size()) {
  if (!params.on) return;
  std::vector<Ball> uncut;
  uncut.reserve(parents_);
  for (const BallState& ball : parents)
    uncut.push_back({.center_m = ball.center_m, .radius_m = ball.radius_m});
  splitter_.emplace(std::move(uncut), params);
  block_.assign(parents_, kNone);
}

void BallRemoval::Remove(std::span<const Capsule> capsules, std::vector<BallState>& balls) {
  if (!splitter_) {
    for (BallState& ball : balls) Shrink(ball, capsules);
    return;
  }
  const SplitParams& params = splitter_->params();
  // blocks that are emptied in this frame are only free from the next frame on
  std::size_t free_blocks = params.pool_blocks - blocks_in_use();
  std::size_t splits_left =
      params.blocks_per_frame > 0 ? params.blocks_per_frame : std::numeric_limits<std::size_t>::max();
  std::vector<WaitingBall> waited_before;
  waited_before.swap(waiting_);
  auto next = waited_before.begin();
  std::vector<std::uint32_t> emptied;

  // for each parent: shrink the ball, or let it wait for its children, or make and cut its children
  for (std::uint32_t i = 0; i < parents_; ++i) {
    std::optional<WaitingBall> waiting;
    if (next != waited_before.end() && next->parent == i) {
      waiting = std::move(*next++);
    } else if (block_[i] == kNone) {
      const bool wanted = splitter_->ShouldSplit(balls[i], capsules);
      if (wanted && free_blocks > 0) {
        --free_blocks;
        TakeBlock(i, balls);
        waiting = WaitingBall{.parent = i, .root = balls[i]};
      } else {
        if (wanted) ++refused_;
        Shrink(balls[i], capsules);
        continue;
      }
    }
    if (waiting && splits_left == 0) {
      Shrink(balls[i], capsules);
      splitter_->StoreCuts(capsules, balls[i], *waiting);
      waiting_.push_back(std::move(*waiting));
      continue;
    }
    if (waiting) {
      --splits_left;
      splitter_->MakeChildren(*waiting, ChildrenOf(i, balls));
      balls[i].radius_m = 0.0;
    }
    if (!splitter_->CutChildren(i, capsules, ChildrenOf(i, balls))) emptied.push_back(i);
  }
  for (const std::uint32_t parent : emptied) FreeBlock(parent);
}

void BallRemoval::TakeBlock(std::uint32_t parent, std::vector<BallState>& balls) {
  std::uint32_t block = 0;
  if (free_.empty()) {
    block = static_cast<std::uint32_t>(blocks_++);
    balls.resize(ChildAt(blocks_));
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

void BallRemoval::Save(const std::vector<BallState>& balls, CarvedState& state) const {
  state.balls.resize(4 * parents_);
  BallSplitter::Save(std::span(balls).first(parents_), state.balls);
  state.split_balls.clear();
  state.split_cuts.clear();
  state.split_slots.clear();
  if (!splitter_) return;
  const std::size_t slots = splitter_->slots();
  auto waiting = waiting_.begin();
  for (std::uint32_t i = 0; i < parents_; ++i) {
    if (block_[i] == kNone) continue;
    state.split_balls.push_back(i);
    state.split_slots.resize(state.split_slots.size() + 4 * slots);
    const std::span<float> block = std::span(state.split_slots).last(4 * slots);
    // split_cuts: 0 if the block holds children; 1 + number of stored capsules if the ball waits for its
    // children
    if (waiting != waiting_.end() && waiting->parent == i) {
      state.split_cuts.push_back(static_cast<std::uint32_t>(1 + waiting->cuts.size()));
      splitter_->Save(*waiting++, block);
    } else {
      state.split_cuts.push_back(0);
      BallSplitter::Save(std::span(balls).subspan(ChildAt(static_cast<std::size_t>(block_[i])), slots),
                         block);
    }
  }
}

std::optional<std::uint32_t> BallRemoval::SavedIndex(std::uint32_t ball) const {
  if (ball < parents_) return ball;
  const auto slots = static_cast<std::uint32_t>(splitter_->slots());
  const std::uint32_t block = (ball - static_cast<std::uint32_t>(parents_)) / slots;
  std::uint32_t blocks_before = 0;
  for (const std::int32_t other : block_) {
    if (other == static_cast<std::int32_t>(block)) return ball + slots * blocks_before - slots * block;
    if (other != kNone) ++blocks_before;
  }
  return {};
}

void BallRemoval::Load(const CarvedState& state, std::vector<BallState>& balls) {
  if (state.balls.size() != 4 * parents_) throw std::invalid_argument("carved state: not of this bone");
  if (splitter_)
    splitter_->CheckState(state);
  else if (!state.split_balls.empty())
    throw std::invalid_argument("carved state: has split balls, split is off");

  const std::size_t blocks = state.split_balls.size(), slots = splitter_ ? splitter_->slots() : 0;
  balls.assign(parents_ + slots * blocks, BallState{});
  BallSplitter::Load(state.balls, std::span(balls).first(parents_));
  waiting_.clear();
  free_.clear();
  blocks_ = blocks;
  block_.assign(splitter_ ? parents_ : 0, kNone);
  for (std::size_t j = 0; j < blocks; ++j) {
    const std::uint32_t parent = state.split_balls[j];
    block_[parent] = static_cast<std::int32_t>(j);
    const auto block = std::span(state.split_slots).subspan(4 * slots * j, 4 * slots);
    if (state.split_cuts[j] == 0)
      BallSplitter::Load(block, ChildrenOf(parent, balls));
    else
      waiting_.push_back(BallSplitter::LoadWaiting(parent, state.split_cuts[j], block));
  }
}

}  // namespace osteon::simulation
