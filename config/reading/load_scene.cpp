#include "config/reading/load_scene.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "config/reading/sections/density_image.h"
#include "config/reading/sections/read_events.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

using simulation::SceneParams;

/// The names of a scene's materials, in the order of their first use: a name's position is the material's
/// index.
class SceneMaterialNames {
 public:
  explicit SceneMaterialNames(std::vector<std::string> names) : names_(std::move(names)) {}

  /// Reads the name of a material and returns its index; a new name is added.
  simulation::MaterialIndex Read(Reader& section, const std::string& key) {
    constexpr std::size_t kMax = 8;
    const std::string name = section.Text(key);
    if (name.empty()) return 0;  // missing: Finish() reports it
    const auto at = std::find(names_.begin(), names_.end(), name);
    if (at == names_.end()) {
      if (names_.size() == kMax)
        section.Refuse(key, fmt::format("found {}, accepted at most {} materials a scene", name, kMax));
      names_.push_back(name);
      return static_cast<simulation::MaterialIndex>(names_.size() - 1);
    }
    return static_cast<simulation::MaterialIndex>(at - names_.begin());
  }
  [[nodiscard]] const std::vector<std::string>& list() const { return names_; }

 private:
  std::vector<std::string> names_;
};

std::vector<simulation::TissueLayer> ReadLayers(Reader& section, SceneMaterialNames& names) {
  std::vector<simulation::TissueLayer> layers;
  for (Reader& layer : section.Sections("layers", 0, 8)) {
    simulation::TissueLayer& read = layers.emplace_back();
    read.material = names.Read(layer, "material");
    read.thickness_m = layer.Number("thickness_mm", 0, 100);
  }
  return layers;
}

// Each of these functions reads the section `shape` of one kind of scene.

void ReadAcetabulum(Reader shape, SceneParams& scene, SceneMaterialNames&) {
  simulation::AcetabulumShape read;
  read.width_m = shape.Number("width_mm", 10, 500);
  read.height_m = shape.Number("height_mm", 5, 500);
  read.cup_radius_m = shape.Number("cup_radius_mm", 2, 100);
  read.cartilage_m = shape.Number("cartilage_mm", 0, 20);
  read.subchondral_m = shape.Number("subchondral_mm", 0, 20);
  scene.shape = read;
}

void ReadMolar(Reader shape, SceneParams& scene, SceneMaterialNames&) {
  simulation::MolarShape read;
  read.length_m = shape.Number("length_mm", 10, 40);
  read.enamel_m = shape.Number("enamel_mm", 0, 4.8);
  read.pulp_width = shape.Number("pulp_width_ratio", 0.6, 1.3);
  scene.shape = read;
}

void ReadFemur(Reader shape, SceneParams& scene, SceneMaterialNames&) {
  simulation::FemurShape read;
  read.length_m = shape.Number("length_mm", 20, 400);
  read.flare_m = shape.Number("flare_mm", 5, 400);
  read.shaft_radius_m = shape.Number("shaft_radius_mm", 5, 40);
  read.top_radius_m = shape.Number("top_radius_mm", 5, 60);
  read.oval_ratio = shape.Number("oval_ratio", 1, 1.6);
  read.medial_shift_m = shape.Number("medial_shift_mm", 0, 30);
  read.shaft_wall_m = shape.Number("shaft_wall_mm", 0.2, 28);
  read.top_wall_m = shape.Number("top_wall_mm", 0.2, 30);
  read.shaft_lining_m = shape.Number("shaft_lining_mm", 0, 40);
  read.top_marrow_radius_m = shape.Number("top_marrow_radius_mm", 0.2, 60);
  scene.shape = read;
}

void ReadBlock(Reader shape, SceneParams& scene, SceneMaterialNames& names) {
  simulation::BlockShape read;
  read.width_m = shape.Number("width_mm", 0.1, 500);
  read.depth_m = shape.Number("depth_mm", 0.1, 500);
  read.height_m = shape.Number("height_mm", 0.1, 500);
  read.layers = ReadLayers(shape, names);
  read.core = names.Read(shape, "core");
  scene.shape = read;
}

