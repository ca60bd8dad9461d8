#pragma once

#include <array>
#include <vector>

#include "control/rt/marker.h"
#include "kinematics/spatial.h"
#include "safety/zone.h"

namespace osteon::safety {

/// Where the tool's apex may be, inside a sphere and on the keep-in side of a plane, and zones for it, for
/// the flange and for the elbow.
struct WorkspaceParams {
  Vector3 sphere_center_W_m{Vector3::Zero()};
  double sphere_radius_m{1.5};               ///< > 0
  Vector3 plane_normal_W{Vector3::UnitZ()};  ///< unit, pointing to the side to keep in
  double plane_offset_m{-1.0};               ///< keep in: normal·p >= offset
  std::vector<ZoneParams> zones{};           ///< as many as Workspace::kMostZones
  double deceleration_m_per_s2{3.0};         ///< that a stop may count on; > 0
  double tolerance_m{1e-6};                  ///< outside by more than this is a fault; >= 0
};

/// Keeps points of the arm in their workspace.
///
/// The speed at which a point nears a bound is kept below BrakingSpeed of its distance, so that a stop ends
/// before it. Of the apex, first only the component toward each bound is reduced, so that the tool slides
/// along; then what leads it out at the end of a stop straight on from there is taken off as well, so that
///
///     p + v (dt + |v| / 2a)  in every set that is kept in (they are convex: so is all of the way)
///
/// It slides along flat and curved bounds, and comes to one at a slant in dt + |v| / 2a. Where several bounds
/// meet and that does not end, the whole velocity is scaled. Flange and elbow go where the joints take them:
/// a step of those is scaled as a whole.
class Workspace {
 public:
  static constexpr std::size_t kMostZones = 16;

  /// @throws std::invalid_argument where a value is out of range.
  explicit Workspace(const WorkspaceParams& params);

  /// Whether there is anything to heed for that point; for the apex there always is.
  [[nodiscard]] bool Has(ZonePoint point) const OSTEON_RT { return !Bounds(point).empty(); }

  /// Distance of a point of the arm, the apex where none is said, to its nearest bound [m]; negative outside,
  /// infinite where it has none.
  [[nodiscard]] double Distance(const Vector3& p_WP, ZonePoint point = ZonePoint::kApex) const OSTEON_RT;
  /// True where it is outside by more than the tolerance, or not finite.
  [[nodiscard]] bool Violated(const Vector3& p_WP, ZonePoint point = ZonePoint::kApex) const OSTEON_RT;

  struct Result {
    Vector3 v_WT{Vector3::Zero()};
    bool acted{false};
  };
  /// The velocity that the apex may have in the coming tick. Zero for input that is not finite.
  [[nodiscard]] Result Limit(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;

  /// Share of a tick's way of a point that it may go, 0 … 1, each of its bounds heeded. Of a straight way; of
  /// a curved one the share is to be asked for again.
  [[nodiscard]] double Share(ZonePoint point, const Vector3& p_WP, const Vector3& p_next_WP,
                             double dt_s) const OSTEON_RT;

  /// Whether a step takes a point out of one of WorkspaceParams::zones, or further out of one that it is out
  /// of: for a way that begins outside, such as that of an arm which is not at its start yet. The apex's
  /// sphere and plane do not count.
  [[nodiscard]] bool LeavesZone(ZonePoint point, const Vector3& p_WP,
                                const Vector3& p_next_WP) const OSTEON_RT;

  /// Whether Limit would leave that velocity of the apex alone, but for rounding.
  [[nodiscard]] bool Allows(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;

  /// Whether a stop of the apex from that velocity ends inside, or so far beyond a bound, after one more tick
  /// of it.
  [[nodiscard]] bool StopsInside(const Vector3& p_WT, const Vector3& v_WT, double dt_s,
                                 double slack_m = 0.0) const OSTEON_RT;

 private:
  /// Seconds at the speed that a stop begins with, for the way that it takes.
  [[nodiscard]] double StopTime(const Vector3& v_WT, double dt_s) const OSTEON_RT {
    return dt_s + 0.5 * v_WT.norm() / params_.deceleration_m_per_s2;
  }
  /// What is left of a velocity so that its stop ends inside: turned along the bounds where that does, scaled
  /// as a whole where not.
  [[nodiscard]] Vector3 StoppingInside(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT;
  /// The velocity nearest to it that ends inside after so long.
  [[nodiscard]] Vector3 TurnedInside(const Vector3& p_WT, const Vector3& v_WT, double look_s) const OSTEON_RT;

  static constexpr std::size_t kOwn = 2;  // bounds of the apex that are no zones: sphere and plane

  [[nodiscard]] const std::vector<ZoneParams>& Bounds(ZonePoint point) const OSTEON_RT {
    return bounds_[static_cast<std::size_t>(point)];
  }

  WorkspaceParams params_;
  std::array<std::vector<ZoneParams>, 3> bounds_;  // by ZonePoint; the apex's own first
};

}  // namespace osteon::safety
