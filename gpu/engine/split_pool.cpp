#include "gpu/engine/split_pool.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace osteon::gpu {
namespace {

using simulation::BallSplitter;
using simulation::BallState;

// ToState converts the device's ball [mm] to a state [m]; ToBall converts back.
BallState ToState(const vec4& ball) {
  return {.center_m = 1e-3 * Vector3(ball.x, ball.y, ball.z), .radius_m = 1e-3 * ball.w};
}
vec4 ToBall(const BallState& state) {
  const Vector3 c = 1e3 * state.center_m;
  return {static_cast<float>(c.x()), static_cast<float>(c.y()), static_cast<float>(c.z()),
          static_cast<float>(1e3 * state.radius_m)};
}

}  // namespace

SplitPool::SplitPool(const std::vector<simulation::Ball>& uncut, const simulation::SplitParams& params)
    : splitter_(uncut, params),
      parents_(uncut.size()),
      first_((uncut.size() + kGroupSize - 1) / kGroupSize * kGroupSize),
      block_(uncut.size(), -1),
      blocks_of_cluster_(first_ / kGroupSize) {
  if (splitter_.slots() > kGroupSize)
    throw std::invalid_argument("split: children: found " + std::to_string(splitter_.slots()) +
                                ", accepted 8 … 64 on a Vulkan device");
}

uint SplitPool::TakeBlock(std::uint32_t parent) {
  uint block = static_cast<uint>(parent_.size());
  if (free_.empty()) {
    parent_.push_back(parent);
  } else {
    block = *free_.begin();
    free_.erase(free_.begin());
    parent_[block] = parent;
  }
  block_[parent] = static_cast<std::int32_t>(block);
  in_use_.insert(block);
  blocks_of_cluster_[parent / kGroupSize].push_back(block);
  return block;
}

void SplitPool::FreeBlock(uint block) {
  const std::uint32_t parent = parent_[block];
  block_[parent] = -1;
  in_use_.erase(block);
  free_.insert(block);
  std::erase(blocks_of_cluster_[parent / kGroupSize], block);
}

void SplitPool::EndFrame(std::span<const SplitEvent> events, std::span<const simulation::Capsule> capsules) {
  std::vector<SplitEvent> sorted;
  for (const SplitEvent& event : events) {
    if (event.index >= kEmptiedBlock)
      emptied_.push_back(event.index - kEmptiedBlock);
    else
      sorted.push_back(event);
  }
  std::ranges::sort(sorted, {}, &SplitEvent::index);
  std::size_t free = params().pool_blocks - in_use_.size();
  std::size_t splits_left =
      params().blocks_per_frame > 0 ? params().blocks_per_frame : std::numeric_limits<std::size_t>::max();

  // Serve waiting balls and new requests in ascending order of the parent balls' indices. A ball that already
  // waits may request again; the request then only updates the ball's present state.
  std::vector<Waiting> waited;
  waited.swap(waiting_);
  auto next = waited.begin();
  auto request = sorted.begin();
  std::vector<BallState> children(splitter_.slots());
  while (next != waited.end() || request != sorted.end()) {
    std::optional<Waiting> waiting;
    const bool has_waiting =
        next != waited.end() && (request == sorted.end() || next->ball.parent <= request->index);
    const bool has_request = request != sorted.end() && (!has_waiting || request->index == next->ball.parent);
    if (has_waiting) {
      waiting = std::move(*next++);
    } else if (free > 0) {
      --free;
      waiting = Waiting{.ball = {.parent = request->index, .root = ToState(request->before)}, .now = {}};
      TakeBlock(request->index);
    } else {
      ++refused_;
    }
    if (waiting && has_request) waiting->now = ToState(request->after);
    if (has_request) ++request;
    if (!waiting) continue;
    const std::uint32_t parent = waiting->ball.parent;
    if (splits_left == 0) {  // the ball waits, and keeps this frame's cuts for its children
      splitter_.StoreCuts(capsules, waiting->now, waiting->ball);
      waiting_.push_back(std::move(*waiting));
      continue;
    }
    --splits_left;
    splitter_.MakeChildren(waiting->ball, children);
    splitter_.CutChildren(parent, capsules, children);
    const auto block = static_cast<uint>(block_[parent]);
    std::size_t live = 0;  // number of children that remain after the cuts
    uploads_.push_back({.index = parent, .ball = {0, 0, 0, 0}});  // removes the parent
    for (std::size_t k = 0; k < kGroupSize; ++k) {
      const BallState child = k < children.size() ? children[k] : BallState{};
      uploads_.push_back(
          {.index = static_cast<uint>(first_ + block * kGroupSize + k), .ball = ToBall(child)});
      if (child.radius_m > 0.0) ++live;
    }
    uploads_.push_back({.index = static_cast<uint>(ball_count() + block),
                        .ball = {MinChildRadius_mm(parent), static_cast<float>(live), 0, 0}});
    if (live == 0) emptied_.push_back(block);
  }
  for (const uint block : emptied_) FreeBlock(block);
  emptied_.clear();
}

