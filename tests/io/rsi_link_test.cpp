#include "io/rsi/rsi_link.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "control/rt/no_alloc_scope.h"
#include "tests/io/rsi_oracle.h"

namespace osteon::io {
namespace {

using control::ArmCommand;
using control::ArmState;
using control::ReceiveResult;

// The controller's side: a plain UDP socket.
class Controller {
 public:
  explicit Controller(std::uint16_t port) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  ~Controller() { close(socket_); }
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  void Send(std::string_view text) const {
    EXPECT_EQ(send(socket_, text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
  }
  void Send(std::uint64_t ipoc, int delay = 0) const {
    Send("<Rob Type=\"KUKA\"><AIPos A1=\"0\" A2=\"-90\" A3=\"90\" A4=\"0\" A5=\"90\" A6=\"0\"/><Delay D=\"" +
         std::to_string(delay) + "\"/><IPOC>" + std::to_string(ipoc) + "</IPOC></Rob>");
  }
  // Loopback delivers within the sender's call, so what is not here now was never sent.
  [[nodiscard]] std::string Answer() const {
    std::string text(3000, '\0');
    const ssize_t size = recv(socket_, text.data(), text.size(), MSG_DONTWAIT);
    text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return text;
  }

 private:
  int socket_;
};

rt::Nanoseconds Soon() { return rt::MonotonicNow() + 2 * rt::kSecond; }

std::unique_ptr<RsiLink> OpenAnywhere() {
  auto link = RsiLink::Open({.port = 0});
  EXPECT_TRUE(link) << link.error();
  return std::move(*link);
}

TEST(RsiLink, AnswersTheControllerAtTheAddressItSpokeFrom) {
  const auto link = OpenAnywhere();
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

TEST(RsiLink, TakesTheNewestOfWhatWaitsAndSkipsHostileBytes) {
  const auto link = OpenAnywhere();
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

TEST(RsiLink, KeepsToTheFirstPeer) {
  const auto link = OpenAnywhere();
  const Controller kr(link->port()), stranger(link->port());
  ArmState state;
  stranger.Send("noise");  // does not make a peer
  stranger.Send(120, 50);  // nor does RSI that ran without us; its numbers are forgotten
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

TEST(RsiLink, ErrorsSayWhatIsWrong) {
  const auto first = OpenAnywhere();
  const auto taken = RsiLink::Open({.port = first->port()});
  ASSERT_FALSE(taken);
  EXPECT_NE(taken.error().find("RSI: UDP 127.0.0.1:" + std::to_string(first->port()) + " is taken"),
            std::string::npos)
      << taken.error();
  const auto no_address = RsiLink::Open({.bind_address = "localhost", .port = 0});
  ASSERT_FALSE(no_address);
  EXPECT_NE(no_address.error().find("'localhost' is not an IPv4 address"), std::string::npos);
  const auto no_cycle = RsiLink::Open({.port = 0, .session = {.cycle_ms = 8}});
  ASSERT_FALSE(no_cycle);
  EXPECT_NE(no_cycle.error().find("cycle_ms: found 8"), std::string::npos) << no_cycle.error();
}

TEST(RsiLink, DoesNotAllocate) {
  const auto link = OpenAnywhere();
  const Controller kr(link->port());
  kr.Send(1);
  ArmState state;
  const rt::NoAllocScope scope;
  const ReceiveResult received = link->Receive(state, Soon());
  const bool sent = link->Send(ArmCommand{state.q_ipo});
  EXPECT_EQ(scope.heap_calls(), 0);
  EXPECT_EQ(scope.locks(), 0);
  EXPECT_EQ(received, ReceiveResult::kOk);
  EXPECT_TRUE(sent);
}

}  // namespace
}  // namespace osteon::io
