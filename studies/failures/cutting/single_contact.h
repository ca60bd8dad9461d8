#pragma once

#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/tools/tool.h"

namespace osteon::studies {

/// Variants of the single-contact law.
struct SingleContactParams {
  double stiffness_N_per_m{20e3};
  bool positive_roots_only{false};  ///< ignores pairs that overlap already, as equation 3 does
  /// How often, after a contact, the remaining displacement is projected on the plane of the touching pair;
  /// 0: the proxy stops at first contact.
  int slides{0};
};

/// Result of one frame, in G.
struct SingleContactFrame {
  Vector3 p_G{Vector3::Zero()};  ///< proxy: T's origin
  Wrench F_T_G;                  ///< force on the tool, and its torque about the tool's centre of mass
  Vector3 n{Vector3::Zero()};    ///< normal of the pair that touched last; zero without contact
  bool touching{false};
};

/// Baseline of the contact scenarios: the force of a god-object that considers one pair of balls at a time.
///
///     P' = first contact on the path P ──▶ T (equation 3)     n = from bone ball to tool ball of that pair
///     F = k (P' - T)    (1)                                   tau = (p_s - p_COM) x F    (2)
///
/// with the proxy P of the frame before, the new proxy P', the hand's tool T, the stiffness k, the pair's
/// contact point p_s and the tool's centre of mass p_COM. The proxy takes the tool's rotation: contact never
/// blocks it. Nothing is cut; every pair is tested by plain loops. Sources: Kaluschke et al., IEEE VR 2019,
/// equations 1 to 3; for the slide Zilles and Salisbury 1995, with one plane.
class SingleContact {
 public:
  /// @param balls  the bone, in G
  /// @param tool   its centre of mass is the reference point of the torque in (2), and so of F_T_G's torque
  SingleContact(std::vector<simulation::Ball> balls, const simulation::Tool& tool,
                const SingleContactParams& params);

  /// Advances by one frame. The first frame's pose is assumed to be free of contact.
  SingleContactFrame Step(const Pose& X_GT);

 private:
  struct FirstHit {
    double fraction;  ///< fraction of the displacement from A to B; above 1: no contact
    std::size_t bone_ball, tool_ball;
  };
  /// The first pair of balls that touches while the tool moves straight from A to B.
  [[nodiscard]] FirstHit FirstContact(const Pose& X_GA, const Pose& X_GB) const;

  std::vector<simulation::Ball> balls_;
  simulation::Tool tool_;
  SingleContactParams params_;
  Pose X_GP_{Pose::Identity()};
  bool has_proxy_{false};
};

}  // namespace osteon::studies
