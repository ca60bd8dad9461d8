#include "studies/bench/page_reloads.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "console/server/console_server.h"
#include "console/server/page_client.h"
#include "safety/cell_state.h"
#include "tests/io/temporary_folder.h"

// Opens and closes pages of a console server in this process. A thread feeds the server a tick each
// millisecond.

namespace osteon::studies {
namespace {

class PageReloads : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* file : {"index.html", "main.js", "main.css"})
      std::ofstream(folder_.path() / file) << "a file of the page";
    auto server = console::ConsoleServer::Start(
        {.port = 0, .page = folder_.path(), .hello = R"({"type":"hello"})", .context = {}, .request = {}},
        feed_, surface_);
    ASSERT_TRUE(server) << server.error();
    server_ = std::move(*server);
    surface_.Begin({}, R"({"type":"surface"})");
    surface_.Put({{0, "a brick"}});
    feeder_ = std::thread([this] {
      control::TickRecord tick;
      for (; !done_.load(); std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
        tick.stamp = rt::MonotonicNow();
        ++tick.tick;
        feed_.TakeTick(tick);
      }
    });
  }
  void TearDown() override {
    server_.reset();
    done_.store(true);
    if (feeder_.joinable()) feeder_.join();
  }
  [[nodiscard]] std::uint16_t port() const { return static_cast<std::uint16_t>(server_->port()); }

  io::test::TemporaryFolder folder_;
  console::LiveFeed feed_;
  console::SurfaceStore surface_;
  std::atomic<bool> done_{false};
  std::unique_ptr<console::ConsoleServer> server_;
  std::thread feeder_;
};

TEST_F(PageReloads, AHundredReloadsLeaveNoDescriptorThreadOrMemory) {
  const ReloadFigures figures = ReloadPages("127.0.0.1", port(), ::getpid(), 100, [](int) { return true; });
  EXPECT_EQ(figures.loaded, 100) << (figures.failed.empty() ? "" : figures.failed.front());
  EXPECT_EQ(figures.killed, 33);
  EXPECT_EQ(server_->counts().opened, 100u);
  EXPECT_EQ(server_->pages(), 0u);
  EXPECT_TRUE(LeftNothing(figures)) << figures.warm.descriptors << " to " << figures.after.descriptors
                                    << " descriptors, " << figures.warm.threads << " to "
                                    << figures.after.threads << " threads, " << figures.warm.resident_MB
                                    << " to " << figures.after.resident_MB << " MB";
}

// A page that stays open keeps a descriptor and a thread, so LeftNothing must be false.
TEST_F(PageReloads, APageThatStaysOpenIsDetected) {
  std::vector<std::unique_ptr<console::PageClient>> stay;
  const ReloadFigures figures = ReloadPages("127.0.0.1", port(), ::getpid(), 10, [&](int done) {
    if (done == 5) stay.push_back(*console::PageClient::Open("127.0.0.1", server_->port(), true));
    return true;
  });
  EXPECT_EQ(figures.loaded, 10);
  EXPECT_FALSE(LeftNothing(figures));
}

TEST_F(PageReloads, AMissingServerIsReportedWithItsPort) {
  const int gone = server_->port();
  server_.reset();
  const auto loaded = LoadPageAndLeave("127.0.0.1", static_cast<std::uint16_t>(gone), PageEnd::kCloses,
                                       PageStay::kLiveMessage, 1.0);
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().find(std::to_string(gone)), std::string::npos) << loaded.error();
}

TEST_F(PageReloads, AnIncompleteBoneIsReported) {
  surface_.Begin({}, R"({"type":"surface"})");
  const auto loaded = LoadPageAndLeave("127.0.0.1", port(), PageEnd::kCloses, PageStay::kWholeBone, 0.5);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error(), "/live: the bone did not come whole");
}

TEST_F(PageReloads, AServerThatEndsIsReportedAtOnce) {
  surface_.Begin({}, R"({"type":"surface"})");  // incomplete: the page waits for the rest
  std::thread ends([this] {
    while (server_->pages() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    server_.reset();
  });
  const auto loaded = LoadPageAndLeave("127.0.0.1", port(), PageEnd::kCloses, PageStay::kWholeBone, 600.0);
  ends.join();
  ASSERT_FALSE(loaded);
  EXPECT_TRUE(loaded.error().ends_with(": the server closed the connection")) << loaded.error();
}

// The test's client measures the time from a tick's stamp to its message's arrival, both by one clock.
TEST_F(PageReloads, TheTimeFromTickToPageIsMeasured) {
  auto page = console::PageClient::Open("127.0.0.1", server_->port(), true);
  ASSERT_TRUE(page) << page.error();
  for (int i = 0; i < 2000 && (*page)->received_ms().size() < 5; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_GE((*page)->received_ms().size(), 5u);
  for (const double ms : (*page)->received_ms()) {
    EXPECT_GE(ms, -1.0) << "stamps are rounded to a millisecond";
    EXPECT_LT(ms, 20e3);
  }
}

}  // namespace
}  // namespace osteon::studies
