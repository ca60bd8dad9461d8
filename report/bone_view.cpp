#include "report/bone_view.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "report/page.h"
#include "report/page_scripts.h"
#include "report/svg_text.h"
#include "report/ticks.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/chunk_bytes.h"
#include "simulation/surface/dual_surface.h"
#include "simulation/surface/millimetres.h"
#include "simulation/surface/tool_sweep.h"

namespace osteon::report {
namespace {

constexpr double kMaxDeviation_um = 32'767.0;  // largest value of std::int16_t
constexpr int kTries = 5;  // number of grids that are tried, each coarser than the one before

/// Samples the uncut bone on a grid: its solid or, without one, the union of its balls. Null: there is no
/// ball.
std::shared_ptr<const surface::SolidField> FieldOf(const simulation::Bone& bone,
                                                   const simulation::Solid* solid, float voxel_mm) {
  if (solid != nullptr) return surface::SampleSolid(*solid, voxel_mm);
  simulation::Bone finite;  // the bone's finite balls and nothing else
  for (const simulation::Ball& ball : bone.balls)
    if (Vector3(ball.center_m).allFinite() && ball.radius_m > 0.0) finite.balls.push_back(ball);
  if (finite.balls.empty()) return nullptr;
  return surface::UnionOfBalls(finite, voxel_mm);
}

/// Returns the deepest pose of a tool's path, and that pose moved out along the site's axis; empty if the
/// tool cannot cut or its path is empty.
std::vector<Pose> DeepestAndOut(const simulation::Bone& bone, const simulation::ToolPath& path) {
  const simulation::ToolBall* head = simulation::CuttingHead(*path.tool);
  const Vector3 axis = Vector3(bone.site.axis).normalized();
  const Pose* deepest = nullptr;
  double depth_m = 0.0;
  for (const Pose& X : path.X_GP) {
    if (head == nullptr || !X.matrix().allFinite()) continue;
    const double height_m = (X * Vector3(head->center_m) - Vector3(bone.site.center_m)).dot(axis);
    if (deepest != nullptr && height_m >= depth_m) continue;
    deepest = &X;
    depth_m = height_m;
  }
  if (deepest == nullptr || !axis.allFinite()) return {};
  constexpr double kOut_m = 0.5;  // distance that is clear of every bone
  std::vector<Pose> way(2, *deepest);
  way[1].translation() += kOut_m * axis;
  return way;
}

/// Returns the ideal cavity: the space that the tools sweep if each moves straight out from its deepest pose.
simulation::SweptTool IdealCavity(const simulation::Bone& bone, std::span<const simulation::ToolPath> paths) {
  std::vector<std::vector<Pose>> deepest;
  std::vector<simulation::ToolPath> straight;
  deepest.reserve(paths.size());
  for (const simulation::ToolPath& path : paths) {
    deepest.push_back(DeepestAndOut(bone, path));
    straight.push_back({.tool = path.tool, .X_GP = deepest.back()});
  }
  return simulation::SweptTool(straight);
}

/// Signed distance of a point from the planned or ideal cavity [m].
using DistanceTo = std::function<double(const Vector3&)>;
/// Returns the distance function of the cavity with which cut faces are compared: of the planned cavity or,
/// without a plan, of the ideal one. Empty: no tool cuts, or there is no path.
DistanceTo DistanceToCavity(const CarveInput& input) {
  auto ideal = std::make_shared<const simulation::SweptTool>(IdealCavity(input.bone, input.paths));
  if (ideal->empty()) return {};
  if (input.planned) return input.planned;
  return [ideal](const Vector3& p_m) { return ideal->SignedDistance(p_m); };
}

/// Extracts the carved surface as the page's bytes, with the deviation of each vertex on a cut face.
CarvedSurface ExtractForPage(const surface::CarvedField& field, const MaterialMap& materials,
                             const DistanceTo& distance_m) {
  CarvedSurface out{.layout = field.layout()};
  const auto material = [&materials](surface::Vec3 p_mm) {
    return static_cast<std::uint8_t>(materials.At(surface::ToMetres(p_mm)).value_or(0));
  };
  std::vector<ErrorSample> samples;
  surface::SurfaceChunk chunk, sent;
  for (surface::BrickIndex brick = 0; brick < out.layout.Count(); ++brick) {
    surface::ExtractChunk(field, brick, chunk, {}, material);
    if (chunk.quads.empty()) continue;
    out.quads += chunk.quads.size() / 4;
    const std::size_t begin = out.chunks.size();
    surface::AppendChunk(out.layout, chunk, out.chunks);
    if (!distance_m) continue;
    // read the chunk back as the page's script will, because the deviations must be those of the vertices in
    // these bytes
    if (!surface::ReadChunk(out.layout, std::span(out.chunks).subspan(begin), sent)) continue;
    for (const surface::SurfaceVertex& vertex : sent.vertices) {
      if (!vertex.cut) continue;
      const double error_m = distance_m(surface::ToMetres(vertex.p_mm));
      samples.push_back({.error_m = error_m});
      out.deviation_um.push_back(static_cast<std::int16_t>(
          std::lround(std::clamp(1e6 * error_m, -kMaxDeviation_um, kMaxDeviation_um))));
    }
  }
  out.error = SummarizeErrors(samples);
  return out;
}

/// Extracts the field's surface; nothing if it has more than `max_quads` quads.
std::optional<BoneMesh> MeshOf(const surface::CarvedField& field, std::size_t max_quads) {
  BoneMesh mesh;
  surface::SurfaceChunk chunk;
  for (surface::BrickIndex brick = 0; brick < field.layout().Count(); ++brick) {
    surface::ExtractChunk(field, brick, chunk);
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (const surface::SurfaceVertex& vertex : chunk.vertices) {
      mesh.vertices_m.emplace_back(surface::ToMetres(vertex.p_mm).cast<float>());
      mesh.normals.emplace_back(vertex.normal.x, vertex.normal.y, vertex.normal.z);
    }
    for (std::size_t i = 0; i + 3 < chunk.quads.size(); i += 4) {
      const auto corner = [&](std::size_t k) { return first + chunk.quads[i + k]; };
      mesh.triangles.push_back({corner(0), corner(1), corner(2)});
      mesh.triangles.push_back({corner(0), corner(2), corner(3)});
    }
    if (mesh.triangles.size() > 2 * max_quads) return std::nullopt;
  }
  return mesh;
}

/// Carves with many capsules per call, because each call visits all bricks. The number per call is limited,
/// because each brick is checked against all capsules of the call.
void CarveInBatches(surface::CarvedField& field, std::span<const surface::Capsule> capsules) {
  constexpr std::size_t kBatch = 4096;  // capsules
  for (std::size_t at = 0; at < capsules.size(); at += kBatch)
    field.Carve(capsules.subspan(at, std::min(kBatch, capsules.size() - at)));
}

/// Collects the capsules of all tools; the order in which they carve a field does not matter.
std::vector<surface::Capsule> CapsulesOf(std::span<const simulation::ToolPath> paths) {
  std::vector<surface::Capsule> capsules;
  for (const simulation::ToolPath& path : paths) {
    const std::vector<surface::Capsule> swept = CapsulesAlong(path);
    capsules.insert(capsules.end(), swept.begin(), swept.end());
  }
  return capsules;
}

/// Makes a "data:" URL that contains the bytes.
std::string DataAddress(const std::vector<std::uint8_t>& bytes) {
  return "data:application/octet-stream;base64," + Base64(bytes);
}

/// Returns "#rrggbb" for a colour with components 0 … 1.
std::string Hex(const Vector3& color) {
  const auto byte = [](double x) { return static_cast<int>(std::lround(255.0 * std::clamp(x, 0.0, 1.0))); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(color.x()), byte(color.y()), byte(color.z()));
}

/// Makes the button that selects a colouring of the view. @param what  "tissue" or "deviation", for the
/// script
std::string ShowButton(const char* what, const char* text, bool pressed) {
  return fmt::format("<button type=\"button\" data-show=\"{}\" aria-pressed=\"{}\">{}</button>\n", what,
                     pressed, text);
}

/// Returns the deviation at the end of the colour scale: rounded, and at least 0.1 mm.
double ColorRange_mm(const CavityError& error) {
  constexpr double kMinRange_mm = 0.1;
  return NiceRange({0.0, std::max(kMinRange_mm, 1e3 * error.p95_m)}, 3).max;
}

}  // namespace

std::vector<surface::Capsule> CapsulesAlong(const simulation::ToolPath& path) {
  surface::ToolSweep sweep(*path.tool, Pose::Identity());
  std::vector<surface::Capsule> capsules;
  std::uint64_t frame = 0;
  const auto append_swept = [&] {
    const std::vector<surface::Capsule> swept = sweep.TakeCapsules();
    capsules.insert(capsules.end(), swept.begin(), swept.end());
  };
  for (const Pose& X : path.X_GP) {
    if (!X.matrix().allFinite()) continue;
    if (sweep.Add({.X_WP = X, .p_WS_m = X.translation(), .cuts = true, .frame = ++frame})) append_swept();
  }
  append_swept();
  return capsules;
}

void CarveAlong(surface::CarvedField& field, const simulation::ToolPath& path) {
  CarveInBatches(field, CapsulesAlong(path));
}

void CarveAlong(surface::CarvedField& field, std::span<const simulation::ToolPath> paths) {
  for (const simulation::ToolPath& path : paths) CarveAlong(field, path);
}

BoneMeshes MeshBone(const CarveInput& input) {
  if (input.paths.empty()) return {};
  const std::vector<surface::Capsule> capsules = CapsulesOf(input.paths);
  float voxel_mm = surface::VoxelFor(*input.paths.back().tool);
  for (int i = 0; i < kTries; ++i, voxel_mm *= 1.5F) {
    try {
      const auto uncut = FieldOf(input.bone, input.solid, voxel_mm);
      if (uncut == nullptr) return {};
      surface::CarvedField field(uncut);
      auto before = MeshOf(field, input.max_quads);
      if (!before) continue;
      CarveInBatches(field, capsules);
      if (auto after = MeshOf(field, input.max_quads))
        return {.before = std::move(*before), .after = std::move(*after)};
    } catch (const std::invalid_argument&) {  // the grid is too large for the memory: try a coarser one
    }
  }
  return {};
}

CarvedSurface CarveSurface(const CarveInput& input) {
  if (input.paths.empty()) return {};
  const DistanceTo distance_m = DistanceToCavity(input);
  constexpr double kCoarser = 1.1;  // margin: factor on the voxel size that is expected to give max_quads
  float voxel_mm = surface::VoxelFor(*input.paths.back().tool);
  const std::vector<surface::Capsule> capsules = CapsulesOf(input.paths);
  CarvedSurface carved;
  for (int i = 0; i < kTries; ++i) {
    try {
      const auto uncut = FieldOf(input.bone, input.solid, voxel_mm);
      if (uncut == nullptr) return {};
      surface::CarvedField field(uncut);
      CarveInBatches(field, capsules);
      carved = ExtractForPage(field, input.materials, distance_m);
      carved.planned = static_cast<bool>(input.planned);
      if (carved.quads <= input.max_quads) return carved;
      // the number of quads is inversely proportional to the square of the voxel size
      voxel_mm *= static_cast<float>(
          kCoarser * std::sqrt(static_cast<double>(carved.quads) / static_cast<double>(input.max_quads)));
    } catch (const std::invalid_argument&) {  // the grid is too large for the memory
      voxel_mm *= 2.0F;
    }
  }
  return {};
}

std::string BoneViewHtml(const CarvedSurface& carved, const simulation::Bone& bone,
                         const RenderParams& params, const BoneViewStart& start) {
  if (carved.chunks.empty()) return {};
  const auto triple = [](const Vector3& v) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", v.x(), v.y(), v.z());
  };
  std::string colors = Hex(MaterialColor(bone, 0));
  for (std::size_t i = 1; i < bone.materials.size(); ++i)
    colors += " " + Hex(MaterialColor(bone, static_cast<simulation::MaterialIndex>(i)));
  std::vector<std::uint8_t> deviation(2 * carved.deviation_um.size());
  if (!deviation.empty()) std::memcpy(deviation.data(), carved.deviation_um.data(), deviation.size());
  const double range_mm = start.range_mm > 0.0 ? start.range_mm : ColorRange_mm(carved.error);
  const surface::BrickLayout& layout = carved.layout;
  const bool compares = !carved.deviation_um.empty(), deviates = compares && start.shows_deviation;