void SplitPool::Save(std::span<const vec4> balls, simulation::CarvedState& state) const {
  const std::size_t slots = splitter_.slots();
  state.balls.resize(4 * parents_);
  std::copy_n(&balls[0].x, 4 * parents_, state.balls.begin());
  auto waiting = waiting_.begin();
  for (std::uint32_t i = 0; i < parents_; ++i) {
    if (block_[i] < 0) continue;
    state.split_balls.push_back(i);
    state.split_slots.resize(state.split_slots.size() + 4 * slots);
    const std::span<float> block = std::span(state.split_slots).last(4 * slots);
    if (waiting != waiting_.end() && waiting->ball.parent == i) {
      state.split_cuts.push_back(static_cast<std::uint32_t>(1 + waiting->ball.cuts.size()));
      splitter_.Save((waiting++)->ball, block);
    } else {
      state.split_cuts.push_back(0);
      std::copy_n(&balls[first_ + static_cast<std::size_t>(block_[i]) * kGroupSize].x, 4 * slots,
                  block.begin());
    }
  }
}

SplitPool::DeviceState SplitPool::Load(const simulation::CarvedState& state) {
  splitter_.CheckState(state);
  const std::size_t slots = splitter_.slots();
  std::ranges::fill(block_, -1);
  for (std::vector<uint>& of_cluster : blocks_of_cluster_) of_cluster.clear();
  parent_.clear();
  free_.clear();
  in_use_.clear();
  emptied_.clear();
  waiting_.clear();
  uploads_.clear();
  DeviceState loaded{.balls = std::vector<vec4>(ball_count(), vec4{0, 0, 0, 0}),
                     .blocks = std::vector<Block>(block_count(), Block{.min_mm = 0, .live = 0})};
  std::vector<vec4>& balls = loaded.balls;
  std::copy_n(state.balls.begin(), 4 * parents_, &balls[0].x);
  for (std::size_t j = 0; j < state.split_balls.size(); ++j) {
    const std::uint32_t parent = state.split_balls[j];
    const uint block = TakeBlock(parent);
    const auto saved = std::span(state.split_slots).subspan(4 * slots * j, 4 * slots);
    Block& record = loaded.blocks[block];
    record.min_mm = MinChildRadius_mm(parent);
    if (state.split_cuts[j] > 0) {
      waiting_.push_back({.ball = BallSplitter::LoadWaiting(parent, state.split_cuts[j], saved),
                          .now = ToState(balls[parent])});
      continue;
    }
    std::copy_n(saved.begin(), 4 * slots, &balls[first_ + block * kGroupSize].x);
    for (std::size_t k = 0; k < slots; ++k) record.live += saved[4 * k + 3] > 0.0f ? 1 : 0;
    if (record.live == 0) emptied_.push_back(block);
  }
  return loaded;
}

void SplitPool::ToSaved(simulation::ContactMemory& contact) const {
  const int count = std::exchange(contact.pair_count, 0), held = std::exchange(contact.held_count, 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    simulation::ContactPair pair = contact.pairs[i];
    if (pair.bone_ball >= first_) {
      // The ball is a child. A saved state stores the blocks in the order of their parents, so the block's
      // position there is the number of used blocks with a smaller parent index.
      const uint place = pair.bone_ball - static_cast<uint>(first_), block = place / kGroupSize;
      if (!in_use_.contains(block)) continue;
      const auto rank =
          std::ranges::count_if(in_use_, [&](uint other) { return parent_[other] < parent_[block]; });
      pair.bone_ball = static_cast<uint>(parents_ + static_cast<std::size_t>(rank) * splitter_.slots() +
                                         place % kGroupSize);
    }
    contact.pairs[static_cast<std::size_t>(contact.pair_count++)] = pair;
    if (i < static_cast<std::size_t>(held)) ++contact.held_count;
  }
}

void SplitPool::FromSaved(simulation::ContactMemory& contact) const {
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact.pair_count); ++i) {
    std::uint32_t& ball = contact.pairs[i].bone_ball;
    if (ball < parents_) continue;
    // the ball is a child: Load has assigned block k to the k-th split parent
    const std::size_t place = ball - parents_;
    ball = static_cast<uint>(first_ + place / splitter_.slots() * kGroupSize + place % splitter_.slots());
  }
}

}  // namespace osteon::gpu
