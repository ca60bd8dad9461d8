#pragma once

#include <array>
#include <limits>

#include "simulation/contact_memory.h"
#include "simulation/cutting_constants.h"
#include "simulation/cutting_engine.h"
#include "simulation/frame_solution.h"
#include "simulation/hold_point.h"

// Pass 2, from the pairs near the tool at first contact to the constrained target and the contacts that are
// reported.
//
//     pairs ─┬─▶ the nearest in each of 60 bins of direction ─┐
//            │   the pairs that held the frame before        ─┴─▶ planes ─▶ nearest target ─▶ friction ─┐
//            └─▶ lens-weighted sums about each face's normal ─▶ normal and point of the face ───────────┴─▶ contacts
//
// Position comes from pairs themselves, so it is exact; direction and point of action come from means over
// the balls around, so they change smoothly while the tool passes from one ball to the next.

namespace osteon::simulation {

/// Bins of direction: nine to a face of a cube for balls that cut, one to a face for balls that do not.
inline constexpr int kCuttingBins = 54, kContactBins = 60;

/// Bin of a pair, and how far its direction is from the bin's middle (1 - cosine).
struct ContactBin {
  int number;
  double off_middle;
};
/// @param u_T  unit, from bone to tool, in T.
[[nodiscard]] ContactBin FindBin(const Vector3& u_T, bool cutting);

/// A pair near the tool at first contact, in G.
struct NearPair {
  ContactPair pair;
  bool present{false}, cutting{true};
  Vector3 n{Vector3::Zero()};  ///< unit, from bone to tool
  double gap_m{std::numeric_limits<double>::infinity()};
  double score_m{std::numeric_limits<double>::infinity()};  ///< gap and what the direction costs
  Vector3 motion_m{Vector3::Zero()};    ///< of the tool ball's centre from there to the tool's pose
  Vector3 center_T_m{Vector3::Zero()};  ///< tool ball, in T
  double tool_radius_m{0.0};
};

/// True where a has the lower score; of equal ones that with the smaller indices, so that the order of
/// visits does not matter.
[[nodiscard]] bool Nearer(const NearPair& a, const NearPair& b);

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
  int held_count{0};  ///< the first of these held the frame before
  std::array<FaceSums, kMaxFaces> faces{};
};

/// What a frame's contact is solved from, besides the near field.
struct ContactInput {
  Matrix3 R_GT{Matrix3::Identity()};    ///< at the tool's pose
  Vector3 motion_G_m{Vector3::Zero()};  ///< of T's origin from first contact to there
  Vector3 turn_G{Vector3::Zero()};      ///< rotation vector from first contact to there
  double friction{0.0};  ///< mu; 0 while the spindle turns: the surface then slips along its own speed
};

/// The pairs that may hold the tool, each once, and their gaps at first contact.
///
/// Where another faces a pair and less than the contact tolerance is left between them, both yield until it
/// is, but overlap by no more than three quarters of it: a tool goes freely along a hole of its own width,
/// whose balls it would else meet one after the other.
struct Candidates {
  std::array<NearPair, kContactBins + kRememberedPairs> pairs{};
  std::array<double, kContactBins + kRememberedPairs> gap_m{};
  std::size_t count{0};
  std::array<std::size_t, kMostHolding> held{};  ///< those that held the frame before, by index
  std::size_t held_count{0};
};
[[nodiscard]] Candidates FindCandidates(const NearField& near, double contact_tolerance_m);

/// Where planes hold a tool, and what friction takes back of its way there.
struct ContactHold {
  HoldPoint hold;        ///< from where the tool would be
  double normal_m{0.0};  ///< sum of multipliers
  /// Of these, what is worth a force. A tool that does not fit (turned askew in its own slot) is wedged
  /// between planes that all yield by the slack: of multipliers that balance one another only as much is a
  /// force as the slack is worth at the coupling's stiffness.
  double most_m{0.0};
  Vector3 friction_m{Vector3::Zero()};

  [[nodiscard]] Vector3 point_m() const { return hold.point_m + friction_m; }
};
/// Fills normal_m and most_m from the hold point.
void WeighHold(ContactHold& held);

/// @param turning  to the tool's pose; otherwise with T's origin alone, the tool kept as it was turned at
///   first contact
///
/// Friction (Coulomb, on the proxy): of the slip of the touching surface from first contact to the target,
/// mu times the normal displacements' sum is taken back, within what the planes allow.
[[nodiscard]] ContactHold HoldTool(const Candidates& candidates, const ContactInput& input, bool turning);

/// Fills contacts, delta, shift, n, cutting_m and shaft planes of the solution, and what the next frame
/// should remember.
/// @param held  turning;  @param unturned  not turning
void ReportContacts(const CuttingParams& params, const NearField& near, const Candidates& candidates,
                    const ContactHold& held, const ContactHold& unturned, const ContactInput& input,
                    ContactMemory& memory, FrameSolution& solution);

}  // namespace osteon::simulation
