#include <gtest/gtest.h>

#include <algorithm>

#include "io/fri/fri_link.h"
#include "tests/app/command.h"
#include "tests/simulation/mesh/mesh_shapes.h"

// Wrong input to `osteon`. The command must do nothing but print one line, which names the value found and
// the values accepted, and exit with code 2.

namespace osteon::app {
namespace {

// A valid value of --cup: X,Y,Z,NX,NY,NZ,R (centre, axis, radius), lengths in mm.
const std::string kGoodCup = "0,0,0,0,0,1,24";

class WrongInput : public testing::Test {
 protected:
  /// Runs the command and expects a refusal whose line contains each of the texts.
  void ExpectRefused(const std::vector<std::string>& arguments, const std::vector<std::string>& texts,
                     const std::vector<std::string>& environment = {}) {
    std::string line;
    for (const std::string& argument : arguments) line += argument + " ";
    SCOPED_TRACE(line);
    const CommandResult run = RunCommand(folder_.path(), arguments, environment);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    for (const std::string& text : texts) EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
    EXPECT_TRUE(run.err.starts_with("osteon")) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'),
              one_line_ ? 1 : std::ranges::count(run.err, '\n'))
        << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "demo_out")) << "a refused run leaves nothing";
  }

  /// Writes a file into the test's folder. @returns its path.
  std::filesystem::path Write(const std::string& name, const std::string& text) {
    io::test::WriteAll(folder_.path() / name, text);
    return folder_.path() / name;
  }

  /// Makes a copy of config/ with one text of one file replaced. @returns its path.
  std::string ConfigWith(const std::string& file, const std::string& text, const std::string& replacement) {
    const auto root = folder_.path() / "config";
    std::filesystem::remove_all(root);
    std::filesystem::copy(OSTEON_SOURCE_DIR "/config", root, std::filesystem::copy_options::recursive);
    std::string content = io::test::ReadAll(root / file);
    const std::size_t at = content.find(text);
    EXPECT_NE(at, std::string::npos) << file << " has no " << text;
    if (at != std::string::npos) content.replace(at, text.size(), replacement);
    io::test::WriteAll(root / file, content);
    return root.string();
  }

  TemporaryFolder folder_;
  bool one_line_{true};  ///< whether the error must have only one line
};

TEST_F(WrongInput, APlansTargetErrorOrFrameRateOutsideItsRangeIsRefused) {
  for (const char* value : {"0", "-1", "nan", "inf", "6", "abc"})
    ExpectRefused({"plan", "molar", "--rate-hz", "1000", "--error-mm", value},
                  {"--error-mm", value, "0.001 … 5"});
  for (const char* value : {"0", "nan", "1e9"})
    ExpectRefused({"plan", "molar", "--error-mm", "0.1", "--rate-hz", value},
                  {"--rate-hz", value, "1 … 100000"});
}

TEST_F(WrongInput, AnInvalidNumberIsRefused) {
  for (const char* value : {"0", "-1", "nan", "inf", "3601"})
    ExpectRefused({"demo", "--virtual-time", "--seconds", value}, {"--seconds", value, "0.1 … 3600"});
  ExpectRefused({"demo", "--seconds", "abc"}, {"--seconds", "abc", "0.1 … 3600"});
  ExpectRefused({"demo", "--seconds"}, {"--seconds: found no value, accepted "});
  ExpectRefused({"tune", "demo", "--nodes", "3.5"}, {"--nodes: found 3.5, accepted a whole number, 3 … 100"});
  ExpectRefused({"capability", "demo", "--x-mm", "5"}, {"--x-mm: found 1 values, accepted at least 2 ("});
  ExpectRefused({"status", "--pid", "x"}, {"--pid: found x, accepted 1 … 4194304"});
}

