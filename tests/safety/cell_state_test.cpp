#include "safety/cell_state.h"

#include <array>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "safety/fault.h"
#include "safety/motion_permit.h"

namespace osteon::safety {
namespace {

constexpr CellState StateOf(int i) { return static_cast<CellState>(i); }
constexpr CellEvent EventOf(int i) { return static_cast<CellEvent>(i); }

// The expected transitions, written by hand: a row per state, an entry per event, in the order of CellEvent
// (the heading of kExpected abbreviates their names). `.`: the state stays, without an action. Otherwise the
// entry has the letter of the next state and the letter of the action: f follow the arm, h hold, b brake, p
// begin the start path, r begin to render, c clear the faults, - no action.
//   O off  C checking  R ready  A aligning  H haptic  X cutting  P paused  0 1 2 stops  F fault  Y recovery
struct Row {
  CellState state;
  std::array<const char*, kCellEvents> entries;
};
// clang-format off
//                     lost  fault left  stop  pause restF rest  idle  seen  notOK OK    away  there turns still recov resum
const std::array<Row, kCellStates> kExpected{{
    {CellState::kOff,      {"Fh", "Fh", ".",  ".",  "Ph", ".",  ".",  ".",  "Cf", ".",  ".",  ".",  ".",  ".",  ".",  ".",  "."}},
    {CellState::kChecking, {"Fh", "Fh", ".",  "Oh", "Ph", ".",  ".",  "Of", ".",  ".",  "R-", ".",  ".",  ".",  ".",  ".",  "."}},
    {CellState::kReady,    {"Fh", "Fh", ".",  "Oh", "Ph", ".",  ".",  "Of", ".",  "C-", ".",  "Ap", "Hr", ".",  ".",  ".",  "."}},
    {CellState::kAligning, {"0h", "1b", "Cf", "1b", "2b", ".",  ".",  ".",  ".",  ".",  ".",  ".",  "Hr", ".",  ".",  ".",  "."}},
    {CellState::kHaptic,   {"0h", "1b", "0f", "1b", "2b", ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  "X-", ".",  ".",  "."}},
    {CellState::kCutting,  {"0h", "1b", "0f", "1b", "2b", ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  "H-", ".",  "."}},
    {CellState::kPaused,   {"Fh", "Fh", ".",  "Oh", ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  "C-"}},
    {CellState::kStop0,    {".",  ".",  ".",  ".",  ".",  "Fh", "Oh", ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  "Yc", "."}},
    {CellState::kStop1,    {"0h", ".",  "0f", ".",  ".",  "Fh", "Oh", ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  "."}},
    {CellState::kStop2,    {"0h", "1b", "0f", "1b", ".",  "Fh", "Ph", ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  "."}},
    {CellState::kFault,    {".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  ".",  "Yc", "."}},
    {CellState::kRecovery, {"Fh", "Fh", ".",  "Oh", "Ph", ".",  ".",  ".",  ".",  ".",  ".",  "Ap", "Hr", ".",  ".",  ".",  "."}},
}};
// clang-format on

// Decodes an entry of kExpected in the row of the state `from`.
CellTransition ReadEntry(CellState from, const std::string& entry) {
  static const std::map<char, CellState> states{
      {'O', CellState::kOff},      {'C', CellState::kChecking}, {'R', CellState::kReady},
      {'A', CellState::kAligning}, {'H', CellState::kHaptic},   {'X', CellState::kCutting},
      {'P', CellState::kPaused},   {'0', CellState::kStop0},    {'1', CellState::kStop1},
      {'2', CellState::kStop2},    {'F', CellState::kFault},    {'Y', CellState::kRecovery}};
  static const std::map<char, CellAction> actions{
      {'-', CellAction::kNone},       {'f', CellAction::kFollowArm}, {'h', CellAction::kHold},
      {'b', CellAction::kBrake},      {'p', CellAction::kBeginPath}, {'r', CellAction::kBeginRendering},
      {'c', CellAction::kClearFaults}};
  if (entry == ".") return {from, CellAction::kNone};
  return {states.at(entry[0]), actions.at(entry[1])};
}

TEST(CellState, EveryTransitionIsThatOfTheTableWrittenByHand) {
  for (int s = 0; s < kCellStates; ++s) {
    const Row& row = kExpected[static_cast<std::size_t>(s)];
    ASSERT_EQ(row.state, StateOf(s));
    for (int e = 0; e < kCellEvents; ++e) {
      const CellTransition expected = ReadEntry(row.state, row.entries[static_cast<std::size_t>(e)]);
      EXPECT_EQ(Next(StateOf(s), EventOf(e)), expected)
          << Describe(StateOf(s)).name << " × " << Describe(EventOf(e)).name << ": found "
          << Describe(Next(StateOf(s), EventOf(e)).state).name;
    }
  }
}

// States that are reachable from a state by the events that `allowed` accepts, in any order and number.
template <class Allowed>
std::set<CellState> Reached(CellState from, Allowed&& allowed) {
  std::set<CellState> reached{from};
  for (bool more = true; more;) {
    more = false;
    for (const CellState state : std::set<CellState>(reached))
      for (int e = 0; e < kCellEvents; ++e)
        if (allowed(EventOf(e))) more |= reached.insert(Next(state, EventOf(e)).state).second;
  }
  return reached;
}

// Whether the loop raises this event only while every permission for motion is given.
bool NeedsEveryPermit(CellEvent event) {
  return event == CellEvent::kBeginAligning || event == CellEvent::kBeginRendering;
}

TEST(CellState, AnArmAtRestMovesOnlyByTheEventsThatNeedEveryPermission) {
  for (int s = 0; s < kCellStates; ++s) {
    if (IsMotion(StateOf(s))) continue;
    for (const CellState reached :
         Reached(StateOf(s), [](CellEvent event) { return !NeedsEveryPermit(event); }))
      EXPECT_FALSE(IsMotion(reached)) << "from " << Describe(StateOf(s)).name;
  }
}

TEST(CellState, AFaultInAnyStateLeadsToTheFaultStateAtRest) {
  // Any event comes first, then a fault, then the arm's rest. The loop raises a fault event in each tick that
  // latches a fault.
  for (int s = 0; s < kCellStates; ++s)
    for (int before = 0; before < kCellEvents; ++before) {
      const CellState at = Next(StateOf(s), EventOf(before)).state;
      for (const CellEvent fault : {CellEvent::kFault, CellEvent::kArmLost}) {
        const CellState after = Next(at, fault).state;
        EXPECT_FALSE(IsMotion(after)) << Describe(at).name;
        EXPECT_NE(after, CellState::kStop2) << "a pause that a fault meets is none";
        if (IsStop(after)) {
          EXPECT_EQ(Next(after, CellEvent::kRestFault).state, CellState::kFault);
        } else {
          EXPECT_EQ(after, CellState::kFault) << Describe(at).name;
        }
      }
    }
}

TEST(CellState, OnlyARecoveryLeadsOutOfAFault) {
  const auto reached =
      Reached(CellState::kFault, [](CellEvent event) { return event != CellEvent::kRecover; });
  EXPECT_EQ(reached, std::set<CellState>{CellState::kFault});
  EXPECT_FALSE(IsMotion(Next(CellState::kFault, CellEvent::kRecover).state));
}

TEST(CellState, OnlyAResumeAStopOrAFaultEndsAPause) {
  const auto reached = Reached(CellState::kPaused, [](CellEvent event) {
    return event != CellEvent::kResume && event != CellEvent::kStopRequested && event != CellEvent::kFault &&
           event != CellEvent::kArmLost;
  });
  EXPECT_EQ(reached, std::set<CellState>{CellState::kPaused});
}

TEST(CellState, EveryStateIsReachedFromOffAndLeadsToHaptic) {
  const auto every = [](CellEvent) { return true; };
  EXPECT_EQ(Reached(CellState::kOff, every).size(), static_cast<std::size_t>(kCellStates));
  for (int s = 0; s < kCellStates; ++s) {
    EXPECT_TRUE(Reached(StateOf(s), every).contains(CellState::kHaptic)) << Describe(StateOf(s)).name;
    EXPECT_STRNE(Describe(StateOf(s)).leave, "") << Describe(StateOf(s)).name;
  }
}

TEST(CellState, StatesEventsAndPermissionsHaveDistinctNames) {
  std::set<std::string> states, events, actions;
  for (int s = 0; s < kCellStates; ++s) states.insert(Describe(StateOf(s)).name);
  for (int e = 0; e < kCellEvents; ++e) events.insert(Describe(EventOf(e)).name);
  EXPECT_EQ(states.size(), static_cast<std::size_t>(kCellStates));
  EXPECT_EQ(events.size(), static_cast<std::size_t>(kCellEvents));
  std::set<std::string> missing;
  for (int i = 0; i < kMotionPermits; ++i)
    missing.insert(DescribeMissing(static_cast<MotionPermit>(1u << i)));
  EXPECT_EQ(missing.size(), static_cast<std::size_t>(kMotionPermits));
  EXPECT_FALSE(missing.contains("an unknown condition"));
}

TEST(MotionPermits, AreCompleteOnlyIfNoneIsMissing) {
  for (int i = 0; i < kMotionPermits; ++i) {
    const auto permit = static_cast<MotionPermit>(1u << i);
    MotionPermits permits(MotionPermits::kAll);
    EXPECT_TRUE(permits.All() && permits.AllButHandedOver());
    permits.Set(permit, false);
    EXPECT_FALSE(permits.All());
    EXPECT_EQ(permits.AllButHandedOver(), permit == MotionPermit::kHandedOver);
    permits.Set(permit, true);
    EXPECT_TRUE(permits.All());
  }
  EXPECT_EQ(MotionPermits(~0u).bits(), MotionPermits::kAll) << "bits that are not there";
}

TEST(Fault, ARecoveryNeedsEveryLatchedFaultToAllowIt) {
  FaultSet faults;
  EXPECT_FALSE(AllowsRecovery(faults)) << "nothing to recover from";
  faults.Latch(Fault::kSession);
  EXPECT_TRUE(AllowsRecovery(faults));
  faults.Latch(Fault::kArmStale);
  EXPECT_TRUE(AllowsRecovery(faults));
  for (int bit = 0; bit < kFaultCount; ++bit) {
    const auto fault = static_cast<Fault>(1u << bit);
    FaultSet more = faults;
    more.Latch(fault);
    EXPECT_EQ(AllowsRecovery(more), fault == Fault::kSession || fault == Fault::kArmStale);
  }
}

}  // namespace
}  // namespace osteon::safety
