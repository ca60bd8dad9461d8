#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/marker.h"
#include "kinematics/spatial.h"

// Convex sets in space, and points of the arm that are kept in or out of them.

namespace osteon::safety {

enum class ZoneShape : std::uint8_t { kHalfSpace, kSphere, kBox, kCylinder, kCapsule };
enum class ZoneSide : std::uint8_t { kKeepIn, kKeepOut };
/// The constrained point: the tool's apex, the centre of the flange, or the centre of the elbow (for a
/// six-axis arm the axis of A3).
enum class ZonePoint : std::uint8_t { kApex, kFlange, kElbow };

/// A convex set and the point that has to keep to it. Fields that the shape does not name are ignored.
struct ZoneParams {
  ZoneShape shape{ZoneShape::kHalfSpace};
  ZoneSide side{ZoneSide::kKeepIn};
  ZonePoint point{ZonePoint::kApex};
  /// For a half-space a point of its face, for other shapes the centre.
  Vector3 p_W_m{Vector3::Zero()};
  /// Orientation of the set. Box: the columns are the directions of the edges. Cylinder and capsule: column 2
  /// is the axis. Half-space: column 2 points into the half-space.
  Matrix3 R_W{Matrix3::Identity()};
  Vector3 half_edge_m{Vector3::Ones()};  ///< box; each > 0
  double radius_m{1.0};                  ///< sphere, cylinder, capsule; > 0
  double half_length_m{1.0};  ///< half the length of a cylinder between its ends, of a capsule between the
                              ///< centres of its end balls; > 0
};

/// Checks the parameters. @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const ZoneParams& zone);

/// A face of a zone as seen from a point: direction and distance.
struct ZoneBound {
  Vector3 toward_W{Vector3::Zero()};  ///< unit, from the allowed side to the forbidden side
  double distance_m{0.0};             ///< along toward_W; negative if the point is past the face
};

/// The faces of a zone as seen from a point at p_WP. A keep-in box has six faces and a keep-in cylinder
/// three; other keep-in sets and all keep-out sets have one, the nearest. The point keeps the zone if no
/// distance is negative.
class ZoneBounds {
 public:
  static constexpr std::size_t kMax = 6;

  /// @pre p_WP finite
  ZoneBounds(const ZoneParams& zone, const Vector3& p_WP) OSTEON_RT;

  [[nodiscard]] std::span<const ZoneBound> all() const OSTEON_RT { return {bounds_.data(), count_}; }
  /// Distance to the nearest face [m]. Along any path it decreases by at most the length of the path.
  [[nodiscard]] double distance_m() const OSTEON_RT;

 private:
  void Add(const Vector3& toward_W, double distance_m) OSTEON_RT {
    bounds_[count_++] = {.toward_W = toward_W, .distance_m = distance_m};
  }
  // KeepIn and KeepOut fill in the faces. They express toward_W in the zone's frame Z; the constructor
  // converts it to W. p_Z: the point in Z.
  void KeepIn(const ZoneParams& zone, const Vector3& p_Z) OSTEON_RT;
  void KeepOut(const ZoneParams& zone, const Vector3& p_Z) OSTEON_RT;

  std::array<ZoneBound, kMax> bounds_{};
  std::size_t count_{0};
};

}  // namespace osteon::safety
