#pragma once

#include <optional>

#include "simulation/methods/ball_method.h"

namespace osteon::simulation {

/// The cutting method of Kaluschke et al., "A Continuous Material Cutting Model with Haptic Feedback for
/// Medical Simulations", IEEE VR 2019, on the bone's balls (the paper's balls are disjoint:
/// disjoint_packing.h), as printed or as corrected. Equations and symbols are the paper's. The paper tests
/// every pair on a GPU; here a tree of boxes finds the pairs, with the same result.
///
/// As printed:
///   1  First contact: equation 3, only its positive roots; the least *distance* over all tool spheres. Only
///      a contact on the path counts (s <= 1: "along the path"). Without contact the proxy
///      goes to the path's end.
///   2  Normal: equation 4, with the contact sphere enlarged "by its radius", which doubles its radius. Other
///      tool spheres whose centres lie within it count at their own size. The normal is reported, but no
///      printed equation uses it. Force: equation 1, k (p_proxy - p_HIP), with ζ = 0 (assumed: no value is
///      given). Torque: equation 2 at the sphere's centre, about the tool's origin (the cell adds the lever
///      to the centre of mass).
///   3  Removal: equation 5 with the contact sphere alone, from where it was to where it would have ended, at
///      once. There is no removal law: CuttingParams::law and ::cutters are ignored. The proxy's next
///      path begins at the device's pose.
///   Where the printed equations fail: m = 0 (the divisor of equation 3) counts as no contact, and
///   d_c = 0 (the distance of the centres in equation 5) leaves the ball as it is. A
///   contact at rest has a root of ±0, so the proxy stops 1 µm short (assumed; otherwise every second frame
///   tunnels at rest). A whole turn of the tool within a frame is treated as a chord. The paper does not say
///   how removed volume is counted: here the mass points in the contact sphere's capsule count as removed.
///
/// As corrected (cutting.md), with the same structure of one contact and one slide:
///   1  First contact: the least fraction; overlapping pairs that move inwards are contact at 0; pairs that
///      overlap without moving cause no division by zero.
///   2  Normal: equation 4 with the squares that its print lacks, with the enlargement e =
///   CuttingParams::normal_enlargement_m for
///      the contact sphere and tool spheres that overlap it; the weights by density remain. The force acts
///      only along the normal, at the surface point; the proxy slides once along the contact's plane.
///   3  Removal: equation 5 with the penetration (ShrinkBall), along the proxy's path, by the cutters and the
///      law of CuttingParams.
class PaperEngine final : public BallMethod {
 public:
  /// @param printed  as printed, else as corrected
  /// @param solid  the shape from which the bone was packed, or null (MakeMethod)
  /// @throws std::invalid_argument as MakeMethod does.
  PaperEngine(bool printed, const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
              const CuttingParams& params);

 protected:
  MethodFrame Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) override;

 private:
  struct FirstTouch {
    double fraction;  ///< of the path
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
  /// Removes what the contact sphere removes on its path from a to b.
  void PrintedRemoval(const Vector3& a, const Vector3& b, double radius_m, MethodFrame& frame);
  /// Removes what the contact ball sweeps from a to b. With the number of tool balls as `contact_ball`,
  /// removes what every cutting ball sweeps.
  void Cut(const ToolPoints& a, const ToolPoints& b, std::size_t contact_ball, MethodFrame& frame);

  bool printed_;
};

}  // namespace osteon::simulation
