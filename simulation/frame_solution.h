#pragma once

#include <array>
#include <vector>

#include "simulation/bone.h"
#include "simulation/cutting_engine.h"
#include "simulation/material_map.h"
#include "simulation/tool_path.h"

// What both engines share: how a frame is prepared from poses, and how its solution becomes a ContactModel.
// What lies between (the passes over balls and points) each engine does in its own way.

namespace osteon::simulation {

inline constexpr int kMaxShaftPlanes = 6;

/// One contact as the contact law reports it, at the tool's pose, before the advance.
struct SolvedContact {
  Vector3 n{Vector3::Zero()};      ///< unit, from bone to tool, in G; tilted by friction
  Vector3 p_T_m{Vector3::Zero()};  ///< touching point on the tool, in T
  double gap_m{0.0};               ///< negative inside
  double multiplier_m{0.0};        ///< its share of the proxy's displacement, along n
  double weight{0.0};              ///< square of the overlap with the enlarged tool [m^2]
  bool cutting{true};
};

/// A plane that touches a ball that does not cut, where the proxy may not advance.
struct ShaftPlane {
  Vector3 n{Vector3::Zero()};
  double gap_m{0.0};  ///< at first contact
};

/// What the passes of a frame have found, in G.
struct FrameSolution {
  double contact_fraction{1.0};  ///< first contact on the path from the proxy to the tool
  double slide_fraction{1.0};    ///< of the way from there to the constrained target
  double turn_fraction{1.0};     ///< of the turn from there to the tool's pose
  double slide_m{0.0};           ///< length of that part, of the tool point that moves farthest
  std::array<SolvedContact, kMaxContacts> contacts{};
  int contact_count{0};
  std::array<ShaftPlane, kMaxShaftPlanes> shaft{};
  int shaft_count{0};
  Vector3 shift{
      Vector3::Zero()};  ///< from first contact to the target of a tool that does not turn any further
  Vector3 delta{Vector3::Zero()};                       ///< from the tool's pose to the constrained target
  Vector3 n{Vector3::Zero()};                           ///< direction of the cutting planes' resultant
  double cutting_m{0.0};                                ///< length of the cutting planes' share of delta
  double advance_m{0.0};                                ///< how far the bone gave way along -n
  double edge_work_J{0.0};                              ///< of the edge in this frame
  Vector3 step{Vector3::Zero()};                        ///< of the slid proxy into the bone that gives way
  std::array<double, kMaxMaterials> engaged_area_m2{};  ///< projected on n, by material
  std::array<double, kMaxMaterials>
      engaged_moment_m3{};                         ///< the same, times the distance to the spindle's axis
  Vector3 origin_contact{Vector3::Zero()};         ///< T's origin at first contact
  Vector3 origin_slid{Vector3::Zero()};            ///< after sliding
  Vector3 origin_end{Vector3::Zero()};             ///< after the advance: the new proxy
  std::array<double, kMaxMaterials> removed_m3{};  ///< cleared in this frame, by material
};

/// How far a frame's slide may go: max_slide_m, or kSlideShare of it where the rate law cuts as well [m].
[[nodiscard]] double MostSlide(const CuttingParams& params, const FrameInput& input);

/// What the slid proxy goes on by where the bone gives way: along -n by the advance. With the immediate law a
/// cutting tool goes all the way to its pose, be it that its slide was cut short or that n is a mean over
/// many balls; but where balls that do not cut hold it alone.
[[nodiscard]] Vector3 StepOfAdvance(const CuttingParams& params, const FrameInput& input,
                                    const FrameSolution& solution, const Vector3& origin_goal);

/// The slid proxy after its step, held back by the planes of the balls that do not cut.
[[nodiscard]] Vector3 EndOfAdvance(const FrameSolution& solution);

/// What a frame's cutting does.
struct FrameAdvance {
  double advance_m{0.0};
  double edge_work_J{0.0};  ///< of the cutting edge in this frame
};
/// How far the bone gives way in a frame, by energy balance:
///
///     power = F w sum(mu_c r dA) / sum(dA)        work per advance = sum(u_c dA)
///
/// with dA the engaged area projected on the plane normal to n (only that projection sweeps volume), F = K x
/// at most max_force. With x the penetration the law x' = -c K x has the exact solution used here, so that
/// the result does not depend on the frame rate; the advance never exceeds the penetration. `debt_J` is work
/// that was done but not paid for (points cleared in excess of the balance); it is paid back over
/// kDebtSeconds.
[[nodiscard]] FrameAdvance AdvanceOfFrame(const CuttingParams& params, const std::vector<Material>& materials,
                                          const FrameSolution& solution, double spindle_rad_per_s,
                                          double dt_s, double debt_J);
inline constexpr double kDebtSeconds = 0.1;

/// What an engine carries from frame to frame besides balls and points.
struct FrameMemory {
  ContactMemory contact;
  Pose X_GP{Pose::Identity()};  ///< proxy in G
  bool has_proxy{false};
  double removed_volume_m3{0.0}, removed_mass_kg{0.0}, cutting_work_J{0.0}, debt_J{0.0};
  std::uint64_t frame{0};
};

/// Books what a frame has cleared, by material: volume, mass, cutting work, and the debt that the edge's own
/// work leaves.
void BookRemoved(const CuttingParams& params, const std::vector<Material>& materials,
                 const std::array<double, kMaxMaterials>& removed_m3, double edge_work_J,
                 FrameMemory& memory);

/// Books the solution in `memory` (proxy, volumes, debt) and writes the frame's ContactModel. The contacts of
/// balls that cut have the material of which most is engaged; the others, and all where nothing is engaged,
/// have the material that `map` tells at their place on the bone.
[[nodiscard]] ContactModel FinishFrame(const CuttingParams& params, const std::vector<Material>& materials,
                                       const MaterialMap& map, const Pose& X_WG, const FrameInput& input,
                                       const FrameSolution& solution, FrameMemory& memory);

/// Takes part number k of n, which is done, into the whole.
void CombineParts(ContactModel& whole, const ContactModel& part, int k, int n);

/// A frame in n parts, each a frame of its own with its share of the time: a turn so large that one chord
/// would leave its arc (SubframeCount). `frame(part)` does one; the last one's model stands for all, but
/// first contact is a fraction of the whole way.
///
/// Where a part is refused after others were done, the frame ends with those: what they cut is cut, so the
/// whole is no refused frame, which would have changed nothing. The next frame begins where they ended. Only
/// a lost device is told at once.
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
/// The part of a CarvedState that is not balls and points.
void ToState(const FrameMemory& memory, CarvedState& state);
[[nodiscard]] FrameMemory ToMemory(const CarvedState& state);

/// Looks at the part of a state that is not balls and points before an engine takes it.
/// @throws std::invalid_argument naming what was found and what is accepted: counts beyond their arrays,
///   pairs of balls that bone and tool do not have, a proxy that is no pose, numbers that are not finite.
void CheckMemory(const CarvedState& state, std::size_t tool_balls);

/// True where pose, spindle and time are finite, the pose is a rotation, and dt is in [0, 1] s.
[[nodiscard]] bool IsUsable(const FrameInput& input);

}  // namespace osteon::simulation
