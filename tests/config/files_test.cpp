#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <set>
#include <sstream>

#include <unistd.h>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "config/reading/load.h"
#include "config/reading/load_robot.h"
#include "config/reading/load_rubric.h"
#include "config/reading/load_scenario.h"
#include "config/reading/load_surgical_plan.h"
#include "config/reading/load_sweep.h"
#include "config/reading/strict/overlay.h"
#include "config/reading/strict/units.h"

// Tests that must hold for every file in config/. Each test has a copy of the folder, which it may change.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;

std::string ReadText(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Loads a file of config/ with the reader for its folder.
void LoadAny(const fs::path& path) {
  const std::string folder = path.parent_path().filename().string();
  if (folder == "robots") return static_cast<void>(LoadRobot(path));
  if (folder == "tools") return static_cast<void>(LoadTool(path));
  if (folder == "materials") return static_cast<void>(LoadMaterials(path));
  if (folder == "scenes") return static_cast<void>(LoadScene(path));
  if (folder == "plans") return static_cast<void>(LoadSurgicalPlan(path));
  if (folder == "rubrics") return static_cast<void>(LoadRubric(path));
  if (folder == "cells") return static_cast<void>(LoadCell(path));
  if (folder == "sweeps") return static_cast<void>(LoadSweep(path));
  if (folder == "scenarios") {
    const ScenarioConfig scenario = LoadScenario(path);
    Overlay overlay(scenario.cell);
    overlay.SetFromFile(path, kOverridesKey);
    static_cast<void>(LoadCell(scenario.cell));
    return overlay.Finish();
  }
  FAIL() << path << ": no loader for this folder";
}

// The first part of a key in an overlay, which is a path such as "limits.max_force_N". An error names only
// one part.
std::string FirstPart(const std::string& key) { return key.substr(0, key.find('.')); }
std::string LastPart(const std::string& key) { return key.substr(key.rfind('.') + 1); }

// A number or a key in a YAML text, with its position.
struct Scalar {
  std::string key;  // key of the nearest mapping that contains the scalar
  std::size_t begin;
  int line;
  std::string text;
  std::string place{};  // path of keys and indices from the top of the file, with the kind of each mapping
};

// Collects all unquoted numbers of the text, with their positions.
void CollectNumbers(const YAML::Node& node, const std::string& key, std::string place,
                    std::vector<Scalar>& numbers) {
  if (node.IsMap()) {
    for (const char* kind : {"kind", "law", "level"})
      if (const YAML::Node word = node[kind]; word && word.IsScalar()) place += "(" + word.Scalar() + ")";
    for (const auto& pair : node)
      CollectNumbers(pair.second, pair.first.Scalar(), place + "/" + pair.first.Scalar(), numbers);
  }
  if (node.IsSequence())
    for (std::size_t i = 0; i < node.size(); ++i)
      CollectNumbers(node[i], key, place + "/" + std::to_string(i), numbers);
  if (!node.IsScalar() || node.Tag() == "!") return;
  std::size_t used = 0;
  try {
    static_cast<void>(std::stod(node.Scalar(), &used));
  } catch (const std::exception&) {
    return;
  }
  if (used != node.Scalar().size()) return;
  numbers.push_back(
      {key, static_cast<std::size_t>(node.Mark().pos), node.Mark().line + 1, node.Scalar(), place});
}

// A copy of config/ in a folder of its own. A test may change one file at a time.
class ConfigFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    root_ =
        fs::path(::testing::TempDir()) / ("osteon_config_" + std::to_string(::getpid()) + "_" + info->name());
    fs::remove_all(root_);
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(OSTEON_SOURCE_DIR) / "config")) {
      const bool yaml = entry.path().extension() == ".yaml";
      if (!yaml && entry.path().extension() != ".obj" && entry.path().extension() != ".png") continue;
      const fs::path copy = root_ / fs::relative(entry.path(), OSTEON_SOURCE_DIR);
      fs::create_directories(copy.parent_path());
      fs::copy_file(entry.path(), copy);
      if (yaml) files_.push_back(copy);
    }
    std::sort(files_.begin(), files_.end());
  }
  void TearDown() override { fs::remove_all(root_); }

  static void Write(const fs::path& path, const std::string& text) {
    fs::remove(path);  // truncating and rewriting a file costs milliseconds on ext4
    std::ofstream(path, std::ios::binary) << text;
  }

  fs::path root_;
  std::vector<fs::path> files_;
};

