#pragma once

#include <array>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/bone/material_map.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool_path.h"

// Steps that both engines share: how a frame is prepared from poses, and how its solution becomes a
// ContactModel. Each engine has its own passes over balls and points in between.

namespace osteon::simulation {

/// Largest number of ShaftPlanes of a frame: one for each bin of balls that do not cut.
inline constexpr int kMaxShaftPlanes = 6;

/// One contact as the contact law reports it, at the tool's pose, before the advance.
struct SolvedContact {
  Vector3 n{Vector3::Zero()};      ///< unit, from bone to tool, in G; tilted by friction
  Vector3 p_T_m{Vector3::Zero()};  ///< touching point on the tool, in T
  double gap_m{0.0};               ///< at the tool's pose; negative inside
  double multiplier_m{0.0};        ///< the contact's part of the proxy's displacement, along n
  double weight{0.0};              ///< square of the overlap with the enlarged tool [m^2]
  bool cutting{true};
};

/// A plane at a ball that does not cut. The proxy may not advance into it.
struct ShaftPlane {
  Vector3 n{Vector3::Zero()};
  double gap_m{0.0};  ///< at first contact
};

/// Results of a frame's passes, in G.
struct FrameSolution {
  double contact_fraction{1.0};  ///< first contact, on the path from the proxy to the tool's pose
  double slide_fraction{1.0};    ///< slide, on the way from first contact to the constrained target
  double turn_fraction{1.0};     ///< turn, from first contact to the tool's pose
  double slide_m{0.0};           ///< length of the slide, of the tool point that moves farthest
  std::array<SolvedContact, kMaxContacts> contacts{};
  int contact_count{0};
  std::array<ShaftPlane, kMaxShaftPlanes> shaft{};
  int shaft_count{0};
  /// From first contact to the target of a tool that does not turn any further.
  Vector3 shift{Vector3::Zero()};
  Vector3 delta{Vector3::Zero()};  ///< from the tool's pose to the constrained target
  Vector3 n{Vector3::Zero()};      ///< direction of the cutting planes' resultant
  double cutting_m{0.0};           ///< length of the cutting planes' share of delta
  double advance_m{0.0};           ///< how far the bone gave way along -n
  double edge_work_J{0.0};         ///< work of the edge on chips in this frame
  double ploughing_work_J{0.0};    ///< work of the edge beside chips, which removes nothing
  Vector3 step{Vector3::Zero()};   ///< step of the proxy, after its slide, into the bone that gives way
  std::array<double, kMaxMaterials> engaged_area_m2{};  ///< projected on n, by material
  /// The same area times its distance from the spindle's axis.
  std::array<double, kMaxMaterials> engaged_moment_m3{};
  Vector3 origin_contact{Vector3::Zero()};         ///< T's origin at first contact
  Vector3 origin_slid{Vector3::Zero()};            ///< after sliding
  Vector3 origin_end{Vector3::Zero()};             ///< after the advance: the new proxy
  std::array<double, kMaxMaterials> removed_m3{};  ///< cleared in this frame, by material
};

/// Longest slide of a frame: max_slide_m, or kSlideShare of it where the rate law cuts as well [m].
[[nodiscard]] double MaxSlide(const CuttingParams& params, const FrameInput& input);

/// Step of the slid proxy where the bone gives way: the advance along -n. With the immediate law a cutting
/// tool goes all the way to its pose, even if its slide was cut short or n is only a mean over many balls.
/// The exception is a tool that only balls without a cutting edge hold.
[[nodiscard]] Vector3 ComputeAdvanceStep(const CuttingParams& params, const FrameInput& input,
                                         const FrameSolution& solution, const Vector3& origin_goal);

/// Position of the slid proxy after its step, held back by the planes of the balls that do not cut.
[[nodiscard]] Vector3 ComputeAdvanceEnd(const FrameSolution& solution);

/// The bone's materials as the engine's tool meets them: SplitCuttingEnergy where `params.edge_force` is on.
[[nodiscard]] std::vector<Material> MaterialsUnderTool(const Bone& bone, const Tool& tool,
                                                       const CuttingParams& params);

/// Work of the edges' own force in a frame [J]: each pass of an edge over the engaged area costs the
/// material's edge force,
///
///     w dt / (2 pi) sum(edge_force dA)      at most F w dt sum(mu_c r dA) / sum(dA)
///
/// The bound is all the work that the spindle can do on an edge pressed with F: below the edge's force the
/// edge rubs and takes no chip. 0 with the immediate law.
/// @param materials  of MaterialsUnderTool
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
/// with dA the engaged area projected on the plane normal to n (only that projection sweeps volume), and F =
/// K x, at most max_force. The edges' own force F_e takes its part of the power first (PloughingWork). For
/// the penetration x the law x' = -c (K x - F_e) has the exact solution used here. The result therefore does
/// not depend on the frame rate, and the advance never exceeds the penetration. `energy_lead_J` is work of
/// points cleared in excess of the balance; it is paid back over kEnergyLeadSeconds.
[[nodiscard]] FrameAdvance ComputeAdvance(const CuttingParams& params, const std::vector<Material>& materials,
                                          const FrameSolution& solution, double spindle_rad_per_s,
                                          double dt_s, double energy_lead_J);
/// Time over which energy_lead_J is paid back [s].
inline constexpr double kEnergyLeadSeconds = 0.1;

/// State of an engine from frame to frame, besides balls and points.
struct FrameMemory {
  ContactMemory contact;
  Pose X_GP{Pose::Identity()};  ///< proxy in G
  bool has_proxy{false};
  double removed_volume_m3{0.0}, removed_mass_kg{0.0}, cutting_work_J{0.0}, energy_lead_J{0.0};
  std::uint64_t frame{0};
};

/// Adds a frame's cleared volume to the memory's total volume, mass and cutting work, and updates
/// energy_lead_J by the cleared points' work minus the edge's work.
/// @param removed_m3  by material
void BookRemoved(const CuttingParams& params, const std::vector<Material>& materials,
                 const std::array<double, kMaxMaterials>& removed_m3, double edge_work_J,
                 FrameMemory& memory);

/// Enters the solution into `memory` (proxy, volumes, energy lead) and computes the frame's ContactModel.
/// Contacts of cutting balls get the material with the largest engaged area. Other contacts, and all contacts
/// where nothing is engaged, get the material that `map` has at their place on the bone.
[[nodiscard]] ContactModel FinishFrame(const CuttingParams& params, const std::vector<Material>& materials,
                                       const MaterialMap& map, const Pose& X_WG, const FrameInput& input,
                                       const FrameSolution& solution, FrameMemory& memory);

/// Adds the finished part k (from 0) of n to the whole frame's model.
void CombineParts(ContactModel& whole, const ContactModel& part, int k, int n);

/// Computes a frame in n parts, each a frame with its share of the time. A turn needs several parts where one
/// chord would leave its arc (SubframeCount). `frame(part)` computes one part. The last part's model stands
/// for the whole, but first contact is a fraction of the whole way.
///
/// Where a part is refused after others were done, the frame ends with those and the next frame begins there.
/// Their cuts stay, so the whole is not reported as refused, which would mean an unchanged bone. Only a lost
/// device is reported at once.
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
/// Copy the part of a CarvedState that is not balls and points, from the memory or into it.
void ToState(const FrameMemory& memory, CarvedState& state);
[[nodiscard]] FrameMemory ToMemory(const CarvedState& state);

/// Checks the part of a state that is not balls and points, before an engine restores it.
/// @throws std::invalid_argument naming what was found and what is accepted: counts beyond their arrays,
///   pairs of balls that bone and tool do not have, a proxy that is no pose, numbers that are not finite.
void CheckMemory(const CarvedState& state, std::size_t tool_balls);

/// True where pose, spindle and time are finite, the pose is a rotation, and dt is in [0, 1] s.
[[nodiscard]] bool IsUsable(const FrameInput& input);

}  // namespace osteon::simulation
