#include "simulation/surface/surface_thread.h"

#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/surface/welded_surface.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/simulation/surface/surface_shapes.h"

namespace osteon::surface {
namespace {

using simulation::Tool;

const Tool kBall{.name = "ball", .balls = {{.center_m = Vector3(0, 0, 0), .radius_m = 0.003}}};

/// Frame i of a helix: the ball circles at 4 mm around the bone's axis and sinks by 10 um a frame from z = 11
/// mm.
ToolFrame FrameNumber(std::uint64_t i) {
  const double s = static_cast<double>(i);
  Pose X = Pose::Identity();
  X.translation() = Vector3(0.004 * std::cos(0.02 * s), 0.004 * std::sin(0.02 * s), 0.011 - 1e-5 * s);
  return {.X_WP = X, .p_WS_m = Vector3(X.translation()), .cuts = true, .frame = i};
}

/// Keeps the newest chunk of every brick.
class ChunkKeeper final : public SurfaceSink {
 public:
  void Begin(const BrickLayout& layout) override { bricks = layout.Count(); }
  void Publish(std::span<const SurfaceChunk> chunks, std::uint64_t frame) override {
    for (const SurfaceChunk& chunk : chunks) kept[chunk.brick] = chunk;
    last_frame = frame;
  }
  std::map<BrickIndex, SurfaceChunk> kept;
  BrickIndex bricks{0};
  std::atomic<std::uint64_t> last_frame{0};
};

/// Number of quads in all chunks.
std::size_t CountQuads(const std::map<BrickIndex, SurfaceChunk>& chunks) {
  std::size_t count = 0;
  for (const auto& [brick, chunk] : chunks) count += chunk.quads.size() / 4;
  return count;
}

TEST(SurfaceThread, PublishesTheMeshOfAllFrames) {
  constexpr std::uint64_t kFrames = 500;
  ChunkKeeper sink;
  SurfaceThread thread(kBall, Pose::Identity(), {.make_solid = [] { return BallField(9.0F, 0.5F); }}, sink);
  for (std::uint64_t i = 1; i <= kFrames; ++i) ASSERT_TRUE(thread.Push(FrameNumber(i)));
  thread.Stop();
  EXPECT_EQ(thread.error(), "");
  EXPECT_EQ(thread.skipped_frames(), 0U);
  EXPECT_EQ(sink.last_frame, kFrames);

  CarvedField field(BallField(9.0F, 0.5F));
  ToolSweep sweep(kBall, Pose::Identity());
  for (std::uint64_t i = 1; i <= kFrames; ++i)
    if (sweep.Add(FrameNumber(i))) field.Carve(sweep.TakeCapsules());
  field.Carve(sweep.TakeCapsules());
  EXPECT_EQ(sink.bricks, field.layout().Count());
  EXPECT_EQ(CountQuads(sink.kept), WeldSurface(field).quads.size());
  EXPECT_NE(CountQuads(sink.kept), WeldSurface(CarvedField(BallField(9.0F, 0.5F))).quads.size());
}

TEST(SurfaceThread, PushNeitherAllocatesNorLocks) {
  ChunkKeeper sink;
  SurfaceThread thread(kBall, Pose::Identity(),
                       {.ring_frames = 64, .make_solid = [] { return BallField(9.0F, 0.5F); }}, sink);
  rt::CheckedNoAllocScope scope;
  for (std::uint64_t i = 1; i <= 200; ++i) (void)thread.Push(FrameNumber(i));  // more than the ring can hold
  scope.End();
}

TEST(SurfaceThread, ReplacesFramesThatAFullRingRefusedByAStraightWay) {
  constexpr std::size_t kRing = 8;
  std::mutex mutex;
  std::condition_variable changed;
  bool may_begin = false;
  ChunkKeeper sink;
  SurfaceThread thread(kBall, Pose::Identity(),
                       {.ring_frames = kRing,
                        .make_solid =
                            [&] {
                              std::unique_lock lock(mutex);
                              changed.wait(lock, [&] { return may_begin; });
                              return BallField(9.0F, 0.5F);
                            }},
                       sink);
  for (std::uint64_t i = 1; i <= 100; ++i) EXPECT_EQ(thread.Push(FrameNumber(i)), i <= kRing);
  EXPECT_EQ(thread.skipped_frames(), 100 - kRing);
  {
    const std::lock_guard lock(mutex);
    may_begin = true;
  }
  changed.notify_one();
  while (!thread.Push(FrameNumber(101))) std::this_thread::yield();
  thread.Stop();
  EXPECT_EQ(sink.last_frame, 101U);
  CarvedField field(BallField(9.0F, 0.5F));
  ToolSweep sweep(kBall, Pose::Identity());
  for (std::uint64_t i = 1; i <= kRing; ++i) (void)sweep.Add(FrameNumber(i));
  (void)sweep.Add(FrameNumber(101));
  field.Carve(sweep.TakeCapsules());
  EXPECT_EQ(CountQuads(sink.kept), WeldSurface(field).quads.size());
}

TEST(SurfaceThread, AppliesAChangeAfterAllPushedFrames) {
  ChunkKeeper sink;
  SurfaceThread thread(kBall, Pose::Identity(), {.make_solid = [] { return BallField(9.0F, 0.5F); }}, sink);
  for (std::uint64_t i = 1; i <= 205; ++i) ASSERT_TRUE(thread.Push(FrameNumber(i)));
  std::uint64_t frame = 0;
  BrickField swept;
  thread.Apply([&](CarvedField& field, ToolSweep& sweep) {
    frame = sweep.frame();
    swept = field.swept();
  });
  EXPECT_EQ(frame, 205U);
  const std::size_t quads = CountQuads(sink.kept);
  for (std::uint64_t i = 206; i <= 500; ++i) ASSERT_TRUE(thread.Push(FrameNumber(i)));
  thread.Apply([](CarvedField&, ToolSweep&) {});
  EXPECT_NE(CountQuads(sink.kept), quads);
  thread.Apply([&](CarvedField& field, ToolSweep&) { field.SetSwept(swept); });
  EXPECT_EQ(CountQuads(sink.kept), quads) << "published as it was";
  EXPECT_THROW(thread.Apply([](CarvedField&, ToolSweep&) { throw std::logic_error("mine"); }),
               std::logic_error);
}

TEST(SurfaceThread, MeshesNothingWhileUnwatchedAndEveryChangeOnceWatched) {
  ChunkKeeper sink;
  std::atomic<bool> watched{false};
  SurfaceThread thread(
      kBall, Pose::Identity(),
      {.make_solid = [] { return BallField(9.0F, 0.5F); }, .is_watched = [&] { return watched.load(); }},
      sink);
  thread.Apply([](CarvedField&, ToolSweep&) {});
  const std::size_t uncut = CountQuads(sink.kept);
  EXPECT_GT(uncut, 0U) << "the first mesh is ready for who comes";
  BrickField swept;
  for (std::uint64_t i = 1; i <= 205; ++i) ASSERT_TRUE(thread.Push(FrameNumber(i)));
  thread.Apply([&](CarvedField& field, ToolSweep&) { swept = field.swept(); });
  EXPECT_EQ(sink.last_frame, 0U);
  EXPECT_EQ(CountQuads(sink.kept), uncut);
  CarvedField expected(BallField(9.0F, 0.5F));
  expected.SetSwept(swept);
  const std::size_t cut = WeldSurface(expected).quads.size();
  EXPECT_NE(cut, uncut) << "the field follows";
  watched.store(true);
  thread.Apply([](CarvedField&, ToolSweep&) {});
  EXPECT_EQ(sink.last_frame, 205U);
  EXPECT_EQ(CountQuads(sink.kept), cut);
}

// Frames 1 … 205 are the first pass, frames 207 … 500 the second. If the second pass is undone, the mesh must
// be that after the first pass again.
TEST(SurfaceThread, TakingAPassBackRestoresTheMeshBeforeIt) {
  const auto frame = [](std::uint64_t i) {
    ToolFrame made = FrameNumber(i);
    made.touches = true;
    made.pose_stamp = static_cast<rt::Nanoseconds>(i);
    made.cuts = i != 206;  // the spindle stands still, which ends the batch
    return made;
  };
  ChunkKeeper sink;
  SurfaceThread thread(kBall, Pose::Identity(),
                       {.make_solid = [] { return BallField(9.0F, 0.5F); },
                        .carve_earlier =
                            [](CarvedField& field) {
                              const Capsule hole{.a_mm = {0, 0, -9}, .b_mm = {0, 0, -8}, .radius_mm = 1.0F};
                              field.Carve({&hole, 1});
                            },
                        .keeps_batches = true},
                       sink);
  for (std::uint64_t i = 1; i <= 206; ++i) ASSERT_TRUE(thread.Push(frame(i)));
  thread.Apply([](CarvedField&, ToolSweep&) {});
  const std::size_t first = CountQuads(sink.kept);
  for (std::uint64_t i = 207; i <= 500; ++i) ASSERT_TRUE(thread.Push(frame(i)));
  thread.Apply([](CarvedField&, ToolSweep&) {});
  EXPECT_NE(CountQuads(sink.kept), first);
  thread.Undo({{.begin = 207, .end = 500}});
  thread.Stop();
  EXPECT_EQ(thread.error(), "");
  EXPECT_EQ(CountQuads(sink.kept), first) << "with what was cut earlier";
}

TEST(SurfaceThread, AgeIsAtMostTheTimeSinceAllFramesWerePushed) {
  ChunkKeeper sink;
  SurfaceThread thread(kBall, Pose::Identity(), {.make_solid = [] { return BallField(9.0F, 0.5F); }}, sink);
  for (std::uint64_t i = 1; i <= 100; ++i) ASSERT_TRUE(thread.Push(FrameNumber(i)));
  const rt::Nanoseconds before = rt::MonotonicNow();
  thread.Apply([](CarvedField&, ToolSweep&) {});
  EXPECT_LE(thread.age().count(), rt::MonotonicNow() - before);
}

// Three spinning threads share the only CPU of the surface's thread, and SCHED_IDLE leaves it almost no time.
// The mesh must follow nevertheless.
TEST(SurfaceThread, FollowsTheCutOnABusyMachine) {
  cpu_set_t all, one;
  ASSERT_EQ(pthread_getaffinity_np(pthread_self(), sizeof all, &all), 0);
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
  pthread_setaffinity_np(pthread_self(), sizeof one, &one);  // the threads made here inherit it
  std::atomic<bool> done{false};
  std::vector<std::thread> others;
  for (int i = 0; i < 3; ++i)
    others.emplace_back([&] {
      while (!done.load()) continue;
    });
  ChunkKeeper sink;
  SurfaceThread thread(kBall, Pose::Identity(), {.make_solid = [] { return BallField(9.0F, 0.5F); }}, sink);
  pthread_setaffinity_np(pthread_self(), sizeof all, &all);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(15);
  const auto follows_to = [&](std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t i = first; i <= last; ++i) (void)thread.Push(FrameNumber(i));
    while (sink.last_frame < last && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return sink.last_frame.load();
  };
  for (std::uint64_t i = 0; i < 4; ++i) EXPECT_EQ(follows_to(480 * i + 1, 480 * i + 480), 480 * i + 480);
  done.store(true);
  for (std::thread& other : others) other.join();
}

TEST(SurfaceThread, ReportsWhyItsThreadFailed) {
  ChunkKeeper sink;
  SurfaceThread thread(kBall, Pose::Identity(), {.make_solid = []() -> std::shared_ptr<const SolidField> {
                         throw std::invalid_argument("no solid");
                       }},
                       sink);
  (void)thread.Push(FrameNumber(1));
  EXPECT_THROW(thread.Apply([](CarvedField&, ToolSweep&) {}), std::runtime_error);
  thread.Stop();
  EXPECT_EQ(thread.error(), "no solid");
}

}  // namespace
}  // namespace osteon::surface
