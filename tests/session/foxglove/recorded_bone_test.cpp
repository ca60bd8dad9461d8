#include "session/foxglove/recorded_bone.h"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/session/foxglove/shown_bone.h"
#include "tests/session/run/virtual_run.h"

namespace osteon::session {
namespace {

// Runs of the cell "molar" in virtual time, whose recordings contain the bone's surface.
class RecordedBoneRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setup_ = new CellSetup(*SetUpCell(OSTEON_SOURCE_DIR "/config/cells/molar.yaml", std::nullopt));
  }
  static void TearDownTestSuite() {
    delete setup_;
    setup_ = nullptr;
  }
  // Records a run of 3 s. @param bone_state_s  time between two states of the bone; 0: none
  std::filesystem::path Run(const char* name, double bone_state_s) {
    auto engine = MakeEngine(*setup_, {.engine = "cpu"});
    EXPECT_TRUE(engine) << engine.error();
    const CellRunParams params{.seconds = 3.0,
                               .virtual_time = true,
                               .recording = folder_.path() / name,
                               .bone_state_s = bone_state_s};
    const auto run = RunCell(*setup_, **engine, params);
    EXPECT_TRUE(run) << run.error().what;
    EXPECT_GT(run->after.removed_volume_m3, 0.0);
    return params.recording;
  }
  static std::string BytesOf(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  io::test::TemporaryFolder folder_;
  static inline CellSetup* setup_{nullptr};
};

TEST_F(RecordedBoneRun, ARecordingShowsTheWholeBoneFirstThenTheChangedParts) {
  const auto states = BoneStates(Run("a.mcap", 1.0));
  ASSERT_GE(states.size(), 3u);
  EXPECT_EQ(states[0].deletions_size(), 1);
  EXPECT_GT(states[0].entities_size(), 30);
  for (std::size_t i = 1; i < states.size(); ++i) {
    EXPECT_EQ(states[i].deletions_size(), 0);
    EXPECT_LT(states[i].entities_size(), states[0].entities_size() / 2);
  }
}

TEST_F(RecordedBoneRun, ARunWithoutBoneStatesRecordsNone) {
  EXPECT_TRUE(BoneStates(Run("none.mcap", 0.0)).empty());
}

TEST_F(RecordedBoneRun, EqualRunsGiveRecordingsWithEqualBytes) {
  EXPECT_EQ(BytesOf(Run("a.mcap", 1.0)), BytesOf(Run("b.mcap", 1.0)));
}

// If the bone is carved in its own thread, the states in between may differ, but the last state must be the
// same.
TEST_F(RecordedBoneRun, EndsWithTheSameBoneOnItsOwnThreadAndOnTheCallers) {
  const auto recording = io::ReadRecording(Run("a.mcap", 0.0));
  ASSERT_TRUE(recording);
  const CellScene scene(*setup_);
  std::vector<Shown> ends;
  for (const bool own_thread : {false, true}) {
    RecordedBone bone(*setup_, scene, {.step = 500'000'000, .own_thread = own_thread});
    Shown& shown = ends.emplace_back();
    foxglove::SceneUpdate state;
    const auto show = [&](const std::string* bytes) {
      if (!bytes) return false;
      EXPECT_TRUE(state.ParseFromString(*bytes));
      Show(state, shown);
      return true;
    };
    std::size_t frame = 0;
    bool turns = false;
    for (const control::TickRecord& tick : recording->ticks) {
      for (; frame < recording->frames.size() && recording->frames[frame].stamp < tick.stamp; ++frame)
        bone.Add(recording->frames[frame].model, turns);
      turns = tick.spindle_rad_per_s != 0.0;
      show(bone.Take(tick.stamp));
    }
    while (show(bone.Finish())) {
    }
  }
  ASSERT_GT(ends[0].size(), 30u);
  EXPECT_EQ(ends[0], ends[1]);
}

TEST_F(RecordedBoneRun, TheGridIsCoarserIfTheBoneHasTooManyFaces) {
  const CellScene scene(*setup_);
  RecordedBone fine(*setup_, scene, {.own_thread = false}),
      coarse(*setup_, scene, {.own_thread = false, .max_quads = 2'000});
  foxglove::SceneUpdate state;
  const auto triangles_of = [&](RecordedBone& bone) {
    EXPECT_TRUE(state.ParseFromString(*bone.Take(1)));
    std::size_t triangles = 0;
    for (const auto& entity : state.entities())
      for (const auto& part : entity.triangles())
        triangles += static_cast<std::size_t>(part.indices_size()) / 3;
    return triangles;
  };
  EXPECT_LE(triangles_of(coarse), 4'000u);
  EXPECT_GT(triangles_of(fine), 4'000u);
  EXPECT_GT(coarse.voxel_mm(), fine.voxel_mm());
}

}  // namespace
}  // namespace osteon::session
