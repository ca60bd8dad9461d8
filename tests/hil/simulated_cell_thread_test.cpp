#include "hil/simulated_cell_thread.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "test_client.h"
#include "tests/io/net/loopback_socket.h"

// Tests a simulated cell in a thread of its own, over UDP in real time.

namespace osteon::hil {
namespace {

using control::SessionState;

// The UDP socket of a client on the loopback interface.
class ClientSocket : public io::test::LoopbackSocket {
 public:
  // Receives the oldest waiting datagram; empty if none arrives within 2 s.
  [[nodiscard]] Bytes Receive() const { return LoopbackSocket::Receive(2000).value_or(Bytes{}); }
};

// A cell whose session does not end because a busy machine delays it. These tests check the datagrams, not
// their times.
SimulatedCell PatientCell(SessionEnd session_end = SessionEnd::kSilence) {
  SimulatedCellParams params;
  params.fri.session_end = session_end;
  params.arm = kinematics::Iiwa14();
  params.fri.quality.end_after_lost_in_a_row = 1000000;
  params.fri.quality.end_after_lost_per_s = 1000000;
  params.fri.quality.good_max_lost_per_s = 1000000;
  params.fri.quality.good_timeout_s = 3600.0;
  params.q_start = {0.0, 0.6, 0.0, -1.3, 0.0, 0.9, 0.0};
  return SimulatedCell(params, MakeReamingScript({}));
}

TEST(SimulatedCellThread, ReachesCommandingActiveOverUdp) {
  ClientSocket socket, stranger;
  SimulatedCellThread cell({.client_port = socket.port()}, PatientCell());
  TestClient client;
  SessionState seen = SessionState::kIdle;
  for (int i = 0; i < 5000 && seen != SessionState::kCommandingActive; ++i) {
    const Bytes message = socket.Receive();
    ASSERT_FALSE(message.empty());
    seen = static_cast<SessionState>(UintAt(message, {4, 1}));
    socket.SendTo(cell.port(), client.Answer(message));
    stranger.SendTo(cell.port(), Bytes{1, 2, 3});  // comes from another port, so it must not reach the cell
  }
  EXPECT_EQ(seen, SessionState::kCommandingActive);
  EXPECT_GT(cell.Load().stamp, 0);
  cell.Stop();
  const CellThreadStatistics& s = cell.statistics();
  EXPECT_EQ(s.cell.counters.sent, s.cell.cycle);
  EXPECT_EQ(s.cell.counters.answered + s.cell.counters.lost + s.cell.counters.excused, s.cell.cycle - 1);
  EXPECT_EQ(s.cell.counters.malformed, 0u);
  EXPECT_EQ(s.cell.stop.reason, StopReason::kNone);
}

// The last session states that a client receives after Stop(). With kSilence the messages only stop; with
// kIdleMessages the arm first reports READY, then IDLE.
TEST(SimulatedCellThread, StopEndsTheSessionSilentlyOrWithIdleMessages) {
  for (const SessionEnd end : {SessionEnd::kSilence, SessionEnd::kIdleMessages}) {
    ClientSocket socket;
    SimulatedCellThread cell({.client_port = socket.port()}, PatientCell(end));
    TestClient client;
    SessionState seen = SessionState::kIdle;
    const auto answer = [&](const Bytes& message) {
      seen = static_cast<SessionState>(UintAt(message, {4, 1}));
      socket.SendTo(cell.port(), client.Answer(message));
    };
    for (int i = 0; i < 5000 && seen != SessionState::kCommandingActive; ++i) answer(socket.Receive());
    ASSERT_EQ(seen, SessionState::kCommandingActive);
    cell.Stop();  // messages that were sent before still wait in the socket
    std::vector<SessionState> states;
    for (auto message = socket.LoopbackSocket::Receive(0); message;
         message = socket.LoopbackSocket::Receive(0)) {
      const auto state = static_cast<SessionState>(UintAt(*message, {4, 1}));
      if (states.empty() || states.back() != state) states.push_back(state);
    }
    ASSERT_FALSE(states.empty());
    EXPECT_EQ(states.back(),
              end == SessionEnd::kIdleMessages ? SessionState::kIdle : SessionState::kCommandingActive);
    if (end == SessionEnd::kIdleMessages) {
      EXPECT_EQ(states.at(states.size() - 2), SessionState::kMonitoringReady);
    }
  }
}

TEST(SimulatedCellThread, MalformedDatagramsOfTheClientAreCounted) {
  ClientSocket socket;
  SimulatedCellThread cell({.client_port = socket.port()}, PatientCell());
  for (int i = 0; i < 20; ++i) {
    ASSERT_FALSE(socket.Receive().empty());
    socket.SendTo(cell.port(), Bytes(static_cast<std::size_t>(100 * i),
                                     0xff));  // sizes from 0 to more than the largest datagram
  }
  while (!socket.Receive().empty() && cell.statistics().cell.counters.malformed < 20) {
  }
  cell.Stop();
  EXPECT_EQ(cell.statistics().cell.counters.malformed, 20u);
  EXPECT_EQ(cell.statistics().cell.counters.answered, 0u);
}

TEST(SimulatedCellThread, StopsCleanlyWithoutAClient) {
  std::uint16_t port = 0;
  { port = ClientSocket().port(); }
  SimulatedCellThread cell({.client_port = port}, PatientCell());
  while (cell.statistics().cell.cycle < 20) rt::SleepUntil(rt::MonotonicNow() + rt::kMillisecond);
  cell.Stop();
  const std::uint64_t cycles = cell.statistics().cell.cycle;
  EXPECT_EQ(cell.statistics().cell.session, SessionState::kMonitoringWait);
  EXPECT_GT(cell.statistics().undelivered, 0u);
  cell.Stop();  // a second call has no effect
  EXPECT_EQ(cell.statistics().cell.cycle, cycles);
}

TEST(SimulatedCellThread, SendsNothingAfterStop) {
  ClientSocket socket;
  SimulatedCellThread cell({.client_port = socket.port()}, PatientCell());
  ASSERT_FALSE(socket.Receive().empty());
  cell.Stop();
  std::uint64_t received = 1;
  while (received < cell.statistics().cell.counters.sent && !socket.Receive().empty()) ++received;
  EXPECT_EQ(received, cell.statistics().cell.counters.sent);
}

TEST(SimulatedCellThread, RefusesAWrongAddressOrPort) {
  EXPECT_THROW(SimulatedCellThread({.client_address = "localhost"}, PatientCell()), std::invalid_argument);
  EXPECT_THROW(SimulatedCellThread({.client_port = 0}, PatientCell()), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
