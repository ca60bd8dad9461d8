#pragma once

#include <memory>
#include <span>
#include <vector>

#include "simulation/surface/solid_field.h"

namespace osteon::surface {

/// The carved bone as two distance fields, `solid` and `swept`. Their maximum is the field of the solid
/// without the volume that the tool's cutting balls swept. Carve only increases the values of the swept
/// field. One thread at a time carves; while nobody carves, any number of threads may extract
/// (dual_surface.h).
class CarvedField {
 public:
  explicit CarvedField(std::shared_ptr<const SolidField> solid);

  /// Removes capsules from the bone. The result does not depend on their order, or on how they are divided
  /// among calls.
  void Carve(std::span<const Capsule> capsules);

  /// Replaces the swept field by another state of it, for an undo or a saved cut.
  /// @throws std::invalid_argument if the other field has another number of bricks.
  void SetSwept(BrickField swept);

  /// Dirty bricks: those whose mesh may have changed since ClearDirty, in the order of their first change. At
  /// the start, all bricks that may have a surface are dirty.
  [[nodiscard]] std::span<const BrickIndex> Dirty() const { return dirty_list_; }
  void ClearDirty();
  /// Marks every brick that may have a surface as dirty, for a viewer that begins to show the bone.
  void MarkAllDirty();

  [[nodiscard]] const BrickLayout& layout() const { return solid_->layout(); }
  [[nodiscard]] const BrickField& solid() const { return solid_->distances(); }
  /// The swept field: positive where the tool has been.
  [[nodiscard]] const BrickField& swept() const { return swept_; }
  [[nodiscard]] std::size_t Bytes() const { return solid().Bytes() + swept_.Bytes(); }

 private:
  /// Removes the capsules from one brick, and marks the bricks whose mesh changes.
  void CarveBrick(int x, int y, int z, std::span<const Capsule> capsules);
  void MarkDirty(int x, int y, int z);

  std::shared_ptr<const SolidField> solid_;
  BrickField swept_;
  std::vector<bool> is_dirty_;
  std::vector<BrickIndex> dirty_list_;
  std::vector<std::uint32_t> selected_;  // CarveBrick's memory, kept for its next call
  std::vector<float> depths_;            // the same
};

}  // namespace osteon::surface
