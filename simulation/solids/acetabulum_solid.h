#pragma once

#include "simulation/solids/cut_zone.h"

namespace osteon::simulation {

/// Sizes of the generated acetabulum: a block of bone with a hemispherical cup in its top face.
struct AcetabulumShape {
  double width_m{0.080};   ///< along x and y
  double height_m{0.060};  ///< along z
  double cup_radius_m{0.024};
  double cartilage_m{0.002};    ///< thickness of the cartilage that lines the cup
  double subchondral_m{0.001};  ///< thickness of the cortical plate below the cartilage
};

/// @throws std::invalid_argument naming the size, its value and what is accepted.
void CheckShape(const AcetabulumShape& shape);

/// A block from which a ball is removed. G's origin is the cup's centre, in the block's top face; +z points
/// out of the opening. The block fills |x|, |y| <= width/2, -height <= z <= 0.
///
/// The tissue depends on the distance from the cup's sphere: cartilage, then the subchondral cortical plate,
/// then cancellous bone. The block's outer faces are saw cuts, so they have no cortical shell.
class AcetabulumSolid final : public Solid {
 public:
  /// @throws std::invalid_argument as CheckShape does.
  explicit AcetabulumSolid(const AcetabulumShape& shape);

  /// The distance is exact inside and outside.
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override;
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p_m) const override;
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return block_; }
  [[nodiscard]] const CutSite& cup() const { return cup_; }

 private:
  AcetabulumShape shape_;
  CutSite cup_;
  CupZone zone_;
  Eigen::AlignedBox3d block_;
};

}  // namespace osteon::simulation
