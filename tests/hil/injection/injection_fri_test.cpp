// Tests that both sides count the faults that are injected into FRI's datagrams: the simulated arm (with
// libprotobuf) and the product's client, in lockstep.

#include <string>

#include <gtest/gtest.h>

#include "hil/fri/fri_server.h"
#include "hil/injection/impaired_wire.h"
#include "injection_bench.h"
#include "io/fri/fri_session.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::hil {
namespace {

// Numbers of cycles with faults. kDatagrams with a fault rate of 5 % gives about 1000 faults, and more than
// 800 in any draw. kFewer is enough if every datagram has a fault.
constexpr int kDatagrams = 20'000, kFewer = 5'000;

// An arm and a client with one wire for each direction. The constructor runs `count` cycles with faults and a
// hundred cycles without. Each cycle lasts one millisecond.
struct FriPair {
  FriPair(const WireFaults& faults, Direction direction, int count = kDatagrams)
      : params{.injections = {{.direction = direction, .to_s = count * 1e-3, .faults = faults}}},
        to_controller(params, Wire::kArm, Direction::kToController),
        from_controller(params, Wire::kArm, Direction::kFromController),
        server(ServerParams(), kinematics::Iiwa14().limits, kinematics::JointVector::Constant(0.1)),
        session({.version = io::FriVersion::k2_7}) {  // the checksum of 2.7 detects every damage
    server.Open();
    to_controller.StartSchedule(0);
    from_controller.StartSchedule(0);
    for (int i = 0; i < count + 100; ++i) Step(i * rt::kMillisecond);
    EXPECT_TRUE(Balances(to_controller) && Balances(from_controller));
  }

  static FriServerParams ServerParams() {
    FriServerParams p{.version = io::FriVersion::k2_7};
    p.quality.good_timeout_s = 3600.0;  // the session must not end, however many answers are lost
    return p;
  }

  // Runs one cycle of the arm: delivers the answers that are due, sends the next message, and delivers the
  // messages that are due, which the client answers.
  void Step(rt::Nanoseconds now) {
    while (from_controller.NextDue() <= now) server.Receive(from_controller.Next(now));
    server.EndCycle();
    to_controller.Push(server.BeginCycle({.q = server.q_commanded()}, now), now);
    while (to_controller.NextDue() <= now) {
      const auto result = session.Accept(to_controller.Next(now), now, arm);
      if (result != io::FriAccept::kAccepted) continue;
      const auto answer = session.Answer({.q = arm.q_ipo, .activation = arm.activation});
      if (!answer.empty()) from_controller.Push(answer, now);
    }
  }

