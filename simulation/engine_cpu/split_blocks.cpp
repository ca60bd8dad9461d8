#include "simulation/engine_cpu/split_blocks.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace osteon::simulation::cpu {
namespace {

constexpr std::size_t kReservedBlocks = 65'536;  // number of split balls with memory reserved at set-up

// Returns the uncut balls, rounded to floats, from a new store.
std::vector<Ball> UncutBalls(const BoneStore& bone) {
  std::vector<Ball> balls;
  balls.reserve(bone.ball_count());
  for (std::size_t i = 0; i < bone.ball_count(); ++i) {
    const BallState ball = bone.BallAt(i);
    balls.push_back({.center_m = ball.center_m, .radius_m = ball.radius_m});
  }
  return balls;
}

}  // namespace

SplitBlocks::SplitBlocks(BoneStore& bone, const SplitParams& params)
    : bone_(bone),
      splitter_(UncutBalls(bone), params),
      stride_(static_cast<std::uint32_t>((splitter_.slots() + 7) / 8)),
      number_of_(bone.ball_count(), -1),
      first_in_cluster_(bone.ball_tree.cluster_count(), -1),
      children_(splitter_.slots()) {
  const std::size_t reserved = std::min(params.pool_blocks, kReservedBlocks);
  for (auto* list : {&parent_, &free_, &made_, &emptied_}) list->reserve(reserved);
  min_child_m_.reserve(reserved), next_in_cluster_.reserve(reserved);
  small_.reserve(8 * reserved), small_before_.reserve(8 * reserved);
  // room for the children of all balls that are split in a frame with many splits
  set_aside_.reserve(std::min<std::size_t>(reserved, 4096) * splitter_.slots());
  if (params.blocks_per_frame > 0) waiting_.reserve(reserved), waited_.reserve(reserved);
}

std::uint32_t SplitBlocks::FirstBlock(std::uint32_t number) const {
  return bone_.first_child_block() + number * stride_;
}

std::uint32_t SplitBlocks::ParentCluster(std::uint32_t number) const {
  return parent_[number] / BoxTree::kCluster;
}

// Gives a number to a parent and enters it in the list of its cluster.
void SplitBlocks::AddNumber(std::uint32_t number, std::uint32_t parent) {
  number_of_[parent] = static_cast<std::int32_t>(number);
  parent_[number] = parent;
  min_child_m_[number] = splitter_.MinChildRadius_m(parent);
  std::int32_t& first = first_in_cluster_[parent / BoxTree::kCluster];
  next_in_cluster_[number] = first;
  first = static_cast<std::int32_t>(number);
}

// Takes the smallest free number, like BallRemoval. The number only affects the order of balls that are
// equally near.
void SplitBlocks::TakeNumber(std::uint32_t parent) {
  std::uint32_t number = 0;
  if (free_.empty()) {
    number = static_cast<std::uint32_t>(parent_.size());
    parent_.push_back(parent), min_child_m_.push_back(0.0), next_in_cluster_.push_back(-1);
    bone_.SetChildBlocks(static_cast<std::uint32_t>(parent_.size()) * stride_);
  } else {
    std::pop_heap(free_.begin(), free_.end(), std::greater<>());
    number = free_.back();
    free_.pop_back();
  }
  AddNumber(number, parent);
}

void SplitBlocks::FreeNumber(std::uint32_t number) {
  const std::uint32_t parent = parent_[number];
  number_of_[parent] = -1;
  std::int32_t* at = &first_in_cluster_[parent / BoxTree::kCluster];
  while (*at != static_cast<std::int32_t>(number)) at = &next_in_cluster_[static_cast<std::size_t>(*at)];
  *at = next_in_cluster_[number];
  free_.push_back(number);
  std::push_heap(free_.begin(), free_.end(), std::greater<>());
}

