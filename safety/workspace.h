#pragma once

#include <array>
#include <vector>

#include "base/marker.h"
#include "kinematics/spatial.h"
#include "safety/zone.h"

namespace osteon::safety {

/// Bounds of points of the arm: a sphere in which the tool's apex stays, a plane on one side of which the
/// apex stays, and zones for the apex, the flange and the elbow.
struct WorkspaceParams {
  Vector3 sphere_center_W_m{Vector3::Zero()};
  double sphere_radius_m{1.5};               ///< > 0
  Vector3 plane_normal_W{Vector3::UnitZ()};  ///< unit, points to the allowed side
  double plane_offset_m{-1.0};               ///< allowed: normal·p >= offset
  std::vector<ZoneParams> zones{};           ///< at most Workspace::kMaxZones
  double deceleration_m_per_s2{3.0};         ///< deceleration that every stop can reach; > 0
  double tolerance_m{1e-6};                  ///< a point outside by more than this is a fault; >= 0
};

/// Keeps points of the arm in their workspace.
///
/// The speed of a point toward a bound is kept below BrakingSpeed of its distance, so that a stop ends before
/// the bound. For the apex, first only the velocity component toward each bound is reduced, so that the tool
/// slides along the bound. Then the part of the velocity with which a straight stop would end outside a set
/// is removed, so that
///
///     p + v (dt + |v| / 2a)  is in every keep-in set
///
/// This point is the end of one more tick and a stop with deceleration a. Keep-in sets are convex, so the
/// whole path to it is inside. The apex can slide along flat and curved bounds. If several bounds meet and
/// this does not converge, the whole velocity is scaled. Flange and elbow move with the joints, so for them
/// the whole joint step is scaled (Share).
class Workspace {
 public:
  static constexpr std::size_t kMaxZones = 16;

  /// @throws std::invalid_argument if a value is out of range.
  explicit Workspace(const WorkspaceParams& params);

  /// Whether the point has bounds; the apex always has some.
  [[nodiscard]] bool Has(ZonePoint point) const OSTEON_RT { return !Bounds(point).empty(); }

  /// Distance of a point of the arm (by default the apex) to its nearest bound [m]; negative outside,
  /// infinite if it has no bounds.
  [[nodiscard]] double Distance(const Vector3& p_WP, ZonePoint point = ZonePoint::kApex) const OSTEON_RT;
  /// Whether the point is outside by more than the tolerance, or not finite.
  [[nodiscard]] bool Violated(const Vector3& p_WP, ZonePoint point = ZonePoint::kApex) const OSTEON_RT;

  struct Result {
    Vector3 v_WT{Vector3::Zero()};
    bool acted{false};
  };
  /// Limits the apex' velocity in the coming tick. Zero for input that is not finite.
  [[nodiscard]] Result Limit(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;

  /// Largest share 0 … 1 of a point's displacement in a tick for which the point keeps all of its bounds.
  /// Valid for a straight displacement; for a curved one, check the result again.
  [[nodiscard]] double Share(ZonePoint point, const Vector3& p_WP, const Vector3& p_next_WP,
                             double dt_s) const OSTEON_RT;

  /// Whether a step takes a point out of one of WorkspaceParams::zones, or further out of a zone that it is
  /// already outside of. Use it for a path that may begin outside, such as the path to the start. Ignores the
  /// apex's sphere and plane.
  [[nodiscard]] bool LeavesZone(ZonePoint point, const Vector3& p_WP,
                                const Vector3& p_next_WP) const OSTEON_RT;

  /// Whether Limit would leave this velocity of the apex unchanged, within rounding.
  [[nodiscard]] bool Allows(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;

  /// Whether the apex ends inside, or at most slack_m beyond a bound, if it keeps this velocity for one more
  /// tick and then stops.
  [[nodiscard]] bool StopsInside(const Vector3& p_WT, const Vector3& v_WT, double dt_s,
                                 double slack_m = 0.0) const OSTEON_RT;

 private:
  /// Length of the path of one more tick and the stop, divided by the speed [s].
  [[nodiscard]] double StopTime(const Vector3& v_WT, double dt_s) const OSTEON_RT {
    return dt_s + 0.5 * v_WT.norm() / params_.deceleration_m_per_s2;
  }
  /// Changes a velocity so that a stop from it ends inside: turns it along the bounds if possible, otherwise
  /// scales it.
  [[nodiscard]] Vector3 StoppingInside(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;
  /// The velocity nearest to v_WT with which the apex is inside after look_s; may fail if several bounds
  /// meet.
  [[nodiscard]] Vector3 TurnedInside(const Vector3& p_WT, const Vector3& v_WT, double look_s) const OSTEON_RT;

  static constexpr std::size_t kOwn = 2;  // the apex's bounds that are not zones: sphere and plane

  [[nodiscard]] const std::vector<ZoneParams>& Bounds(ZonePoint point) const OSTEON_RT {
    return bounds_[static_cast<std::size_t>(point)];
  }

  WorkspaceParams params_;
  std::array<std::vector<ZoneParams>, 3> bounds_;  // index: ZonePoint; sphere and plane come first
};

}  // namespace osteon::safety
