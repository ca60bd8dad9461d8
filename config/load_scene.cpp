#include <algorithm>

#include <fmt/format.h>

#include "config/load.h"
#include "config/read_events.h"

namespace osteon::config {
namespace {

// Spacing in mm at the finest, and the two depths from which it may double.
simulation::GradeParams ReadGrade(Reader& section, const std::string& prefix, double min_mm, double max_mm) {
  return {.finest_m = section.Number(prefix + "spacing_mm", min_mm, max_mm),
          .coarser_from_m = section.Numbers(prefix + "coarser_from_mm", 2, 0, 500)};
}

void CheckAscending(const Reader& section, const std::string& key, const simulation::GradeParams& grade) {
  if (grade.coarser_from_m[0] > grade.coarser_from_m[1])
    section.Refuse(key, fmt::format("found {:.10g} after {:.10g}, accepted the smaller depth first",
                                    grade.coarser_from_m[1] * 1e3, grade.coarser_from_m[0] * 1e3));
}

}  // namespace

simulation::AcetabulumParams LoadScene(const std::filesystem::path& path) {
  Reader reader = Reader::Load(path);
  simulation::AcetabulumParams scene;
  static_cast<void>(reader.Choice("kind", {"acetabulum"}));

  Reader shape = reader.Section("shape");
  scene.shape.width_m = shape.Number("width_mm", 10, 500);
  scene.shape.height_m = shape.Number("height_mm", 5, 500);
  scene.shape.cup_radius_m = shape.Number("cup_radius_mm", 2, 100);
  scene.shape.cartilage_m = shape.Number("cartilage_mm", 0, 20);
  scene.shape.subchondral_m = shape.Number("subchondral_mm", 0, 20);

  Reader packing = reader.Section("packing");
  scene.packing.lattice = ReadGrade(packing, "", 0.2, 20);
  scene.packing.cup_radius_cap_m = packing.Number("cup_radius_cap_mm", 0.1, 50);
  scene.packing.cup_depth_m = packing.Number("cup_depth_mm", 0, 100);
  scene.packing.radius_over_spacing = packing.Number("radius_over_spacing_ratio", 0.56, 5);
  scene.packing.least_radius_m = packing.Number("least_radius_mm", 0.01, 5);
  scene.packing.surface_gap_m = packing.Number("surface_gap_mm", 0.005, 5);
  scene.packing.surface_gap_growth = packing.Number("surface_gap_growth_ratio", 0, 1);
  scene.packing.greatest_surface_gap_m = packing.Number("greatest_surface_gap_mm", 0.005, 10);
  scene.packing.samples = ReadGrade(packing, "sample_", 0.05, 10);

  Reader points = reader.Section("mass_points");
  scene.points.cells = ReadGrade(points, "", 0.1, 10);
  scene.points.samples_along_axis = points.Whole("axis_sample_count", 1, 16);
  scene.events = ReadEvents(reader.Section("events"));
  reader.Finish();

  constexpr double kLeastWall_m = 0.002;  // bone beside and below the cup
  const double room_m = std::min(0.5 * scene.shape.width_m, scene.shape.height_m) - kLeastWall_m;
  if (scene.shape.cup_radius_m > room_m)
    shape.Refuse("cup_radius_mm",
                 fmt::format("found {:.10g}, accepted at most {:.10g}: 2 mm less than half the width "
                             "and the height",
                             scene.shape.cup_radius_m * 1e3, room_m * 1e3));
  CheckAscending(packing, "coarser_from_mm", scene.packing.lattice);
  CheckAscending(packing, "sample_coarser_from_mm", scene.packing.samples);
  CheckAscending(points, "coarser_from_mm", scene.points.cells);
  return scene;
}

}  // namespace osteon::config
