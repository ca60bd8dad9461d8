#pragma once

#include <cstdint>

#include "simulation/engine_cpu/aligned_array.h"
#include "simulation/engine_cpu/pass_data.h"

namespace osteon::simulation::cpu {

/// Blocks and their rows (PairRows). All room is taken at set-up; what does not fit is told, not grown.
class PairRowList {
 public:
  PairRowList() = default;
  PairRowList(std::size_t max_blocks, std::size_t max_rows);

  void Clear();
  /// Where a block's rows may be written before Add: behind those that are there.
  [[nodiscard]] std::uint16_t* free_tools() { return tool_.data() + row_count_; }
  [[nodiscard]] float* free_bounds() { return bound_.data() + row_count_; }
  /// Whether another block with so many rows fits.
  [[nodiscard]] bool HasRoom(std::size_t rows) const {
    return block_count_ < block_.size() && row_count_ + rows <= tool_.size();
  }
  /// Takes in `rows` rows that were written there. @pre block is above all others, rows > 0
  void Add(std::uint32_t block, std::size_t rows);
  /// Puts a block's rows where they belong, in place of those that it had. Rows may be none.
  /// @returns false where there is no room; nothing has changed then.
  bool Replace(std::uint32_t block, const std::uint16_t* tools, const float* bounds, std::size_t rows);

  [[nodiscard]] std::size_t row_count() const { return row_count_; }
  [[nodiscard]] std::size_t block_count() const { return block_count_; }
  [[nodiscard]] PairRows rows();

 private:
  void Erase(std::size_t at);

  AlignedArray<std::uint32_t> block_, first_;
  AlignedArray<float> block_bound_, bound_;
  AlignedArray<std::uint16_t> tool_;
  std::size_t block_count_{0}, row_count_{0};
};

}  // namespace osteon::simulation::cpu