TEST_F(WrongInput, UnknownCommandsUnacceptedValuesAndContradictoryOptionsAreRefused) {
  ExpectRefused({"demo", "--secnods", "3"}, {"--secnods", "--seconds", "--help"});
  ExpectRefused({"dmeo"}, {"dmeo", "did you mean demo?"});
  ExpectRefused({"frobnicate"},
                {"frobnicate", "accepted: demo, pack, failures, doctor, faults, states, bench, chart"});
  ExpectRefused({"demo", "extra"}, {"extra"});
  ExpectRefused({"--nonsense"}, {"--nonsense"});
  ExpectRefused({"demo", "--port", "70000"}, {"--port", "70000", "0 … 65535"});
  ExpectRefused({"demo", "--port", "-1"}, {"--port", "-1", "0 … 65535"});
  ExpectRefused({"doctor", "--port", "x"}, {"--port", "x", "0 … 65535"});
  for (const char* command : {"run", "cell"}) {
    ExpectRefused({command, "demo", "--cpu", "1023"}, {"--cpu", "found 1023", "accepted"});
    ExpectRefused({command, "demo", "--cpu", "-1"}, {"--cpu", "-1", "0 … 1023"});
  }
  ExpectRefused({"demo", "--cpu", "1023"}, {"--cpu", "found 1023", "accepted"});
  ExpectRefused({"demo", "--cpu", "0", "--virtual-time"}, {"--cpu", "--virtual-time", "wall time"});
  ExpectRefused({"demo", "--engine", "cuda"}, {"--engine", "cuda", "auto, vulkan, cpu, reference"});
  ExpectRefused({"demo", "--frame-ms", "8"}, {"--frame-ms", "8", "--virtual-time"});
  ExpectRefused({"demo", "--real-time-factor", "2"}, {"--real-time-factor", "2", "--virtual-time"});
  ExpectRefused({"demo", "--virtual-time", "--real-time-factor", "0"}, {"--real-time-factor", "0.01 … 1000"});
  ExpectRefused({"demo", "--virtual-time", "--frame-ms", "0.5"}, {"--frame-ms", "0.5", "1 … 100"});
  ExpectRefused({"demo", "--engine", "reference"}, {"--engine reference", "--virtual-time"});
}

TEST_F(WrongInput, MissingPathsAndPathsOfAnotherKindAreRefused) {
  Write("file.mcap", "x");
  ExpectRefused({"report", "nosuch.mcap"},
                {"recording: found no file nosuch.mcap, accepted one that is there"});
  ExpectRefused({"report", "."}, {"recording: found the folder ., accepted a file"});
  ExpectRefused({"assess", "nosuch"}, {"nosuch/session.json: found no readable file, accepted the folder"});
  ExpectRefused({"assess", "s", "--against", "nosuch"},
                {"found no folder nosuch, accepted one that is there"});
  ExpectRefused({"assess", "s", "--against", "file.mcap"}, {"found the file file.mcap, accepted a folder"});
}

TEST_F(WrongInput, AdmittanceGainsForACellWithTheImpedanceLawAreRefused) {
  const auto gains = Write("gains.yaml", "admittance:\n  mass_kg: [2, 2, 2]\n");
  ExpectRefused({"run", "thin_plate_impedance", "--gains", gains.string()},
                {gains.string() + ":1: admittance", "impedance law", "accepted coupling alone"});
}

TEST_F(WrongInput, AnInvalidCupIsRefused) {
  const auto mesh = Write(
      "box.obj", simulation::ObjText(simulation::MakeBox(Vector3::Constant(-0.03), Vector3::Constant(0.03))));
  ExpectRefused({"demo", "--mesh", mesh.string()}, {"--mesh", "--cup"});
  ExpectRefused({"demo", "--cup", kGoodCup}, {"--cup", "--mesh"});
  const std::vector<std::pair<std::string, std::vector<std::string>>> cups{
      {"1,2,3", {"found 3 values", "7: X,Y,Z,NX,NY,NZ,R"}},
      {"1,2,3,0,0,1,24,8", {"found 8 values", "7: X,Y,Z,NX,NY,NZ,R"}},
      {"1,2,3,0,0,1,-24", {"R: found -24 mm", "0.5 … 60"}},
      {"1,2,3,0,up,1,24", {"NY: found \"up\"", "a number"}},
      {"1,2,3,0,0,0,24", {"NX,NY,NZ: found a zero vector"}},
      {"", {"found 0 values"}}};
  for (const auto& [cup, texts] : cups) {
    std::vector<std::string> wanted = texts;
    wanted.insert(wanted.end(), {"--cup", "accepted"});
    ExpectRefused({"demo", "--mesh", mesh.string(), "--cup", cup}, wanted);
  }
}

