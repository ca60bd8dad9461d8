#pragma once
#include <stdint.h>

// Storage of FRI's unpacked repeated scalars, named by fri.options and so included by the C code that nanopb
// generates.

#ifdef __cplusplus
extern "C" {
#endif

enum { kOsteonFriArraySize = 7 };

/// The values of one JointValues; count tells how many were on the wire.
typedef struct OsteonFriJoints {
  uint32_t count;
  double value[kOsteonFriArraySize];
} OsteonFriJoints;

/// The drive states of one RobotInfo.
typedef struct OsteonFriDriveStates {
  uint32_t count;
  uint32_t value[kOsteonFriArraySize];
} OsteonFriDriveStates;

#ifdef __cplusplus
}
#endif
