#include "simulation/engine_cpu/pair_row_list.h"

#include <algorithm>
#include <cstring>

namespace osteon::simulation::cpu {
namespace {

// Number of elements of each array that are written at set-up, so that their memory pages exist before the
// first frame.
constexpr std::size_t kTouched = 1u << 18;

// Moves the elements from `from` to end - 1, so that the first one is at `to`.
template <class T>
void Move(AlignedArray<T>& a, std::size_t from, std::size_t end, std::size_t to) {
  std::memmove(a.data() + to, a.data() + from, (end - from) * sizeof(T));
}

}  // namespace

PairRowList::PairRowList(std::size_t max_blocks, std::size_t max_rows)
    : block_(max_blocks, kTouched),
      first_(max_blocks + 1, kTouched),
      block_bound_(max_blocks, kTouched),
      bound_(max_rows, kTouched),
      tool_(max_rows, kTouched) {
  Clear();
}

void PairRowList::Clear() {
  block_count_ = row_count_ = 0;
  first_[0] = 0;
}

void PairRowList::Add(std::uint32_t block, std::size_t rows) {
  block_bound_[block_count_] = *std::min_element(free_bounds(), free_bounds() + rows);
  block_[block_count_++] = block;
  row_count_ += rows;
  first_[block_count_] = static_cast<std::uint32_t>(row_count_);
}

void PairRowList::Erase(std::size_t at) {
  const std::size_t begin = first_[at], end = first_[at + 1];
  Move(bound_, end, row_count_, begin);
  Move(tool_, end, row_count_, begin);
  Move(block_, at + 1, block_count_, at);
  Move(block_bound_, at + 1, block_count_, at);
  Move(first_, at + 1, block_count_ + 1, at);
  --block_count_;
  for (std::size_t b = at; b <= block_count_; ++b) first_[b] -= static_cast<std::uint32_t>(end - begin);
  row_count_ -= end - begin;
}

bool PairRowList::Replace(std::uint32_t block, const std::uint16_t* tools, const float* bounds,
                          std::size_t rows) {
  const std::uint32_t* found = std::lower_bound(block_.data(), block_.data() + block_count_, block);
  const auto at = static_cast<std::size_t>(found - block_.data());
  if (!HasRoom(rows)) return false;
  if (at < block_count_ && *found == block) Erase(at);
  if (rows == 0) return true;
  const std::size_t begin = first_[at];
  Move(bound_, begin, row_count_, begin + rows);
  Move(tool_, begin, row_count_, begin + rows);
  Move(block_, at, block_count_, at + 1);
  Move(block_bound_, at, block_count_, at + 1);
  Move(first_, at, block_count_ + 1, at + 1);
  std::copy_n(bounds, rows, bound_.data() + begin);
  std::copy_n(tools, rows, tool_.data() + begin);
  block_[at] = block;
  block_bound_[at] = *std::min_element(bounds, bounds + rows);
  ++block_count_;
  for (std::size_t b = at + 1; b <= block_count_; ++b) first_[b] += static_cast<std::uint32_t>(rows);
  row_count_ += rows;
  return true;
}

PairRows PairRowList::rows() {
  return {.block_count = static_cast<std::uint32_t>(block_count_),
          .block = block_.data(),
          .first = first_.data(),
          .block_bound = block_bound_.data(),
          .tool = tool_.data(),
          .bound = bound_.data()};
}

}  // namespace osteon::simulation::cpu
