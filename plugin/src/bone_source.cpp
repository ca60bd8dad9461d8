#include "plugin/src/bone_source.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/text.h"
#include "base/utf8.h"
#include "config/reading/load_scene.h"
#include "config/reading/load_tool.h"
#include "plugin/src/convert.h"
#include "plugin/src/result.h"
#include "plugin/src/shipped_files.h"
#include "simulation/bone/scenes.h"
#include "simulation/packing/packing_file.h"

namespace osteon::plugin {
namespace {

using simulation::Ball;
using simulation::Bone;
using simulation::CutSite;
using simulation::MassPoint;

// distance between the mass points that are made for a caller's balls
constexpr double kPointSpacing_m = 0.75e-3;
constexpr double kMaxPoints = 50e6;  // most grid cells in a caller's balls; cells in two balls count twice
constexpr double kMaxSiteRadius_m = 10.0;
constexpr std::size_t kMaxBalls = 100'000'000;

bool AreFinite(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// Returns the caller's site; nothing if its radius is 0. @throws Failure if a value is out of range.
std::optional<CutSite> SiteOf(const OsteonBoneParams& params) {
  const auto& c = params.site_center_m;
  const auto& a = params.site_axis;
  if (params.site_radius_m == 0.0) return std::nullopt;
  const Vector3 axis(a[0], a[1], a[2]);
  const bool is_near = std::ranges::all_of(c, [](double x) { return std::abs(x) <= kMaxPosition_m; });
  if (!AreFinite({a[0], a[1], a[2]}) || !is_near || !(axis.stableNorm() > 1e-9) ||
      !(params.site_radius_m > 0.0 && params.site_radius_m <= kMaxSiteRadius_m))
    throw Failure(
        OSTEON_ERROR_ARGUMENT,
        fmt::format("site: found centre ({}, {}, {}), axis ({}, {}, {}), radius {} m; accepted a centre "
                    "within 1 km, an axis of any length but 0, a radius of 0 … 10 m",
                    c[0], c[1], c[2], a[0], a[1], a[2], params.site_radius_m));
  return CutSite{.center_m = Vector3(c[0], c[1], c[2]),
                 .axis = Vector3(axis.stableNormalized()),
                 .radius_m = params.site_radius_m};
}

/// Converts a caller's balls, each x y z r in mm. @throws Failure naming the ball that is not accepted.
std::vector<Ball> BallsFrom(const float* balls_mm, std::size_t count) {
  if (count == 0 || count > kMaxBalls)
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  fmt::format("ball_count: found {}, accepted 1 … {}", count, kMaxBalls));
  std::vector<Ball> balls(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float* b = balls_mm + 4 * i;
    const bool is_good =
        std::all_of(b, b + 3, [](float v) { return std::abs(v) <= 1e4F; }) && b[3] > 0.0F && b[3] <= 1e3F;
    if (!is_good)
      throw Failure(OSTEON_ERROR_ARGUMENT,
                    fmt::format("balls_mm: ball {}: found ({}, {}, {}) radius {} mm, accepted within 10 m, a "
                                "radius above 0 and up to 1 m",
                                i, b[0], b[1], b[2], b[3]));
    balls[i] = {.center_m = 1e-3 * Vector3(b[0], b[1], b[2]), .radius_m = 1e-3 * static_cast<double>(b[3])};
  }
  return balls;
}

/// Returns the points of a cubic grid that lie within any of the balls, sorted by z, then y, then x.
std::vector<MassPoint> PointsWithin(std::span<const Ball> balls) {
  double cells = 0.0;
  for (const Ball& ball : balls) cells += std::pow(2.0 * ball.radius_m / kPointSpacing_m + 1.0, 3.0);
  if (cells > kMaxPoints)
    throw Failure(
        OSTEON_ERROR_ARGUMENT,
        fmt::format("balls_mm: found {:.0f} million cells of 0.75 mm in them, accepted up to {:.0f}",
                    1e-6 * cells, 1e-6 * kMaxPoints));
  using Cell = std::tuple<std::int64_t, std::int64_t, std::int64_t>;  // z, y, x
  std::vector<Cell> inside;
  // first and last index of the grid's points between two coordinates
  const auto first = [](double low_m) {
    return static_cast<std::int64_t>(std::ceil(low_m / kPointSpacing_m));
  };
  const auto last = [](double high_m) {
    return static_cast<std::int64_t>(std::floor(high_m / kPointSpacing_m));
  };
  for (const Ball& ball : balls) {
    const Vector3 c = ball.center_m;
    const double r = ball.radius_m;
    for (std::int64_t z = first(c.z() - r); z <= last(c.z() + r); ++z)
      for (std::int64_t y = first(c.y() - r); y <= last(c.y() + r); ++y)
        for (std::int64_t x = first(c.x() - r); x <= last(c.x() + r); ++x) {
          const Vector3 p = kPointSpacing_m *
                            Vector3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
          if ((p - c).squaredNorm() <= r * r) inside.emplace_back(z, y, x);
        }
  }
  std::sort(inside.begin(), inside.end());
  inside.erase(std::unique(inside.begin(), inside.end()), inside.end());
  std::vector<MassPoint> points;
  points.reserve(inside.size());
  for (const auto& [z, y, x] : inside)
    points.push_back({.p_m = kPointSpacing_m *
                             Vector3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)),
                      .volume_m3 = std::pow(kPointSpacing_m, 3.0)});
  if (points.empty())
    throw Failure(OSTEON_ERROR_ARGUMENT, "balls_mm: found no mass point of 0.75 mm spacing in any ball");
  return points;
}

