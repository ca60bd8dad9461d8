#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "io/engine/local_engine.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/engine/engine_samples.h"

// Tests the simulation engine in another process of this machine. Client and server share a memory segment in
// a folder.

namespace osteon::io {
namespace {

using testing::HasSubstr;

constexpr rt::Nanoseconds kPatience = 10 * rt::kSecond;  // so long that a busy machine fails no test

// Deadline of a wait that must succeed.
rt::Nanoseconds Soon() { return rt::MonotonicNow() + kPatience; }

// A client (the controller's side) with its folder, and a server (the engine's side) that has opened this
// folder.
struct ClientAndServer {
  ClientAndServer() {
    auto made = LocalEngineClient::Create(EncodeSetup(test::SampleSetup()));
    if (!made) throw std::runtime_error(made.error());
    client = std::move(*made);
    auto opened = LocalEngineServer::Open(client->folder());
    if (!opened) throw std::runtime_error(opened.error());
    server = std::move(*opened);
  }
  // A frame with this number that answers this command.
  EngineFrame FrameFor(const EngineCommand& command, std::uint64_t number) const {
    EngineFrame frame = test::SampleFrame();
    frame.model.pose_stamp = command.command.stamp;
    frame.model.frame = number;
    return frame;
  }
  std::unique_ptr<LocalEngineClient> client;
  std::unique_ptr<LocalEngineServer> server;
};

TEST(LocalEngine, ACommandReachesTheEngineAndItsFrameReturns) {
  ClientAndServer pair;
  EXPECT_EQ(DecodeSetup(*pair.server->ReadSetup())->bone.name, "block");
  pair.server->SetRunning("cpu", "some processor");
  EXPECT_EQ(pair.client->state(), SharedState::kRunning);
  pair.client->ReadNames();
  EXPECT_EQ(pair.client->engine(), "cpu");
  EXPECT_EQ(pair.client->device(), "some processor");
  EXPECT_EQ(pair.client->Load().frame, 0u) << "none yet";

  pair.client->Store(test::CommandAt(50));
  EngineCommand command;
  ASSERT_EQ(pair.server->Await(command, Soon()), EngineEvent::kCommand);
  EXPECT_EQ(command.command.stamp, 50);
  EXPECT_EQ(command.command.spindle_rad_per_s, 3.0);
  EXPECT_LT(command.dt_s, 0.0) << "by the stamps";
  pair.server->Publish(pair.FrameFor(command, 1));
  EXPECT_EQ(pair.client->Load().pose_stamp, 50) << "the stamp returns";
  EngineFrame frame;
  ASSERT_TRUE(pair.client->AwaitFrame(frame, Soon()));
  EXPECT_EQ(frame.model.frame, 1u);
  EXPECT_FALSE(pair.client->AwaitFrame(frame, 0)) << "each frame once";
}

TEST(LocalEngine, TheLoopLoadsTheNewestFrameAndTheRecordingReceivesEach) {
  ClientAndServer pair;
  for (std::uint64_t n = 1; n <= 20; ++n) pair.server->Publish(pair.FrameFor(test::SampleCommand(), n));
  EXPECT_EQ(pair.client->Load().frame, 20u);
  EngineFrame frame;
  for (std::uint64_t n = 1; n <= 20; ++n) {
    ASSERT_TRUE(pair.client->AwaitFrame(frame, Soon()));
    EXPECT_EQ(frame.model.frame, n);
  }
  EXPECT_EQ(pair.client->counters().lost, 0u);
  EXPECT_EQ(pair.client->counters().frames, 20u);
}

TEST(LocalEngine, FramesThatOverflowTheRingAreCountedAsLost) {
  ClientAndServer pair;
  const std::uint64_t made = SharedRing::kMessages + 10;
  for (std::uint64_t n = 1; n <= made; ++n) pair.server->Publish(pair.FrameFor(test::SampleCommand(), n));
  EngineFrame frame;
  std::uint64_t came = 0;
  while (pair.client->AwaitFrame(frame, 0)) ++came;
  EXPECT_EQ(came, SharedRing::kMessages);
  pair.server->Publish(pair.FrameFor(test::SampleCommand(), made + 1));
  ASSERT_TRUE(pair.client->AwaitFrame(frame, Soon()));
  EXPECT_EQ(pair.client->counters().lost, 10u);
}

// One thread publishes messages while another reads them. Each message must be complete, and none may be
// older than the previous one.
TEST(LocalEngine, NoMessageIsTornBetweenWriterAndReader) {
  ClientAndServer pair;
  std::atomic<bool> stop{false};
  std::thread writer([&] {
    for (std::uint64_t n = 1; !stop.load(); ++n)
      pair.server->Publish(pair.FrameFor(test::SampleCommand(), n));
  });
  std::uint64_t last = 0, seen = 0;
  const rt::Nanoseconds end = Soon();
  while (seen < 2000 && rt::MonotonicNow() < end) {
    const std::uint64_t now = pair.client->Load().frame;
    EXPECT_GE(now, last);
    seen += now > last ? 1 : 0;
    last = now;
  }
  stop.store(true);
  writer.join();
  EXPECT_EQ(seen, 2000u);
  EXPECT_EQ(pair.client->counters().rejected, 0u);
}

// The other process overwrites the frames in the shared segment with noise. The noise must be refused.
TEST(LocalEngine, NoiseInTheSegmentIsRefusedAndTheLastFrameStays) {
  ClientAndServer pair;
  pair.server->Publish(pair.FrameFor(test::SampleCommand(), 1));
  EXPECT_EQ(pair.client->Load().frame, 1u);
  const std::filesystem::path segment = pair.client->folder() / "segment";
  std::fstream file(segment, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(offsetof(SharedEngine, models)));
  const std::string noise(sizeof(SharedSlot), '\xff');
  file.write(noise.data(), static_cast<std::streamsize>(noise.size()));
  file.seekp(static_cast<std::streamoff>(offsetof(SharedEngine, frames)));
  const std::string more(sizeof(SharedRing), '\xa5');
  file.write(more.data(), static_cast<std::streamsize>(more.size()));
  file.close();
  EXPECT_EQ(pair.client->Load().frame, 1u) << "the last that was whole";
  EngineFrame frame;
  EXPECT_FALSE(pair.client->AwaitFrame(frame, rt::MonotonicNow() + rt::kMillisecond));
  pair.client->Store(test::CommandAt(60));
}

TEST(LocalEngine, TheCarvedStateIsFetchedAtTheEnd) {
  ClientAndServer pair;
  std::thread engine([&] {
    EngineCommand command;
    EngineEvent event = EngineEvent::kNothing;
    while (event != EngineEvent::kEnd) event = pair.server->Await(command, Soon());
    pair.server->PutCarved({1, 2, 3});
  });
  const auto carved = pair.client->FetchCarved(Soon());
  engine.join();
  ASSERT_TRUE(carved) << carved.error();
  EXPECT_EQ(*carved, (std::vector<std::uint8_t>{1, 2, 3}));
}

TEST(LocalEngine, WaitsForASilentEngineNoLongerThanItsDeadline) {
  ClientAndServer pair;
  const auto carved = pair.client->FetchCarved(rt::MonotonicNow() + 20 * rt::kMillisecond);
  ASSERT_FALSE(carved);
  EXPECT_THAT(carved.error(), HasSubstr("does not answer"));
}

TEST(LocalEngine, TheEnginesFailureReachesTheClient) {
  ClientAndServer pair;
  pair.server->SetFailed("no such device");
  EXPECT_EQ(pair.client->state(), SharedState::kFailed);
  EXPECT_EQ(pair.client->ReadError(), "no such device");
}

TEST(LocalEngine, TheEngineDetectsTheEndOfTheRun) {
  ClientAndServer pair;
  pair.client.reset();
  EngineCommand command;
  EXPECT_EQ(pair.server->Await(command, Soon()), EngineEvent::kGone);
}

TEST(LocalEngine, TheFolderIsPrivateAndRemovedWithTheRun) {
  ClientAndServer pair;
  const std::filesystem::path folder = pair.client->folder();
  struct stat status {};
  ASSERT_EQ(stat(folder.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 077, 0u);
  pair.client.reset();
  EXPECT_FALSE(std::filesystem::exists(folder));
}

// A killed run leaves its folder behind, but no process holds the folder's lock. The next run must remove the
// folder.
TEST(LocalEngine, TheFolderOfAKilledRunIsRemovedByTheNextRun) {
  ClientAndServer pair;
  const std::filesystem::path left = pair.client->folder().parent_path() / "osteon_engine_left_by_test";
  std::filesystem::create_directory(left);
  std::ofstream(left / "segment") << "old";
  const auto next = LocalEngineClient::Create({});
  ASSERT_TRUE(next) << next.error();
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(std::filesystem::exists(pair.client->folder())) << "of a run that lives";
}

TEST(LocalEngine, FoldersThatAreNotOfARunAreRefused) {
  ClientAndServer pair;
  EXPECT_FALSE(LocalEngineServer::Open("/nowhere"));
  std::filesystem::permissions(pair.client->folder(), std::filesystem::perms::all);
  EXPECT_THAT(LocalEngineServer::Open(pair.client->folder()).error(), HasSubstr("others may enter"));
  std::filesystem::permissions(pair.client->folder(), std::filesystem::perms::owner_all);
  std::filesystem::resize_file(pair.client->folder() / "segment", sizeof(SharedEngine) + 8);
  EXPECT_THAT(LocalEngineServer::Open(pair.client->folder()).error(), HasSubstr("another size"));
}

TEST(LocalEngine, StoreAndLoadDoNotAllocate) {
  ClientAndServer pair;
  pair.server->Publish(pair.FrameFor(test::SampleCommand(), 1));
  rt::CheckedNoAllocScope no_alloc;
  pair.client->Store(test::CommandAt(70));
  const std::uint64_t frame = pair.client->Load().frame;
  no_alloc.End();
  EXPECT_EQ(frame, 1u);
}

}  // namespace
}  // namespace osteon::io
