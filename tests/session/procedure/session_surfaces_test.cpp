// The carved bone of a session, in its recording and on the console. It must have the cuts of each tool in
// turn, but not those of undone passes, and also the cuts of the session's earlier recordings.

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "safety/cell_state.h"
#include "session/run/live_surface.h"
#include "tests/session/foxglove/shown_bone.h"
#include "tests/session/procedure/procedure_rig.h"

namespace osteon::session {
namespace {

constexpr double kTolerance = 0.08;  // share of a pass's volume: the recording's grid is coarse

/// The surface as a console page has it: the newest chunk of every brick.
class ShownSurface final : public surface::SurfaceSink {
 public:
  void Begin(const surface::BrickLayout&) override {}
  void Publish(std::span<const surface::SurfaceChunk> chunks, std::uint64_t) override {
    for (const surface::SurfaceChunk& chunk : chunks) kept_[chunk.brick] = chunk;
  }
  [[nodiscard]] double Volume_mm3() const {
    double volume_mm3 = 0.0;
    for (const auto& [brick, chunk] : kept_) {
      const auto point = [&chunk](std::size_t i) {
        const surface::Vec3 p = chunk.vertices[chunk.quads[i]].p_mm;
        return Vector3(p.x, p.y, p.z);
      };
      for (std::size_t i = 0; i + 3 < chunk.quads.size(); i += 4)
        volume_mm3 += (point(i).dot(point(i + 1).cross(point(i + 2))) +
                       point(i).dot(point(i + 2).cross(point(i + 3)))) /
                      6.0;
    }
    return volume_mm3;
  }

 private:
  std::map<surface::BrickIndex, surface::SurfaceChunk> kept_;
};

/// Bone that the passes have removed [mm³]. @param undone  true: of the undone passes; false: of the others
double Removed_mm3(const SessionFile& session, bool undone) {
  double removed_mm3 = 0.0;
  for (const SessionPass& pass : session.passes)
    if (pass.undone == undone) removed_mm3 += pass.removed_mm3;
  return removed_mm3;
}

/// Once `ready` returns true: asks for a pause, then for an undo of the last pass, then for the run's end.
class UndoByHand {
 public:
  UndoByHand(Rig& rig, std::function<bool()> ready) : rig_(rig), ready_(std::move(ready)) {
    rig_.params.requests = &buttons_;
    rig_.params.stop = &stop_;
    rig_.params.ticked = [this](const control::TickRecord& tick, const simulation::ContactModel&) {
      OnTick(tick);
    };
  }
  [[nodiscard]] bool done() const { return done_; }

 private:
  void OnTick(const control::TickRecord& tick) {
    if (done_ || !ready_()) return;
    const bool paused = tick.cell_state == static_cast<std::uint8_t>(safety::CellState::kPaused);
    if (!paused) buttons_.pause.store(true);
    if (paused)
      (void)rig_.session->Post({.kind = SessionRequest::Kind::kUndo}, [this](const SessionAnswer& answer) {
        done_ = done_ || answer.done;
        if (answer.done) stop_.store(true);
      });
  }
  Rig& rig_;
  std::function<bool()> ready_;
  base::OperatorRequests buttons_;
  std::atomic<bool> stop_{false};
  bool done_{false};
};

TEST(SessionSurfaces, FollowEachToolAndLeaveOutAnUndonePass) {
  Rig rig("surfaces", 14.0);
  rig.params.bone_state_s = 1.0;
  UndoByHand undo(rig, [&] {
    const std::vector<SessionPass> passes = rig.session->File().passes;
    return !passes.empty() && passes.back().tool_index == 1;
  });
  ShownSurface page;
  auto live = StartSurface(*rig.setup, rig.session.get(), {}, page);
  rig.params.surface = live.get();
  double page_with_all_mm3 = 0.0;
  rig.params.progress = [&](double) {
    // wait until all frames so far are carved
    live->Apply([](surface::CarvedField&, surface::ToolSweep&) {});
    if (!undo.done()) page_with_all_mm3 = page.Volume_mm3();
  };
  live->Apply([](surface::CarvedField&, surface::ToolSweep&) {});
  const double page_before_mm3 = page.Volume_mm3();
  rig.Run();
  ASSERT_TRUE(undo.done());
  live->Stop();
  ASSERT_EQ(live->error(), "");

  const SessionFile session = rig.session->File();
  const double kept_mm3 = Removed_mm3(session, false), undone_mm3 = Removed_mm3(session, true);
  ASSERT_GT(kept_mm3, 500.0);
  ASSERT_GT(undone_mm3, 200.0);
  const std::vector<double> recorded_mm3 = BoneVolumes(rig.params.recording);
  ASSERT_GT(recorded_mm3.size(), 3u);
  const double min_mm3 = *std::ranges::min_element(recorded_mm3);
  EXPECT_NEAR(recorded_mm3.front() - min_mm3, kept_mm3 + undone_mm3, kTolerance * (kept_mm3 + undone_mm3))
      << "both reamers, each with its own head";
  EXPECT_NEAR(recorded_mm3.front() - recorded_mm3.back(), kept_mm3, kTolerance * kept_mm3);
  EXPECT_NEAR(page_before_mm3 - page_with_all_mm3, kept_mm3 + undone_mm3,
              kTolerance * (kept_mm3 + undone_mm3));
  EXPECT_NEAR(page_before_mm3 - page.Volume_mm3(), kept_mm3, kTolerance * kept_mm3);
}

TEST(SessionSurfaces, BeginWithTheCutsOfEarlierRecordingsAndUndoThemAsWell) {
  SessionFile first;
  double bone_mm3 = 0.0;  // volume at the first recording's end
  {
    Rig rig("resumed_surfaces", 4.0);
    rig.params.bone_state_s = 1.0;
    rig.Run();
    first = rig.session->File();
    bone_mm3 = BoneVolumes(rig.params.recording).back();
  }
  ASSERT_FALSE(first.passes.empty());
  const double undone_mm3 = first.passes.back().removed_mm3;
  ASSERT_GT(undone_mm3, 200.0);
  Rig again("resumed_surfaces", 2.0, &first);
  again.params.bone_state_s = 1.0;
  ShownSurface page;
  UndoByHand undo(again, [ticks = 0]() mutable { return ++ticks > 500; });
  auto begun = again.session->Begin(*again.engine);
  ASSERT_TRUE(begun) << begun.error();
  auto live = StartSurface(*again.setup, again.session.get(), {}, page);
  live->Apply([](surface::CarvedField&, surface::ToolSweep&) {});
  const double page_begins_mm3 = page.Volume_mm3();
  again.params.surface = live.get();
  const auto run = RunCell(*again.setup, *again.engine, again.params);
  ASSERT_TRUE(run) << run.error().what;
  ASSERT_TRUE(undo.done());
  live->Stop();
  ASSERT_EQ(live->error(), "");
  const std::vector<double> resumed_mm3 = BoneVolumes(again.params.recording);
  ASSERT_GE(resumed_mm3.size(), 2u);
  EXPECT_NEAR(resumed_mm3.front(), bone_mm3, 0.02 * undone_mm3);
  EXPECT_NEAR(resumed_mm3.back() - resumed_mm3.front(), undone_mm3, kTolerance * undone_mm3)
      << "the first recording's last pass was undone";
  EXPECT_NEAR(page.Volume_mm3() - page_begins_mm3, undone_mm3, kTolerance * undone_mm3);
}

}  // namespace
}  // namespace osteon::session
