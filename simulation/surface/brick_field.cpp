#include "simulation/surface/brick_field.h"

namespace osteon::surface {

std::int16_t* BrickField::MakeValues(BrickIndex brick) {
  const std::int16_t limit =
      slots_[brick] == kAllHigh ? kFieldLimit : static_cast<std::int16_t>(-kFieldLimit);
  std::int32_t slot = used_;
  if (free_.empty()) {
    ++used_;
    values_.resize(std::max(values_.size(), Offset(used_)));
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  slots_[brick] = slot;
  std::fill_n(Values(brick), kBrickNodes, limit);
  return Values(brick);
}

void BrickField::MakeUniform(BrickIndex brick, std::int32_t state) {
  if (HasValues(brick)) free_.push_back(slots_[brick]);
  slots_[brick] = state;
}

}  // namespace osteon::surface
