#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/plugin/plugin_objects.h"

// Sessions that run their engine in a thread, in wall time. No assertion depends on timing.

namespace osteon::plugin {
namespace {

OsteonSettings Threaded(bool with_surface) {
  OsteonSettings settings = Lockstep(with_surface);
  settings.lockstep = 0;
  return settings;
}

std::size_t ThreadsOfThisProcess() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) ++count;
  return count;
}

std::string NameOfThisThread() {
  std::ifstream file("/proc/thread-self/comm");
  std::string name;
  std::getline(file, name);
  return name;
}

TEST(OsteonSessionThreads, CutWhileAHapticThreadEvaluatesTheWrench) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Threaded(true));
  const OsteonPose free = Above(4.2);
  double largest_N = 0.0;
  for (int i = 0; i < 5000 && FiguresOf(session.get()).frame == 0; ++i) {  // wait for the first frame
    ASSERT_OK(osteon_session_set_tool_pose(session.get(), &free, 100.0));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  for (int ms = 0; ms < 1000; ++ms) {
    const OsteonPose pose = Above(4.2 - 0.002 * ms);
    OsteonWrench wrench;
    ASSERT_OK(osteon_session_set_tool_pose(session.get(), &pose, 100.0));
    ASSERT_OK(osteon_session_evaluate(session.get(), &pose, nullptr, &wrench));
    largest_N = std::max(largest_N, std::hypot(wrench.force_N[0], wrench.force_N[1], wrench.force_N[2]));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const OsteonFigures figures = FiguresOf(session.get());
  EXPECT_GT(figures.frame, 10U);
  EXPECT_GT(figures.removed_volume_m3, 0.0);
  EXPECT_LE(largest_N, 200.0);
}

TEST(OsteonSessionThreads, PoseAndWrenchNeitherAllocateNorLock) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Threaded(true));
  OsteonWrench wrench;
  const OsteonTwist twist{};
  rt::CheckedNoAllocScope scope;
  for (int i = 0; i < 2000; ++i) {
    const OsteonPose pose = Above(4.2 - 0.001 * i);
    (void)osteon_session_set_tool_pose(session.get(), &pose, 100.0);
    (void)osteon_session_evaluate(session.get(), &pose, &twist, &wrench);
  }
  scope.End();
}

// If no new poses come, the last pose becomes too old and the force fades to zero.
TEST(OsteonSessionThreads, TheForceFadesWhenPosesStop) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Threaded(false));
  OsteonPose pose = Above(4.2);
  for (int ms = 0; ms < 5000 && FiguresOf(session.get()).contacts == 0; ++ms) {
    pose = Above(std::max(3.0, 4.2 - 0.004 * ms));
    ASSERT_OK(osteon_session_set_tool_pose(session.get(), &pose, 0.0));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  OsteonWrench wrench;
  ASSERT_OK(osteon_session_evaluate(session.get(), &pose, nullptr, &wrench));
  EXPECT_EQ(std::hypot(wrench.force_N[0], wrench.force_N[1], wrench.force_N[2]), 0.0);
  EXPECT_GE(FiguresOf(session.get()).pose_age_s, 0.2);
}

TEST(OsteonSessionThreads, LeaveTheHostsThreadsUnchanged) {
  const std::string name = NameOfThisThread();
  cpu_set_t before, after;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  const int nice = getpriority(PRIO_PROCESS, 0), policy = sched_getscheduler(0);
  const std::size_t threads = ThreadsOfThisProcess();
  {
    const auto bone = BlockOfBalls();
    const auto tool = BallTool();
    const auto session = MakeSession(bone.get(), tool.get(), Threaded(true));
    EXPECT_GT(ThreadsOfThisProcess(), threads);
  }
  EXPECT_EQ(ThreadsOfThisProcess(), threads) << "all joined";
  EXPECT_EQ(NameOfThisThread(), name);
  ASSERT_EQ(sched_getaffinity(0, sizeof after, &after), 0);
  EXPECT_TRUE(CPU_EQUAL(&before, &after));
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), nice);
  EXPECT_EQ(sched_getscheduler(0), policy);
}

TEST(OsteonSessionThreads, BeginAndEndManyTimesInAnyOrder) {
  for (int i = 0; i < 200; ++i) {
    auto bone = BlockOfBalls();
    auto tool = BallTool();
    auto session = MakeSession(bone.get(), tool.get(), Threaded(i % 4 == 0));
    const OsteonPose free = Above(4.2);
    ASSERT_OK(osteon_session_set_tool_pose(session.get(), &free, 0.0));
    if (i % 2 == 0) bone.reset(), tool.reset();  // a session keeps its own references
    session.reset();
  }
}

// Any thread may ask for figures, marks and the surface while the engine runs and a haptic thread evaluates
// the force.
TEST(OsteonSessionThreads, AnswerManyThreadsAtOnce) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Threaded(true));
  const OsteonPose free = Above(4.2);
  std::atomic<bool> stop{false};
  std::thread haptic([&] {
    for (int i = 0; !stop; ++i) {
      const OsteonPose pose = Above(4.2 - 0.0005 * (i % 2000));
      OsteonWrench wrench;
      (void)osteon_session_set_tool_pose(session.get(), &pose, 100.0);
      (void)osteon_session_evaluate(session.get(), &pose, nullptr, &wrench);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  std::thread other([&] {
    for (int i = 0; i < 40; ++i) {
      (void)osteon_session_mark(session.get());
      (void)osteon_session_undo(session.get(), &free);
    }
  });
  for (int i = 0; i < 40; ++i) {
    (void)FiguresOf(session.get());
    EXPECT_OK(osteon_session_surface_wait(session.get()));
  }
  other.join();
  stop = true;
  haptic.join();
  EXPECT_GT(FiguresOf(session.get()).frame, 0U);
}

}  // namespace
}  // namespace osteon::plugin
