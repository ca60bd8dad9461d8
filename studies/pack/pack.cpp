#include "studies/pack/pack.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/parallel.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "session/summary/summary.h"
#include "simulation/packing/disjoint_packing.h"
#include "simulation/packing/packing_export.h"
#include "studies/pack/pack_report.h"
#include "studies/pack/pack_result.h"

namespace osteon::studies {
namespace {

bool HasExtension(const std::filesystem::path& path, const char* extension) {
  return path.extension() == extension;
}

// Checks the output paths before any work is done. @returns the error; empty if the paths are usable
std::string WrongPlace(const PackOptions& options) {
  std::error_code error;
  if (options.outputs.empty()) return "-o: found no file, accepted FILE.osp, FILE.ply or FILE.csv";
  for (const auto& output : options.outputs) {
    if (!HasExtension(output, ".osp") && !HasExtension(output, ".ply") && !HasExtension(output, ".csv"))
      return fmt::format("-o {}: found extension \"{}\", accepted .osp (packing), .ply, .csv (spheres)",
                         output.string(), output.extension().string());
    if (std::filesystem::is_directory(output, error))
      return fmt::format("-o {}: found a folder, accepted a file", output.string());
    if (std::string wrong = session::ValidateParentFolder("-o", output); !wrong.empty()) return wrong;
    if (std::filesystem::equivalent(output, options.source.input, error))
      return fmt::format("-o {}: found the input, accepted another file", output.string());
  }
  if (std::string wrong = session::ValidateOutputFolder("--report", options.report); !wrong.empty())
    return wrong;
  return session::ValidateParentFolder("--json", options.json);
}

/// Default spacing of the mass points: evenly spaced, there are about 200 000 points. If the packing is finer
/// in a cut zone, the spacing in the zone is at most 0.75 mm.
simulation::MassPointParams PointParams(const PackOptions& options, const session::PackSource& source,
                                        double volume_m3) {
  constexpr double kPoints = 200'000.0, kFinest_m = 0.1e-3, kCoarsest_m = 3e-3, kMaxAtZone_m = 0.75e-3;
  simulation::MassPointParams params;
  if (source.own && source.site.radius_m > 0.0)
    params = source.own->points;
  else {
    double spacing_m = std::clamp(std::cbrt(volume_m3 / kPoints), kFinest_m, kCoarsest_m);
    if (!source.zone_is_uniform) spacing_m = std::min(spacing_m, kMaxAtZone_m);
    params.cells.finest_m = spacing_m;
  }
  params.threads = options.threads;
  if (options.point_spacing_mm) params.cells.finest_m = 1e-3 * *options.point_spacing_mm;
  if (source.zone_is_uniform) params.cells.coarser_from_m.clear();
  return params;
}

// Packs the solid with disjoint or overlapping balls. The parameters are those of the scene, unless options
// replace them.
std::vector<simulation::Ball> Pack(const PackOptions& options, const session::PackSource& source) {
  const double r_min_m = 1e-3 * options.r_min_mm.value_or(0.0),
               r_max_m = 1e-3 * options.r_max_mm.value_or(0.0);
  if (options.disjoint) {
    simulation::DisjointParams params{.seed = options.seed, .threads = options.threads};
    if (options.count) params.count = *options.count;
    if (options.r_min_mm) params.min_radius_m = r_min_m;
    if (options.r_max_mm) params.max_radius_m = r_max_m;
    params.grade = options.grade.value_or(0.0);
    return simulation::BuildDisjointPacking(*source.solid, *source.zone, params);
  }
  const bool as_the_scene_says =
      source.own && !options.count && !options.r_min_mm && !options.r_max_mm && !options.grade;
  if (as_the_scene_says) {
    simulation::PackingParams params = source.own->packing;
    params.seed = options.seed;
    params.threads = options.threads;
    return simulation::BuildPacking(*source.solid, *source.zone, params);
  }
  return simulation::BuildPacking(*source.solid, *source.zone,
                                  simulation::OverlapParamsFor(*source.solid, *source.zone,
                                                               {.count = options.count.value_or(0),
                                                                .min_radius_m = r_min_m,
                                                                .max_radius_m = r_max_m,
                                                                .grade = options.grade.value_or(0.0),
                                                                .seed = options.seed,
                                                                .threads = options.threads}));
}

/// The parameters that determined the result, and the result's quality, as the file's provenance.
simulation::PackingProvenance Provenance(const PackOptions& options, const session::PackSource& source,
                                         const PackResult& result) {
  simulation::PackingProvenance provenance = source.provenance;
  provenance.program = "osteon " OSTEON_VERSION;
  auto& parameters = provenance.parameters;
  parameters.emplace_back("mode", result.mode);
  const auto add_if_given = [&parameters](const char* key, const auto& value) {
    if (value) parameters.emplace_back(key, fmt::format("{}", *value));
  };
  add_if_given("count", options.count);
  add_if_given("r_min_mm", options.r_min_mm);
  add_if_given("r_max_mm", options.r_max_mm);
  add_if_given("grade", options.grade);
  parameters.emplace_back("seed", fmt::format("{}", options.seed));
  if (options.points)
    parameters.emplace_back("point_spacing_mm", fmt::format("{}", result.point_params.cells.finest_m * 1e3));
  for (auto& measured : QualityParameters(result.quality)) parameters.push_back(std::move(measured));
  return provenance;
}

// Mass and inertia of the mass points, with every material at 1000 kg/m³.
simulation::MassProperties EvenMass(const simulation::Bone& bone) {
  std::vector<simulation::Material> even = bone.materials;
  for (simulation::Material& material : even) material.density_kg_per_m3 = 1000.0;
  return simulation::PointMassProperties(bone.points, even);
}

// Writes each output in the format of its extension, then the JSON; stops early after Ctrl-C.
tl::expected<void, std::string> WriteOutputs(const PackOptions& options, const PackResult& result) {
  for (const auto& output : options.outputs) {
    const auto written = HasExtension(output, ".osp")
                             ? simulation::WritePackingFile(output, result.bone, result.provenance)
                         : HasExtension(output, ".ply") ? simulation::WritePly(output, result.bone.balls)
                                                        : simulation::WriteCsv(output, result.bone.balls);
    if (!written) return tl::make_unexpected(written.error().Text());
    if (base::Interrupted()) return {};
  }
  if (!options.json.empty()) return base::WriteText(options.json, ToJson(result));
  return {};
}

// Writes report.html into the report's folder.
tl::expected<void, std::string> WriteReportOf(const PackOptions& options, const session::PackSource& source,
                                              const PackResult& result,
                                              const std::vector<base::PhaseProgress::Phase>& phases) {
  std::vector<report::SummaryRow> times;
  for (const auto& phase : phases)
    times.push_back({"time: " + phase.name, fmt::format("{:.2f} s", phase.seconds)});
  const bool good = KeepsTolerances(result);
  return WritePackReport({.verdict = good ? "within the tolerances" : "out of the tolerances",
                          .good = good,
                          .summary = Rows(result),
                          .bone = result.bone,
                          .quality = result.quality,
                          .solid = *source.solid,
                          .zone = *source.zone,
                          .point_params = result.point_params,
                          .mass = result.mass,
                          .even_points = result.even_points,
                          .even_solid = result.even_solid,
                          .provenance = result.provenance,
                          .times = std::move(times),
                          .command_line = options.command_line,
                          .version = OSTEON_VERSION,
                          .threads = options.threads},
                         options.report / "report.html");
}

void PrintTable(const PackResult& result) {
  fmt::print("Osteon pack: {}\n", result.bone.name);
  for (const report::SummaryRow& row : Rows(result)) fmt::print("  {:<30} {}\n", row.key, row.value);
}

/// Saves a packing file in other formats. @returns the process's exit code
int Convert(const PackOptions& options) {
  if (!options.packing_options.empty())
    return session::Fail("pack", fmt::format("{}: found with a packing file, accepted with a mesh or shape",
                                             options.packing_options.front()));
  if (!options.report.empty())
    return session::Fail("pack", "--report: found with a packing file, accepted with a mesh or shape");
  const auto file = simulation::PackingFile::Open(options.source.input, options.threads);
  if (!file) return session::Fail("pack", file.error().Text());
  PackResult result{
      .bone = file->ToBone(), .mode = "unknown", .converted = true, .provenance = file->provenance()};
  result.outputs = options.outputs;
  result.threads = simulation::ThreadCount(options.threads);
  for (const auto& [key, value] : result.provenance.parameters) {
    if (key == "mode") result.mode = value;
    if (key == "zone") result.zone = value;
  }
  const auto [least, greatest] =
      std::ranges::minmax(result.bone.balls, {}, [](const simulation::Ball& ball) { return ball.radius_m; });
  result.quality.spheres = result.bone.balls.size();
  result.quality.r_min_m = least.radius_m;
  result.quality.r_max_m = greatest.radius_m;
  ReadQualityParameters(result.provenance, result.quality);
  if (!result.bone.points.empty())
    result.mass = simulation::PointMassProperties(result.bone.points, result.bone.materials);
  base::InstallInterrupt();
  if (const auto written = WriteOutputs(options, result); !written)
    return session::Fail("pack", written.error(), session::kFailed);
  if (base::Interrupted()) return base::kExitInterrupted;
  PrintTable(result);
  return 0;
}

/// Runs the subcommand; does not catch a builder's std::invalid_argument, as RunPack does.
int Run(const PackOptions& options) {
  if (const std::string wrong = WrongPlace(options); !wrong.empty()) return session::Fail("pack", wrong);
  if (HasExtension(options.source.input, ".osp")) return Convert(options);

  // As long as nothing is written, Ctrl-C may end the process at once.
  const bool report = !options.report.empty();
  base::PhaseProgress progress("osteon pack", 4 + (options.points ? 1 : 0) + (report ? 1 : 0));
  progress.BeginPhase("load");
  auto source = session::LoadPackSource(options.source);
  if (!source) {
    progress.Done();
    return session::Fail("pack", source.error());
  }
  PackResult result{.mode = options.disjoint ? "disjoint" : "overlap"};
  result.bone.name = source->name;
  result.bone.materials = source->materials;
  result.bone.site = source->site;
  result.zone = source->zone_text;
  result.triangles = source->triangles;
  result.even_solid = source->even;
  result.seed = options.seed;
  result.threads = simulation::ThreadCount(options.threads);
  result.outputs = options.outputs;

  progress.BeginPhase("pack");
  const double begun_s = rt::ToSeconds(rt::MonotonicNow());
  result.bone.balls = Pack(options, *source);
  result.seconds = rt::ToSeconds(rt::MonotonicNow()) - begun_s;
  if (result.bone.balls.empty()) {
    progress.Done();
    return session::Fail(
        "pack", "no sphere of the radii that were asked for fits into it: accepted a lesser --r-min-mm");
  }
  progress.BeginPhase("measure");
  result.quality =
      simulation::MeasurePacking(*source->solid, result.bone.balls, {.threads = options.threads});
  result.point_params = PointParams(options, *source, result.quality.solid_volume_m3);
  if (options.points) {
    progress.BeginPhase("mass points");
    result.bone.points = simulation::BuildMassPoints(*source->solid, *source->zone, result.point_params);
    result.mass = simulation::PointMassProperties(result.bone.points, result.bone.materials);
    result.even_points = EvenMass(result.bone);
  }
  result.provenance = Provenance(options, *source, result);

  base::InstallInterrupt();
  if (report) {
    progress.BeginPhase("report");
    const auto written = WriteReportOf(options, *source, result, progress.phases());
    if (!written) {
      progress.Done();
      return session::Fail("pack", written.error(), session::kFailed);
    }
    result.outputs.push_back(options.report / "report.html");
  }
  if (base::Interrupted()) {
    progress.Done();
    return base::kExitInterrupted;
  }
  progress.BeginPhase("write");
  result.phases = progress.phases();
  const auto written = WriteOutputs(options, result);
  progress.Done();
  if (!source->warning.empty()) fmt::print(stderr, "osteon pack: warning: {}\n", source->warning);
  if (!written) return session::Fail("pack", written.error(), session::kFailed);
  if (base::Interrupted()) return base::kExitInterrupted;
  PrintTable(result);
  if (KeepsTolerances(result)) return 0;
  return session::Fail(
      "pack",
      fmt::format(
          "found a protrusion of {:.4g} mm and an overlap of {:.4g} mm; accepted {:g} mm, and {:g} mm "
          "in a disjoint packing",
          result.quality.protrusion_max_m * 1e3, result.quality.overlap_max_m * 1e3, kMaxProtrusion_m * 1e3,
          kMaxDisjointOverlap_m * 1e3),
      session::kFailed);
}

}  // namespace

int RunPack(const PackOptions& options) {
  try {
    return Run(options);
  } catch (const std::invalid_argument& error) {  // a builder rejected a value
    return session::Fail("pack", error.what());
  }
}

}  // namespace osteon::studies
