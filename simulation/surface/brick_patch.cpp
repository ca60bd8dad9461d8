#include "simulation/surface/brick_patch.h"

namespace osteon::surface {
namespace {

/// The values of one field in one of the 27 bricks around a patch.
struct Part {
  const std::int16_t* values{nullptr};  // null: the brick is uniform
  std::int16_t uniform{0};
};

using Parts = std::array<Part, 27>;

/// Fills a row of 12 patch nodes from three neighbouring bricks.
/// @param at  index in each brick at which the row begins
void FillRow(std::int16_t* row, const Part* parts, int at) {
  constexpr std::array<int, 3> kFrom{6, 0, 0}, kCount{2, 8, 2};
  for (std::size_t i = 0; i < 3; ++i) {
    if (parts[i].values)
      std::copy_n(parts[i].values + at + kFrom[i], kCount[i], row);
    else
      std::fill_n(row, kCount[i], parts[i].uniform);
    row += kCount[i];
  }
}

/// Fills a patch with the values of one field.
void Fill(const Parts& parts, std::array<std::int16_t, kPatchNodes>& out) {
  // index of the brick that holds a patch's node, of three in a row: 2 nodes of the first, 8 of the second, 2
  // of the third
  const auto part_of = [](int node) { return node < 2 ? 0 : node < 10 ? 1 : 2; };
  for (int z = 0; z < kPatchEdge; ++z)
    for (int y = 0; y < kPatchEdge; ++y) {
      const int at = (((z + 6) & 7) * kBrickEdge + ((y + 6) & 7)) * kBrickEdge;
      FillRow(out.data() + z * kLayer + y * kRow, parts.data() + (part_of(z) * 3 + part_of(y)) * 3, at);
    }
}

/// One brick's part of a field.
Part PartOf(const BrickField& field, BrickIndex brick) {
  return {field.Values(brick),
          field.State(brick) == BrickField::kAllLow ? static_cast<std::int16_t>(-kFieldLimit) : kFieldLimit};
}

}  // namespace

bool GatherPatch(const CarvedField& field, BrickIndex brick, BrickPatch& patch) {
  const BrickLayout& layout = field.layout();
  const auto place = layout.PlaceOf(brick);
  Parts solid, swept;
  bool air = false, bone = false, mixed = false;
  unsigned fields = BrickPatch::kNone;
  for (int k = 0; k < 27; ++k) {
    const int x = place[0] + k % 3 - 1, y = place[1] + k / 3 % 3 - 1, z = place[2] + k / 9 - 1;
    const auto i = static_cast<std::size_t>(k);
    if (!layout.Contains(x, y, z)) {  // a brick outside the grid is air
      solid[i] = {nullptr, kFieldLimit};
      swept[i] = {nullptr, static_cast<std::int16_t>(-kFieldLimit)};
      air = true;
      fields |= BrickPatch::kSolid;
      continue;
    }
    const BrickIndex neighbour = layout.At(x, y, z);
    const std::int32_t solid_state = field.solid().State(neighbour),
                       swept_state = field.swept().State(neighbour);
    solid[i] = PartOf(field.solid(), neighbour);
    swept[i] = PartOf(field.swept(), neighbour);
    if (solid_state != BrickField::kAllLow) fields |= BrickPatch::kSolid;
    if (swept_state != BrickField::kAllLow) fields |= BrickPatch::kSwept;
    if (solid_state == BrickField::kAllHigh || swept_state == BrickField::kAllHigh)
      air = true;
    else if (solid_state == BrickField::kAllLow && swept_state == BrickField::kAllLow)
      bone = true;
    else
      mixed = true;
  }
  if (!mixed && !(air && bone)) return false;
  patch.fields = static_cast<BrickPatch::Fields>(fields);
  if ((fields & BrickPatch::kSolid) != 0) Fill(solid, patch.solid);
  if ((fields & BrickPatch::kSwept) != 0) Fill(swept, patch.swept);
  if (fields == BrickPatch::kBoth)
    for (std::size_t i = 0; i < kPatchNodes; ++i) patch.both[i] = std::max(patch.solid[i], patch.swept[i]);
  return true;
}

}  // namespace osteon::surface