TEST_F(WrongInput, ACellsCupAwayFromItsMeshIsRefused) {
  Write("box.obj",
        simulation::ObjText(simulation::MakeBox(Vector3::Constant(-0.03), Vector3::Constant(0.03))));
  const auto cell = Write("my.yaml",
                          "extends: demo\nbone:\n  mesh: box.obj\n  cup: {center_mm: [300, 300, 300], "
                          "outward_axis: [0, 0, 1], radius_mm: 24}\n");
  ExpectRefused({"demo", "--virtual-time", "--cell", cell.string()},
                {cell.string() + ":4: ", "box.obj", "cup at (300, 300, 300) mm", "accepted"});
}

TEST_F(WrongInput, AFolderAsACellIsRefused) {
  ExpectRefused({"demo", "--cell", folder_.path().string()},
                {folder_.path().string(), "found a folder", "demo"});
}

TEST_F(WrongInput, AScaleForAPackingIsRefused) {
  const auto packing = Write("bone.osp", "");
  ExpectRefused({"demo", "--mesh", packing.string(), "--scale", "2"},
                {"--scale", "bone.osp", "accepted with a mesh"});
}

TEST_F(WrongInput, AnUnusableMeshIsRefused) {
  ExpectRefused({"demo", "--mesh", "missing.obj", "--cup", kGoodCup}, {"missing.obj"});
  ExpectRefused({"demo", "--mesh", "", "--cup", kGoodCup}, {"--mesh"});
  ExpectRefused({"demo", "--mesh", folder_.path().string(), "--cup", kGoodCup}, {folder_.path().string()});

  const auto garbage = Write("garbage.stl", std::string(3000, '\x9b'));
  ExpectRefused({"demo", "--mesh", garbage.string(), "--cup", kGoodCup}, {garbage.string()});
  const auto text = Write("notes.txt", "no mesh at all");
  ExpectRefused({"demo", "--mesh", text.string(), "--cup", kGoodCup}, {text.string()});

  simulation::TriangleMesh box = simulation::MakeBox(Vector3::Constant(-0.03), Vector3::Constant(0.03));
  const auto far = Write("far.obj", simulation::ObjText(box));
  ExpectRefused({"demo", "--mesh", far.string(), "--cup", "500,0,0,0,0,1,24"},
                {far.string(), "cup at (500, 0, 0) mm", "accepted", "spans"});
  box.triangles.resize(2);  // only the two triangles of one face remain: such a sheet bounds no solid
  const auto sheet = Write("sheet.obj", simulation::ObjText(box));
  ExpectRefused({"demo", "--mesh", sheet.string(), "--cup", kGoodCup},
                {sheet.string(), "open edges", "accepted 2", "no solid can be made of it"});
}

TEST_F(WrongInput, InvalidCellsAndConfigurationsAreRefused) {
  ExpectRefused({"demo", "--cell", "nosuch"}, {"nosuch", "accepted", "demo"});
  ExpectRefused({"demo", "--cell", "nosuch.yaml"}, {"nosuch.yaml"});
  ExpectRefused({"--config-root", "/nonexistent", "demo"}, {"/nonexistent"});

  std::string root = ConfigWith("tools/reamer.yaml", "radius_mm: 8", "raduis_mm: 8");
  ExpectRefused({"--config-root", root, "demo"},
                {root + "/tools/reamer.yaml:22: ", "unknown key \"raduis_mm\"", "\"radius_mm\""});
  root = ConfigWith("tools/reamer.yaml", "radius_mm: 8", "radius_mm: -8");
  ExpectRefused({"--config-root", root, "demo"},
                {root + "/tools/reamer.yaml:22: radius_mm: found -8, accepted 0.5 … 50"});
  root = ConfigWith("cells/demo.yaml", "tool_diameter_mm: 50", "tool_diameter_mm: 80");
  ExpectRefused({"--config-root", root, "demo"},
                {root + "/cells/demo.yaml:6: tool_diameter_mm: found 80, accepted 36 … 68 in steps of 1"});
  root = ConfigWith("cells/demo.yaml", "max_force_N: 200", "max_force_N: 2000");
  ExpectRefused({"--config-root", root, "demo"}, {root + "/cells/demo.yaml:", "max_force_N: found 2000"});
  root = ConfigWith("cells/demo.yaml", "fri:", "fri: [");
  ExpectRefused({"--config-root", root, "demo"}, {root + "/cells/demo.yaml:"});
  root = ConfigWith("cells/demo.yaml", "tool: reamer", "tool: rimmer");
  ExpectRefused({"--config-root", root, "demo"},
                {root + "/cells/demo.yaml:", "tool: found rimmer, accepted a file"});
}

