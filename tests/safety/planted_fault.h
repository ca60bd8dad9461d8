#pragma once

// What the spoilt copies of kinematics/serial_chain.cpp and safety/zone.cpp do wrong (plant_faults.cmake):
// one fault at a time, of sign, offset or axis, in each function that the guard once shared with the servo
// loop.

namespace osteon::planted {

enum class Fault {
  kNone,
  // kinematics::SerialChain: its constructor, Walk (Place, FlangePose) and FillJacobian (Jacobian,
  // JacobianAt)
  kJointSign,       // A2 turns the other way
  kJointAxis,       // A3 is tilted the other way
  kJointOrigin,     // A3 stands 30 mm beside its place
  kJointZero,       // A4's zero is off by 0.1 rad
  kFlangeOrigin,    // the flange is 30 mm further out
  kFlangeAxis,      // and turned by 1 rad
  kJacobianSign,    // of A1's column
  kJacobianOffset,  // levers from 300 mm beside the axes
  kJacobianAxis,    // A2's column about another axis
  // safety::ZoneBounds: its constructor, KeepIn, KeepOut, the helpers of the two, distance_m
  kZoneSign,  // the way from the point to the zone in place of the other
  kZoneOrigin,
  kZoneAxis,         // the zone's rotation, the wrong way round
  kZoneDirection,    // the same of the directions that come out
  kInHalfSpaceSign,  // KeepIn …
  kInBoxOffset,      // … each 20 mm
  kInCylinderOffset,
  kInCylinderEndSign,
  kInSphereOffset,
  kAxisOffset,        // a capsule's axis is 20 mm longer
  kOutHalfSpaceSign,  // KeepOut …: away from the set in place of toward it
  kOutBoxOffset,
  kOutCylinderOffset,
  kOutSphereOffset,
  kOutSphereSign,  // as of the half-space
  kGapsSign,       // the same of boxes and cylinders
  kLargestOfAll,   // distance_m: the farthest face in place of the nearest
};

inline Fault fault = Fault::kNone;
[[nodiscard]] inline bool Is(Fault which) { return fault == which; }

}  // namespace osteon::planted
