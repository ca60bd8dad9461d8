#pragma once

#include <array>
#include <limits>

#include "simulation/contact/constrained_goal.h"
#include "simulation/contact/contact_memory.h"
#include "simulation/contact/cutting_constants.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/engine/frame_solution.h"

// Pass 2: from the pairs near the tool at first contact to the constrained target and the reported contacts.
//
//     pairs ─┬─▶ the nearest in each of 60 bins of direction ─┐
//            │   the pairs that held the frame before        ─┴─▶ planes ─▶ nearest target ─▶ friction ─┐
//            └─▶ lens-weighted sums about each face's normal ─▶ normal and point of the face ───────────┴─▶ contacts
//
// The position comes from the pairs themselves, so it is exact. Direction and point of action are means over
// the surrounding pairs, so they change smoothly while the tool passes from one ball to the next.

namespace osteon::simulation {

/// Numbers of bins of direction. Balls that cut have nine bins on each face of a cube (54); balls that do not
/// cut have one bin for each face (6).
inline constexpr int kCuttingBins = 54, kContactBins = 60;

/// Bin of a pair's direction.
struct ContactBin {
  int number;
  double off_centre;  ///< 1 - cosine of the angle between the direction and the bin's centre
};
/// Finds the bin of a direction. @param u_T  the direction: unit vector from bone to tool, in T
[[nodiscard]] ContactBin FindBin(const Vector3& u_T, bool cutting);

/// A pair of a bone ball and a tool ball that are near each other at first contact; vectors in G.
struct NearPair {
  ContactPair pair;
  bool present{false}, cutting{true};
  Vector3 n{Vector3::Zero()};  ///< unit normal, from bone to tool
  double gap_m{std::numeric_limits<double>::infinity()};
  double score_m{std::numeric_limits<double>::infinity()};  ///< gap + kBinCentreBias_m (1 - cosine)
  Vector3 motion_m{Vector3::Zero()};    ///< of the tool ball's centre, from first contact to the tool's pose
  Vector3 center_T_m{Vector3::Zero()};  ///< centre of the tool ball, in T
  double tool_radius_m{0.0};
};

/// Whether pair a comes before pair b: by the lower score, then by the smaller indices. The result does not
/// depend on the order in which pairs are visited.
[[nodiscard]] bool Nearer(const NearPair& a, const NearPair& b);

/// Sums over the pairs in the cone around a face's normal, weighted by lens volume.
struct FaceSums {
  double weight{0.0};                 ///< sum of the weights
  Vector3 n{Vector3::Zero()};         ///< sum of the pairs' normals
  Vector3 center_T{Vector3::Zero()};  ///< sum of the tool balls' centres
  double radius{0.0};                 ///< sum of the tool balls' radii

  /// Adds a pair if it lies in the face's cone. @param lens_m3  weight of the pair @param face_n  the face's
  /// direction in the frame before
  void Add(double lens_m3, const Vector3& face_n, const NearPair& pair);
};

/// Pairs near the tool that pass 2 found, and the sums over the pairs in the cones of the faces of the frame
/// before.
struct NearField {
  std::array<NearPair, kContactBins> nearest{};
  std::array<NearPair, kRememberedPairs> remembered{};
  int held_count{0};  ///< number of remembered pairs that held the tool in the frame before; they come first
  std::array<FaceSums, kMaxFaces> faces{};
};

/// Further inputs of a frame's contact problem, besides the near field.
struct ContactInput {
  Matrix3 R_GT{Matrix3::Identity()};    ///< orientation of the tool's pose
  Vector3 motion_G_m{Vector3::Zero()};  ///< motion of T's origin, from first contact to the tool's pose
  Vector3 turn_G{Vector3::Zero()};      ///< rotation vector from first contact to the tool's pose
  double friction{0.0};  ///< mu; 0 while the spindle turns, because slip then follows the spindle's speed
};

/// The pairs that may hold the tool, without duplicates, and their gaps at first contact.
///
/// If two pairs face each other across the tool and leave it less room than the contact tolerance, both gaps
/// are enlarged until the room equals the tolerance, each by at most three quarters of the tolerance. So a
/// tool moves freely along a hole of its own width; otherwise it would catch on each of the hole's balls.
struct Candidates {
  std::array<NearPair, kContactBins + kRememberedPairs> pairs{};
  std::array<double, kContactBins + kRememberedPairs> gap_m{};
  std::size_t count{0};
  std::array<std::size_t, kMaxHolding> held{};  ///< indices of pairs that held the tool in the frame before
  std::size_t held_count{0};
};
/// Collects the candidates of a frame and their gaps.
[[nodiscard]] Candidates FindCandidates(const NearField& near, double contact_tolerance_m);

/// The displacement at which planes hold a tool, and the displacement by friction.
struct ContactSolution {
  ConstrainedGoal goal;  ///< relative to the tool's pose
  double normal_m{0.0};  ///< sum of the multipliers
  /// Largest part of normal_m that counts as force. A tool that does not fit (turned askew in its own slot)
  /// is wedged between planes that all yield by the slack. The multipliers then balance each other and would
  /// be too large as forces, so the cap limits them to 2 (|point| + slack) (ForceMultiplierCap).
  double force_multiplier_cap_m{0.0};
  Vector3 friction_m{Vector3::Zero()};

  /// Displacement at which the tool is held, including friction, relative to the tool's pose.
  [[nodiscard]] Vector3 point_m() const { return goal.point_m + friction_m; }
};
/// Computes normal_m and force_multiplier_cap_m from held.goal.
void ComputeForceCap(ContactSolution& held);

/// Finds the displacement at which the candidates' planes hold the tool.
/// @param turning  true: for the motion to the tool's pose; false: for the same motion of T's origin without
/// the turn, with the orientation at first contact
///
/// Coulomb friction takes back a part of the slip of the tool's touching surface between first contact and
/// the target. That part is at most mu times the sum of the multipliers (capped by force_multiplier_cap_m),
/// and no plane is violated by it.
[[nodiscard]] ContactSolution SolveContacts(const Candidates& candidates, const ContactInput& input,
                                            bool turning);

/// Sets contacts, delta, shift, n, cutting_m and the shaft planes of the solution, and the memory for the
/// next frame.
/// @param held  solution with the tool's turn;  @param unturned  solution without the turn
void FillContacts(const CuttingParams& params, const NearField& near, const Candidates& candidates,
                  const ContactSolution& held, const ContactSolution& unturned, const ContactInput& input,
                  ContactMemory& memory, FrameSolution& solution);

}  // namespace osteon::simulation
