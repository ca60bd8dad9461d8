#include "session/planning/pack_source.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/mapped_file.h"
#include "base/text.h"
#include "base/utf8.h"
#include "config/reading/load.h"
#include "config/reading/named_file.h"
#include "simulation/solids/ball_solid.h"
#include "simulation/solids/box_solid.h"

namespace osteon::session {
namespace {

constexpr double kEvenDensity_kg_per_m3 = 1000.0;  // density of PackSource::even
constexpr double kMaxLength_mm = 10'000.0;         // largest magnitude of a number that ParseNumbers accepts

/// Finds materials by their names, in the given file or, without one, in the configuration's files; there
/// each material is taken from the first file that has it.
tl::expected<std::vector<simulation::Material>, std::string> SelectMaterials(
    const SourceOptions& options, const std::vector<std::string>& names) {
  std::vector<simulation::Material> found;
  const auto files = options.materials.empty() ? config::YamlFilesIn(options.config_root / "materials")
                                               : std::vector<std::filesystem::path>{options.materials};
  for (const auto& file : files)
    for (simulation::Material& material : config::LoadMaterials(file))
      if (std::ranges::find(found, material.name, &simulation::Material::name) == found.end())
        found.push_back(std::move(material));
  std::vector<simulation::Material> picked;
  for (const std::string& name : names) {
    const auto at = std::ranges::find(found, name, &simulation::Material::name);
    if (at == found.end()) {
      std::vector<std::string> found_names;
      for (const simulation::Material& material : found) found_names.push_back(material.name);
      return tl::make_unexpected(
          fmt::format("--materials {}: found {}, accepted files with {} as well, which the scene needs",
                      options.materials.empty() ? (options.config_root / "materials").string()
                                                : options.materials.string(),
                      found_names.empty() ? "none" : fmt::format("{}", fmt::join(found_names, ", ")), name));
    }
    picked.push_back(*at);
  }
  return picked;
}

/// Finds a scene's YAML file by its path or name. @param option  name of the option, for the beginning of the
/// error
tl::expected<std::filesystem::path, std::string> SceneFile(const SourceOptions& options,
                                                           const std::string& name,
                                                           const std::string& option) {
  const std::filesystem::path scenes = options.config_root / "scenes";
  return config::FindNamedFile(scenes, name).map_error([&](const std::filesystem::path& file) {
    const bool other = option == options.input && !options.scenes_only;
    return fmt::format(
        "{}: no file {}; accepted: {}a scene: a YAML file, or one of {}{}", option, file.string(),
        other ? "a mesh (.stl, .obj, .ply), a packing (.osp), ball:R, box:X,Y,Z, or " : "",
        config::YamlNamesIn(scenes), options.scenes_only ? "; a mesh (.stl, .obj, .ply) with --cup" : "");
  });
}

/// Reads the positions of a tool path from a CSV file in mm. @returns them in m
tl::expected<std::vector<Vector3>, std::string> ReadPath(const std::filesystem::path& file) {
  std::ifstream lines(file);
  if (!lines || std::filesystem::is_directory(file))
    return tl::make_unexpected(
        fmt::format("--path {}: no such file, accepted a CSV file with lines x_mm,y_mm,z_mm", file.string()));
  std::vector<Vector3> points;
  std::string line;
  constexpr std::size_t kMaxPoints = 100'000;  // a longer path is refused
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.ends_with('\r')) line.pop_back();
    // empty line, or header
    if (line.empty() || (number == 1 && line.find_first_of("xX") != line.npos)) continue;
    const auto values = ParseNumbers(line, 3, fmt::format("--path {}:{}", file.string(), number));
    if (!values) return tl::make_unexpected(values.error());
    if (points.size() == kMaxPoints)
      return tl::make_unexpected(fmt::format("--path {}:{}: found more points, accepted up to {}",
                                             file.string(), number, kMaxPoints));
    points.emplace_back(1e-3 * Vector3((*values)[0], (*values)[1], (*values)[2]));
  }
  if (points.empty())
    return tl::make_unexpected(
        fmt::format("--path {}: found no points, accepted lines x_mm,y_mm,z_mm", file.string()));
  return points;
}

std::string PlaceText(const PlainVector3& p) {
  return fmt::format("({:g}, {:g}, {:g}) mm", p.x * 1e3, p.y * 1e3, p.z * 1e3);
}

