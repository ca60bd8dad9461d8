#include "simulation/solids/tissue_map.h"

#include <algorithm>
#include <cmath>

#include "base/check_range.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {
namespace {

constexpr double kMaxThickness_m = 0.100;
constexpr int kMaxSamples = 4096;  // largest number of samples along each side of an image
constexpr double kMaxDensity_kg_per_m3 = 25000.0;

/// The layer at this depth, if the depth lies in one.
std::optional<MaterialIndex> LayerAt(const std::vector<TissueLayer>& layers, double depth_m) {
  double bottom_m = 0.0;
  for (const TissueLayer& layer : layers) {
    bottom_m += layer.thickness_m;
    if (depth_m < bottom_m) return layer.material;
  }
  return std::nullopt;
}

/// Checks a material's index. @throws std::invalid_argument if it is not below `count`.
void CheckMaterial(const std::string& name, MaterialIndex material, std::size_t count) {
  if (material >= count)
    throw std::invalid_argument(
        fmt::format("{}: found material {}, accepted 0 … {}", name, material, count - 1));
}

void CheckLayers(const std::string& name, const std::vector<TissueLayer>& layers, std::size_t count) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string layer = fmt::format("{}: layer {}", name, i);
    CheckRangeMm(layer + ": thickness", layers[i].thickness_m, 0.0, kMaxThickness_m);
    CheckMaterial(layer, layers[i].material, count);
  }
}

void CheckImage(const std::string& name, const DensityImage& image, std::size_t count) {
  const auto refuse = [&name](const std::string& what) { throw std::invalid_argument(name + ": " + what); };
  if (image.rows < 2 || image.rows > kMaxSamples || image.columns < 1 || image.columns > kMaxSamples)
    refuse(fmt::format("found {} × {} samples, accepted 2 … {} rows and 1 … {} columns", image.rows,
                       image.columns, kMaxSamples, kMaxSamples));
  if (image.density_kg_per_m3.size() != static_cast<std::size_t>(image.rows) * image.columns)
    refuse(fmt::format("found {} densities, accepted {} × {} = {}", image.density_kg_per_m3.size(),
                       image.rows, image.columns, static_cast<std::size_t>(image.rows) * image.columns));
  CheckRangeMm(name + ": row step", image.row_step_m, 1e-6, kMaxThickness_m);
  for (std::size_t i = 0; i < image.density_kg_per_m3.size(); ++i) {
    const float density = image.density_kg_per_m3[i];
    if (!(density >= 0.0f && density <= static_cast<float>(kMaxDensity_kg_per_m3)))
      refuse(fmt::format("row {}, column {}: found {:g} kg/m^3, accepted 0 … {:g}", i / image.columns,
                         i % image.columns, density, kMaxDensity_kg_per_m3));
  }
  const Vector3 axis = image.axis;
  if (!(std::abs(axis.norm() - 1.0) < 1e-6))
    refuse(
        fmt::format("axis: found ({:g}, {:g}, {:g}), accepted a unit vector", axis.x(), axis.y(), axis.z()));
  if (image.columns > 1 && !(image.last_column_m - image.first_column_m > 1e-6 &&
                             std::isfinite(image.last_column_m - image.first_column_m)))
    refuse(fmt::format("found columns from {:g} to {:g} mm, accepted ascending heights",
                       image.first_column_m * 1e3, image.last_column_m * 1e3));
  if (image.classes.empty()) refuse("found no density classes, accepted one and more");
  for (std::size_t i = 0; i < image.classes.size(); ++i) {
    CheckMaterial(fmt::format("{}: class {}", name, i), image.classes[i].material, count);
    const double below = image.classes[i].below_kg_per_m3;
    const double before = i == 0 ? 0.0 : image.classes[i - 1].below_kg_per_m3;
    if (!(below > before))
      refuse(fmt::format("class {}: found below {:g} kg/m^3, accepted more than {:g} (ascending)", i, below,
                         before));
  }
}

}  // namespace

double DensityImage::DensityAt(double depth_m, double height_m) const {
  // splits a position among `count` samples into the index of the sample before it and the fraction of the
  // way to the next sample
  const auto split = [](double at, int count) {
    const double clamped = std::clamp(at, 0.0, static_cast<double>(count - 1));
    const int low = std::min(static_cast<int>(clamped), std::max(0, count - 2));
    return std::pair{low, clamped - low};
  };
  const auto [row, row_share] = split(depth_m / row_step_m, rows);
  const double column_place =
      columns > 1 ? (height_m - first_column_m) / (last_column_m - first_column_m) * (columns - 1) : 0.0;
  const auto [column, column_share] = split(column_place, columns);
  const auto sample = [this](int r, int c) -> double {
    return density_kg_per_m3[static_cast<std::size_t>(std::min(r, rows - 1)) * columns +
                             std::min(c, columns - 1)];
  };
  const double upper = (1.0 - column_share) * sample(row, column) + column_share * sample(row, column + 1);
  const double lower =
      (1.0 - column_share) * sample(row + 1, column) + column_share * sample(row + 1, column + 1);
  return (1.0 - row_share) * upper + row_share * lower;
}

MaterialIndex DensityImage::MaterialAt(double depth_m, double height_m) const {
  const double density = DensityAt(depth_m, height_m);
  for (const DensityClass& c : classes)
    if (density < c.below_kg_per_m3) return c.material;
  return classes.back().material;
}

MaterialIndex ShellTissue::MaterialAt(double depth_m, const Vector3& p_m) const {
  if (const auto layer = LayerAt(layers, depth_m)) return *layer;
  if (image && depth_m <= image->DepthOfLastRow_m())
    return image->MaterialAt(depth_m, p_m.dot(Vector3(image->axis)));
  return core;
}

bool LiningTissue::Covers(const Vector3& p_m, const Vector3& normal) const {
  const Vector3 from_center = p_m - Vector3(cup.center_m);
  return from_center.norm() <= lining_radii * cup.radius_m && from_center.dot(Vector3(cup.axis)) <= 0.0 &&
         normal.dot(from_center) < 0.0;
}

MaterialIndex LiningTissue::MaterialAt(double depth_m) const {
  return LayerAt(layers, depth_m).value_or(core);
}

void CheckTissueMap(const TissueMap& map, std::size_t material_count) {
  if (map.shells.empty()) throw std::invalid_argument("tissue: found no shells, accepted one and more");
  for (std::size_t i = 0; i < map.shells.size(); ++i) {
    const std::string name = fmt::format("tissue: shell {}", i);
    CheckLayers(name, map.shells[i].layers, material_count);
    CheckMaterial(name + ": core", map.shells[i].core, material_count);
    if (map.shells[i].image) CheckImage(name + ": density image", *map.shells[i].image, material_count);
  }
  if (!map.lining) return;
  CheckLayers("tissue: lining", map.lining->layers, material_count);
  CheckMaterial("tissue: lining: core", map.lining->core, material_count);
  if (!(map.lining->lining_radii >= 1.0 && map.lining->lining_radii <= 2.0))
    throw std::invalid_argument(
        fmt::format("tissue: lining_radii: found {:g}, accepted 1 … 2", map.lining->lining_radii));
}

}  // namespace osteon::simulation
