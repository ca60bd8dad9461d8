#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <foxglove.pb.h>
#include <gtest/gtest.h>

#include "io/recording/mcap_reader.h"
#include "session/foxglove/live_topics.h"
#include "session/foxglove/recorded_topics.h"
#include "tests/io/temporary_folder.h"
#include "tests/session/set_up_cell.h"

// The messages of a cell for the viewer Foxglove, in recordings and live, decoded by Foxglove's own schemas.

namespace osteon::session {
namespace {

Pose PoseOf(const foxglove::FrameTransform& frame) {
  Pose X = Pose::Identity();
  const auto& q = frame.rotation();
  X.linear() = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).toRotationMatrix();
  X.translation() = Vector3(frame.translation().x(), frame.translation().y(), frame.translation().z());
  return X;
}

// A tick `number` ms after the start, with a coupling force of 50 N along z.
control::TickRecord Tick(int number) {
  control::TickRecord tick;
  tick.stamp = static_cast<rt::Nanoseconds>(number) * 1'000'000;
  for (std::size_t i = 0; i < tick.q_meas.size(); ++i) tick.q_meas[i] = 0.3 * static_cast<double>(i) - 0.8;
  Pose X = Pose::Identity();
  X.translation() = Vector3(0.1, 0.2, 0.3);
  tick.X_WT_cmd = tick.X_WT_meas = X;
  tick.F_coupling_T_W.f = {0.0, 0.0, 50.0};
  return tick;
}

// A contact model with one contact.
simulation::ContactModel Model() {
  simulation::ContactModel model;
  model.frame = 3;
  model.contact_count = 1;
  model.contacts[0].n_W = {0.0, 0.0, -1.0};
  model.contacts[0].p_W_m = {0.1, 0.2, 0.3};
  return model;
}

class CellTopicsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    setup_ = new CellSetup(*SetUpCell(OSTEON_SOURCE_DIR "/config/cells/demo.yaml", std::nullopt));
  }
  static void TearDownTestSuite() {
    delete setup_;
    setup_ = nullptr;
  }
  static inline CellSetup* setup_{nullptr};
};

TEST_F(CellTopicsTest, TheFramesLeadFromTheWorldToTheFlangeOfTheArm) {
  const control::TickRecord tick = Tick(1);
  std::string bytes;
  io::EncodeFrames(tick.stamp, CellScene(*setup_).Frames(tick, Model()), bytes);
  foxglove::FrameTransforms message;
  ASSERT_TRUE(message.ParseFromString(bytes));
  std::map<std::string, const foxglove::FrameTransform*> of;
  for (const auto& frame : message.transforms()) {
    EXPECT_EQ(frame.timestamp().nanos(), 1'000'000);
    EXPECT_TRUE(of.emplace(frame.child_frame_id(), &frame).second) << frame.child_frame_id();
  }
  for (const char* name : {"bone", "tool", "tool_measured", "proxy"}) {
    ASSERT_TRUE(of.contains(name)) << name;
    EXPECT_EQ(of[name]->parent_frame_id(), "world");
  }
  Pose X_WF = Pose::Identity();
  for (std::string name = "flange"; name != "world"; name = of[name]->parent_frame_id()) {
    ASSERT_TRUE(of.contains(name)) << name;
    X_WF = PoseOf(*of[name]) * X_WF;
  }
  const config::LbrConfig* lbr = setup_->config.robot.lbr();
  ASSERT_NE(lbr, nullptr) << "the demo's arm is an LBR";
  const Pose expected =
      setup_->config.X_WB * kinematics::LbrArm(lbr->params)
                                .FlangePose(Eigen::Map<const kinematics::JointVector>(tick.q_meas.data()));
  EXPECT_TRUE(X_WF.isApprox(expected, 1e-12)) << X_WF.matrix() << "\n" << expected.matrix();
}

TEST_F(CellTopicsTest, AForceIsAnArrowOfOneMillimetrePerNewton) {
  const control::TickRecord tick = Tick(1);
  std::string bytes;
  io::EncodeScene(tick.stamp, CellScene(*setup_).Forces(tick, Model()), true, bytes);
  foxglove::SceneUpdate message;
  ASSERT_TRUE(message.ParseFromString(bytes));
  ASSERT_EQ(message.deletions_size(), 1);
  EXPECT_EQ(message.deletions(0).type(), foxglove::SceneEntityDeletion::ALL);
  ASSERT_EQ(message.entities_size(), 2) << "the hand presses nothing";
  const auto& arrow = message.entities(0).arrows(0);
  EXPECT_NEAR(arrow.shaft_length() + arrow.head_length(), 0.050, 1e-12);
  const auto& q = arrow.pose().orientation();
  const Vector3 along = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()) * Vector3::UnitX();
  EXPECT_TRUE(along.isApprox(Vector3::UnitZ(), 1e-12)) << along.transpose();
  ASSERT_EQ(message.entities(1).cubes_size(), 1);
}

TEST_F(CellTopicsTest, APartOfTheBoneHasTwoTrianglesPerQuad) {
  surface::SurfaceChunk chunk;
  for (const float x : {0.0F, 1.0F})
    for (const float y : {0.0F, 1.0F})
      chunk.vertices.push_back({.p_mm = {x, y, 2.0F}, .normal = {0, 0, 1}, .cut = x > 0.0F});
  chunk.quads = {0, 2, 3, 1};
  const io::SceneEntity part = CellScene(*setup_).BonePart("brick_7", {&chunk, 1});
  EXPECT_EQ(part.frame, "bone");
  EXPECT_EQ(part.mesh.triangles, (std::vector<std::uint32_t>{0, 2, 3, 0, 3, 1}));
  EXPECT_TRUE(part.mesh.points_m[2].isApprox(Vector3(0.001, 0.0, 0.002), 1e-6));
  EXPECT_NE(part.mesh.colors[0].g, part.mesh.colors[2].g) << "what was cut is redder";
}