  std::string html = "<figure class=\"turn\" hidden=\"hidden\">\n";
  html += fmt::format(
      "<canvas tabindex=\"0\" role=\"img\" aria-label=\"The carved bone, to be turned\" data-layout=\"{:.9g} "
      "{:.9g} {:.9g} {:.9g} {} {} {}\" data-centre=\"{}\" data-axis=\"{}\" data-reach=\"{:.4g}\" "
      "data-tilt=\"{:.4g}\" data-turn=\"{:.4g}\" data-range=\"{:.6g}\" data-colours=\"{}\" "
      "data-surface=\"{}\" data-deviation=\"{}\" data-first=\"{}\"></canvas>\n",
      layout.origin_mm.x, layout.origin_mm.y, layout.origin_mm.z, layout.voxel_mm, layout.bricks[0],
      layout.bricks[1], layout.bricks[2], triple(1e3 * Vector3(bone.site.center_m)), triple(bone.site.axis),
      1e3 * SiteReach(bone, 0.75 * params.reach_in_cup_radii), params.tilt_rad, params.turn_rad,
      1e3 * range_mm, colors, DataAddress(carved.chunks), compares ? DataAddress(deviation) : "",
      deviates ? "deviation" : "tissue");
  html += "<div class=\"bar\">\n" + ShowButton("tissue", "Tissue", !deviates);
  if (compares)
    html += ShowButton("deviation", carved.planned ? "Deviation from the plan" : "Deviation", deviates);
  html += "<button type=\"button\">Reset the view</button>\n";
  if (compares)
    html += fmt::format(
        "<span class=\"scale\" data-with=\"deviation\"{}>bone left {} mm <i></i> {} mm removed "
        "beyond</span>\n",
        deviates ? "" : " hidden=\"hidden\"", Number(range_mm, 2), Number(range_mm, 2));
  html += "</div>\n";
  std::string caption = fmt::format(
      "The bone after the run, its solid less what the tool's cutting parts swept; {} triangles. "
      "Drag to turn, wheel or two fingers to zoom, Shift and drag to move; arrow keys turn as well.",
      Number(2.0 * static_cast<double>(carved.quads), 0));
  if (compares)
    caption +=
        carved.planned
            ? " Deviation: distance of the cut faces from the planned cavity, which is what the last "
              "tool clears at its planned place and on its way in along the plan's axis. Grey: not cut."
            : " Deviation: distance of the cut faces from the tool's ideal cavity, which is what the tool "
              "leaves if it is drawn straight out along the site's axis from its deepest pose. There is "
              "no plan to compare with.";
  return html + "<figcaption>" + Escape(caption) + "</figcaption>\n</figure>\n" + ScriptHtml(kBoneViewScript);
}

}  // namespace osteon::report
