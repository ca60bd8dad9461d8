#include <array>

#include "hil/failures/breakthrough.h"
#include "hil/failures/cogging.h"
#include "hil/failures/concave_cup.h"
#include "hil/failures/contact_switch.h"
#include "hil/failures/corner.h"
#include "hil/failures/determinism.h"
#include "hil/failures/energy.h"
#include "hil/failures/failure.h"
#include "hil/failures/fast_rotation.h"
#include "hil/failures/frame_rate.h"
#include "hil/failures/grip_step.h"
#include "hil/failures/high_feed.h"
#include "hil/failures/joint_limit.h"
#include "hil/failures/leak.h"
#include "hil/failures/material_step.h"
#include "hil/failures/own_slot.h"
#include "hil/failures/packets.h"
#include "hil/failures/resting_buzz.h"
#include "hil/failures/saturation.h"
#include "hil/failures/sensor_errors.h"
#include "hil/failures/simulation_stall.h"
#include "hil/failures/singularity.h"
#include "hil/failures/thin_sheet.h"

namespace osteon::hil {

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
  };
  return scenarios;
}

}  // namespace osteon::hil