TEST_F(WrongInput, AnUnknownToolOrDiameterIsRefused) {
  ExpectRefused({"demo", "--tool", "nosuch"}, {"--tool nosuch", "accepted", "reamer", "twist_drill"});
  ExpectRefused({"demo", "--tool", "nosuch.yaml"},
                {"no file nosuch.yaml", "accepted", "reamer", "twist_drill"});
  ExpectRefused({"demo", "--tool", "reamer.yaml:80"},
                {"--tool reamer.yaml:80: found 80", "36 … 68 in steps of 1"});
  ExpectRefused({"demo", "--tool", "reamer:big"}, {"found \"big\"", "a diameter in mm"});
  ExpectRefused({"demo", "--tool", "reamer:80"}, {"--tool reamer:80: found 80", "36 … 68 in steps of 1"});
  for (const std::string name : {"reamer54", "reamer_54", "reamer-54"})
    ExpectRefused({"demo", "--tool", name}, {"--tool " + name, "did you mean \"reamer:54\"?", "accepted"});
  ExpectRefused({"demo", "--tool", "raemer:54"}, {"did you mean \"reamer:54\"?"});
}

TEST_F(WrongInput, AnUnknownDeviceIsRefused) {
  one_line_ = false;  // further lines list the available devices
  ExpectRefused({"demo", "--device", "nosuch"}, {"\"nosuch\"", "found:\n  "});
}

TEST_F(WrongInput, AMissingVulkanDriverIsReported) {
  ExpectRefused({"demo", "--engine", "vulkan"}, {"no Vulkan driver", "install", "mesa-vulkan-drivers"},
                {"VK_DRIVER_FILES=/nonexistent", "VK_ICD_FILENAMES=/nonexistent"});
}

TEST_F(WrongInput, ATakenPortIsReported) {
  const auto other = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(other) << other.error();
  const std::string port = std::to_string((*other)->port());
  ExpectRefused({"demo", "--port", port}, {"127.0.0.1:" + port, "taken", "another port"});
}

TEST_F(WrongInput, ATakenPortLeavesTheFilesOfAnEarlierRun) {
  const auto out = folder_.path() / "kept";
  std::filesystem::create_directory(out);
  io::test::WriteAll(out / "recording.mcap", "an earlier run's");
  io::test::WriteAll(out / "summary.json", "an earlier run's");
  const auto other = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(other) << other.error();
  ExpectRefused({"demo", "--out", "kept", "--port", std::to_string((*other)->port())}, {"FRI"});
  EXPECT_EQ(io::test::ReadAll(out / "recording.mcap"), "an earlier run's");
  EXPECT_EQ(io::test::ReadAll(out / "summary.json"), "an earlier run's");
}

TEST_F(WrongInput, AnUnusableOutputFolderIsRefused) {
  const auto file = Write("taken", "a file");
  ExpectRefused({"demo", "--virtual-time", "--out", file.string()}, {"--out", file.string(), "folder"});
  EXPECT_EQ(io::test::ReadAll(file), "a file");
  ExpectRefused({"demo", "--virtual-time", "--out", (file / "below").string()},
                {file.string(), "Not a directory"});
  ExpectRefused({"demo", "--virtual-time", "--out", ""}, {"--out"});
  std::filesystem::create_directories(folder_.path() / "odd/recording.mcap");
  ExpectRefused({"demo", "--virtual-time", "--out", "odd"}, {"odd/recording.mcap"});
}

TEST_F(WrongInput, AJsonFileInAMissingFolderIsRefused) {
  ExpectRefused({"demo", "--virtual-time", "--seconds", "3600", "--json", "nowhere/summary.json"},
                {"--json", "nowhere/summary.json", "no folder"});
}

// Nobody can create a file in /proc, not even root.
TEST_F(WrongInput, AnUnwritableOutputFolderIsRefused) {
  ExpectRefused({"demo", "--virtual-time", "--out", "/proc"}, {"/proc"});
  ExpectRefused({"demo", "--virtual-time", "--out", "/proc/osteon_out"}, {"/proc/osteon_out"});
}

}  // namespace
}  // namespace osteon::app
