#include <gtest/gtest.h>

#include "tests/app/command.h"
#include "tests/simulation/mesh/mesh_shapes.h"

// Runs `osteon plan` as a user does. Times depend on this machine, so no test compares them with a bound.

namespace osteon::app {
namespace {

TEST(Plan, WritesTheDocumentedKeysAndKeepsThePredictedError) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"plan", "thin_plate", "--error-mm", "0.08", "--rate-hz", "1", "--check",
                                 "--json", "plan.json", "--out", "page"});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const nlohmann::json json = ReadJson(folder.path() / "plan.json");
  EXPECT_EQ(json.at("schema"), "osteon.plan/1");
  const std::string page = io::test::ReadAll(folder.path() / "page/plan.html");
  const std::string level = json.at("verdict").at("level");
  for (const std::string& part :
       {"<div class=\"verdict " + level + "\">", std::string("<span>predicted error</span>"),
        std::string("this plan, measured"), std::string("osteon plan thin_plate")})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_GT(json.at("spheres").get<int>(), 100);
  EXPECT_GT(json.at("spheres_uniform").get<int>(), json.at("spheres").get<int>());
  EXPECT_GT(json.at("r_min_mm").get<double>(), 0.0);
  EXPECT_GT(json.at("r_max_mm").get<double>(), json.at("r_min_mm").get<double>());
  EXPECT_EQ(json.at("tool_spheres"), 45) << "a drill is many";
  EXPECT_EQ(json.at("arm_level"), "servo");
  EXPECT_GT(json.at("predicted_frame_us").get<double>(), 0.0);
  const double predicted = json.at("predicted_error_mm"), measured = json.at("check").at("error_mm");
  EXPECT_LE(predicted, 0.08);
  EXPECT_LE(measured, 0.08);
  EXPECT_GT(measured, 0.3 * predicted);
  EXPECT_TRUE(json.at("given_up").empty());
  EXPECT_EQ(json.at("calibration").size(), 2u);
  EXPECT_NE(run.out.find("given up           nothing"), std::string::npos) << run.out;
}

// Goal for a 25 mm reamer and an error of 0.1 mm: at most a twentieth of the spheres of a uniform packing
// with disjoint spheres, as in the cutting paper.
TEST(Plan, NeedsATwentiethOfTheSpheresOfAUniformPacking) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(), {"plan", "acetabulum", "--error-mm", "0.1", "--rate-hz", "1", "--json", "plan.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const nlohmann::json json = ReadJson(folder.path() / "plan.json");
  const double balls = json.at("spheres");
  EXPECT_GT(json.at("spheres_uniform_disjoint").get<double>(), 20.0 * balls);
  EXPECT_GT(json.at("spheres_uniform").get<double>(), 5.0 * balls);
  EXPECT_NE(run.out.find("and disjoint"), std::string::npos) << run.out;
}

// No machine computes 100 000 frames per second. The plan must keep the error and say that it misses the
// rate.
TEST(Plan, SaysThatItMissesTheRate) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"plan", "thin_plate", "--error-mm", "0.08",
                                                       "--rate-hz", "100000", "--json", "plan.json"});
  EXPECT_EQ(run.exit_code, 1) << run.err << run.out;
  const nlohmann::json json = ReadJson(folder.path() / "plan.json");
  ASSERT_EQ(json.at("given_up").size(), 1u) << json.at("given_up");
  const nlohmann::json& given = json.at("given_up").at(0);
  EXPECT_EQ(given.at("what"), "rate");
  EXPECT_EQ(given.at("unit"), "Hz");
  EXPECT_LT(given.at("predicted").get<double>(), 100e3);
  EXPECT_LE(json.at("predicted_error_mm").get<double>(), 0.08);
  EXPECT_NE(run.out.find("given up           rate: "), std::string::npos) << run.out;
}

// A mesh replaces the scene. It is a block of the same size as in the scene thin_plate.
TEST(Plan, PlansAMesh) {
  const TemporaryFolder folder;
  io::test::WriteAll(folder.path() / "plate.stl",
                     simulation::StlText(simulation::MakeBox({-0.02, -0.02, -0.002}, {0.02, 0.02, 0.0})));
  const CommandResult run =
      RunCommand(folder.path(), {"plan", "plate.stl", "--cup", "0,0,1.5,0,0,1,2", "--scene", "thin_plate",
                                 "--error-mm", "0.08", "--rate-hz", "1", "--json", "plan.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const nlohmann::json json = ReadJson(folder.path() / "plan.json");
  EXPECT_GT(json.at("spheres").get<int>(), 100);
  EXPECT_LE(json.at("predicted_error_mm").get<double>(), 0.08);
  EXPECT_NE(run.out.find("Osteon plan: plate, "), std::string::npos) << run.out;
}

TEST(Plan, RefusesInvalidArguments) {
  const TemporaryFolder folder;
  const std::vector<std::string> asked{"--error-mm", "0.1", "--rate-hz", "1000"};
  for (const auto& [arguments, said] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{}, "scene is required"},
           {{"elbow"}, "elbow: no file"},
           {{"ball:20"}, "accepted: a scene: a YAML file, or one of acetabulum, "},
           {{"bone.stl"}, "bone.stl: found a mesh without its site, accepted with --cup X,Y,Z,NX,NY,NZ,R"},
           {{"bone.stl", "--cup", "0,0,10,0,0,1,2"}, "bone.stl: no such file"},
           {{"bone.stl", "--cup", "0,0,10"}, "--cup"},
           {{"molar", "--cup", "0,0,10,0,0,1,2"}, "--cup: found with molar, accepted with a mesh"},
           {{"molar", "--scale", "2"}, "--scale: found with molar, accepted with a mesh"},
           {{"bone.stl", "--cup", "0,0,10,0,0,1,2", "--scene", "elbow"}, "--scene elbow: no file"},
           {{"molar", "--cell", "elbow"}, "--cell elbow: no file"},
           {{"molar", "--tool", "round_burr:77"}, "found 77"}}) {
    std::vector<std::string> all{"plan"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), asked.begin(), asked.end());
    const CommandResult run = RunCommand(folder.path(), all);
    EXPECT_EQ(run.exit_code, 2) << said;
    EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
  }
  for (const auto& [arguments, said] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"molar", "--rate-hz", "1000"}, "--error-mm is required"},
           {{"molar", "--error-mm", "0.1"}, "--rate-hz is required"},
           {{"molar", "--error-mm", "0", "--rate-hz", "1000"}, "--error-mm: found 0, accepted 0.001"},
           {{"molar", "--error-mm", "nan", "--rate-hz", "1000"}, "--error-mm"},
           {{"molar", "--error-mm", "0.1", "--rate-hz", "0"}, "--rate-hz: found 0, accepted 1"}}) {
    std::vector<std::string> all{"plan"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult run = RunCommand(folder.path(), all);
    EXPECT_EQ(run.exit_code, 2) << said;
    EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
  }
  EXPECT_NE(RunCommand(folder.path(), {"plan", "--help"}).out.find("Examples:"), std::string::npos);
}

}  // namespace
}  // namespace osteon::app
