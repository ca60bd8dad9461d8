#include "session/setup/cell_setup.h"

#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "config/reading/load.h"
#include "session/setup/cell_bone.h"
#include "session/setup/recorded_config.h"
#include "simulation/solids/cup_frame.h"

namespace osteon::session {
namespace {

// Joins the YAML files of a configuration that were read, one after the other.
std::string ConfigText(const io::ConfigSource& source) {
  std::string text;
  for (const io::ConfigFile& file : source.files)
    if (const std::string extension = std::filesystem::path(file.name).extension().string();
        extension == ".yaml" || extension == ".yml")
      text += fmt::format("# {}\n{}\n", file.name, file.content);
  return text;
}

}  // namespace

tl::expected<simulation::CutSite, std::string> ParseCup(const std::string& text) {
  static constexpr std::array<const char*, 7> kNames{"X", "Y", "Z", "NX", "NY", "NZ", "R"};
  // accepted are: coordinates of the centre from -kFar_mm to kFar_mm, a radius from kMinRadius_mm to
  // kMaxRadius_mm
  static constexpr double kFar_mm = 2000.0, kMinRadius_mm = 0.5, kMaxRadius_mm = 60.0;
  std::array<double, 7> values{};
  std::istringstream parts(text);
  std::string part;
  std::size_t count = 0;  // number of parts in the text, including surplus ones
  while (std::getline(parts, part, ',')) {
    if (count < values.size()) {
      const char* end = part.data() + part.size();
      const auto [rest, error] = std::from_chars(part.data(), end, values[count]);
      if (error != std::errc{} || rest != end || !std::isfinite(values[count]))
        return tl::make_unexpected(
            fmt::format("--cup: {}: found \"{}\", accepted a number", kNames[count], part));
    }
    ++count;
  }
  if (text.ends_with(',')) ++count;  // getline omits an empty last part
  if (count != values.size())
    return tl::make_unexpected(
        fmt::format("--cup: found {} values in \"{}\", accepted 7: X,Y,Z,NX,NY,NZ,R in mm", count, text));
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs(values[i]) > kFar_mm)
      return tl::make_unexpected(
          fmt::format("--cup: {}: found {} mm, accepted {} … {}", kNames[i], values[i], -kFar_mm, kFar_mm));
  if (!(values[6] >= kMinRadius_mm && values[6] <= kMaxRadius_mm))
    return tl::make_unexpected(
        fmt::format("--cup: R: found {} mm, accepted {} … {}", values[6], kMinRadius_mm, kMaxRadius_mm));
  const Vector3 axis(values[3], values[4], values[5]);
  if (axis.stableNorm() < 1e-6)
    return tl::make_unexpected(
        std::string("--cup: NX,NY,NZ: found a zero vector, accepted the axis out of the opening"));
  return simulation::CutSite{.center_m = 1e-3 * Vector3(values[0], values[1], values[2]),
                             .axis = Vector3(axis.stableNormalized()),
                             .radius_m = 1e-3 * values[6]};
}

tl::expected<CellSetup, std::string> PrepareCell(const std::filesystem::path& cell_yaml,
                                                 const std::optional<MeshChoice>& mesh_instead,
                                                 const std::optional<config::ToolChoice>& tool,
                                                 const std::filesystem::path& gains,
                                                 const std::filesystem::path& identified) {
  CellSetup setup;
  setup.cell_name = cell_yaml.stem().string();
  {
    const config::ConfigFileTracker files;
    setup.config = config::LoadCell(cell_yaml, tool, gains, identified);
    auto kept = KeepConfig(files, cell_yaml, tool, gains, identified);
    if (!kept) return tl::make_unexpected(kept.error());
    setup.config_source = std::move(*kept);
  }
  setup.config_text = ConfigText(setup.config_source);
  if (auto made = MakeCellBone(setup, mesh_instead); !made) return tl::make_unexpected(made.error());
  return setup;
}

tl::expected<CellSetup, std::string> SetUpRecorded(const io::SessionInfo& session,
                                                   const std::optional<MeshChoice>& mesh) {
  auto config = LoadRecordedCell(session.config);
  if (!config) return tl::make_unexpected(config.error());
  CellSetup setup;
  setup.config = std::move(*config);
  setup.config_text = session.config_text;
  setup.config_source = session.config;
  setup.cell_name = std::filesystem::path(session.config.cell_file).stem().string();
  const auto made = MakeCellBone(setup, mesh);
  std::string wrong = made ? "" : made.error();
  if (wrong.empty() && setup.bone.name != session.scene)
    wrong = fmt::format("{}: found the bone {}, accepted the recording's, {}",
                        mesh ? "--mesh" : "configuration", setup.bone.name, session.scene);
  if (wrong.empty()) return setup;
  setup.bone_warning = wrong + ": the bone cannot be shown";
  setup.solid = nullptr;
  setup.bone = simulation::Bone();
  setup.bone.name = session.scene;
  setup.X_WG = setup.config.X_WG * simulation::CupPose(setup.bone.site).inverse();
  return setup;
}

void PackAsScene(CellSetup& setup) {
  if (!setup.solid) return;
  setup.bone = simulation::PackScene({.name = setup.bone.name, .solid = setup.solid, .site = setup.bone.site},
                                     setup.config.scene, setup.config.cutting.split.on);
}

tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeEngine(const CellSetup& setup,
                                                                                 const EngineChoice& choice) {
  return MakeEngine(choice, setup.bone, setup.config.tool.tool, setup.X_WG, setup.config.cutting);
}

}  // namespace osteon::session
