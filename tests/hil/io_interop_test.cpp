// The simulated arm (libprotobuf) against the product's client (nanopb): two schemas, two implementations,
// one protocol.

#include <gtest/gtest.h>

#include "hil/simulated_cell_thread.h"
#include "io/fri/fri_link.h"
#include "io/fri/fri_session.h"
#include "test_client.h"

namespace osteon::hil {
namespace {

using control::SessionState;

SimulatedCellParams CellParams() {
  SimulatedCellParams params;
  params.arm = kinematics::Iiwa14();
  params.q_start = {0.1, 0.6, -0.2, -1.3, 0.3, 0.9, -0.4};
  return params;
}

TEST(FriInterop, SessionWalksToActiveAndEveryFigureArrives) {
  SimulatedCell cell(CellParams(), MakeReamingScript({}));
  io::FriSession session;
  control::ArmState arm;
  control::ArmCommand command{.q = CellParams().q_start};
  for (int k = 1; k <= 2000; ++k) {
    const rt::Nanoseconds now = k * rt::kMillisecond;
    const auto message = cell.Step(now);
    ASSERT_EQ(session.Accept(message, now, arm), io::FriAccept::kAccepted)
        << io::Describe(session.last_error());
    const CellState& s = cell.state();
    ASSERT_EQ(arm.session, s.session);
    ASSERT_EQ(arm.q_meas, s.q_meas);
    ASSERT_EQ(arm.sequence, s.counters.sent);
    ASSERT_EQ(arm.has_ipo, s.session >= SessionState::kCommandingWait);
    if (arm.has_ipo) {
      ASSERT_EQ(arm.q_ipo, CellParams().q_start);
    }
    ASSERT_EQ(arm.safety_state, 0);
    ASSERT_EQ(arm.period_s, 1e-3);
    command.activation = arm.activation;
    if (s.session == SessionState::kCommandingActive) command.q[0] += 1e-4;
    cell.Receive(session.Answer(command));
  }
  EXPECT_EQ(arm.session, SessionState::kCommandingActive);
  EXPECT_EQ(arm.quality, 3);
  EXPECT_EQ(arm.lost + arm.duplicate + arm.late + arm.rejected, 0u);
  const FriCounters& n = cell.state().counters;
  EXPECT_EQ(n.answered, n.sent - 1);
  EXPECT_EQ(n.lost + n.stale + n.duplicate + n.malformed + n.incomplete, 0u);
  EXPECT_NEAR(arm.q_meas[0], command.q[0], 5e-3);  // 0.1 rad/s behind a lag of some 25 ms
  EXPECT_GT(arm.q_meas[0], 0.11);
}

TEST(FriInterop, LinkReachesActiveOverUdp) {
  SimulatedCellParams params = CellParams();  // no delay of a busy machine may end the session
  params.fri.quality = {.good_max_lost_per_s = 1000000,
                        .end_after_lost_in_a_row = 1000000,
                        .end_after_lost_per_s = 1000000,
                        .good_timeout_s = 3600.0};
  auto link = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(link) << link.error();
  SimulatedCellThread cell({.client_port = (*link)->port()}, SimulatedCell(params, MakeReamingScript({})));
  control::ArmState arm;
  for (int k = 0; k < 20000 && arm.session != SessionState::kCommandingActive; ++k) {
    const auto result = (*link)->Receive(arm, rt::MonotonicNow() + 2 * rt::kSecond);
    ASSERT_EQ(result, control::ReceiveResult::kOk);
    ASSERT_TRUE((*link)->Send({.q = params.q_start}));
  }
  EXPECT_EQ(arm.session, SessionState::kCommandingActive);
  cell.Stop();
  EXPECT_EQ(cell.statistics().cell.counters.malformed, 0u);
  EXPECT_EQ(arm.rejected, 0u);
}

}  // namespace
}  // namespace osteon::hil
