#include "session/replay/recorded_surface.h"

#include <map>

#include <gtest/gtest.h>

#include "io/recording/recording_reader.h"
#include "session/run/cell_run.h"
#include "simulation/surface/bone_solid.h"
#include "tests/io/temporary_folder.h"
#include "tests/session/set_up_cell.h"

// The carved bone's surface that is made from a recording is compared with the surface that was made during
// the run.

namespace osteon::session {
namespace {

constexpr double kSeconds = 2.0;

/// Counts the quads of the live surface: those of the newest chunk of every brick.
class QuadCounter final : public surface::SurfaceSink {
 public:
  void Begin(const surface::BrickLayout&) override {}
  void Publish(std::span<const surface::SurfaceChunk> chunks, std::uint64_t) override {
    for (const surface::SurfaceChunk& chunk : chunks) quads_[chunk.brick] = chunk.quads.size() / 4;
  }
  [[nodiscard]] std::size_t Sum() const {
    std::size_t sum = 0;
    for (const auto& [brick, count] : quads_) sum += count;
    return sum;
  }

 private:
  std::map<surface::BrickIndex, std::size_t> quads_;
};

/// A run of the cell "molar" in virtual time, and the surface that was made during the run.
class RecordedSurface : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new io::test::TemporaryFolder;
    setup_ = new CellSetup(*SetUpCell(OSTEON_SOURCE_DIR "/config/cells/molar.yaml", std::nullopt));
    auto engine = MakeEngine(*setup_, {});
    ASSERT_TRUE(engine) << engine.error();
    QuadCounter sink;
    const simulation::Tool& tool = setup_->config.tool.tool;
    surface::SurfaceThread live(
        tool, setup_->X_WG,
        {.ring_frames = 100'000,
         .make_solid = [&] { return surface::SampleSolid(*setup_->solid, surface::VoxelFor(tool)); }},
        sink);
    const auto result =
        RunCell(*setup_, **engine,
                {.seconds = kSeconds, .virtual_time = true, .recording = Recording(), .surface = &live});
    ASSERT_TRUE(result) << result.error().what;
    live.Stop();
    ASSERT_EQ(live.error(), "");
    ASSERT_EQ(live.skipped_frames(), 0U);
    live_quads_ = sink.Sum();
    removed_mm3_ = 1e9 * result->after.removed_volume_m3;
  }
  static void TearDownTestSuite() {
    delete setup_;
    delete folder_;
  }
  static std::filesystem::path Recording() { return folder_->path() / "r.mcap"; }

  static WrittenSurface Write(const CellSetup& setup, std::optional<double> at_s, const char* name) {
    auto written = WriteRecordedSurface(Recording(), setup, at_s, folder_->path() / name);
    EXPECT_TRUE(written) << written.error();
    return *written;
  }

  static inline io::test::TemporaryFolder* folder_{nullptr};
  static inline CellSetup* setup_{nullptr};
  static inline std::size_t live_quads_{0};
  static inline double removed_mm3_{0.0};
};

TEST_F(RecordedSurface, HasAsManyTrianglesAsTheLiveSurface) {
  const WrittenSurface end = Write(*setup_, {}, "end.stl");
  EXPECT_TRUE(end.figures.watertight);
  EXPECT_FALSE(end.from_balls);
  EXPECT_EQ(end.figures.triangles, 2 * live_quads_);
}

TEST_F(RecordedSurface, LosesTheVolumeThatTheEngineRemoved) {
  const WrittenSurface before = Write(*setup_, 0.0, "before.ply"), end = Write(*setup_, {}, "end.ply");
  ASSERT_GT(removed_mm3_, 1.0);
  // 10 %: the engine counts mass points of about 0.3 mm, and the burr's radius is only 4 voxels.
  EXPECT_NEAR(before.figures.volume_mm3 - end.figures.volume_mm3, removed_mm3_, 0.1 * removed_mm3_);
}

TEST_F(RecordedSurface, LosesVolumeAsTheRequestedTimeGrows) {
  double last_mm3 = 1e9;
  for (const double at_s : {1.0, 1.5, 2.0}) {
    const WrittenSurface written = Write(*setup_, at_s, "at.obj");
    EXPECT_LE(written.time_s, at_s);
    EXPECT_GT(written.time_s, at_s - 0.01);
    EXPECT_LE(written.figures.volume_mm3, last_mm3);
    last_mm3 = written.figures.volume_mm3;
  }
}

TEST_F(RecordedSurface, IsTheSameFromTheRecordingAloneAndFromTheCell) {
  const auto stream = io::ReadRecording(Recording());
  ASSERT_TRUE(stream);
  const auto setup = PrepareRecordedCell(stream->session, {});
  ASSERT_TRUE(setup) << setup.error();
  const WrittenSurface from_cell = Write(*setup_, {}, "cell.stl"), alone = Write(*setup, {}, "alone.stl");
  EXPECT_EQ(io::test::ReadAll(from_cell.file), io::test::ReadAll(alone.file));
}

TEST_F(RecordedSurface, RefusesARecordingOfAnotherBone) {
  auto recording = io::ReadRecording(Recording());
  ASSERT_TRUE(recording);
  recording->session.scene = "hip.obj";
  const auto setup = PrepareRecordedCell(recording->session, {});
  ASSERT_FALSE(setup);
  EXPECT_NE(setup.error().find("accepted the recording's, hip.obj"), std::string::npos) << setup.error();
}

TEST(SurfaceFile, IsRefusedIfItsExtensionIsUnknown) {
  EXPECT_EQ(ValidateSurfaceFile(""), "");
  EXPECT_NE(ValidateSurfaceFile("bone.step").find("accepted a name that ends in"), std::string::npos);
}

}  // namespace
}  // namespace osteon::session