void SplitBlocks::Begin(std::span<const std::uint32_t> large, std::span<const Capsule> capsules) {
  set_aside_.clear(), made_.clear(), emptied_.clear();
  std::size_t free = params().pool_blocks - InUse();  // without the blocks that this frame empties
  std::size_t may_split =
      params().blocks_per_frame > 0 ? params().blocks_per_frame : std::numeric_limits<std::size_t>::max();
  waited_.clear();
  waited_.swap(waiting_);
  // visit waiting balls and large balls together, by ascending parent
  auto next = waited_.begin();
  for (auto found = large.begin(); next != waited_.end() || found != large.end();) {
    const bool waits = next != waited_.end() && (found == large.end() || next->parent <= *found);
    const std::uint32_t parent = waits ? next->parent : *found;
    if (found != large.end() && *found == parent) ++found;
    if (waits) {
      Visit(parent, std::move(*next++), capsules, may_split);
      continue;
    }
    if (number_of_[parent] >= 0) continue;
    const BallState ball = bone_.BallAt(parent);
    if (!splitter_.ShouldSplit(ball, capsules)) continue;
    if (free == 0) {
      ++refused_;
      continue;
    }
    --free;
    TakeNumber(parent);
    Visit(parent, {.parent = parent, .root = ball}, capsules, may_split);
  }
  // take these balls out of the bone, so that the removal pass does not change them; End stores them again
  for (const auto& [ball, state] : set_aside_) bone_.Remove(ball);
}

// Visits a ball that has a number but no children: makes the children now, or lets the ball wait.
void SplitBlocks::Visit(std::uint32_t parent, WaitingBall waiting, std::span<const Capsule> capsules,
                        std::size_t& may_split) {
  if (may_split > 0) {
    --may_split;
    MakeChildren(waiting, capsules);
    return;
  }
  BallState ball = bone_.BallAt(parent);
  Shrink(ball, capsules);
  splitter_.StoreCuts(capsules, ball, waiting);
  waiting_.push_back(std::move(waiting));
  set_aside_.emplace_back(parent, ball);
}

// Replaces a parent by its children, cut by the capsules of this frame.
void SplitBlocks::MakeChildren(const WaitingBall& waiting, std::span<const Capsule> capsules) {
  const auto number = static_cast<std::uint32_t>(number_of_[waiting.parent]);
  splitter_.MakeChildren(waiting, children_);
  const bool any = splitter_.CutChildren(waiting.parent, capsules, children_);
  bone_.Remove(waiting.parent);
  const std::size_t first = FirstChild(number);
  for (std::size_t k = 0; k < children_.size(); ++k) set_aside_.emplace_back(first + k, children_[k]);
  (any ? made_ : emptied_).push_back(number);
}

// Adds the children of a block that are below their smallest radius to small_.
void SplitBlocks::NoteSmallChildren(std::uint32_t block) {
  const double min_m = min_child_m_[(block - bone_.first_child_block()) / stride_];
  for (std::size_t ball = 8 * std::size_t{block}; ball < 8 * (std::size_t{block} + 1); ++ball)
    if (const float r = bone_.RadiusOf(ball); r > 0.0f && 1e-3 * r < min_m)
      small_.push_back(static_cast<std::uint32_t>(ball));
}

// If all children of a number are gone, adds the number to the list of empty ones.
void SplitBlocks::NoteIfEmpty(std::uint32_t number) {
  const bool in_use = number_of_[parent_[number]] == static_cast<std::int32_t>(number);
  if (in_use && !bone_.AnyLeft(FirstBlock(number), FirstBlock(number) + stride_)) emptied_.push_back(number);
}

std::span<const std::uint32_t> SplitBlocks::End(std::span<const std::uint32_t> touched) {
  for (const auto& [ball, state] : set_aside_) bone_.PutBall(ball, state);
  small_before_.clear();
  small_before_.swap(small_);
  for (const std::uint32_t ball : small_before_) bone_.Remove(ball);
  const auto number_of_block = [this](std::uint32_t block) {
    return (block - bone_.first_child_block()) / stride_;
  };
  for (const std::uint32_t block : touched) NoteSmallChildren(block);
  for (const std::uint32_t number : made_)
    for (std::uint32_t b = FirstBlock(number); b < FirstBlock(number) + stride_; ++b) NoteSmallChildren(b);
  for (const std::uint32_t block : touched) NoteIfEmpty(number_of_block(block));
  for (const std::uint32_t ball : small_before_) NoteIfEmpty(number_of_block(ball / 8));
  for (const std::uint32_t number : empty_at_load_) NoteIfEmpty(number);
  empty_at_load_.clear();
  std::sort(emptied_.begin(), emptied_.end());
  emptied_.erase(std::unique(emptied_.begin(), emptied_.end()), emptied_.end());
  for (const std::uint32_t number : emptied_) FreeNumber(number);
  std::sort(made_.begin(), made_.end());
  return made_;
}

}  // namespace osteon::simulation::cpu
