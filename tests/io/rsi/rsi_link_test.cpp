#include "io/rsi/rsi_link.h"

#include <gtest/gtest.h>

#include "tests/io/net/link_bench.h"
#include "tests/io/net/loopback_socket.h"
#include "tests/io/rsi/rsi_oracle.h"

namespace osteon::io {
namespace {

using control::ArmCommand;
using control::ArmState;
using control::ReceiveResult;
using test::Soon;

// The controller's side: a plain UDP socket.
class Controller : public test::LoopbackSocket {
 public:
  explicit Controller(std::uint16_t port) { Connect(port); }

  void Send(std::string_view text) const { LoopbackSocket::Send(test::Bytes(text)); }
  // A robot message with this IPOC and this count of late answers.
  void Send(std::uint64_t ipoc, int delay = 0) const {
    Send("<Rob Type=\"KUKA\"><AIPos A1=\"0\" A2=\"-90\" A3=\"90\" A4=\"0\" A5=\"90\" A6=\"0\"/><Delay D=\"" +
         std::to_string(delay) + "\"/><IPOC>" + std::to_string(ipoc) + "</IPOC></Rob>");
  }
  // The XML of the next answer; empty if none comes.
  [[nodiscard]] std::string Answer() const {
    return test::Text(Receive().value_or(std::vector<std::uint8_t>{}));
  }
};

std::unique_ptr<RsiLink> OpenOnAnyPort() { return test::OpenOnAnyPort<RsiLink>(); }

TEST(RsiLink, AnswersTheControllerAtTheAddressItSpokeFrom) {
  const auto link = OpenOnAnyPort();
  ASSERT_NE(link->port(), 0);
  const Controller kr(link->port());
  ArmState state;
  EXPECT_FALSE(link->Send(ArmCommand{})) << "never speaks first";
  kr.Send(7);
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  EXPECT_LE(state.stamp, rt::MonotonicNow());
  ASSERT_TRUE(link->Send(ArmCommand{state.q_meas}));
  const auto answer = test::ReadByExpat(kr.Answer());
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->at("IPOC"), "7");
  EXPECT_EQ(link->Receive(state, 0), ReceiveResult::kTimeout) << "a deadline in the past";
}

TEST(RsiLink, TakesTheNewestWaitingMessageAndSkipsHostileBytes) {
  const auto link = OpenOnAnyPort();
  const Controller kr(link->port());
  kr.Send("");
  kr.Send(std::string(kRsiMaxDatagram + 500, '<'));
  kr.Send("<Rob");
  for (std::uint64_t k = 0; k < 5; ++k) kr.Send(100 + 4 * k);
  ArmState state;
  ASSERT_EQ(link->Receive(state, 0), ReceiveResult::kOk)
      << "what has arrived is taken after the deadline too";
  EXPECT_EQ(state.sequence, 116u);
  EXPECT_EQ(state.late, 4u);
  EXPECT_EQ(state.lost, 0u);
  EXPECT_EQ(state.rejected, 3u);
}

TEST(RsiLink, AnswersOnlyTheFirstValidPeer) {
  const auto link = OpenOnAnyPort();
  const Controller kr(link->port()), stranger(link->port());
  ArmState state;
  stranger.Send("noise");  // not a valid message: its sender does not become the peer
  stranger.Send(120, 50);  // 50 late answers: this RSI was running before, so it is ignored
  kr.Send(100);
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  EXPECT_EQ(state.sequence, 100u);
  stranger.Send(104);
  kr.Send(108);
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  EXPECT_EQ(state.sequence, 108u);
  EXPECT_EQ(state.lost, 1u) << "the stranger's 104 is not the controller's";
  EXPECT_EQ(state.rejected, 3u);
  ASSERT_TRUE(link->Send(ArmCommand{}));
  EXPECT_TRUE(stranger.Answer().empty());
  EXPECT_FALSE(kr.Answer().empty());
}

TEST(RsiLink, OpenErrorsNameTheWrongParameter) {
  test::ExpectAddressErrors<RsiLink, RsiLinkParams>("RSI");
  const auto no_cycle = RsiLink::Open({.port = 0, .session = {.cycle_ms = 8}});
  ASSERT_FALSE(no_cycle);
  EXPECT_NE(no_cycle.error().find("cycle_ms: found 8"), std::string::npos) << no_cycle.error();
}

TEST(RsiLink, DoesNotAllocate) {
  const auto link = OpenOnAnyPort();
  const Controller kr(link->port());
  kr.Send(1);
  test::ExpectNoAllocation(*link);
}

}  // namespace
}  // namespace osteon::io
