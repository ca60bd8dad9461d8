#include "simulation/methods/ball_method.h"

#include "simulation/fidelity/carved_shape.h"

namespace osteon::simulation {

std::unique_ptr<CarvedShape> BallMethod::Shape() const { return std::make_unique<BallUnion>(bone_.Left()); }

void BallMethod::MeasureEngagement(const ToolPoints& at, const Vector3& spindle_axis,
                                   MethodFrame& frame) const {
  const double layer_m = params_.engaged_layer_m;
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    if (!tool_.balls[t].cutting) continue;
    const double r_t = tool_.balls[t].radius_m;
    bone_.ForEachPointInShell(at[t], r_t - layer_m, r_t + layer_m, [&](const MassPoint& point) {
      AddEngaged({.p_m = point.p_m, .volume_m3 = point.volume_m3, .material = point.material}, layer_m, t, at,
                 spindle_axis, frame);
    });
  }
}

}  // namespace osteon::simulation
