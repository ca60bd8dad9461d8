#include <algorithm>
#include <utility>

#include "simulation/engine_cpu/split_blocks.h"

// Saves split balls to a carved state, and loads them from it.

namespace osteon::simulation::cpu {

void SplitBlocks::Save(CarvedState& state) const {
  const std::size_t slots = splitter_.slots();
  auto waiting = waiting_.begin();
  for (std::uint32_t parent = 0; parent < number_of_.size(); ++parent) {
    if (number_of_[parent] < 0) continue;
    state.split_balls.push_back(parent);
    state.split_slots.resize(state.split_slots.size() + 4 * slots);
    const std::span<float> block = std::span(state.split_slots).last(4 * slots);
    if (waiting != waiting_.end() && waiting->parent == parent) {
      state.split_cuts.push_back(static_cast<std::uint32_t>(1 + waiting->cuts.size()));
      splitter_.Save(*waiting++, block);
      continue;
    }
    state.split_cuts.push_back(0);
    const std::size_t first = FirstChild(static_cast<std::uint32_t>(number_of_[parent]));
    for (std::size_t k = 0; k < slots; ++k) bone_.ReadFloats(first + k, &block[4 * k]);
  }
}

// Gives the split balls the numbers 0, 1, … in the order of the state.
void SplitBlocks::Load(const CarvedState& state) {
  std::ranges::fill(number_of_, -1);
  std::ranges::fill(first_in_cluster_, -1);
  for (auto* list : {&parent_, &free_, &small_, &empty_at_load_}) list->clear();
  min_child_m_.clear(), next_in_cluster_.clear(), waiting_.clear();
  const std::size_t slots = splitter_.slots(), count = state.split_balls.size();
  parent_.resize(count), min_child_m_.resize(count), next_in_cluster_.resize(count);
  bone_.SetChildBlocks(0);
  bone_.SetChildBlocks(static_cast<std::uint32_t>(count) * stride_);
  for (std::uint32_t number = 0; number < count; ++number) {
    const std::uint32_t parent = state.split_balls[number];
    AddNumber(number, parent);
    const auto block = std::span(state.split_slots).subspan(4 * slots * number, 4 * slots);
    if (state.split_cuts[number] != 0) {
      waiting_.push_back(BallSplitter::LoadWaiting(parent, state.split_cuts[number], block));
      continue;
    }
    for (std::size_t k = 0; k < slots; ++k) bone_.WriteFloats(FirstChild(number) + k, &block[4 * k]);
    for (std::uint32_t b = FirstBlock(number); b < FirstBlock(number) + stride_; ++b) NoteSmallChildren(b);
    if (!bone_.AnyLeft(FirstBlock(number), FirstBlock(number) + stride_)) empty_at_load_.push_back(number);
  }
}

// In a saved state, balls are counted in this order: the bone's balls, then the slots of all split balls by
// rising parent. Pairs whose ball is not saved are removed.
void SplitBlocks::ToSaved(ContactMemory& contact) const {
  const std::int32_t count = std::exchange(contact.pair_count, 0),
                     held = std::exchange(contact.held_count, 0);
  const std::uint32_t first_child = 8 * bone_.first_child_block();
  for (std::int32_t i = 0; i < count; ++i) {
    ContactPair pair = contact.pairs[static_cast<std::size_t>(i)];
    if (pair.bone_ball >= first_child) {
      const std::uint32_t child = pair.bone_ball - first_child, number = child / (8 * stride_);
      const std::uint32_t parent = parent_[number];
      if (number_of_[parent] != static_cast<std::int32_t>(number)) continue;  // the block is free now
      const auto before = std::count_if(number_of_.begin(), number_of_.begin() + parent,
                                        [](std::int32_t other) { return other >= 0; });
      pair.bone_ball = static_cast<std::uint32_t>(
          bone_.ball_count() + static_cast<std::size_t>(before) * splitter_.slots() + child % (8 * stride_));
    }
    contact.pairs[static_cast<std::size_t>(contact.pair_count++)] = pair;
    if (i < held) ++contact.held_count;
  }
}

void SplitBlocks::FromSaved(ContactMemory& contact) const {
  for (std::int32_t i = 0; i < contact.pair_count; ++i) {
    std::uint32_t& ball = contact.pairs[static_cast<std::size_t>(i)].bone_ball;
    if (ball < bone_.ball_count()) continue;
    const std::size_t child = ball - bone_.ball_count(), slots = splitter_.slots();
    ball =
        static_cast<std::uint32_t>(8 * (bone_.first_child_block() + child / slots * stride_) + child % slots);
  }
}

}  // namespace osteon::simulation::cpu