/// Chooses the zone in which the bone is cut: that of the command line, else that of the scene if there is a
/// site, else the whole bone.
tl::expected<void, std::string> ChooseZone(const SourceOptions& options, PackSource& source) {
  source.zone_is_uniform = false;
  if (options.path) {
    auto points = ReadPath(options.path->file);
    if (!points) return tl::make_unexpected(points.error());
    source.zone_text = fmt::format("tool path of {} points in {}, radius {:g} mm", points->size(),
                                   options.path->file.filename().string(), options.path->radius_m * 1e3);
    source.zone = std::make_unique<simulation::PathZone>(std::move(*points), options.path->radius_m);
    return {};
  }
  if (options.region) {
    source.zone_text = fmt::format("surface within {:g} mm of {}", options.region->radius_m * 1e3,
                                   PlaceText(options.region->center_m));
    source.zone = std::make_unique<simulation::SurfaceZone>(*source.solid, *options.region);
    return {};
  }
  const bool scene_has_zone = source.own && source.site.radius_m > 0.0 &&
                              source.own->zone.kind != simulation::ZoneParams::Kind::kEverywhere;
  if (scene_has_zone) {
    source.zone_text = "the scene's";
    source.zone = simulation::MakeZone(source.own->zone, source.site, *source.solid);
    return {};
  }
  if (options.cup) {
    source.zone_text = fmt::format("cup at {}, radius {:g} mm", PlaceText(options.cup->center_m),
                                   options.cup->radius_m * 1e3);
    source.zone = std::make_unique<simulation::CupZone>(*options.cup);
    return {};
  }
  if (options.graded) {
    source.zone_text = "all of the surface";
    source.zone = std::make_unique<simulation::SurfaceZone>(*source.solid);
    return {};
  }
  source.zone_is_uniform = true;
  source.zone_text = "everywhere alike";
  source.zone = std::make_unique<simulation::EverywhereZone>();
  return {};
}

/// Returns the mass properties of a box of uniform density, about its centre.
simulation::MassProperties EvenBox(const Vector3& size_m) {
  simulation::MassProperties even;
  even.volume_m3 = size_m.prod();
  even.mass_kg = kEvenDensity_kg_per_m3 * even.volume_m3;
  const Vector3 squares = size_m.cwiseAbs2();
  even.inertia_kg_m2 = (even.mass_kg / 12.0 * (Vector3::Constant(squares.sum()) - squares)).asDiagonal();
  return even;
}

/// Returns the mass properties of a ball of uniform density, about its centre.
simulation::MassProperties EvenBall(double radius_m) {
  simulation::MassProperties even;
  even.volume_m3 = 4.0 / 3.0 * std::numbers::pi * std::pow(radius_m, 3);
  even.mass_kg = kEvenDensity_kg_per_m3 * even.volume_m3;
  even.inertia_kg_m2 = 0.4 * even.mass_kg * radius_m * radius_m * Matrix3::Identity();
  return even;
}

/// Makes the shape of an input "ball:R" or "box:X,Y,Z".
tl::expected<void, std::string> LoadShape(const SourceOptions& options, PackSource& source) {
  const bool ball = options.input.starts_with("ball:");
  const std::string numbers = options.input.substr(options.input.find(':') + 1);
  const auto values = ParseNumbers(numbers, ball ? 1 : 3, options.input);
  if (!values) return tl::make_unexpected(values.error());
  if (ball) {
    const double radius_m = 1e-3 * values->front();
    source.solid = std::make_shared<simulation::BallSolid>(radius_m);
    source.even = EvenBall(radius_m);
  } else {
    const Vector3 size_m = 1e-3 * Vector3((*values)[0], (*values)[1], (*values)[2]);
    source.solid = std::make_shared<simulation::BoxSolid>(-0.5 * size_m, 0.5 * size_m);
    source.even = EvenBox(size_m);
  }
  auto materials = SelectMaterials(options, {"cancellous"});
  if (!materials) return tl::make_unexpected(materials.error());
  source.materials = std::move(*materials);
  source.name = options.input;
  if (options.cup) source.site = *options.cup;
  return {};
}

/// Loads solid, site and materials of a scene, and stores the scene itself in `source.own`.
tl::expected<void, std::string> LoadScene(const SourceOptions& options, PackSource& source) {
  const auto file = SceneFile(options, options.input, options.input);
  if (!file) return tl::make_unexpected(file.error());
  source.own = config::LoadScene(*file);
  auto materials = SelectMaterials(options, source.own->material_names);
  if (!materials) return tl::make_unexpected(materials.error());
  source.materials = std::move(*materials);
  const simulation::SceneSolid made = simulation::MakeSceneSolid(*source.own);
  source.name = made.name;
  source.solid = made.solid;
  source.site = made.site;
  source.provenance.source = base::Utf8(file->filename().string());
  return {};
}