TEST_F(ConfigFilesTest, EveryFileLoads) {
  ASSERT_GE(files_.size(), 5u);
  for (const fs::path& file : files_) {
    try {
      LoadAny(file);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

// Replaces each number by ±1e12. The file must be refused, and the error must name file, line and key. All
// files of a folder have the same reader, so each place is tried only in the first file that contains it.
TEST_F(ConfigFilesTest, EveryNumberHasAUnitIsReadAndIsBounded) {
  std::size_t total = 0;
  std::set<std::string> tried;
  for (const fs::path& file : files_) {
    const std::string text = ReadText(file);
    std::vector<Scalar> numbers;
    CollectNumbers(YAML::Load(text), "", "", numbers);
    total += numbers.size();
    EXPECT_TRUE(!numbers.empty() || text.find("\nextends:") != std::string::npos)
        << file;  // a file that extends another file may contain no number
    for (const Scalar& number : numbers) {
      ASSERT_EQ(text.substr(number.begin, number.text.size()), number.text)
          << file << " line " << number.line;
      EXPECT_TRUE(UnitOf(number.key)) << file << ":" << number.line << ": " << number.key << " names no unit";
      if (!tried.insert(file.parent_path().filename().string() + number.place).second) continue;
      for (const char* absurd : {"1e12", "-1e12"}) {
        std::string changed = text;
        changed.replace(number.begin, number.text.size(), absurd);
        Write(file, changed);
        const std::string where =
            file.string() + ":" + std::to_string(number.line) + ": " + LastPart(number.key) + ": ";
        try {
          LoadAny(file);
          ADD_FAILURE() << where << absurd << " is accepted: not read, or without a bound";
        } catch (const ConfigError& error) {
          const std::string what = error.what();
          EXPECT_TRUE(what.starts_with(where + "found " + absurd + ", accepted ")) << what;
        }
      }
    }
    Write(file, text);
  }
  EXPECT_GT(total, 100u);
  EXPECT_GT(tried.size(), 1000u);
}

// Misspells each key. The file must be refused with a suggestion. So no key is ignored, and none has a silent
// default.
TEST_F(ConfigFilesTest, EveryMisspelledKeyIsRefused) {
  for (const fs::path& file : files_) {
    const std::string text = ReadText(file);
    std::vector<Scalar> keys;
    const std::function<void(const YAML::Node&)> collect = [&](const YAML::Node& node) {
      if (node.IsSequence())
        for (const YAML::Node& item : node) collect(item);
      if (!node.IsMap()) return;
      for (const auto& pair : node) {
        keys.push_back({pair.first.Scalar(), static_cast<std::size_t>(pair.first.Mark().pos),
                        pair.first.Mark().line + 1, pair.first.Scalar()});
        collect(pair.second);
      }
    };
    collect(YAML::Load(text));
    for (const Scalar& key : keys) {
      std::string changed = text;
      changed.insert(key.begin, "x");
      Write(file, changed);
      const std::string expected = file.string() + ":" + std::to_string(key.line) + ": unknown key \"x" +
                                   FirstPart(key.text) + "\"; did you mean \"" + FirstPart(key.text) + "\"?";
      try {
        LoadAny(file);
        ADD_FAILURE() << expected << " was not said";
      } catch (const ConfigError& error) {
        // two errors may be found before the unknown key: a list of a wrong length (the length depends on a
        // kind), and a consequence of a misspelled `remove` or `extends`
        if (std::string(error.what()).find("_deg: found a list of") == std::string::npos &&
            key.text != "remove" && key.text != "extends") {
          EXPECT_EQ(error.what(), expected);
        }
      }
    }
    Write(file, text);
  }
}

TEST_F(ConfigFilesTest, ANegativeRadiusIsRefusedWithFileLineAndRange) {
  const fs::path file = root_ / "config/tools/reamer.yaml";
  std::string text = ReadText(file);
  text.replace(text.find("radius_mm: 8"), 12, "radius_mm: -8");
  Write(file, text);
  const fs::path before = fs::current_path();
  fs::current_path(root_);
  std::string what;
  try {
    static_cast<void>(LoadCell("config/cells/demo.yaml"));
  } catch (const ConfigError& error) {
    what = error.what();
  }
  fs::current_path(before);
  EXPECT_EQ(what, "config/tools/reamer.yaml:22: radius_mm: found -8, accepted 0.5 … 50");
}

TEST_F(ConfigFilesTest, ValuesThatContradictEachOtherAreRefused) {
  struct Case {
    const char *file, *from, *to, *expected;
  };
  for (const Case& c : {
           Case{"tools/reamer.yaml", "radius_mm: 8", "radius_mm: 18",
                "radius_mm: found 18, accepted less than the smallest head's 18"},
           Case{"tools/reamer.yaml", "to_mm: 68", "to_mm: 67.5",
                "to_mm: found 67.5, accepted 36 and whole steps of 1 from there"},
           Case{"tools/reamer.yaml", "default_diameter_mm: 50", "default_diameter_mm: 69",
                "default_diameter_mm: found 69, accepted 36 … 68 in steps of 1"},
           Case{"tools/round_burr.yaml", "neck_mm: 1.26", "neck_mm: 2.3",
                "diameter_mm: round burr 2.3 mm: neck diameter"},
           Case{"tools/taper_burr.yaml", "max_count: 64", "max_count: 40",
                "diameter_mm: taper burr 2.1 mm: greatest count: found 40, accepted more"},
           Case{"tools/twist_drill.yaml", "flute_mm: 36", "flute_mm: 66",
                "diameter_mm: twist drill 3.2 mm: length: found 65 mm, accepted 66"},
           Case{"tools/broach.yaml", "to_z_mm: 0", "to_z_mm: -100",
                "to_z_mm: found -100, accepted more than from_z_mm (-100)"},
           Case{"tools/broach.yaml", "from_z_mm: -100\n  to_z_mm: 0", "from_z_mm: -900\n  to_z_mm: -800",
                "mesh: broach: nothing of the mesh lies in z -900 … -800 mm"},
           Case{"tools/broach.yaml", "scale_ratio: 1 ", "scale_ratio: 0.001 ",
                "mesh: broach: greatest count"},
           Case{"tools/broach.yaml", "position_mm: [0, 0, 0]\n  rpy_deg: [0, 0, 0]\ncutting",
                "position_mm: [0, 0, 3]\n  rpy_deg: [0, 0, 0]\ncutting",
                "mesh: broach: highest point of the mesh in T (the apex): found 3 mm, accepted -0.1 … 0.1"},
           Case{"cells/demo.yaml", "tool_diameter_mm: 50", "tool_diameter_mm: 50.5",
                "tool_diameter_mm: found 50.5, accepted 36 … 68 in steps of 1"},
           Case{"robots/lbr_iiwa_14_r820.yaml", "name: A2", "name: A3", "name: found A3, accepted A2"},
           Case{"cells/demo.yaml", "[0.00024, 0.00024, 0.0004,", "[0.00024, 0.00024, 0.0005,",
                "inertia_kg_m2: force_sensor: principal moments of inertia"},
           Case{"scenes/acetabulum.yaml", "cup_radius_mm: 24", "cup_radius_mm: 39",
                "cup_radius_mm: found 39, accepted at most 38"},
           Case{"scenes/acetabulum.yaml", "[6.5, 12]", "[12, 6.5]",
                "coarser_from_mm: found 6.5 after 12, accepted the smaller depth first"},
           Case{"cells/demo.yaml", "sensor_full_ms: 20", "sensor_full_ms: 100",
                "sensor_stop_ms: found 100, accepted more than sensor_full_ms (100)"},
           Case{"cells/demo.yaml", "gone_ms: 60", "gone_ms: 20",
                "gone_ms: found 20, accepted more than fresh_ms (20)"},
           Case{"cells/demo.yaml", "model_stop_ms: 250", "model_stop_ms: 60",
                "model_stop_ms: found 60, accepted more than the coupling's gone_ms (60)"},
           Case{"cells/demo.yaml", "push_force_N: 120", "push_force_N: 200",
                "max_force_N: found 150, accepted more than the script's push_force_N (200)"},
           Case{"cells/demo.yaml", "good_answered_count: 50", "good_answered_count: 5",
                "good_answered_count: found 5, accepted at least fair_answered_count (10)"},
           Case{"cells/demo.yaml", "excellent_answered_count: 90", "excellent_answered_count: 40",
                "excellent_answered_count: found 40, accepted at least good_answered_count (50)"},
           Case{"cells/demo.yaml", "period_ms: 1", "period_ms: 20",
                "excellent_answered_count: found 90, accepted at most 50"},
           Case{"cells/demo.yaml", "model_sight_mm: 0.5", "model_sight_mm: 1",
                "model_sight_mm: found 1, accepted at most 0.54: normal_enlargement_um"},
           Case{"cells/demo.yaml", "height_mm: 40 ", "height_mm: 400 ",
                "height_mm: the tool's apex is outside the workspace"},
           Case{"cells/demo.yaml", "base_in_world:\n  position_mm: [0, 0, 0]",
                "base_in_world:\n  position_mm: [-480, 0, 0]", "out of the stretched arm's reach"},
       }) {
    const fs::path file = root_ / "config" / c.file;
    const std::string text = ReadText(file);
    const std::size_t at = text.find(c.from);
    ASSERT_NE(at, std::string::npos) << c.from;
    std::string changed = text;
    changed.replace(at, std::string(c.from).size(), c.to);
    Write(file, changed);
    try {
      LoadAny(file);
      ADD_FAILURE() << c.expected;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(c.expected), std::string::npos) << error.what();
      EXPECT_GT(error.line(), 0);
    }
    Write(file, text);
  }
}

// Cuts, flips, doubles and shuffles bytes. A damaged file must load or be refused with a ConfigError;
// anything else is a failure.
TEST_F(ConfigFilesTest, DamagedFilesLoadOrAreRefusedWithAnError) {
  std::mt19937 random{99};
  // a random number from 0 to n - 1
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  const std::string yaml_characters = "{}[]&*!|>'\"%@`-:#,? \n\t~<=\\0x1e.";
  int refused = 0, loaded = 0;
  for (const fs::path& file : files_) {
    const std::string text = ReadText(file);
    // few changes, because the fuzz targets test many more
    const int changes = file.parent_path().filename() == "tools" ? 4 : 10;
    for (int n = 0; n < changes; ++n) {
      std::string changed = text;
      const int edits = 1 + static_cast<int>(below(4));
      for (int e = 0; e < edits; ++e) {
        const std::size_t at = below(changed.size());
        switch (below(5)) {
          case 0:
            changed.resize(at);
            break;
          case 1:
            changed.insert(at, 1, yaml_characters[below(yaml_characters.size())]);
            break;
          case 2:
            if (!changed.empty()) changed[at] = static_cast<char>(below(256));
            break;
          case 3:
            changed.erase(at, 1 + below(20));
            break;
          default:
            changed.insert(at, changed.substr(below(changed.size()), below(60)));
            break;
        }
      }
      Write(file, changed);
      try {
        LoadAny(file);
        ++loaded;
      } catch (const ConfigError& error) {
        ++refused;
        EXPECT_TRUE(std::string(error.what()).starts_with(root_.string())) << error.what();
      }
    }
    Write(file, text);
  }
  EXPECT_GT(refused, 200);
  EXPECT_GT(loaded, 10) << "a changed comment harms nothing";
}

}  // namespace
}  // namespace osteon::config
