#pragma once

#include <array>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/bone/material_map.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool_path.h"

// Steps that all engines share: the preparation of a frame, and the conversion of its solution into a
// ContactModel. The passes over balls and points between these steps are each engine's own.

namespace osteon::simulation {

/// Largest number of ShaftPlanes of a frame: one for each bin of balls that do not cut.
inline constexpr int kMaxShaftPlanes = 6;

/// One contact as the contact law computes it: at the tool's pose, before the advance into bone.
struct SolvedContact {
  Vector3 n{Vector3::Zero()};      ///< unit vector from bone to tool, in G; tilted by friction
  Vector3 p_T_m{Vector3::Zero()};  ///< touching point on the tool, in T
  double gap_m{0.0};               ///< gap at the tool's pose; negative: inside the bone
  double multiplier_m{0.0};        ///< part of the proxy's displacement that this contact causes, along n
  double weight{0.0};              ///< square of the overlap with the enlarged tool [m^2]
  bool cutting{true};
};

/// A plane of bone at a tool ball that does not cut. The proxy must not advance through it.
struct ShaftPlane {
  Vector3 n{Vector3::Zero()};
  double gap_m{0.0};  ///< gap at first contact
};

/// Results of a frame's passes, in G.
struct FrameSolution {
  double contact_fraction{1.0};  ///< first contact: fraction of the path from proxy to tool pose
  double slide_fraction{1.0};    ///< slide: fraction of the path from first contact to target
  double turn_fraction{1.0};     ///< turn: fraction of the turn from first contact to tool pose
  double slide_m{0.0};           ///< length of the slide, for the tool point that moves farthest
  std::array<SolvedContact, kMaxContacts> contacts{};
  int contact_count{0};
  std::array<ShaftPlane, kMaxShaftPlanes> shaft{};
  int shaft_count{0};
  /// Vector from first contact to the target of a tool that turns no further.
  Vector3 shift{Vector3::Zero()};
  Vector3 delta{Vector3::Zero()};  ///< vector from the tool's pose to the constrained target
  Vector3 n{Vector3::Zero()};      ///< direction of the resultant of the cutting planes
  double cutting_m{0.0};           ///< length of the part of delta that the cutting planes cause
  double advance_m{0.0};           ///< distance by which the bone gave way along -n
  double edge_work_J{0.0};         ///< work of the edge on chips in this frame
  double ploughing_work_J{0.0};    ///< work of the edge that takes no chip and removes no bone
  Vector3 step{Vector3::Zero()};   ///< step of the proxy into the yielding bone, after its slide
  std::array<double, kMaxMaterials> engaged_area_m2{};  ///< area projected along n, by material
  /// The same area times its distance from the spindle's axis, by material.
  std::array<double, kMaxMaterials> engaged_moment_m3{};
  Vector3 origin_contact{Vector3::Zero()};         ///< T's origin at first contact
  Vector3 origin_slid{Vector3::Zero()};            ///< T's origin after the slide
  Vector3 origin_end{Vector3::Zero()};             ///< T's origin after the advance: that of the new proxy
  std::array<double, kMaxMaterials> removed_m3{};  ///< volume cleared in this frame, by material
};

/// Longest slide of a frame: max_slide_m, or kSlideShare of it while the rate law cuts [m].
[[nodiscard]] double MaxSlide(const CuttingParams& params, const FrameInput& input);

/// Step of the proxy after its slide into bone that gives way. With the rate law it is the advance along -n.
/// With the immediate law, a cutting tool moves all the way to its pose, even if its slide was shortened or n
/// is only a mean over many balls. The exception is a tool that is held only by balls without a cutting edge.
[[nodiscard]] Vector3 ComputeAdvanceStep(const CuttingParams& params, const FrameInput& input,
                                         const FrameSolution& solution, const Vector3& origin_goal);

/// Position of T's origin after slide and step. The planes at balls that do not cut limit the step.
[[nodiscard]] Vector3 ComputeAdvanceEnd(const FrameSolution& solution);

/// The bone's materials for the engine's tool: converted by SplitCuttingEnergy if `params.edge_force` is on.
[[nodiscard]] std::vector<Material> MaterialsUnderTool(const Bone& bone, const Tool& tool,
                                                       const CuttingParams& params);

/// Work of the edges' own force in a frame [J]: each pass of an edge over the engaged area costs the
/// material's edge force,
///
///     w dt / (2 pi) sum(edge_force dA)      at most F w dt sum(mu_c r dA) / sum(dA)
///
/// Here w is the spindle's speed, dt the frame's time, dA the engaged area, r its distance from the spindle's
/// axis, and F the cutting force. The upper bound is all the work that the spindle can do on an edge pressed
/// with F: if F is below the edge's own force, the edge only rubs and takes no chip. 0 with the immediate
/// law.
/// @param materials  result of MaterialsUnderTool
[[nodiscard]] double PloughingWork(const CuttingParams& params, const std::vector<Material>& materials,
                                   const FrameSolution& solution, double spindle_rad_per_s, double dt_s);

/// Result of ComputeAdvance.
struct FrameAdvance {
  double advance_m{0.0};
  double edge_work_J{0.0};       ///< work of the cutting edge on chips in this frame
  double ploughing_work_J{0.0};  ///< result of PloughingWork for this frame
};
/// Computes how far the bone gives way in a frame, by energy balance:
///
///     power = F w sum(mu_c r dA) / sum(dA)        work per advance = sum(u_c dA)
///
/// with w the spindle's speed, r the distance from its axis, dA the engaged area projected along n (only that
/// projection sweeps volume), and F = K x, at most max_force (K: the coupling's stiffness). The work of the
/// edges' own force F_e is subtracted first (PloughingWork). The penetration x follows x' = -c (K x - F_e),
/// and its exact solution is used. So the result does not depend on the frame rate, and the advance never
/// exceeds the penetration. `energy_lead_J` is the work of mass points that were cleared ahead of the
/// balance; it is paid back over kEnergyLeadSeconds.
[[nodiscard]] FrameAdvance ComputeAdvance(const CuttingParams& params, const std::vector<Material>& materials,
                                          const FrameSolution& solution, double spindle_rad_per_s,
                                          double dt_s, double energy_lead_J);
/// Time over which energy_lead_J is paid back [s].
inline constexpr double kEnergyLeadSeconds = 0.1;

/// State that an engine keeps from frame to frame, besides balls and points.
struct FrameMemory {
  ContactMemory contact;
  Pose X_GP{Pose::Identity()};  ///< proxy in G
  bool has_proxy{false};
  double removed_volume_m3{0.0}, removed_mass_kg{0.0}, cutting_work_J{0.0}, energy_lead_J{0.0};
  std::uint64_t frame{0};
};

/// Adds a frame's cleared volume to the memory's total volume, mass and cutting work, and adds the cleared
/// points' work minus the edge's work to energy_lead_J.
/// @param removed_m3  volume cleared in the frame, by material
void BookRemoved(const CuttingParams& params, const std::vector<Material>& materials,
                 const std::array<double, kMaxMaterials>& removed_m3, double edge_work_J,
                 FrameMemory& memory);

/// Updates `memory` by the solution (proxy, volumes, energy lead) and computes the frame's ContactModel.
/// Contacts of cutting balls get the material with the largest engaged area. Other contacts, and all contacts
/// if nothing is engaged, get the material that `map` has at their place on the bone.
[[nodiscard]] ContactModel FinishFrame(const CuttingParams& params, const std::vector<Material>& materials,
                                       const MaterialMap& map, const Pose& X_WG, const FrameInput& input,
                                       const FrameSolution& solution, FrameMemory& memory);

/// Adds the model of part k (0 … n - 1) of a frame to the model of the whole frame.
void CombineParts(ContactModel& whole, const ContactModel& part, int k, int n);

/// Computes a frame in n parts, each with 1 / n of the time. Several parts are needed if the tool turns so
/// far that one straight path would deviate too much from the arc (SubframeCount). `frame(part)` computes one
/// part. The result is the last part's model, except that first contact is a fraction of the whole path.
///
/// If a part is refused after earlier parts were done, the frame ends after these, and the next frame begins
/// there. The frame is then not reported as refused, because that would mean an unchanged bone, but the
/// earlier parts have cut. Only a lost device is reported at once.
template <class Frame>
[[nodiscard]] ContactModel StepInParts(const FrameInput& input, const Pose& X_WP, int n, FrameMemory& memory,
                                       Frame frame) {
  if (n == 1) return frame(input);
  ContactModel whole;
  const std::uint64_t number = memory.frame + 1;
  for (int k = 0; k < n; ++k) {
    FrameInput part = input;
    part.X_WT = PoseBetween(X_WP, Pose(input.X_WT), k + 1, n);
    part.dt_s = input.dt_s / n;
    const ContactModel done = frame(part);
    if (done.status != EngineStatus::kOk) {
      if (k == 0 || done.status == EngineStatus::kDeviceLost) return done;
      break;
    }
    CombineParts(whole, done, k, n);
    whole.frame = memory.frame = number;
  }
  return whole;
}
/// These functions copy the part of a CarvedState that is not balls and points from the memory to the state,
/// and back.
void ToState(const FrameMemory& memory, CarvedState& state);
[[nodiscard]] FrameMemory ToMemory(const CarvedState& state);

/// Checks the part of a state that is not balls and points, before an engine restores it.
/// @throws std::invalid_argument naming what was found and what is accepted: counts beyond their arrays,
///   pairs of balls that bone and tool do not have, a proxy that is no pose, numbers that are not finite.
void CheckMemory(const CarvedState& state, std::size_t tool_balls);

/// Whether pose, spindle speed and time are finite, the pose's matrix is a rotation, and dt is in [0, 1] s.
[[nodiscard]] bool IsUsable(const FrameInput& input);

}  // namespace osteon::simulation
