#pragma once

#include <cstdint>

#include "simulation/engine_cpu/aligned_array.h"
#include "simulation/engine_cpu/pass_data.h"

namespace osteon::simulation::cpu {

/// Blocks and their rows (PairRows). Memory is allocated at set-up and does not grow; rows that do not fit
/// are refused.
class PairRowList {
 public:
  PairRowList() = default;
  PairRowList(std::size_t max_blocks, std::size_t max_rows);

  void Clear();
  /// Free memory behind the last row, into which a block's rows are written before Add.
  [[nodiscard]] std::uint16_t* free_tools() { return tool_.data() + row_count_; }
  [[nodiscard]] float* free_bounds() { return bound_.data() + row_count_; }
  /// Whether another block with this number of rows fits.
  [[nodiscard]] bool HasRoom(std::size_t rows) const {
    return block_count_ < block_.size() && row_count_ + rows <= tool_.size();
  }
  /// Adds a block with `rows` rows, which were written to the free memory. @pre block is higher than all
  /// blocks in the list, rows > 0
  void Add(std::uint32_t block, std::size_t rows);
  /// Replaces the rows of a block, or inserts the block; zero rows remove it.
  /// @returns false if there is no room; nothing is then changed
  bool Replace(std::uint32_t block, const std::uint16_t* tools, const float* bounds, std::size_t rows);

  [[nodiscard]] std::size_t row_count() const { return row_count_; }
  [[nodiscard]] std::size_t block_count() const { return block_count_; }
  [[nodiscard]] PairRows rows();

 private:
  // Removes the block at this index and its rows.
  void Erase(std::size_t at);

  AlignedArray<std::uint32_t> block_, first_;
  AlignedArray<float> block_bound_, bound_;
  AlignedArray<std::uint16_t> tool_;
  std::size_t block_count_{0}, row_count_{0};
};

}  // namespace osteon::simulation::cpu
