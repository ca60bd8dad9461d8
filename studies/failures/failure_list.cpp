#include <array>

#include "studies/failures/compliance/compliance_scenarios.h"
#include "studies/failures/compliance/depth_on_mount.h"
#include "studies/failures/compliance/drill_walk.h"
#include "studies/failures/compliance/late_planes.h"
#include "studies/failures/compliance/swinging_mount.h"
#include "studies/failures/cutting/breakthrough.h"
#include "studies/failures/cutting/concave_cup.h"
#include "studies/failures/cutting/contact_switch.h"
#include "studies/failures/cutting/corner.h"
#include "studies/failures/cutting/determinism.h"
#include "studies/failures/cutting/energy.h"
#include "studies/failures/cutting/fast_rotation.h"
#include "studies/failures/cutting/frame_rate.h"
#include "studies/failures/cutting/high_feed.h"
#include "studies/failures/cutting/leak.h"
#include "studies/failures/cutting/material_step.h"
#include "studies/failures/cutting/own_slot.h"
#include "studies/failures/cutting/thin_sheet.h"
#include "studies/failures/failure.h"
#include "studies/failures/loop/cogging.h"
#include "studies/failures/loop/grip_step.h"
#include "studies/failures/loop/joint_limit.h"
#include "studies/failures/loop/packets.h"
#include "studies/failures/loop/resting_buzz.h"
#include "studies/failures/loop/saturation.h"
#include "studies/failures/loop/sensor_errors.h"
#include "studies/failures/loop/simulation_stall.h"
#include "studies/failures/loop/singularity.h"
#include "studies/failures/procedure/guidance_scenarios.h"
#include "studies/failures/procedure/plan_scenarios.h"
#include "studies/failures/procedure/tool_change.h"
#include "studies/failures/procedure/tool_in_bone.h"
#include "studies/failures/procedure/tool_load.h"
#include "studies/failures/procedure/undo.h"

// The list of all failure scenarios. Their numbers are also those of failures.md and of the page's sketches.

namespace osteon::studies {

std::span<const FailureScenario> FailureScenarios() {
  static const std::array scenarios{
      FailureScenario{.id = 1, .name = "thin sheet", .run = RunThinSheet},
      FailureScenario{.id = 2, .name = "contact switch", .run = RunContactSwitch},
      FailureScenario{.id = 3, .name = "concave cup", .run = RunConcaveCup},
      FailureScenario{.id = 4, .name = "corner", .run = RunCorner},
      FailureScenario{.id = 5, .name = "own slot", .run = RunOwnSlot},
      FailureScenario{.id = 6, .name = "resting buzz", .run = RunRestingBuzz},
      FailureScenario{.id = 7, .name = "cogging", .run = RunCogging},
      FailureScenario{.id = 8, .name = "leak", .run = RunLeak},
      FailureScenario{.id = 9, .name = "high feed", .run = RunHighFeed},
      FailureScenario{.id = 10, .name = "simulation stalls", .run = RunSimulationStall},
      FailureScenario{.id = 11, .name = "fast rotation", .run = RunFastRotation},
      FailureScenario{.id = 12, .name = "singularity", .run = RunSingularity},
      FailureScenario{.id = 13, .name = "joint limit", .run = RunJointLimit},
      FailureScenario{.id = 14, .name = "packets", .run = RunPackets},
      FailureScenario{.id = 15, .name = "sensor", .run = RunSensorErrors},
      FailureScenario{.id = 16, .name = "grip", .run = RunGripStep},
      FailureScenario{.id = 17, .name = "saturation", .run = RunSaturation},
      FailureScenario{.id = 18, .name = "material step", .run = RunMaterialStep},
      FailureScenario{.id = 19, .name = "breakthrough", .run = RunBreakthrough},
      FailureScenario{.id = 20, .name = "energy", .run = RunEnergy},
      FailureScenario{.id = 21, .name = "determinism", .run = RunDeterminism},
      FailureScenario{.id = 22, .name = "frame rate", .run = RunFrameRate},
      FailureScenario{.id = 23, .name = "cup definitions", .run = RunCupDefinition},
      FailureScenario{.id = 24, .name = "wrong side", .run = RunWrongSide},
      FailureScenario{.id = 25, .name = "small cap", .run = RunSmallCap},
      FailureScenario{.id = 26, .name = "coarse packing", .run = RunCoarsePacking},
      FailureScenario{.id = 27, .name = "guided cycles", .run = RunGuidedCycles},
      FailureScenario{.id = 28, .name = "switched on outside", .run = RunSwitchedOnOutside},
      FailureScenario{.id = 29, .name = "guidance at the ceiling", .run = RunGuidanceAtCeiling},
      FailureScenario{.id = 30, .name = "firm hand at the edge", .run = RunFirmHandAtEdge},
      FailureScenario{.id = 31, .name = "let go aside", .run = RunLetGoAside},
      FailureScenario{.id = 32, .name = "tool change", .run = RunToolChange},
      FailureScenario{.id = 33, .name = "tool load", .run = RunToolLoad},
      FailureScenario{.id = 34, .name = "tool in bone", .run = RunToolInBone},
      FailureScenario{.id = 35, .name = "undo", .run = RunUndo},
      FailureScenario{.id = 36, .name = "two springs", .run = RunTwoSprings},
      FailureScenario{.id = 37, .name = "stale stiffness", .run = RunStaleStiffness},
      FailureScenario{.id = 38, .name = "bent arm", .run = RunBentArm},
      FailureScenario{.id = 39, .name = "late planes", .run = RunLatePlanes},
      FailureScenario{.id = 40, .name = "drill walks", .run = RunDrillWalk},
      FailureScenario{.id = 41, .name = "depth on a mount", .run = RunDepthOnMount},
      FailureScenario{.id = 42, .name = "swinging mount", .run = RunSwingingMount},
  };
  return scenarios;
}

}  // namespace osteon::studies
