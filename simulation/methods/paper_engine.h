#pragma once

#include <optional>

#include "simulation/methods/ball_method.h"

namespace osteon::simulation {

/// The cutting method of Kaluschke et al., "A Continuous Material Cutting Model with Haptic Feedback for
/// Medical Simulations", IEEE VR 2019, either as printed or with corrected equations. It works on the bone's
/// balls; the paper's balls are disjoint (disjoint_packing.h). Equations and symbols are the paper's. The
/// paper tests every pair of balls on a GPU; here a tree of boxes finds the touching pairs, with the same
/// result.
///
/// As printed:
///   1  First contact: equation 3, only its positive roots; the least *distance* over all tool spheres. Only
///      a contact on the path counts (s <= 1: "along the path"). Without contact the proxy moves to the
///      path's end.
///   2  Normal: equation 4, with the contact sphere enlarged "by its radius", which doubles its radius. Other
///      tool spheres whose centres lie in the enlarged sphere keep their own radius. The normal is reported,
///      but no printed equation uses it. Force: equation 1, k (p_proxy - p_HIP), with ζ = 0 (assumed: no
///      value is given). Torque: equation 2 at the sphere's centre, about the tool's origin (the cell adds
///      the lever to the centre of mass).
///   3  Removal: equation 5 with the contact sphere alone, on its whole path from the last pose to the
///      device's pose, in this frame. There is no removal law: CuttingParams::law and ::cutters are ignored.
///      The proxy's next path begins at the device's pose.
///   Cases in which the printed equations fail:
///      m = 0 (the divisor of equation 3) counts as no contact.
///      d_c = 0 (the divisor of equation 5) leaves the ball as it is.
///      A contact at rest has a root of ±0, so the proxy stops 1 µm before the contact (assumed; otherwise
///      a tool at rest would pass into the bone in every second frame).
///      If the tool turns within a frame, its spheres still move on straight paths.
///      The paper does not say how the removed volume is measured: here it is that of the mass points in the
///      contact sphere's capsule.
///
/// As corrected (cutting.md), with the same structure of one contact and one slide:
///   1  First contact: the least fraction. Overlapping pairs that move inwards touch at fraction 0. Pairs
///      that overlap without moving cause no division by zero.
///   2  Normal: equation 4 with the squares that its print lacks, over the contact sphere and the tool
///      spheres that overlap it, all enlarged by CuttingParams::normal_enlargement_m. The bone's density is
///      still a weight. The force acts only along the normal, at the surface point. The proxy slides once
///      along the contact's plane.
///   3  Removal: equation 5 with the penetration depth (ShrinkBall), along the proxy's path, by the cutters
///      and the law of CuttingParams.
class PaperEngine final : public BallMethod {
 public:
  /// @param printed  true: the printed equations; false: the corrected ones
  /// @param solid  the solid from which the bone was packed, or null; it gives the balls' densities
  /// (BallBone)
  /// @throws std::invalid_argument as MakeMethod does.
  PaperEngine(bool printed, const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
              const CuttingParams& params);

 protected:
  MethodFrame Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) override;

 private:
  struct FirstTouch {
    double fraction;  ///< fraction of the path up to the touch
    std::size_t tool_ball;
  };
  /// @param tolerance_m  overlap that does not count as contact
  [[nodiscard]] std::optional<FirstTouch> FindTouch(const ToolPoints& from, const ToolPoints& to,
                                                    double tolerance_m) const;
  [[nodiscard]] std::optional<FirstTouch> FindPrintedTouch(const ToolPoints& from,
                                                           const ToolPoints& to) const;
  [[nodiscard]] Vector3 Normal(const ToolPoints& at, std::size_t contact_ball) const;
  [[nodiscard]] Vector3 PrintedNormal(const ToolPoints& at, std::size_t contact_ball) const;
  MethodFrame SolvePrinted(const Pose& X_GP, const Pose& X_GT, const FrameInput& input);
  MethodFrame SolveCorrected(const Pose& X_GP, const Pose& X_GT, const FrameInput& input);
  /// Removes the bone that the contact sphere removes on its path from a to b, by the printed equation 5.
  void PrintedRemoval(const Vector3& a, const Vector3& b, double radius_m, MethodFrame& frame);
  /// Removes the bone that the contact ball sweeps on its path from a to b. If `contact_ball` is the number
  /// of tool balls, removes the bone that all cutting balls sweep.
  void Cut(const ToolPoints& a, const ToolPoints& b, std::size_t contact_ball, MethodFrame& frame);

  bool printed_;
};

}  // namespace osteon::simulation