void ReadFemoralHead(Reader shape, SceneParams& scene, SceneMaterialNames&) {
  simulation::FemoralHeadShape read;
  read.head_radius_m = shape.Number("head_radius_mm", 10, 40);
  read.neck_radius_m = shape.Number("neck_radius_mm", 5, 40);
  read.neck_length_m = shape.Number("neck_length_mm", 15, 100);
  read.neck_tilt_rad = shape.Number("neck_tilt_deg", 0, 60);
  read.cartilage_m = shape.Number("cartilage_mm", 0, 5);
  read.cortical_m = shape.Number("cortical_mm", 0, 20);
  scene.shape = read;
}

// Reads a kind, which decides about the other keys of the section. If the kind is missing, the section is
// refused at once, because the other keys would be refused as unknown.
std::size_t ReadKind(Reader& section, std::initializer_list<const char*> accepted) {
  if (section.Text("kind").empty()) section.Finish();
  return section.Choice("kind", accepted);
}

void ReadZone(Reader section, simulation::ZoneParams& zone) {
  using Kind = simulation::ZoneParams::Kind;
  constexpr Kind kKinds[] = {Kind::kCup, Kind::kPath, Kind::kSurface, Kind::kEverywhere};
  zone.kind = kKinds[ReadKind(section, {"cup", "path", "surface", "everywhere"})];
  if (zone.kind == Kind::kPath || zone.kind == Kind::kSurface)
    zone.radius_m = section.Number("radius_mm", 0.01, 100);
  if (zone.kind == Kind::kPath)
    for (Reader& point : section.Sections("path", 1, 1000))
      zone.path_C_m.push_back(point.Triple("at_mm", -500, 500));
}

// Reads the tissue that a mesh's shell encloses; its density image is optional.
simulation::ShellTissue ReadShellTissue(Reader& section, SceneMaterialNames& names) {
  simulation::ShellTissue read;
  read.layers = ReadLayers(section, names);
  read.core = names.Read(section, "core");
  if (section.Has("density_image"))
    read.image =
        ReadDensityImage(section.Section("density_image"),
                         [&names](Reader& inner, const std::string& key) { return names.Read(inner, key); });
  return read;
}

void ReadMeshTissue(Reader section, simulation::MeshSceneTissue& tissue, SceneMaterialNames& names) {
  tissue.solid = ReadShellTissue(section, names);
  for (Reader& region : section.Sections("regions", 0, 8)) {
    auto& read = tissue.regions.emplace_back();
    read.name = region.Text("name");
    read.tissue = ReadShellTissue(region, names);
  }
  for (Reader& lining : section.Sections("lining", 0, 1)) {
    auto& read = tissue.lining.emplace(simulation::MeshSceneTissue::Lining{});
    read.lining_radii = lining.Number("reach_ratio", 1, 2);
    read.layers = ReadLayers(lining, names);
    read.core = names.Read(lining, "core");
  }
}

// Reads a graded spacing: the finest spacing (key PREFIXspacing_mm), and the depths from which the spacing
// may double once and twice (key PREFIXcoarser_from_mm).
simulation::GradeParams ReadGrade(Reader& section, const std::string& prefix, double min_mm, double max_mm) {
  return {.finest_m = section.Number(prefix + "spacing_mm", min_mm, max_mm),
          .coarser_from_m = section.Numbers(prefix + "coarser_from_mm", 2, 0, 500)};
}

// Refuses a second depth that is smaller than the first.
void CheckAscending(const Reader& section, const std::string& key, const simulation::GradeParams& grade) {
  if (grade.coarser_from_m[0] > grade.coarser_from_m[1])
    section.Refuse(key, fmt::format("found {:.10g} after {:.10g}, accepted the smaller depth first",
                                    grade.coarser_from_m[1] * 1e3, grade.coarser_from_m[0] * 1e3));
}

void ReadPacking(Reader& section, simulation::PackingParams& packing) {
  packing.lattice = ReadGrade(section, "", 0.2, 20);
  packing.cup_radius_cap_m = section.Number("cup_radius_cap_mm", 0.1, 50);
  packing.cup_depth_m = section.Number("cup_depth_mm", 0, 100);
  packing.radius_over_spacing = section.Number("radius_over_spacing_ratio", 0.56, 5);
  packing.min_radius_m = section.Number("min_radius_mm", 0.01, 5);
  packing.surface_gap_m = section.Number("surface_gap_mm", 0.005, 5);
  packing.surface_gap_growth = section.Number("surface_gap_growth_ratio", 0, 1);
  packing.max_surface_gap_m = section.Number("max_surface_gap_mm", 0.005, 10);
  packing.samples = ReadGrade(section, "sample_", 0.05, 10);
}

