#include "config/reading/load.h"
#include "config/reading/load_robot.h"
#include "config/reading/sections/read_calibration.h"
#include "config/reading/sections/read_gains.h"
#include "tests/fuzz/targets/config_claims.h"

// Fuzz target: the files that a cell names, except a tool (see tool_file.cpp): robot, scene, materials,
// gains, calibration. The input is read as each of these kinds. It can be valid as at most one of robot,
// scene and materials.

namespace osteon::fuzz {
namespace {

void ClaimScene(const simulation::SceneParams& scene) {
  simulation::CheckShape(scene.shape);
  Claim(!scene.material_names.empty() && scene.material_names.size() <= simulation::kMaxMaterials,
        "a scene has 1 … 8 materials");
}

template <int kCount>
void ClaimLimits(const kinematics::ChainParams<kCount>& chain) {
  for (const auto& joint : chain.joints)
    Claim(joint.limits.lower_rad < joint.limits.upper_rad && joint.limits.velocity_rad_per_s > 0.0,
          "a joint has a range and a speed");
}

// Claims that the control laws accept a cell with any gains that the reader accepted.
void ClaimGains(const FuzzConfig& files, std::string_view text, const config::CellConfig& cell) {
  for (const control::Law law : {control::Law::kAdmittance, control::Law::kImpedance}) {
    control::AdmittanceParams admittance = cell.servo.admittance;
    control::CouplingParams coupling = cell.servo.coupling;
    if (Loaded([&] { return config::ApplyGainsFile(files.path(), law, admittance, coupling), true; },
               files.path().string(), text))
      control::Validate(control::GainsOf(admittance, coupling));
  }
}

// Claims that the loop accepts a cell with any calibration that the reader accepted.
void ClaimCalibration(const FuzzConfig& files, std::string_view text, config::CellConfig cell) {
  if (!Loaded([&] { return config::ApplyCalibration(files.path(), cell), true; }, files.path().string(),
              text))
    return;
  control::Validate(cell.servo);
  Claim(cell.tool.X_FT.matrix().allFinite(), "the tool has a place");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  static const fuzz::FuzzConfig files;
  static const config::CellConfig cell =
      config::LoadCell(fuzz::FuzzConfig::Shipped() / "cells" / "demo.yaml");
  const std::string text = fuzz::Text({data, size}), name = files.path().string();
  files.Write(text);
  const config::ConfigFileTracker scope(files.scope());

  const auto robot = fuzz::Loaded([&] { return config::LoadRobot(files.path()); }, name, text);
  if (robot) std::visit([](const auto& chain) { fuzz::ClaimLimits(chain); }, robot->chain);
  const auto scene = fuzz::Loaded([&] { return config::LoadScene(files.path()); }, name, text);
  if (scene) fuzz::ClaimScene(*scene);
  const auto materials = fuzz::Loaded([&] { return config::LoadMaterials(files.path()); }, name, text);
  if (materials) simulation::CheckMaterials(*materials);
  fuzz::Claim(robot.has_value() + scene.has_value() + materials.has_value() <= 1, "a file is of one kind");
  fuzz::ClaimGains(files, text, cell);
  fuzz::ClaimCalibration(files, text, cell);
  return 0;
}
