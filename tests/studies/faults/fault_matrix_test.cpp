#include "studies/faults/fault_matrix.h"

#include <set>

#include <gtest/gtest.h>

namespace osteon::studies {
namespace {

using safety::CellState;
using safety::Fault;

const FaultCase& CaseNamed(const std::string& name) {
  for (const FaultCase& fault : FaultCases())
    if (fault.name == name) return fault;
  throw std::logic_error("no fault " + name);
}

// Injects every fault in one state of the cell. One test for each state, so that they can run in parallel.
class FaultMatrix : public ::testing::TestWithParam<int> {};
TEST_P(FaultMatrix, EveryFaultLeadsToTheStatedReaction) {
  const auto state = static_cast<CellState>(GetParam());
  for (const FaultCase& fault : FaultCases()) {
    const FaultVerdict verdict = RunFault(fault, state);
    EXPECT_TRUE(verdict.passed()) << fault.name << " in " << safety::Describe(state).name << ", expected "
                                  << NameOf(verdict.expected.reaction) << ": " << verdict.wrong
                                  << "; noticed after " << verdict.ticks << " ticks, went "
                                  << verdict.distance_m * 1e3 << " of " << verdict.max_distance_m * 1e3
                                  << " mm";
  }
}
INSTANTIATE_TEST_SUITE_P(InEachState, FaultMatrix, ::testing::Range(0, safety::kCellStates),
                         [](const auto& tested) {
                           std::string name = safety::Describe(static_cast<CellState>(tested.param)).name;
                           std::erase(name, ' ');
                           return name;
                         });

TEST(FaultList, CoversEveryFaultOfTheLoopAndNamesEachCaseOnce) {
  std::set<std::string> names;
  safety::FaultSet seen;
  for (const FaultCase& fault : FaultCases()) {
    EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
    for (const Expected& expected : {fault.waiting, fault.aligning, fault.rendering, fault.paused})
      seen.Latch(expected.faults);
  }
  EXPECT_GE(names.size(), 40u);
  // the faults of the loop's own computations are tested in servo_loop, servo_zones and servo_limit
  for (const Fault own : {Fault::kToolSpeed, Fault::kWorkspace, Fault::kJointLimit, Fault::kInverseKinematics,
                          Fault::kToolInBone, Fault::kForceLimit, Fault::kDeflection})
    seen.Latch(own);
  EXPECT_EQ(seen.bits(), (1u << safety::kFaultCount) - 1u);
}

// The matrix must fail if an expectation is wrong: each line changes one expectation of a case that passes.
TEST(FaultMatrixItself, FailsForEachWrongExpectation) {
  FaultCase fault = CaseNamed("drive's fault");
  ASSERT_TRUE(RunFault(fault, CellState::kCutting).passed());
  const auto expect_failure = [](FaultCase changed, const char* why) {
    const FaultVerdict verdict = RunFault(changed, CellState::kCutting);
    EXPECT_FALSE(verdict.passed()) << why;
  };
  FaultCase changed = fault;
  changed.rendering.reaction = Reaction::kGoesOn;
  expect_failure(changed, "it stops");
  changed = fault;
  changed.rendering.ticks = 0;
  expect_failure(changed, "it takes a tick");
  changed = fault;
  changed.rendering.stop = safety::StopCategory::kStop0;
  expect_failure(changed, "it is braked");
  changed = fault;
  changed.rendering.faults = {};
  changed.rendering.faults.Latch(Fault::kInterlock);
  expect_failure(changed, "it is another fault");
  changed = fault;
  changed.inject = [](RigInputs&, int, FaultRig&) {};
  expect_failure(changed, "nothing was injected");
  changed = CaseNamed("a tick is late");
  changed.inject = [](RigInputs&, int since, FaultRig& rig) {
    if (since == 3) rig.recorder().pushed += 1;
  };
  expect_failure(changed, "the recorder did not get each tick once");
}

}  // namespace
}  // namespace osteon::studies