// Reads a section `fidelity`. Planning a packing for it needs a known cut, so the zone must be a cup or a
// path.
simulation::FidelityRequest ReadFidelity(Reader section, const simulation::ZoneParams& zone) {
  using Kind = simulation::ZoneParams::Kind;
  const simulation::FidelityRequest read{.error_m = section.Number("error_mm", 0.001, 5),
                                         .rate_hz = section.Number("rate_hz", 1, 100e3)};
  if (zone.kind != Kind::kCup && zone.kind != Kind::kPath)
    section.Refuse("error_mm", "found with zone: kind surface or everywhere, accepted with cup or path");
  return read;
}

// Checks the sizes of a shape against each other.
void CheckShape(const Reader& section, const simulation::SceneShape& shape) {
  if (const auto* cup = std::get_if<simulation::AcetabulumShape>(&shape)) {
    constexpr double kMinWall_m = 0.002;  // smallest thickness of bone beside and below the cup
    const double max_m = std::min(0.5 * cup->width_m, cup->height_m) - kMinWall_m;
    if (cup->cup_radius_m > max_m)
      section.Refuse("cup_radius_mm",
                     fmt::format("found {:.10g}, accepted at most {:.10g}: 2 mm less than half the width "
                                 "and the height",
                                 cup->cup_radius_m * 1e3, max_m * 1e3));
  }
  try {
    simulation::CheckShape(shape);
  } catch (const std::invalid_argument& error) {
    section.Refuse("shape", error.what());
  }
}

}  // namespace

SceneParams LoadScene(const std::filesystem::path& path) {
  Reader reader = Reader::Load(path);
  SceneParams scene;
  const std::size_t kind =
      ReadKind(reader, {"acetabulum", "molar", "femoral_canal", "block", "femoral_head"});
  constexpr std::size_t kAcetabulum = 0;
  // the array is in the order of the kinds above
  const auto read_shape = std::array{ReadAcetabulum, ReadMolar, ReadFemur, ReadBlock, ReadFemoralHead}[kind];
  const simulation::SceneShape default_shapes[] = {simulation::AcetabulumShape{}, simulation::MolarShape{},
                                                   simulation::FemurShape{}, simulation::BlockShape{},
                                                   simulation::FemoralHeadShape{}};
  SceneMaterialNames names(simulation::MaterialNames(default_shapes[kind]));
  const Reader shape = reader.Section("shape");
  read_shape(shape, scene, names);
  if (kind != kAcetabulum) {  // the site of an acetabulum is its cup
    Reader site = reader.Section("site");
    const std::vector<double> place_m = site.Numbers("place_mm", 2, -500, 500);
    scene.site = {.x_m = place_m[0], .y_m = place_m[1], .radius_m = site.Number("radius_mm", 0.5, 100)};
  }
  ReadZone(reader.Section("zone"), scene.zone);
  ReadMeshTissue(reader.Section("mesh_tissue"), scene.mesh_tissue, names);
  Reader packing = reader.Section("packing");
  ReadPacking(packing, scene.packing);
  if (reader.Has("fidelity")) scene.fidelity = ReadFidelity(reader.Section("fidelity"), scene.zone);
  Reader points = reader.Section("mass_points");
  scene.points.cells = ReadGrade(points, "", 0.1, 10);
  scene.points.samples_along_axis = points.WholeNumber("axis_sample_count", 2, 16);
  scene.events = ReadEvents(reader.Section("events"));
  reader.Finish();

  CheckShape(shape, scene.shape);
  CheckAscending(packing, "coarser_from_mm", scene.packing.lattice);
  CheckAscending(packing, "sample_coarser_from_mm", scene.packing.samples);
  CheckAscending(points, "coarser_from_mm", scene.points.cells);
  scene.material_names = names.list();
  scene.name = path.stem().string();
  std::replace(scene.name.begin(), scene.name.end(), '_', ' ');
  return scene;
}

}  // namespace osteon::config
