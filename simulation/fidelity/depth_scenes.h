#pragma once

#include <memory>
#include <string>
#include <vector>

#include "simulation/solids/cut_zone.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// A hemispherical shell: inner_m <= |p| <= outer_m, z <= 0. A cup's bone without anything around it.
class ShellSolid final : public Solid {
 public:
  /// @throws std::invalid_argument unless 1 mm <= inner < outer <= 1 m.
  ShellSolid(double inner_m, double outer_m);
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override;
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3&) const override { return 0; }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override;

 private:
  double inner_m_, outer_m_;
};

/// A cut with a known exact result, to measure removal. G and the path's frame coincide; the tool's feed
/// points down.
struct DepthScene {
  std::string name;
  std::unique_ptr<Solid> solid;
  std::unique_ptr<CutZone> zone;  ///< region of a fine packing: around the cut, whatever its shape
  Tool tool;
  std::vector<Vector3> corners_m;  ///< of the polyline of the tool's centre

  /// Poses along the polyline, at most `step_m` apart.
  [[nodiscard]] std::vector<Pose> Path(double step_m) const;
};

/// A cube of 20 mm, its top face at z = 0; a ball of 5 mm plunges 5 mm deep and slides 6 mm. The tool is
/// small: about as large as the bone's balls.
[[nodiscard]] DepthScene MakeBlockScene();

/// A shell of 25 to 33 mm; a ball of 25 mm goes 3 mm deeper, as a reamer in its cup.
[[nodiscard]] DepthScene MakeCupScene();

}  // namespace osteon::simulation
