#pragma once

// Faults planted in copies of kinematics/serial_chain.cpp and safety/zone.cpp (plant_faults.cmake): one at a
// time, of sign, offset or axis, in each function that the guard once shared with the servo loop.

namespace osteon::planted {

enum class Fault {
  kNone,
  // faults of kinematics::SerialChain: in its constructor, in Walk (used by Place and FlangePose) and in
  // FillJacobian (used by Jacobian and JacobianAt)
  kJointSign,       // A2 turns in the opposite direction
  kJointAxis,       // A3 is tilted in the opposite direction
  kJointOrigin,     // A3 is displaced by 30 mm sideways
  kJointZero,       // A4's zero is wrong by 0.1 rad
  kFlangeOrigin,    // the flange is 30 mm farther out
  kFlangeAxis,      // the flange is turned by 1 rad
  kJacobianSign,    // A1's column has the wrong sign
  kJacobianOffset,  // levers are taken from points 300 mm beside the axes
  kJacobianAxis,    // A2's column is computed for another axis
  // faults of safety::ZoneBounds: in its constructor, KeepIn, KeepOut, the helpers of both, and distance_m
  kZoneSign,         // the displacement from the point to the zone has the wrong sign
  kZoneOrigin,       // the zone is displaced
  kZoneAxis,         // the zone's rotation is inverted
  kZoneDirection,    // the resulting directions are rotated by the inverse
  kInHalfSpaceSign,  // KeepIn: wrong sign
  kInBoxOffset,      // this and the other offsets of KeepIn are 20 mm
  kInCylinderOffset,
  kInCylinderEndSign,
  kInSphereOffset,
  kAxisOffset,        // a capsule's axis is 20 mm longer
  kOutHalfSpaceSign,  // KeepOut: the direction away from the set instead of toward it
  kOutBoxOffset,
  kOutCylinderOffset,
  kOutSphereOffset,
  kOutSphereSign,  // the same fault for a sphere
  kGapsSign,       // the same fault for boxes and cylinders
  kMaxOfAll,       // distance_m: the farthest face instead of the nearest
};

inline Fault fault = Fault::kNone;  ///< the fault that acts now
/// Whether this fault acts now; the copies of the sources ask for it.
[[nodiscard]] inline bool Is(Fault which) { return fault == which; }

}  // namespace osteon::planted