  InjectionParams params;
  ImpairedWire to_controller, from_controller;
  FriServer server;
  io::FriSession session;
  control::ArmState arm;
};

// Each fault has a rate of 5 % of the datagrams. kBursts loses 20 datagrams in a row.
constexpr WireFaults kLoss{.loss = 0.05}, kBursts{.loss = 0.05, .burst = 20}, kDuplicated{.duplicate = 0.05},
    kReordered{.reorder = 0.05}, kDamaged{.corrupt = 0.05};

TEST(InjectionFri, TheClientCountsMessagesLostOnTheWayToIt) {
  for (const WireFaults& faults : {kLoss, kBursts}) {
    const FriPair pair(faults, Direction::kToController);
    EXPECT_GT(pair.to_controller.counters().lost, 800u);
    EXPECT_EQ(pair.arm.lost, pair.to_controller.counters().lost);
    EXPECT_EQ(pair.arm.duplicate + pair.arm.reordered + pair.arm.rejected, 0u);
    EXPECT_EQ(pair.server.counters().lost, pair.to_controller.counters().lost) << "and nothing answers";
    EXPECT_EQ(pair.server.counters().client_gap, 0u);
  }
}

TEST(InjectionFri, TheClientCountsDuplicateMessages) {
  const FriPair pair(kDuplicated, Direction::kToController);
  EXPECT_GT(pair.to_controller.counters().duplicated, 800u);
  EXPECT_EQ(pair.arm.duplicate, pair.to_controller.counters().duplicated);
  EXPECT_EQ(pair.arm.lost + pair.arm.reordered + pair.arm.rejected, 0u);
  EXPECT_EQ(pair.server.counters().duplicate, 0u) << "answered once";
}

TEST(InjectionFri, TheClientCountsReorderedMessages) {
  const FriPair pair(kReordered, Direction::kToController);
  EXPECT_GT(pair.to_controller.counters().reordered, 800u);
  EXPECT_EQ(pair.arm.reordered, pair.to_controller.counters().reordered);
  EXPECT_EQ(pair.arm.lost + pair.arm.duplicate + pair.arm.rejected, 0u) << "it came after all";
}

TEST(InjectionFri, TheClientCountsDamagedMessages) {
  const FriPair pair(kDamaged, Direction::kToController);
  EXPECT_GT(pair.to_controller.counters().corrupted, 800u);
  EXPECT_EQ(pair.arm.rejected, pair.to_controller.counters().corrupted);
  EXPECT_EQ(pair.arm.lost, pair.to_controller.counters().corrupted) << "its counter is missing as well";
  EXPECT_EQ(pair.arm.duplicate + pair.arm.reordered, 0u);
}

TEST(InjectionFri, TheArmCountsAnswersLostOnTheWayToIt) {
  for (const WireFaults& faults : {kLoss, kBursts}) {
    const FriPair pair(faults, Direction::kFromController);
    const FriCounters& n = pair.server.counters();
    EXPECT_GT(pair.from_controller.counters().lost, 800u);
    EXPECT_EQ(n.client_gap, pair.from_controller.counters().lost);
    EXPECT_EQ(n.lost, n.client_gap);
    EXPECT_EQ(n.stale + n.duplicate + n.malformed, 0u);
    EXPECT_EQ(pair.arm.answers_lost, n.client_gap) << "which the client learns";
    EXPECT_EQ(pair.arm.lost, 0u);
  }
}

TEST(InjectionFri, TheArmCountsDuplicateAndStaleAnswers) {
  const FriPair twice(kDuplicated, Direction::kFromController);
  EXPECT_GT(twice.from_controller.counters().duplicated, 800u);
  EXPECT_EQ(twice.server.counters().duplicate, twice.from_controller.counters().duplicated);
  EXPECT_EQ(twice.server.counters().lost + twice.server.counters().stale, 0u);
  const FriPair swapped(kReordered, Direction::kFromController);
  EXPECT_GT(swapped.from_controller.counters().reordered, 800u);
  EXPECT_EQ(swapped.server.counters().stale, swapped.from_controller.counters().reordered);
  EXPECT_EQ(swapped.server.counters().lost, swapped.from_controller.counters().reordered);
}

TEST(InjectionFri, TheArmCountsDamagedAnswers) {
  const FriPair pair(kDamaged, Direction::kFromController);
  EXPECT_GT(pair.from_controller.counters().corrupted, 800u);
  EXPECT_EQ(pair.server.counters().malformed, pair.from_controller.counters().corrupted);
  EXPECT_EQ(pair.server.counters().client_gap, pair.from_controller.counters().corrupted);
}

TEST(InjectionFri, TheArmCountsASilenceAsLossAndTheClientJoinsAfterIt) {
  const FriPair to(WireFaults{.silence = true}, Direction::kToController, kFewer);
  EXPECT_EQ(to.to_controller.counters().silenced, static_cast<std::uint64_t>(kFewer));
  EXPECT_EQ(to.arm.sequence, static_cast<std::uint32_t>(kFewer + 100)) << "it begins with what comes first";
  const FriPair from(WireFaults{.silence = true}, Direction::kFromController, kFewer);
  EXPECT_EQ(from.server.counters().lost, static_cast<std::uint64_t>(kFewer));
}

TEST(InjectionFri, ADelayOfThreePeriodsLosesNoMessageButMakesEveryAnswerStale) {
  const FriPair pair(WireFaults{.delay = 3 * rt::kMillisecond}, Direction::kToController, kFewer);
  EXPECT_EQ(pair.to_controller.counters().delayed, static_cast<std::uint64_t>(kFewer) + 2)
      << "the last ones hold up the two behind them";
  EXPECT_EQ(pair.arm.lost + pair.arm.duplicate + pair.arm.reordered + pair.arm.rejected, 0u);
  EXPECT_EQ(pair.server.counters().stale, static_cast<std::uint64_t>(kFewer) + 2);
}

TEST(InjectionFri, FaultsOfBothDirectionsAreCountedApart) {
  const FriPair pair(kLoss, Direction::kBoth, kFewer);
  EXPECT_EQ(pair.arm.lost, pair.to_controller.counters().lost);
  EXPECT_EQ(pair.server.counters().client_gap, pair.from_controller.counters().lost);
  EXPECT_NE(pair.to_controller.counters().lost, pair.from_controller.counters().lost);
}

}  // namespace
}  // namespace osteon::hil