TEST_F(CellTopicsTest, ARecordingHasMovingTopicsThirtyTimesASecondAndBodiesOnce) {
  const io::test::TemporaryFolder folder;
  const auto path = folder.path() / "topics.mcap";
  {
    auto file = io::McapWriter::Create(path, "test");
    ASSERT_TRUE(file) << file.error();
    RecordedTopics topics(*setup_);
    topics.Begin(*file, 0);
    simulation::FrameRecord frame;
    frame.model = Model();
    topics.TakeFrame(frame, *file);
    for (int i = 1; i <= 1000; ++i) topics.TakeTick(Tick(i), *file);
    topics.TakeEvent({.stamp = 1'000'000'000, .text = "fault: arm message stale; holds"}, *file);
    ASSERT_TRUE(file->Finish());
  }
  auto reader = io::McapReader::Open(path);
  ASSERT_TRUE(reader) << reader.error();
  std::map<std::string, int> count;
  io::McapMessage message;
  while (*reader->Next(message)) {
    ++count[message.channel->topic];
    const std::string bytes(message.bytes.begin(), message.bytes.end());
    foxglove::Log log;
    foxglove::SceneUpdate scene;
    if (message.channel->schema_name == "foxglove.SceneUpdate") {
      EXPECT_TRUE(scene.ParseFromString(bytes));
    }
    if (message.channel->topic == "scene") {
      EXPECT_GE(scene.entities_size(), 9) << "tool, proxy, seven links";
    }
    if (message.channel->topic == "log") {
      ASSERT_TRUE(log.ParseFromString(bytes));
      EXPECT_EQ(log.level(), foxglove::Log::ERROR);
    }
  }
  EXPECT_EQ(count, (std::map<std::string, int>{
                       {"tf", 31}, {"scene", 1}, {"forces", 31}, {"joints", 31}, {"log", 1}}));
}

// The tools of a procedure: the cell's reamer and a larger one.
std::vector<ProcedureTool> TwoTools(const CellSetup& setup) {
  std::vector<ProcedureTool> tools(2);
  for (ProcedureTool& tool : tools) {
    tool.tool = setup.config.tool.tool;
    tool.loop.X_FT = setup.config.tool.X_FT;
  }
  for (simulation::ToolBall& ball : tools[1].tool.balls) ball.radius_m *= 1.1;
  return tools;
}

// Diameter of the largest ball of the entity "tool" in a message of the topic "scene" [m].
double LargestBall(std::string_view bytes) {
  foxglove::SceneUpdate scene;
  EXPECT_TRUE(scene.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
  double largest_m = 0.0;
  for (const auto& entity : scene.entities())
    for (const auto& sphere : entity.spheres())
      if (entity.id() == "tool") largest_m = std::max(largest_m, sphere.size().x());
  return largest_m;
}

TEST_F(CellTopicsTest, ANewToolIsDrawnWhenTheToolIsChanged) {
  const std::vector<ProcedureTool> tools = TwoTools(*setup_);
  const io::test::TemporaryFolder folder;
  const auto path = folder.path() / "tools.mcap";
  console::LiveFeed feed;
  console::SurfaceStore surface;
  const LiveTopics live(*setup_, feed, surface, tools);
  console::FoxgloveCursor cursor;
  std::vector<console::FoxgloveMessage> sent;
  {
    auto file = io::McapWriter::Create(path, "test");
    ASSERT_TRUE(file) << file.error();
    RecordedTopics topics(*setup_, tools);
    topics.Begin(*file, 0);
    for (int i = 1; i <= 400; ++i) {
      control::TickRecord tick = Tick(i);
      tick.input.tool_index = i > 200 ? 1 : 0;
      topics.TakeTick(tick, *file);
      feed.TakeTick(tick);
      live.New(static_cast<std::size_t>(CellTopic::kScene), cursor, sent);
    }
    ASSERT_TRUE(file->Finish());
  }
  std::vector<double> recorded_m;
  auto reader = io::McapReader::Open(path);
  ASSERT_TRUE(reader) << reader.error();
  io::McapMessage message;
  while (*reader->Next(message))
    if (message.channel->topic == "scene")
      recorded_m.push_back(
          LargestBall({reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size()}));
  ASSERT_EQ(recorded_m.size(), 2u);
  EXPECT_NEAR(recorded_m[1], 1.1 * recorded_m[0], 1e-9);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_NEAR(LargestBall(sent[1].bytes), 1.1 * LargestBall(sent[0].bytes), 1e-9);
}

TEST_F(CellTopicsTest, ALiveViewerGetsTheBodiesOnceAndTheNewestFramesEachTime) {
  console::LiveFeed feed;
  console::SurfaceStore surface;
  const LiveTopics topics(*setup_, feed, surface);
  const auto number = [](CellTopic topic) { return static_cast<std::size_t>(topic); };
  console::FoxgloveCursor frames, scene;
  std::vector<console::FoxgloveMessage> out;
  topics.New(number(CellTopic::kScene), scene, out);
  EXPECT_TRUE(out.empty()) << "nothing was recorded yet";
  for (int round = 0; round < 3; ++round) {
    for (int i = 1; i <= 40; ++i) feed.TakeTick(Tick(40 * round + i));
    topics.New(number(CellTopic::kFrames), frames, out);
    topics.New(number(CellTopic::kScene), scene, out);
  }
  EXPECT_EQ(out.size(), 3u + 1u);
  out.clear();
  topics.New(number(CellTopic::kFrames), frames, out);
  EXPECT_TRUE(out.empty()) << "nothing is new";
}

}  // namespace
}  // namespace osteon::session
