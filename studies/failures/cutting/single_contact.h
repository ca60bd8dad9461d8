#pragma once

#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/tools/tool.h"

namespace osteon::studies {

/// Variants of the single-contact law.
struct SingleContactParams {
  double stiffness_N_per_m{20e3};
  bool positive_roots_only{false};  ///< drops pairs that already overlap, as equation 3 is printed
  /// How often the rest of the way is projected on the touching pair's plane; 0: stops at first contact.
  int slides{0};
};

/// Result of one frame, in G.
struct SingleContactFrame {
  Vector3 p_G{Vector3::Zero()};  ///< proxy: T's origin
  Wrench F_T_G;                  ///< on the tool, at T's origin
  Vector3 n{Vector3::Zero()};    ///< of the pair touched last; zero where free
  bool touching{false};
};

/// Baseline of the contact scenarios: the force of a god-object that considers one pair of balls at a time.
///
///     P' = first contact on the way P ──▶ T (equation 3)      n = from bone ball to tool ball of that pair
///     F = k (P' - T)    (1)                                   tau = (p_s - p_COM) x F    (2)
///
/// with p_s the pair's touching point. Rotation is the tool's: contact never blocks it. Nothing is cut; plain
/// loops. Source: Kaluschke et al., IEEE VR 2019, equations 1 to 3; the slide: Zilles and Salisbury 1995 with
/// one plane.
class SingleContact {
 public:
  /// @param balls  the bone, in G
  /// @param tool  torques in (2), and so F_T_G's torque, are about its centre of mass
  SingleContact(std::vector<simulation::Ball> balls, const simulation::Tool& tool,
                const SingleContactParams& params);

  /// Advances by one frame. The first frame's pose counts as free.
  SingleContactFrame Step(const Pose& X_GT);

 private:
  struct FirstHit {
    double fraction;
    std::size_t bone_ball, tool_ball;
  };
  [[nodiscard]] FirstHit FirstContact(const Pose& X_GA, const Pose& X_GB) const;

  std::vector<simulation::Ball> balls_;
  simulation::Tool tool_;
  SingleContactParams params_;
  Pose X_GP_{Pose::Identity()};
  bool has_proxy_{false};
};

}  // namespace osteon::studies
