#include "simulation/methods/voxel_method.h"

#include <algorithm>
#include <cmath>

#include "simulation/fidelity/carved_shape.h"

namespace osteon::simulation {
namespace {

/// The union of the solid voxels' cubes.
class VoxelShape final : public CarvedShape {
 public:
  explicit VoxelShape(const VoxelGrid& grid) : grid_(grid) {}

  [[nodiscard]] double Distance(const Vector3& p_G, double at_most_m) const override {
    // half the edge of a cube, slightly widened, so that rounding leaves no gap between two cubes
    const double half = (0.5 + 1e-9) * grid_.voxel_m(), corner = std::sqrt(3.0) * half;
    const double farthest = at_most_m + corner;
    double nearest = at_most_m;
    // A cube's surface may be nearer than its centre by half a diagonal. Widen the search until no cube
    // beyond it can be nearer than the nearest one found.
    for (double reach = std::min(4.0 * corner, farthest);; reach = std::min(1.5 * reach, farthest)) {
      grid_.ForEachSolidNear(p_G, reach, 0.0, [&](const VoxelIndex& v, double) {
        const Vector3 out = ((p_G - grid_.CenterOf(v)).cwiseAbs() - Vector3::Constant(half)).cwiseMax(0.0);
        nearest = std::min(nearest, out.norm());
        return nearest > 0.0;
      });
      if (nearest <= reach - corner || reach >= farthest) return nearest;
    }
  }

 private:
  VoxelGrid grid_;
};

}  // namespace

std::unique_ptr<CarvedShape> VoxelMethod::Shape() const { return std::make_unique<VoxelShape>(grid_); }

void VoxelMethod::MeasureEngagement(const ToolPoints& at, const Vector3& spindle_axis,
                                    MethodFrame& frame) const {
  // The layer is at most one voxel thick: a thicker one would take most of a frame's time, and count bone
  // that the tool has not reached yet.
  const double layer_m = std::min(params_.engaged_layer_m, grid_.voxel_m());
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    if (!tool_.balls[t].cutting) continue;
    const double r_t = tool_.balls[t].radius_m;
    grid_.ForEachSolidNear(at[t], r_t + layer_m, r_t - layer_m, [&](const VoxelIndex& v, double) {
      AddEngaged(
          {.p_m = grid_.CenterOf(v), .volume_m3 = grid_.voxel_volume_m3(), .material = grid_.MaterialOf(v)},
          layer_m, t, at, spindle_axis, frame);
      return true;
    });
  }
}

void VoxelMethod::DeleteInside(const ToolPoints& at, double inset_m, MethodFrame& frame) {
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    if (!tool_.balls[t].cutting || tool_.balls[t].radius_m <= inset_m) continue;
    grid_.ForEachSolidNear(at[t], tool_.balls[t].radius_m - inset_m, 0.0, [&](const VoxelIndex& v, double) {
      frame.removed_m3[grid_.MaterialOf(v)] += grid_.voxel_volume_m3();
      grid_.Delete(v);
      OnDeleted(v);
      return true;
    });
  }
}

}  // namespace osteon::simulation
