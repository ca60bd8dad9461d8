#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <numbers>
#include <thread>

#include "simulation/packing/packing_file.h"
#include "tests/app/command.h"
#include "tests/simulation/mesh/mesh_shapes.h"

// Runs `osteon pack` as a user does, and checks the files it writes, its messages and its refusals.

namespace osteon::app {
namespace {

using simulation::Ball;
using simulation::PackingFile;

class PackCommand : public testing::Test {
 protected:
  std::filesystem::path Path(const std::string& name) const { return folder_.path() / name; }

  /// Checks that no partly written file is left.
  void ExpectNoPart() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }

  /// Runs `osteon pack …`, which must succeed.
  CommandResult Pack(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "pack");
    CommandResult run = RunCommand(folder_.path(), std::move(arguments));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run;
  }

  /// Expects exit code 2, no written files, and each of the texts in the last line on stderr.
  void ExpectRefused(std::vector<std::string> arguments, const std::vector<std::string>& texts) {
    std::string line;
    for (const std::string& argument : arguments) line += argument + " ";
    SCOPED_TRACE(line);
    arguments.insert(arguments.begin(), "pack");
    const CommandResult run = RunCommand(folder_.path(), arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    std::istringstream lines(run.err);
    std::string each, last;
    while (std::getline(lines, each)) last = each;  // earlier lines are progress
    EXPECT_TRUE(last.starts_with("osteon pack: ")) << run.err;
    for (const std::string& text : texts) EXPECT_NE(last.find(text), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(Path("out.osp"))) << "a refused run leaves nothing";
    ExpectNoPart();
  }

  /// Writes a mesh of a cube with this edge length. @returns the file's name.
  std::string WriteBox(const std::string& name, double size_m) {
    io::test::WriteAll(Path(name), simulation::ObjText(simulation::MakeBox(Vector3::Constant(-0.5 * size_m),
                                                                           Vector3::Constant(0.5 * size_m))));
    return name;
  }

  TemporaryFolder folder_;
};

TEST_F(PackCommand, ABallIsPackedWithItsVolumeMassAndInertia) {
  const CommandResult run = Pack({"ball:10", "-o", "out.osp", "-o", "out.ply", "-o", "out.csv", "--count",
                                  "1500", "--point-spacing-mm", "0.5", "--json", "out.json"});
  EXPECT_NE(run.out.find("Coverage"), std::string::npos);
  const nlohmann::json json = ReadJson(Path("out.json"));
  EXPECT_EQ(json["schema"], "osteon.pack/1");
  for (const char* key : {"spheres", "r_min_mm", "r_max_mm", "coverage", "surface_gap_mean_mm",
                          "surface_gap_p95_mm", "protrusion_max_mm", "overlap_max_mm", "seconds"})
    EXPECT_TRUE(json[key].is_number()) << key;
  EXPECT_LE(json["protrusion_max_mm"].get<double>(), 0.05);
  EXPECT_GT(json["coverage"].get<double>(), 0.95);

  const auto file = PackingFile::Open(Path("out.osp"));
  ASSERT_TRUE(file) << file.error().Text();
  const simulation::Bone bone = file->ToBone();
  EXPECT_EQ(bone.balls.size(), json["spheres"]);
  EXPECT_EQ(bone.points.size(), json["points"]);
  double volume_m3 = 0.0, farthest_m = 0.0;
  for (const simulation::MassPoint& point : bone.points) volume_m3 += point.volume_m3;
  for (const Ball& ball : bone.balls)
    farthest_m = std::max(farthest_m, Vector3(ball.center_m).norm() + ball.radius_m);
  // 0.5 % of the ball's 4189 mm³ are allowed, because points sample the solid. Spheres may exceed the ball's
  // surface by the protrusion tolerance.
  EXPECT_NEAR(volume_m3 * 1e9, 4.0 / 3.0 * std::numbers::pi * 1000.0, 0.005 * 4189.0);
  EXPECT_LE(farthest_m, 10.05e-3);
  // closed form of a solid ball with density ρ, volume V and radius r: mass m = ρ V, inertia I = 2/5 m r²
  const auto& solid = json["against_solid"]["solid"];
  EXPECT_NEAR(solid["mass_g"].get<double>(), 4.18879, 1e-4);
  EXPECT_NEAR(solid["inertia_g_mm2"][1][1].get<double>(), 0.4 * 4.18879 * 100.0, 1e-2);
  EXPECT_LT(std::abs(json["against_solid"]["volume_error"].get<double>()), 0.005);

  // the exported tables have a line for each sphere
  const std::string csv = io::test::ReadAll(Path("out.csv"));
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')), bone.balls.size() + 1);
  EXPECT_NE(
      io::test::ReadAll(Path("out.ply")).find("element vertex " + std::to_string(bone.balls.size()) + "\n"),
      std::string::npos);
}

TEST_F(PackCommand, TheSameArgumentsGiveTheSameBytesForAnyNumberOfThreads) {
  for (const char* mode : {"overlap", "disjoint"}) {
    const auto bytes = [&](const char* threads, const char* seed) {
      Pack({"box:20,12,9", "-o", "out.osp", "--mode", mode, "--count", "400", "--point-spacing-mm", "0.7",
            "--threads", threads, "--seed", seed});
      return io::test::ReadAll(Path("out.osp"));
    };
    const std::string one = bytes("1", "3");
    EXPECT_TRUE(bytes("2", "3") == one) << mode;
    EXPECT_TRUE(bytes("8", "3") == one) << mode;
    EXPECT_FALSE(bytes("2", "4") == one) << mode << ": the seed is part of it";
  }
}

TEST_F(PackCommand, DisjointSpheresDoNotOverlap) {
  Pack({"box:20,12,9", "-o", "out.osp", "--mode", "disjoint", "--count", "500", "--no-points"});
  const auto file = PackingFile::Open(Path("out.osp"));
  ASSERT_TRUE(file) << file.error().Text();
  EXPECT_TRUE(file->points().empty());
  const std::vector<Ball> balls = file->ToBone().balls;
  ASSERT_EQ(balls.size(), 500u);
  for (std::size_t i = 0; i < balls.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      // spheres may overlap by 1e-3 mm, the rounding of the saved file
      ASSERT_LE(balls[i].radius_m + balls[j].radius_m -
                    (Vector3(balls[i].center_m) - Vector3(balls[j].center_m)).norm(),
                1e-6);
}

TEST_F(PackCommand, AMeshIsPackedInItsOwnFrameAndScale) {
  Pack({WriteBox("box.obj", 0.002), "-o", "out.osp", "--scale", "10", "--count", "300", "--point-spacing-mm",
        "1", "--json", "out.json"});
  const nlohmann::json json = ReadJson(Path("out.json"));
  EXPECT_EQ(json["triangles"], 12);
  EXPECT_NEAR(json["against_solid"]["solid"]["volume_mm3"].get<double>(), 8000.0, 1e-6);
  EXPECT_EQ(json["parameters"]["scale_mm"], "10");
  const auto file = PackingFile::Open(Path("out.osp"));
  ASSERT_TRUE(file) << file.error().Text();
  EXPECT_EQ(file->provenance().source, "box.obj");
  EXPECT_TRUE(file->provenance().source_crc);
  EXPECT_FALSE(file->site());
  EXPECT_EQ(file->name(), "box");
}

TEST_F(PackCommand, AGradeMakesTheInnerSpheresLarger) {
  const auto max_radius_mm = [this](const char* grade) {
    Pack({"box:40,40,40", "-o", "out.osp", "--no-points", "--r-max-mm", "2", "--count", "3000", "--grade",
          grade});
    const auto file = PackingFile::Open(Path("out.osp"));
    float radius_mm = 0.0f;
    for (const auto& ball : file->balls()) radius_mm = std::max(radius_mm, ball.radius_mm);
    return radius_mm;
  };
  EXPECT_LE(max_radius_mm("0"), 2.0f);
  // the radius grows from 2 mm by 0.2 mm per mm of depth, up to 6 mm in the middle at 20 mm depth
  const float graded = max_radius_mm("0.2");
  EXPECT_GT(graded, 3.0f);
  EXPECT_LE(graded, 6.0f);
}

TEST_F(PackCommand, AConvertedPackingKeepsItsFigures) {
  Pack({"ball:10", "-o", "out.osp", "--count", "300", "--point-spacing-mm", "0.7", "--json", "out.json"});
  const std::string before = io::test::ReadAll(Path("out.osp"));
  Pack({"out.osp", "-o", "again.osp", "-o", "again.ply", "--json", "again.json"});
  EXPECT_TRUE(io::test::ReadAll(Path("again.osp")) == before);
  const nlohmann::json made = ReadJson(Path("out.json")), read = ReadJson(Path("again.json"));
  EXPECT_EQ(read["converted"], true);
  for (const char* key : {"spheres", "points", "mode"}) EXPECT_EQ(made[key], read[key]) << key;
  // lengths are converted to metres and back, so allow for rounding
  for (const char* key : {"coverage", "surface_gap_mean_mm", "protrusion_max_mm"})
    EXPECT_NEAR(made[key].get<double>(), read[key].get<double>(), 1e-12) << key;
}

TEST_F(PackCommand, TheReportIsOneFileWithoutExternalParts) {
  Pack({"box:12,10,8", "-o", "out.osp", "--count", "200", "--point-spacing-mm", "0.5", "--report", "report"});
  const std::string html = io::test::ReadAll(Path("report/report.html"));
  for (const char* text :
       {"<h2>Spheres</h2>", "<h2>Section</h2>", "<h2>Radii and gaps</h2>", "<h2>Mass points</h2>",
        "<h2>Mass</h2>", "<h2>Materials</h2>", "assumed", "data:image/png;base64,", "./osteon pack"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  for (const char* text : {"<script ", "http-equiv", "src=\"http", "nan"})
    EXPECT_EQ(html.find(text), std::string::npos) << text;
}

TEST_F(PackCommand, AWrongOptionIsNamedWithTheAcceptedValues) {
  ExpectRefused({"ball:10"}, {"-o", "--help"});
  ExpectRefused({"-o", "out.osp"}, {"input"});
  ExpectRefused({"ball:10", "-o", "out.step"}, {"-o out.step", "\".step\"", ".osp", ".ply", ".csv"});
  ExpectRefused({"ball:10", "-o", "none/out.osp"}, {"-o none/out.osp", "no folder none"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--json", "none/out.json"},
                {"--json none/out.json", "no folder none"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--mode", "random"}, {"--mode", "random", "overlap, disjoint"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--count", "0"}, {"--count", "found 0", "accepted 1"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--count", "-5"}, {"--count", "-5"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--r-min-mm", "nan"}, {"--r-min-mm", "nan"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--conut", "5"}, {"--conut", "did you mean --count?"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--scale", "2"},
                {"--scale: found with ball:10, accepted with a mesh"});
  ExpectRefused({"ball:ten", "-o", "out.osp"}, {"ball:ten: found \"ten\", accepted a number"});
  ExpectRefused({"ball:-1", "-o", "out.osp"}, {"ball: radius: found -1 mm"});
  ExpectRefused({"box:1,2", "-o", "out.osp"}, {"found 2 values", "accepted 3"});
  ExpectRefused({"skull", "-o", "out.osp"}, {"skull", "accepted", "acetabulum", "ball:R", ".stl"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--cup", "1,2"}, {"--cup: found 2 values"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--region", "1,2,3,-4"},
                {"--region: R: found -4 mm, accepted above 0"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--path", "none.csv", "3"}, {"--path none.csv: no such file"});
  ExpectRefused({"ball:10", "-o", "out.osp", "--r-min-mm", "5", "--r-max-mm", "1", "--count", "10"},
                {"found"});
  io::test::WriteAll(Path("path.csv"), "x_mm,y_mm,z_mm\n0,0,10\n0,zero,5\n");
  ExpectRefused({"ball:10", "-o", "out.osp", "--path", "path.csv", "3"}, {"path.csv:3", "found \"zero\""});
}

TEST_F(PackCommand, AMeshWithAHoleIsPackedWithAWarning) {
  // a cube of only 4 mm keeps the test fast: the surface is rebuilt on a grid of 0.1 mm
  simulation::TriangleMesh open = simulation::MakeBox(Vector3::Constant(-0.002), Vector3::Constant(0.002));
  open.triangles.pop_back();
  io::test::WriteAll(Path("open.obj"), simulation::ObjText(open));
  const CommandResult run = Pack(
      {"open.obj", "-o", "out.osp", "--count", "200", "--point-spacing-mm", "0.4", "--json", "out.json"});
  EXPECT_NE(run.err.find("osteon pack: warning: open.obj: found 3 open edges"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("taken as solid where the winding number is above 0.5"), std::string::npos)
      << run.err;
}

TEST_F(PackCommand, AWrongFileIsNamedWithTheAcceptedKind) {
  ExpectRefused({"none.obj", "-o", "out.osp"}, {"none.obj: no such file"});
  ExpectRefused({"none.osp", "-o", "out.ply"}, {"none.osp: found no such file"});
  io::test::WriteAll(Path("bad.osp"), "solid cube");
  ExpectRefused({"bad.osp", "-o", "out.ply"}, {"bad.osp: byte 0: found 73 6f 6c", "an STL mesh as text"});
  simulation::TriangleMesh open = simulation::MakeBox(Vector3::Constant(-0.01), Vector3::Constant(0.01));
  open.triangles.resize(2);  // only the two triangles of one face remain: such a sheet bounds no solid
  io::test::WriteAll(Path("sheet.obj"), simulation::ObjText(open));
  ExpectRefused({"sheet.obj", "-o", "out.osp"}, {"sheet.obj", "open edges", "no solid can be made of it"});
  Pack({"ball:10", "-o", "good.osp", "--count", "50", "--no-points"});
  ExpectRefused({"good.osp", "-o", "out.ply", "--count", "5"}, {"--count: found with a packing file"});
  ExpectRefused({"good.osp", "-o", "good.osp"}, {"-o good.osp: found the input, accepted another file"});
}

TEST_F(PackCommand, AFullDiskIsReportedAsAFailure) {
  std::filesystem::create_symlink("/dev/full", Path("full.osp"));
  const CommandResult run =
      RunCommand(folder_.path(), {"pack", "ball:10", "-o", "full.osp", "--count", "50", "--no-points"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("full.osp: byte 0: cannot be written: found No space left on device"),
            std::string::npos)
      << run.err;
}

TEST_F(PackCommand, CtrlCLeavesNoPartlyWrittenFile) {
  Command command(folder_.path(), {"pack", "box:100,100,100", "-o", "out.osp", "--mode", "disjoint",
                                   "--count", "500000", "--r-min-mm", "0.05"});
  ASSERT_TRUE(command.WaitUntil([&] { return command.Err().find("2 of 5: pack") != std::string::npos; }));
  command.Send(SIGINT);
  EXPECT_EQ(command.Wait().exit_code, 130);
  EXPECT_FALSE(std::filesystem::exists(Path("out.osp")));
  ExpectNoPart();
}

}  // namespace
}  // namespace osteon::app
