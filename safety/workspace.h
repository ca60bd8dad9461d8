#pragma once

#include <array>
#include <vector>

#include "base/marker.h"
#include "kinematics/spatial.h"
#include "safety/zone.h"

namespace osteon::safety {

/// Bounds of the tool's apex, which stays inside a sphere and on one side of a plane; and zones for the apex,
/// the flange and the elbow.
struct WorkspaceParams {
  Vector3 sphere_center_W_m{Vector3::Zero()};
  double sphere_radius_m{1.5};               ///< > 0
  Vector3 plane_normal_W{Vector3::UnitZ()};  ///< unit, pointing to the side to keep in
  double plane_offset_m{-1.0};               ///< keep in: normal·p >= offset
  std::vector<ZoneParams> zones{};           ///< at most Workspace::kMaxZones
  double deceleration_m_per_s2{3.0};         ///< deceleration that a stop can rely on; > 0
  double tolerance_m{1e-6};                  ///< a point outside by more than this is a fault; >= 0
};

/// Keeps points of the arm in their workspace.
///
/// The speed of a point toward a bound is kept below BrakingSpeed of its distance, so that a stop ends before
/// the bound. For the apex, first only the component toward each bound is reduced, so that the tool slides
/// along it. Then the part of the velocity that would lead a straight stop out of a set is removed as well,
/// so that
///
///     p + v (dt + |v| / 2a)  in every set that is kept in (they are convex: so is the whole path)
///
/// The apex slides along flat and curved bounds, and approaches a bound at a slant in dt + |v| / 2a. Where
/// several bounds meet and this does not converge, the whole velocity is scaled. Flange and elbow move with
/// the joints: for them the joint step is scaled as a whole.
class Workspace {
 public:
  static constexpr std::size_t kMaxZones = 16;

  /// @throws std::invalid_argument where a value is out of range.
  explicit Workspace(const WorkspaceParams& params);

  /// Whether the point has bounds; the apex always has.
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

  /// Share of a point's displacement in a tick that keeps to all of its bounds, 0 … 1. Holds for a straight
  /// displacement; for a curved one, check the share again.
  [[nodiscard]] double Share(ZonePoint point, const Vector3& p_WP, const Vector3& p_next_WP,
                             double dt_s) const OSTEON_RT;

  /// Whether a step takes a point out of one of WorkspaceParams::zones, or further out of a zone that it is
  /// outside of already. For a path that begins outside, e.g. of an arm on its way to its start. Ignores the
  /// apex's sphere and plane.
  [[nodiscard]] bool LeavesZone(ZonePoint point, const Vector3& p_WP,
                                const Vector3& p_next_WP) const OSTEON_RT;

  /// Whether Limit would leave this velocity of the apex unchanged, within rounding.
  [[nodiscard]] bool Allows(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;

  /// Whether a stop of the apex from this velocity, after one more tick of it, ends inside, or at most
  /// slack_m beyond a bound.
  [[nodiscard]] bool StopsInside(const Vector3& p_WT, const Vector3& v_WT, double dt_s,
                                 double slack_m = 0.0) const OSTEON_RT;

 private:
  /// Length of the stop's path over the speed at which the stop begins [s].
  [[nodiscard]] double StopTime(const Vector3& v_WT, double dt_s) const OSTEON_RT {
    return dt_s + 0.5 * v_WT.norm() / params_.deceleration_m_per_s2;
  }
  /// Reduces a velocity so that its stop ends inside: turned along the bounds if possible, else scaled.
  [[nodiscard]] Vector3 StoppingInside(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;
  /// The velocity nearest to v_WT that leads to a place inside within look_s; may fail where several bounds
  /// meet.
  [[nodiscard]] Vector3 TurnedInside(const Vector3& p_WT, const Vector3& v_WT, double look_s) const OSTEON_RT;

  static constexpr std::size_t kOwn = 2;  // the apex's bounds that are not zones: sphere and plane

  [[nodiscard]] const std::vector<ZoneParams>& Bounds(ZonePoint point) const OSTEON_RT {
    return bounds_[static_cast<std::size_t>(point)];
  }

  WorkspaceParams params_;
  std::array<std::vector<ZoneParams>, 3> bounds_;  // by ZonePoint; sphere and plane first
};

}  // namespace osteon::safety
