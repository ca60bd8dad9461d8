#include "config/reading/load_tool.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "config/reading/sections/read_pose.h"
#include "config/reading/strict/reader.h"
#include "simulation/tools/tool_kinds.h"
#include "simulation/tools/tool_mesh.h"

namespace osteon::config {
namespace {

using simulation::BallParams;
using simulation::BuiltTool;
using simulation::HolderParams;

constexpr double kSameSize_m = 1e-9;  // diameters that differ by less are the same size

// The sizes that a tool comes in, and the requested one.
struct Sizes {
  std::vector<double> diameters_m;
  double default_m{0.0};
  std::string accepted;      // the accepted sizes as a text
  std::vector<Reader> rows;  // one for each size, if the file lists them
};

// Returns the requested diameter [m], or the default one. Refuses a default that is no size of the tool.
// @throws ToolSizeError if the requested diameter is no size of the tool
double ChooseSize(const Reader& reader, const Sizes& sizes, const std::optional<double>& requested_m) {
  const auto is_listed = [&](double size_m) {
    return std::any_of(sizes.diameters_m.begin(), sizes.diameters_m.end(),
                       [&](double d) { return std::abs(d - size_m) < kSameSize_m; });
  };
  if (!is_listed(sizes.default_m))
    reader.Refuse("default_diameter_mm",
                  fmt::format("found {:.10g}, accepted {}", sizes.default_m / kMillimetre_m, sizes.accepted));
  if (!requested_m) return sizes.default_m;
  if (!is_listed(*requested_m))
    throw ToolSizeError(
        fmt::format("found {:.10g}, accepted {}", *requested_m / kMillimetre_m, sizes.accepted));
  return *requested_m;
}

// Reads sizes from a first to a last one in equal steps, e.g. 36 … 68 mm in steps of 1 mm.
Sizes ReadSteps(Reader& reader, double min_mm, double max_mm) {
  Sizes sizes;
  Reader section = reader.Section("diameters");
  const double from_m = section.Number("from_mm", min_mm, max_mm),
               to_m = section.Number("to_mm", min_mm, max_mm), step_m = section.Number("step_mm", 0.1, 10);
  sizes.default_m = reader.Number("default_diameter_mm", min_mm, max_mm);
  reader.Finish();
  const double steps = (to_m - from_m) / step_m;
  if (steps < 0.0 || std::abs(steps - std::round(steps)) > 1e-6)
    section.Refuse("to_mm",
                   fmt::format("found {:.10g}, accepted {:.10g} and whole steps of {:.10g} from there",
                               to_m / kMillimetre_m, from_m / kMillimetre_m, step_m / kMillimetre_m));
  for (int i = 0; i <= static_cast<int>(std::lround(steps)); ++i)
    sizes.diameters_m.push_back(from_m + i * step_m);
  sizes.accepted = fmt::format("{:.10g} … {:.10g} in steps of {:.10g}", from_m / kMillimetre_m,
                               to_m / kMillimetre_m, step_m / kMillimetre_m);
  return sizes;
}

// Reads a list with a row for each size. For each row, reads the diameter, then calls `read` for the other
// keys.
template <typename ReadRow>
Sizes ReadRows(Reader& reader, double min_mm, double max_mm, const ReadRow& read) {
  Sizes sizes;
  sizes.rows = reader.Sections("sizes", 1, 100);
  for (Reader& row : sizes.rows) {
    sizes.diameters_m.push_back(row.Number("diameter_mm", min_mm, max_mm));
    read(row);
    sizes.accepted += fmt::format("{}{:.10g}", sizes.accepted.empty() ? "" : ", ",
                                  sizes.diameters_m.back() / kMillimetre_m);
  }
  sizes.default_m = reader.Number("default_diameter_mm", min_mm, max_mm);
  return sizes;
}

// Index of a diameter among the sizes. ChooseSize has checked that the diameter is a size.
std::size_t RowOf(const Sizes& sizes, double diameter_m) {
  for (std::size_t i = 0; i < sizes.diameters_m.size(); ++i)
    if (std::abs(sizes.diameters_m[i] - diameter_m) < kSameSize_m) return i;
  return 0;
}

HolderParams ReadHolder(Reader section) {
  static_cast<void>(section.Text("source"));
  return {.radius_m = section.Number("radius_mm", 1, 200),
          .length_m = section.Number("length_mm", 1, 500),
          .density_kg_per_m3 = section.Number("density_g_per_cm3", 0.1, 25)};
}

double ReadDensity(Reader& reader) { return reader.Number("density_g_per_cm3", 0.1, 25); }

// Calls `build`. If `build` refuses its input, reports the error at the key's line of the file.
template <typename Build>
BuiltTool BuildTool(const Reader& reader, const std::string& key, const Build& build) {
  try {
    return build();
  } catch (const std::invalid_argument& error) {
    reader.Refuse(key, error.what());
  }
}

// Each Load function below reads the keys of one kind of tool and builds the tool in the requested size.

BuiltTool LoadReamer(Reader& reader, const std::optional<double>& diameter_m) {
  simulation::ReamerParams params;
  params.shell_m = reader.Section("head").Number("shell_mm", 0.1, 50);
  Reader shaft = reader.Section("shaft");
  params.shaft_radius_m = shaft.Number("radius_mm", 0.5, 50);
  params.shaft_length_m = shaft.Number("length_mm", 0, 500);
  params.touching_length_m = shaft.Number("touching_mm", 0, 500);
  params.density_kg_per_m3 = ReadDensity(reader);
  params.holder = ReadHolder(reader.Section("holder"));
  const Sizes sizes = ReadSteps(reader, 2, 200);

  // the shaft must be thinner than the smallest head
  const double min_radius_m = 0.5 * sizes.diameters_m.front();
  if (params.shaft_radius_m >= min_radius_m)
    shaft.Refuse("radius_mm",
                 fmt::format("found {:.10g}, accepted less than the smallest head's {:.10g}",
                             params.shaft_radius_m / kMillimetre_m, min_radius_m / kMillimetre_m));
  params.diameter_m = ChooseSize(reader, sizes, diameter_m);
  return BuildTool(reader, "head", [&] { return simulation::MakeReamer(params); });
}

BuiltTool LoadBurr(Reader& reader, const std::optional<double>& diameter_m) {
  simulation::BurrParams params;
  params.shape = static_cast<simulation::BurrShape>(
      reader.Choice("shape", {"round", "pear", "cylinder", "taper", "flat_cylinder"}));
  const bool has_length = params.shape != simulation::BurrShape::kRound;
  const bool has_tip = params.shape == simulation::BurrShape::kTaper;
  struct Row {
    double neck_m, head_m, tip_m;
  };
  std::vector<Row> rows;
  const Sizes sizes = ReadRows(reader, 0.2, 50, [&](Reader& row) {
    rows.push_back({.neck_m = row.Number("neck_mm", 0.1, 50),
                    .head_m = has_length ? row.Number("head_length_mm", 0.2, 200) : 0.0,
                    .tip_m = has_tip ? row.Number("tip_mm", 0.1, 50) : 0.0});
  });
  params.neck_length_m = reader.Number("neck_length_mm", 0, 200);
  Reader shank = reader.Section("shank");
  params.shank_diameter_m = shank.Number("diameter_mm", 0.5, 50);
  static_cast<void>(shank.Text("source"));
  params.length_m = reader.Number("length_mm", 1, 300);
  params.density_kg_per_m3 = ReadDensity(reader);
  Reader balls = reader.Section("balls");
  const double cutting_ratio = balls.Number("cutting_gap_ratio", 0.001, 0.5);
  params.balls.touching_gap_m = balls.Number("touching_gap_mm", 0.001, 5);
  params.balls.max_count = static_cast<std::size_t>(balls.WholeNumber("max_count", 1, 10'000));
  params.holder = ReadHolder(reader.Section("holder"));
  reader.Finish();

  params.diameter_m = ChooseSize(reader, sizes, diameter_m);
  const std::size_t which = RowOf(sizes, params.diameter_m);
  const Row& row = rows[which];
  params.neck_diameter_m = row.neck_m;
  params.head_length_m = row.head_m;
  params.tip_diameter_m = row.tip_m;
  params.balls.cutting_gap_m = cutting_ratio * params.diameter_m;
  return BuildTool(sizes.rows[which], "diameter_mm", [&] { return simulation::MakeBurr(params); });
}

BuiltTool LoadTwistDrill(Reader& reader, const std::optional<double>& diameter_m) {
  simulation::TwistDrillParams params;
  struct Row {
    double flute_m, length_m;
  };
  std::vector<Row> rows;
  const Sizes sizes = ReadRows(reader, 0.5, 50, [&](Reader& row) {
    rows.push_back({.flute_m = row.Number("flute_mm", 1, 500), .length_m = row.Number("length_mm", 1, 500)});
  });
  params.point_rad = reader.Number("point_deg", 60, 175);
  params.flute_metal_ratio = reader.Number("flute_metal_ratio", 0.05, 1);
  params.density_kg_per_m3 = ReadDensity(reader);
  Reader balls = reader.Section("balls");
  const double point_ratio = balls.Number("point_gap_ratio", 0.001, 0.5),
               flute_ratio = balls.Number("flute_gap_ratio", 0.001, 0.5),
               shank_ratio = balls.Number("shank_gap_ratio", 0.001, 0.5);
  params.balls.max_count = static_cast<std::size_t>(balls.WholeNumber("max_count", 1, 10'000));
  params.holder = ReadHolder(reader.Section("holder"));
  reader.Finish();

  params.diameter_m = ChooseSize(reader, sizes, diameter_m);
  const std::size_t which = RowOf(sizes, params.diameter_m);
  const Row& row = rows[which];
  params.flute_length_m = row.flute_m;
  params.length_m = row.length_m;
  params.balls.cutting_gap_m = point_ratio * params.diameter_m;
  params.flute_gap_m = flute_ratio * params.diameter_m;
  params.balls.touching_gap_m = shank_ratio * params.diameter_m;
  return BuildTool(sizes.rows[which], "diameter_mm", [&] { return simulation::MakeTwistDrill(params); });
}

BuiltTool LoadMeshTool(Reader& reader, const std::optional<double>& diameter_m) {
  simulation::MeshToolParams params;
  params.name = reader.Text("name");
  const std::filesystem::path file = reader.File("mesh");
  const double scale = reader.Number("scale_ratio", 1e-3, 1e3);
  const Pose X_TM = ReadPose(reader.Section("mesh_in_tool"));
  Reader cutting = reader.Section("cutting");
  params.cutting_back_z_m = cutting.Number("from_z_mm", -1000, 0);
  params.cutting_front_z_m = cutting.Number("to_z_mm", -1000, 1);
  params.density_kg_per_m3 = ReadDensity(reader);
  Reader balls = reader.Section("balls");
  params.balls.cutting_gap_m = balls.Number("cutting_gap_mm", 0.001, 5);
  params.balls.touching_gap_m = balls.Number("touching_gap_mm", 0.001, 5);
  params.balls.max_count = static_cast<std::size_t>(balls.WholeNumber("max_count", 1, 10'000));
  params.holder = ReadHolder(reader.Section("holder"));
  reader.Finish();
  if (diameter_m) throw ToolSizeError("found a diameter, accepted none: this tool comes in one size");
  if (params.cutting_back_z_m >= params.cutting_front_z_m)
    cutting.Refuse("to_z_mm", fmt::format("found {:.10g}, accepted more than from_z_mm ({:.10g})",
                                          params.cutting_front_z_m / kMillimetre_m,
                                          params.cutting_back_z_m / kMillimetre_m));

  auto loaded = simulation::LoadMesh(file);
  if (!loaded) reader.Refuse("mesh", loaded.error().message);
  for (Vector3& vertex : loaded->mesh.vertices_m) vertex = X_TM * (scale * vertex);
  return BuildTool(reader, "mesh", [&] { return simulation::MakeMeshTool(loaded->mesh, params); });
}

// The keys of a tool's section `bending`.
struct BendingSection {
  Reader section;
  simulation::BeamParams beam;
  double relaxation_s{0.0};
};

std::optional<BendingSection> ReadBending(Reader& tool) {
  if (!tool.Has("bending")) return std::nullopt;
  Reader section = tool.Section("bending");
  static_cast<void>(section.Text("source"));
  const simulation::BeamParams beam{.youngs_Pa = section.Number("youngs_GPa", 0.1, 1000),
                                    .poisson = section.Number("poisson_ratio", 0, 0.49),
                                    .clamped_m = section.Number("clamped_mm", 0, 500)};
  const double relaxation_s = section.Number("relaxation_ms", 1, 10'000);
  return BendingSection{.section = section, .beam = beam, .relaxation_s = relaxation_s};
}

// Computes how a tool bends: as a cantilever made of its pieces, clamped at its back.
ToolBendingConfig BendingOf(const BendingSection& read, const BuiltTool& built) {
  if (built.beam.empty())
    read.section.Refuse("source",
                        "found bending of a tool whose beam is not known (a mesh), accepted without it");
  simulation::BeamParams params = read.beam;
  params.load_point_m = built.load_point_m;
  params.head_mass_kg = built.head_mass_kg;
  try {
    return {.compliance = simulation::CantileverCompliance(built.beam, params),
            .relaxation_s = read.relaxation_s};
  } catch (const std::invalid_argument& error) {
    read.section.Refuse("clamped_mm", error.what());
  }
}

ToolDriveConfig ReadDrive(Reader section) {
  static_cast<void>(section.Text("source"));
  return {.gear_ratio = section.Number("gear_ratio", 0.1, 1000),
          .rated_torque_Nm = section.Number("rated_torque_Nm", 0.001, 100),
          .spin_up_s = section.Number("spin_up_s", 0.01, 10)};
}

}  // namespace

ToolConfig LoadTool(const std::filesystem::path& path, const std::optional<double>& diameter_m) {
  Reader reader = Reader::Load(path);
  ToolConfig config;
  const std::size_t kind = reader.Choice("kind", {"hemispherical_reamer", "burr", "twist_drill", "mesh"});
  static_cast<void>(reader.Text("source"));
  config.spindle_rad_per_s = reader.Number("spindle_rpm", 1, 400'000);
  config.drive = ReadDrive(reader.Section("drive"));
  const Pose X_FH = ReadPose(reader.Section("mounting"));
  const std::optional<BendingSection> bending = ReadBending(reader);
  const auto edges =
      static_cast<std::uint8_t>(reader.Has("edge_count") ? reader.WholeNumber("edge_count", 1, 200) : 0);
  BuiltTool built;
  switch (kind) {  // the numbers follow the order of the words above
    case 0:
      built = LoadReamer(reader, diameter_m);
      break;
    case 1:
      built = LoadBurr(reader, diameter_m);
      break;
    case 2:
      built = LoadTwistDrill(reader, diameter_m);
      break;
    default:
      built = LoadMeshTool(reader, diameter_m);
  }
  if (bending) config.bending = BendingOf(*bending, built);
  config.tool = std::move(built.tool);
  for (simulation::ToolBall& ball : config.tool.balls)
    if (ball.cutting) ball.edges = edges;
  config.X_FT = X_FH * Eigen::Translation3d(0, 0, built.length_m);
  return config;
}

}  // namespace osteon::config
