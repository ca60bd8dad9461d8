// A console page that has the operator's role loses its connection: the cell pauses only if its file says so.

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/net/tcp_stream.h"
#include "safety/cell_state.h"
#include "session/run/live_views.h"
#include "tests/session/set_up_cell.h"

namespace osteon::session {
namespace {

constexpr std::chrono::seconds kPatience{20};

// The live views of a cell that cuts, with pages connected over TCP.
class OperatorLeaves : public testing::Test {
 protected:
  // Opens the console. @param pauses  the cell's setting pause_when_operator_leaves
  void Begin(bool pauses) {
    setup_ = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
    ASSERT_TRUE(setup_) << setup_.error();
    setup_->config.pause_when_operator_leaves = pauses;
    live_ = std::make_unique<LiveViews>(*setup_, LiveRun{.command = "run"}, requests_);
    live_->Open({.port = 0, .only_this_port = true}, {.on = false});
    const std::string url = live_->console_url();
    port_ = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  }
  // Feeds the views with 40 ticks of cutting.
  void Feed() {
    for (int i = 0; i < 40; ++i) {
      tick_.stamp += 1'000'000;
      ++tick_.tick;
      tick_.phase = control::Phase::kHaptic;
      tick_.cell_state = static_cast<std::uint8_t>(safety::CellState::kCutting);
      live_->sink()->TakeTick(tick_);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  // Feeds the views until `is` returns true. @returns false if it never does within kPatience
  bool Eventually(const std::function<bool()>& is) {
    for (const auto end = std::chrono::steady_clock::now() + kPatience;
         std::chrono::steady_clock::now() < end; Feed())
      if (is()) return true;
    return false;
  }
  // Opens a page by WebSocket and sends a message from it. @returns the page's connection, which must be kept
  io::TcpStream OpenPage(std::string_view message) {
    auto page = io::TcpStream::Connect("127.0.0.1", port_);
    EXPECT_TRUE(page) << page.error();
    EXPECT_TRUE(
        page->Send(fmt::format("GET /live HTTP/1.1\r\nHost: 127.0.0.1:{0}\r\nOrigin: "
                               "http://127.0.0.1:{0}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                               "Sec-WebSocket-Version: 13\r\n"
                               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
                               port_)));
    EXPECT_NE(page->Receive(kPatience), "");
    std::string frame{"\x81"};  // a text, whole, masked by zeros
    frame += static_cast<char>(0x80 | message.size());
    frame += std::string(4, '\0') + std::string(message);
    EXPECT_TRUE(page->Send(frame));
    return std::move(*page);
  }
  bool AwaitText(io::TcpStream& page, std::string_view text) {
    std::string got;
    return Eventually([&] {
      got += page.Receive(std::chrono::milliseconds(5));
      return got.find(text) != std::string::npos;
    });
  }

  base::OperatorRequests requests_;
  decltype(SetUpCell("", std::nullopt)) setup_;
  std::unique_ptr<LiveViews> live_;
  control::TickRecord tick_;
  std::uint16_t port_{0};
};

TEST_F(OperatorLeaves, PausesACellWhoseFileSaysSo) {
  ASSERT_NO_FATAL_FAILURE(Begin(true));
  Feed();
  {
    io::TcpStream watches = OpenPage(R"({"ask":"all"})");
    ASSERT_TRUE(AwaitText(watches, R"("type":"live")"));
    watches.Kill();
  }
  io::TcpStream operates = OpenPage(R"({"ask":"role"})");
  ASSERT_TRUE(AwaitText(operates, R"("mine":true)"));
  EXPECT_FALSE(requests_.pause.load()) << "a page that watched pauses nothing";
  operates.Kill();
  EXPECT_TRUE(Eventually([&] { return requests_.pause.load(); }));
}

TEST_F(OperatorLeaves, DoesNotPauseOtherCellsAndFreesTheRole) {
  ASSERT_NO_FATAL_FAILURE(Begin(false));
  Feed();
  io::TcpStream operates = OpenPage(R"({"ask":"role"})");
  ASSERT_TRUE(AwaitText(operates, R"("mine":true)"));
  operates.Kill();
  // a new page may ask for the role before the server has noticed that the first page is gone; the answer is
  // then that another page has the role
  EXPECT_TRUE(Eventually([&] {
    io::TcpStream next = OpenPage(R"({"ask":"role"})");
    std::string got;
    for (int i = 0; i < 40 && got.find(R"("mine":true)") == std::string::npos; ++i)
      got += next.Receive(std::chrono::milliseconds(5));
    return got.find(R"("mine":true)") != std::string::npos;
  })) << "the role is free once the first page has gone";
  EXPECT_FALSE(requests_.pause.load());
}

}  // namespace
}  // namespace osteon::session