BoneSource FromBalls(const OsteonBoneParams& params) {
  BoneSource source;
  source.bone.name = "balls";
  source.bone.balls = BallsFrom(params.balls_mm, params.ball_count);
  source.bone.points = PointsWithin(source.bone.balls);
  source.bone.materials =
      FindMaterials(ConfigFolder(params.config_folder), {params.material ? params.material : "cancellous"});
  if (const auto site = SiteOf(params)) source.bone.site = *site;
  return source;
}

BoneSource FromPacking(const OsteonBoneParams& params) {
  const auto file = simulation::PackingFile::Open(params.packing_file);
  if (!file) throw Failure(OSTEON_ERROR_FILE, file.error().Text());
  if (file->points().empty())
    throw Failure(OSTEON_ERROR_FILE,
                  fmt::format("{}: found a packing without mass points, accepted one with them (osteon pack "
                              "without --no-points)",
                              params.packing_file));
  BoneSource source{.bone = file->ToBone(), .solid = nullptr, .events = {}, .warning = {}};
  if (const auto site = SiteOf(params)) source.bone.site = *site;
  return source;
}

// Packs the scene's own solid or, if the caller names a mesh file, that mesh with the scene's materials and
// packing; a mesh needs a site.
BoneSource FromSceneOrMesh(const OsteonBoneParams& params) {
  const std::filesystem::path config = ConfigFolder(params.config_folder);
  simulation::SceneParams scene =
      config::LoadScene(FindShipped(config, "scenes", params.scene ? params.scene : "acetabulum"));
  scene.materials = FindMaterials(config, scene.material_names);
  const auto site = SiteOf(params);
  simulation::SceneSolid solid;
  if (params.mesh_file) {
    if (!site)
      throw Failure(OSTEON_ERROR_ARGUMENT,
                    "site_radius_m: found 0, accepted the site's radius: a mesh needs one");
    const double scale = params.mesh_scale_mm == 0.0 ? 1.0 : params.mesh_scale_mm;
    if (!(std::isfinite(scale) && scale > 0.0))
      throw Failure(OSTEON_ERROR_ARGUMENT,
                    fmt::format("mesh_scale_mm: found {}, accepted above 0", params.mesh_scale_mm));
    auto loaded = simulation::LoadSceneSolid(params.mesh_file, scale, *site, scene);
    if (!loaded) throw Failure(OSTEON_ERROR_FILE, loaded.error().message);
    solid = std::move(*loaded);
  } else {
    solid = simulation::MakeSceneSolid(scene);
    if (site) solid.site = *site;
  }
  std::ranges::replace(solid.warning, '\n', ' ');
  return {.bone = simulation::PackScene(solid, scene),
          .solid = solid.solid,
          .events = scene.events,
          .warning = base::Utf8(base::Printable(solid.warning))};
}

}  // namespace

BoneSource MakeBone(const OsteonBoneParams& params) {
  const int sources = (params.mesh_file ? 1 : 0) + (params.packing_file ? 1 : 0) + (params.balls_mm ? 1 : 0);
  if (sources > 1)
    throw Failure(
        OSTEON_ERROR_ARGUMENT,
        fmt::format("bone: found {} of mesh_file, packing_file and balls_mm, accepted one", sources));
  if (params.balls_mm) return FromBalls(params);
  return params.packing_file ? FromPacking(params) : FromSceneOrMesh(params);
}

namespace {

// Loads a tool in the given size; 0: the size in the tool's file. If the tool has no such size, the error
// names diameter_m and the sizes that the tool has, in mm as in its file.
config::ToolConfig LoadSized(const std::filesystem::path& file, double diameter_m) try {
  return config::LoadTool(file, diameter_m == 0.0 ? std::nullopt : std::optional(diameter_m));
} catch (const config::ToolSizeError& error) {
  throw Failure(OSTEON_ERROR_ARGUMENT, fmt::format("diameter_m, in mm: {}", error.what()));
}

}  // namespace

ToolSource MakeTool(const OsteonToolParams& params) {
  if (params.balls_mm) {
    ToolSource source;
    source.tool.name = "balls";
    const std::vector<Ball> balls = BallsFrom(params.balls_mm, params.ball_count);
    for (std::size_t i = 0; i < balls.size(); ++i)
      source.tool.balls.push_back({.center_m = balls[i].center_m,
                                   .radius_m = balls[i].radius_m,
                                   .cutting = !params.cutting || params.cutting[i] != 0});
    return source;
  }
  if (!(std::isfinite(params.diameter_m) && params.diameter_m >= 0.0))
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  fmt::format("diameter_m: found {}, accepted 0 or a size of the tool", params.diameter_m));
  const auto file =
      FindShipped(ConfigFolder(params.config_folder), "tools", params.name ? params.name : "reamer");
  const config::ToolConfig loaded = LoadSized(file, params.diameter_m);
  ToolSource source{.tool = loaded.tool, .compliance = {}, .spindle_rad_per_s = loaded.spindle_rad_per_s};
  if (loaded.bending) {
    source.compliance = loaded.bending->compliance;
    source.relaxation_s = loaded.bending->relaxation_s;
  }
  return source;
}

}  // namespace osteon::plugin