/// Loads a mesh as the solid, with the materials of the scene that it replaces.
tl::expected<void, std::string> LoadMeshSource(const SourceOptions& options, PackSource& source) {
  const std::string scene_name = options.scene.empty() ? "acetabulum" : options.scene;
  const auto scene_file = SceneFile(options, scene_name, "--scene " + scene_name);
  if (!scene_file) return tl::make_unexpected(scene_file.error());
  simulation::SceneParams scene = config::LoadScene(*scene_file);
  auto materials = SelectMaterials(options, scene.material_names);
  if (!materials) return tl::make_unexpected(materials.error());
  source.materials = std::move(*materials);

  const double scale = options.scale.value_or(1.0);
  const auto loaded = simulation::LoadMesh(options.input, {.scale = scale, .remake = true});
  if (!loaded) return tl::make_unexpected(loaded.error().message);
  const auto made = simulation::MakeMeshSolid(*loaded, options.input, options.cup, scene);
  if (!made) return tl::make_unexpected(made.error().message);
  source.name = base::Utf8(made->name);
  source.solid = made->solid;
  source.site = made->site;
  source.triangles = loaded->mesh.triangles.size();
  source.even = simulation::MeshMassProperties(loaded->mesh, kEvenDensity_kg_per_m3);
  if (!options.scene.empty()) source.own = std::move(scene);
  source.provenance.parameters.emplace_back("tissue", base::Utf8(scene_file->filename().string()));
  if (options.scale) source.provenance.parameters.emplace_back("scale_mm", fmt::format("{}", scale));
  if (loaded->report.remake) {
    source.warning = made->warning;
    source.provenance.parameters.emplace_back("remade", simulation::DescribeRemake(*loaded->report.remake));
  }
  return {};
}

}  // namespace

tl::expected<std::vector<double>, std::string> ParseNumbers(const std::string& text, std::size_t count,
                                                            const std::string& what) {
  std::vector<double> values;
  std::size_t found = 0;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    std::string_view part(text.data() + at, end - at);
    while (part.starts_with(' ')) part.remove_prefix(1);
    while (part.ends_with(' ')) part.remove_suffix(1);
    double value = 0.0;
    const auto [rest, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || rest != part.data() + part.size() || !(std::abs(value) <= kMaxLength_mm))
      return tl::make_unexpected(fmt::format("{}: found \"{}\", accepted a number, -{} … {} mm", what,
                                             part.substr(0, 40), kMaxLength_mm, kMaxLength_mm));
    values.push_back(value);
    ++found;
    at = end + 1;
  }
  if (found != count)
    return tl::make_unexpected(fmt::format("{}: found {} values in \"{}\", accepted {} in mm", what, found,
                                           text.substr(0, 80), count));
  return values;
}

tl::expected<simulation::Ball, std::string> ParseRegion(const std::string& text) {
  const auto values = ParseNumbers(text, 4, "--region");
  if (!values) return tl::make_unexpected(values.error());
  if (!((*values)[3] > 0.0))
    return tl::make_unexpected(fmt::format("--region: R: found {} mm, accepted above 0", (*values)[3]));
  return simulation::Ball{.center_m = 1e-3 * Vector3((*values)[0], (*values)[1], (*values)[2]),
                          .radius_m = 1e-3 * (*values)[3]};
}

tl::expected<PackSource, std::string> LoadPackSource(const SourceOptions& options) {
  PackSource source;
  const std::string& input = options.input;
  source.provenance.source = base::Utf8(std::filesystem::path(input).filename().string());
  const std::string extension = base::Lower(std::filesystem::path(input).extension().string());
  const bool is_shape = !options.scenes_only && (input.starts_with("ball:") || input.starts_with("box:"));
  const bool is_mesh = !options.scenes_only && !is_shape && !extension.empty() && extension != ".yaml";
  if (!is_mesh) {
    const auto refuse = [&](const char* option) {
      return tl::make_unexpected(fmt::format("{}: found with {}, accepted with a mesh", option, input));
    };
    if (options.scale) return refuse("--scale");
    if (!options.scene.empty()) return refuse("--scene");
    if (options.cup && !is_shape) return refuse("--cup");
  }
  if (input.empty()) return tl::make_unexpected(std::string("found no name, accepted a mesh or shape"));
  const auto loaded = is_shape  ? LoadShape(options, source)
                      : is_mesh ? LoadMeshSource(options, source)
                                : LoadScene(options, source);
  if (!loaded) return tl::make_unexpected(loaded.error());
  if (!is_shape) {  // the input is a file: a mesh or a scene
    const auto crc =
        simulation::FileChecksum(is_mesh ? std::filesystem::path(input) : *SceneFile(options, input, input));
    if (!crc) return tl::make_unexpected(crc.error().Text());
    source.provenance.source_crc = *crc;
  }
  if (!options.materials.empty())
    source.provenance.parameters.emplace_back("materials", options.materials.filename().string());
  if (const auto chosen = ChooseZone(options, source); !chosen) return tl::make_unexpected(chosen.error());
  source.provenance.parameters.emplace_back("zone", source.zone_text);
  return source;
}

}  // namespace osteon::session
