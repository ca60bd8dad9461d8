#pragma once

#include <cstdint>

#include "kinematics/spatial.h"
#include "procedure/plan/cup_axis.h"

namespace osteon::procedure {

enum class Side : std::uint8_t { kRight, kLeft };

/// Returns "right" or "left".
[[nodiscard]] const char* NameOf(Side side);

/// The pelvic landmarks, in G: both anterior superior iliac spines (ASIS) and the pubic midpoint.
struct PelvicLandmarks {
  Vector3 asis_right_m{Vector3::Zero()}, asis_left_m{Vector3::Zero()}, pubis_m{Vector3::Zero()};
};

/// The pelvic frame N of one hip: unit vectors in G. lateral points to the patient's left for a left hip, to
/// the right for a right hip. Therefore (lateral, anterior, superior) is left-handed for a left hip and
/// right-handed for a right hip.
struct PelvicFrame {
  Vector3 lateral{Vector3::UnitX()}, anterior{Vector3::UnitY()}, superior{Vector3::UnitZ()};

  [[nodiscard]] Vector3 ToG(const Vector3& v_N) const {
    return v_N.x() * lateral + v_N.y() * anterior + v_N.z() * superior;
  }
  [[nodiscard]] Vector3 FromG(const Vector3& v_G) const {
    return {v_G.dot(lateral), v_G.dot(anterior), v_G.dot(superior)};
  }
};

/// Computes the frame of the anterior pelvic plane. With m the middle of the spines and P the pubis:
///
///     t = unit(ASIS_left - ASIS_right)     superior = unit(m - P less its part along t)
///     anterior = t × superior              lateral = t (left hip) or -t (right hip)
///
/// @throws std::invalid_argument if the spines are less than 50 mm apart, or the pubis is less than 20 mm
/// from the line through them.
[[nodiscard]] PelvicFrame FrameOf(const PelvicLandmarks& landmarks, Side side);

/// @throws std::invalid_argument if the axes are not perpendicular within 1e-3, or if the frame is that of
/// the other side: lateral × superior must be anterior for a left hip, and -anterior for a right hip.
void CheckFrame(const PelvicFrame& frame, Side side);

/// Returns the frame in which the cup's angles are measured if the pelvis is tilted backwards by tau [rad] in
/// that frame. The axes are turned about the lateral axis. A cup that is fixed in the pelvis keeps its
/// operative inclination, and its operative anteversion grows by exactly tau.
[[nodiscard]] PelvicFrame Tilted(const PelvicFrame& frame, double tau_rad);

/// Returns the standard deviations of the cup angles of a fixed axis a_G if each landmark coordinate has the
/// standard deviation `sd_m`, to first order.
[[nodiscard]] CupAngles LandmarkSpread(const PelvicLandmarks& landmarks, Side side, double tau_rad,
                                       CupDefinition definition, const Vector3& a_G, double sd_m);

}  // namespace osteon::procedure
