#pragma once

#include <array>
#include <limits>
#include <span>

#include "simulation/contact_memory.h"
#include "simulation/cutting_engine.h"
#include "simulation/frame_solution.h"

// Pass 2, from the pairs near the tool at first contact to the constrained target and the contacts that are
// reported.
//
//     pairs ─┬─▶ the nearest in each of 60 bins of direction ─┐
//            │   the pairs that held the frame before        ─┴─▶ planes ─▶ nearest target ─▶ friction ─┐
//            └─▶ lens-weighted sums about each face's normal ─▶ normal and point of the face ───────────┴─▶
//            contacts
//
// Position comes from pairs themselves, so it is exact; direction and point of action come from means over
// the balls around, so they change smoothly while the tool passes from one ball to the next.

namespace osteon::simulation {

/// Bins of direction: nine to a face of a cube for balls that cut, one to a face for balls that do not.
inline constexpr int kCuttingBins = 54, kContactBins = 60;

/// Bin of a pair. @param u_T  unit, from bone to tool, in T.
[[nodiscard]] int ContactBin(const Vector3& u_T, bool cutting);

/// A pair near the tool at first contact, in G.
struct NearPair {
  ContactPair pair;
  bool present{false}, cutting{true};
  Vector3 n{Vector3::Zero()};  ///< unit, from bone to tool
  double gap_m{std::numeric_limits<double>::infinity()};
  Vector3 motion_m{Vector3::Zero()};    ///< of the tool ball's centre from there to the tool's pose
  Vector3 center_T_m{Vector3::Zero()};  ///< tool ball, in T
  double tool_radius_m{0.0};
};

/// True where a is nearer than b; of equally near ones that with the smaller indices, so that the order of
/// visits does not matter.
[[nodiscard]] bool Nearer(const NearPair& a, const NearPair& b);

/// Half angle of the cone about a face's normal in which pairs belong to it (cosine of 30 degrees).
inline constexpr double kFaceCosine = 0.866;

/// Lens-weighted sums over the pairs around a face's normal.
struct FaceSums {
  double weight{0.0};
  Vector3 n{Vector3::Zero()};
  Vector3 center_T{Vector3::Zero()};  ///< of tool balls' centres
  double radius{0.0};                 ///< of tool balls' radii

  /// @param lens_m3  weight of the pair; @param face_n  the face's direction, the frame before
  void Add(double lens_m3, const Vector3& face_n, const NearPair& pair);
};

/// What pass 2 hands over.
struct NearField {
  std::array<NearPair, kContactBins> nearest{};
  std::array<NearPair, kRememberedPairs> remembered{};
  std::array<FaceSums, kMaxFaces> faces{};
};

/// What a frame's contact is solved from, besides the near field.
struct ContactInput {
  Matrix3 R_GT{Matrix3::Identity()};  ///< at the tool's pose
  Vector3 turn_G{Vector3::Zero()};    ///< rotation vector from first contact to there
  double friction{0.0};  ///< mu; 0 while the spindle turns: the surface then slips along its own speed
};

/// Fills contacts, delta, n, cutting_m and shaft planes of the solution, and what the next frame should
/// remember.
///
/// Planes of opposite pairs with less than the contact tolerance between them are moved apart to the
/// tolerance: a tool is free to go along a hole of its own width.
///
/// Friction (Coulomb, on the proxy): of the slip of the touching surface from first contact to the target,
/// mu times the normal displacements' sum is taken back, within what the planes allow.
void SolveContact(const CuttingParams& params, const NearField& near, const ContactInput& input,
                  ContactMemory& memory, FrameSolution& solution);

}  // namespace osteon::simulation
