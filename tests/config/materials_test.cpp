#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "config/reading/load.h"
#include "tests/temporary_path.h"

// Tests the lists of materials in config/materials: the shipped lists, and the errors of wrong lists.

namespace osteon::config {
namespace {

using testing::HasSubstr;

std::filesystem::path Shipped(const std::string& name) {
  return std::filesystem::path(OSTEON_SOURCE_DIR) / "config/materials" / name;
}

std::vector<std::string> Names(const std::vector<simulation::Material>& materials) {
  std::vector<std::string> names;
  for (const simulation::Material& m : materials) names.push_back(m.name);
  return names;
}

/// The error of loading a file with one material, in which the first occurrence of `from` is replaced; empty
/// if the file is accepted.
std::string Refusal(const std::string& from, const std::string& to) {
  std::string text =
      "materials:\n"
      "  - name: foam\n"
      "    density_g_per_cm3: 0.32\n"
      "    density_source: by definition\n"
      "    density_assumed: false\n"
      "    cutting_energy_J_per_mm3: 0.05\n"
      "    cutting_energy_source: a guess\n"
      "    cutting_energy_assumed: true\n"
      "    cutting_force_ratio: 0.8\n"
      "    cutting_force_source: a guess\n"
      "    cutting_force_assumed: true\n"
      "    friction_ratio: 0.3\n"
      "    friction_source: a guess\n"
      "    friction_assumed: true\n";
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const auto path = TemporaryPath(std::string("osteon_") + test->name() + ".yaml");
  std::ofstream(path, std::ios::binary) << text;
  std::string what;
  try {
    static_cast<void>(LoadMaterials(path));
  } catch (const ConfigError& error) {
    what = error.what();
  }
  std::filesystem::remove(path);
  const std::string folder = path.parent_path().string();
  return what.starts_with(folder) ? what.substr(folder.size() + 1) : what;
}

TEST(MaterialsConfig, EachShippedListIsValidAndInTheOrderItsScenesExpect) {
  using testing::ElementsAre;
  EXPECT_THAT(Names(LoadMaterials(Shipped("bone.yaml"))),
              ElementsAre("cartilage", "cortical", "cancellous", "marrow"));
  EXPECT_THAT(Names(LoadMaterials(Shipped("tooth.yaml"))), ElementsAre("enamel", "dentine", "pulp"));
  EXPECT_THAT(Names(LoadMaterials(Shipped("sawbone.yaml"))),
              ElementsAre("foam_10", "foam_15", "foam_20", "foam_40", "shell"));
  EXPECT_THAT(Names(LoadMaterials(Shipped("soft_bone.yaml"))),
              ElementsAre("cartilage", "cortical", "cancellous", "marrow", "soft tissue"));
  for (const char* name : {"bone.yaml", "soft_bone.yaml", "tooth.yaml", "sawbone.yaml"})
    EXPECT_NO_THROW(simulation::CheckMaterials(LoadMaterials(Shipped(name)))) << name;
}

// A foam's grade is its density in pounds per cubic foot: 1 lb/ft³ = 16.018 kg/m³. The file states the
// density with three digits.
TEST(MaterialsConfig, FoamsHaveTheDensityOfTheirGrade) {
  const std::vector<simulation::Material> foams = LoadMaterials(Shipped("sawbone.yaml"));
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(foams[i].density_kg_per_m3, 16.018 * std::stod(foams[i].name.substr(5)), 0.5);
    EXPECT_FALSE(foams[i].density_source.assumed);
  }
  EXPECT_NEAR(foams[4].specific_cutting_energy_J_per_m3, 0.5e9, 1.0);
  EXPECT_FALSE(foams[4].cutting_energy_source.assumed);
}

TEST(MaterialsConfig, AssumedValuesAreMarkedAndListed) {
  const std::vector<simulation::Material> bone = LoadMaterials(Shipped("bone.yaml"));
  EXPECT_FALSE(bone[1].cutting_energy_source.assumed);
  EXPECT_THAT(bone[1].cutting_energy_source.text, HasSubstr("MacAvelia"));
  EXPECT_TRUE(bone[0].density_source.assumed);
  const std::vector<std::string> assumed = simulation::Assumptions(bone);
  EXPECT_THAT(assumed, testing::Contains(HasSubstr("cartilage: density 1.1 g/cm³ (")));
  EXPECT_THAT(assumed, testing::Not(testing::Contains(HasSubstr("cortical: cutting energy"))));
}

TEST(MaterialsConfig, ErrorsNameTheLineAndWhatIsAccepted) {
  EXPECT_EQ(Refusal("foam", "foam"), "");
  EXPECT_THAT(Refusal("0.32", "320"), HasSubstr(".yaml:3: density_g_per_cm3: found 320, accepted 0.01 … 10"));
  EXPECT_THAT(Refusal("density_assumed: false", "density_assumed: perhaps"),
              HasSubstr(".yaml:5: density_assumed: found perhaps, accepted false, true"));
  EXPECT_THAT(Refusal("    density_assumed: false\n", ""), HasSubstr("missing key \"density_assumed\""));
  EXPECT_THAT(Refusal("    friction_source: a guess\n", ""), HasSubstr("missing key \"friction_source\""));
  EXPECT_THAT(Refusal("name: foam", "name:"), HasSubstr(".yaml:2: name: found nothing, accepted a text"));
  EXPECT_THAT(Refusal("materials:\n", "tissues:\n"), HasSubstr("unknown key \"tissues\""));
  EXPECT_THAT(Refusal("materials:\n", "materials:\n  - {}\n"), HasSubstr("missing key \"name\""));
  std::string eight_more = "materials:\n";
  for (int i = 0; i < 8; ++i) eight_more += "  - {}\n";
  EXPECT_THAT(Refusal("materials:\n", eight_more),
              HasSubstr("materials: found a list of 9, accepted a list of 1 … 8 mappings"));
}

TEST(MaterialsConfig, AnEdgeForceNeedsTheChipThicknessOfTheMeasuredEnergy) {
  const simulation::Material cortical = LoadMaterials(Shipped("bone.yaml"))[1];
  EXPECT_DOUBLE_EQ(cortical.edge_force_N_per_m, 21e3);
  EXPECT_DOUBLE_EQ(cortical.measured_chip_m, 48e-6);
  EXPECT_FALSE(cortical.edge_force_source.assumed);
  EXPECT_EQ(LoadMaterials(Shipped("bone.yaml"))[2].edge_force_N_per_m, 0.0);
  const std::string edge =
      "name: foam\n    edge_force_N_per_mm: 2\n    edge_force_source: a guess\n    edge_force_assumed: "
      "true\n";
  EXPECT_EQ(Refusal("name: foam\n", edge + "    measured_chip_um: 48\n"), "");
  EXPECT_THAT(Refusal("name: foam\n", edge), HasSubstr("missing key \"measured_chip_um\""));
  EXPECT_THAT(Refusal("name: foam\n", edge + "    measured_chip_um: 40\n"),
              HasSubstr(".yaml:3: edge_force_N_per_mm: found 2, accepted less than 2: "
                        "cutting_energy_J_per_mm3 times measured_chip_um"));
  EXPECT_THAT(Refusal("name: foam\n", "name: foam\n    measured_chip_um: 48\n"),
              HasSubstr("unknown key \"measured_chip_um\""));
}

TEST(MaterialsConfig, ARepeatedNameIsRefused) {
  std::ifstream file(Shipped("tooth.yaml"));
  std::string text((std::istreambuf_iterator<char>(file)), {});
  text.replace(text.find("name: pulp"), 10, "name: enamel");
  const auto path = TemporaryPath("osteon_twice.yaml");
  std::ofstream(path) << text;
  try {
    static_cast<void>(LoadMaterials(path));
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("name: found enamel again, accepted another name"));
    EXPECT_GT(error.line(), 20);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace osteon::config
