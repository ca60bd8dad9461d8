#include "studies/bench/bench_surface.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/percentile.h"
#include "base/write_text.h"
#include "config/reading/load.h"
#include "session/process/exit_code.h"
#include "session/setup/cell_setup.h"
#include "session/summary/chart_files.h"
#include "simulation/solids/cup_frame.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/chunk_bytes.h"
#include "simulation/surface/dual_surface.h"
#include "simulation/surface/tool_sweep.h"

namespace osteon::studies {
namespace {

/// Figures of one bone at one voxel size.
struct SurfaceTimes {
  std::string cell;
  double voxel_mm{0.0}, build_s{0.0}, first_mesh_s{0.0};
  std::size_t triangles{0};
  double field_mb{0.0};
  std::vector<double> carve_ms{}, extract_ms{}, pack_ms{}, chunk_kb{}, bricks{};  // of each step
};

/// Seconds since the last call.
class StopWatch {
 public:
  double Lap() {
    const rt::Nanoseconds now = rt::MonotonicNow();
    return rt::ToSeconds(now - std::exchange(last_, now));
  }

 private:
  rt::Nanoseconds last_{rt::MonotonicNow()};
};

/// The tool's pose in a frame: it circles about the site's axis and goes deeper in each frame.
/// @param X_WC  the site's frame;  @param start_m  the tool's height above its origin in frame 0
surface::ToolFrame FrameOf(const Pose& X_WC, double start_m, std::size_t frame) {
  // feed per frame, radius of the circle, and turn on it per frame
  constexpr double kFeed_m = 5e-6, kCircle_m = 1e-3, kTurn_rad = 0.02;
  const auto i = static_cast<double>(frame);
  Pose X_CP = Pose::Identity();
  X_CP.linear() = Eigen::AngleAxisd(M_PI, Vector3::UnitX()).toRotationMatrix();  // feed into the bone
  X_CP.translation() = Vector3(kCircle_m * std::cos(kTurn_rad * i), kCircle_m * std::sin(kTurn_rad * i),
                               start_m - kFeed_m * i);
  const Pose X_WP = X_WC * X_CP;
  return {.X_WP = X_WP, .p_WS_m = Vector3(X_WP.translation()), .cuts = true, .frame = frame + 1};
}

/// Extracts the meshes of all bricks that have changed.
void Extract(const surface::CarvedField& field, std::vector<surface::SurfaceChunk>& chunks) {
  const auto dirty = field.Dirty();
  chunks.resize(std::max(chunks.size(), dirty.size()));
  for (std::size_t i = 0; i < dirty.size(); ++i) surface::ExtractChunk(field, dirty[i], chunks[i]);
}

/// Times the surface's start at one voxel size, and then each step of the cut.
SurfaceTimes Measure(const session::CellSetup& setup, double voxel_mm, std::size_t frames) {
  SurfaceTimes times{.cell = setup.cell_name, .voxel_mm = voxel_mm};
  StopWatch watch;
  surface::CarvedField field(surface::SampleSolid(*setup.solid, static_cast<float>(voxel_mm)));
  times.build_s = watch.Lap();
  std::vector<surface::SurfaceChunk> chunks;
  Extract(field, chunks);
  times.first_mesh_s = watch.Lap();
  for (std::size_t i = 0; i < field.Dirty().size(); ++i) times.triangles += chunks[i].quads.size() / 2;
  field.ClearDirty();

  const Pose X_WC = setup.X_WG * simulation::CupPose(setup.bone.site);
  // A cup (a site wider than 20 mm in radius) is cut from its floor, a smaller site from its origin.
  const double start_m = setup.bone.site.radius_m > 0.02 ? -setup.bone.site.radius_m : 0.0;
  surface::ToolSweep sweep(setup.config.tool.tool, setup.X_WG);
  std::vector<std::uint8_t> bytes;
  for (std::size_t frame = 0; frame < frames && !base::Interrupted(); ++frame) {
    if (!sweep.Add(FrameOf(X_WC, start_m, frame))) continue;
    (void)watch.Lap();
    field.Carve(sweep.TakeCapsules());
    times.carve_ms.push_back(1e3 * watch.Lap());
    Extract(field, chunks);
    times.extract_ms.push_back(1e3 * watch.Lap());
    bytes.clear();
    for (std::size_t i = 0; i < field.Dirty().size(); ++i)
      surface::AppendChunk(field.layout(), chunks[i], bytes);
    times.pack_ms.push_back(1e3 * watch.Lap());
    times.chunk_kb.push_back(1e-3 * static_cast<double>(bytes.size()));
    times.bricks.push_back(static_cast<double>(field.Dirty().size()));
    field.ClearDirty();
  }
  times.field_mb = 1e-6 * static_cast<double>(field.Bytes());
  return times;
}

void Print(SurfaceTimes& t) {
  fmt::print(
      "{:<12} {:>6.3f} {:>8.3f} {:>8.3f} {:>10} {:>7.1f} {:>8.2f} {:>8.2f} {:>7.2f} {:>7.0f} {:>8.1f}\n",
      t.cell, t.voxel_mm, t.build_s, t.first_mesh_s, t.triangles, t.field_mb, base::Median(t.carve_ms),
      base::Median(t.extract_ms), base::Median(t.pack_ms), base::Median(t.bricks), base::Median(t.chunk_kb));
}

nlohmann::ordered_json Json(SurfaceTimes& t) {
  return {{"cell", t.cell},
          {"voxel_mm", t.voxel_mm},
          {"build_s", t.build_s},
          {"first_mesh_s", t.first_mesh_s},
          {"triangles", t.triangles},
          {"field_MB", t.field_mb},
          {"carve_ms", base::Median(t.carve_ms)},
          {"extract_ms", base::Median(t.extract_ms)},
          {"pack_ms", base::Median(t.pack_ms)},
          {"bricks", base::Median(t.bricks)},
          {"chunk_kB", base::Median(t.chunk_kb)}};
}

/// Runs the subcommand, except that it throws if the input is bad.
int Run(const BenchSurfaceOptions& options) {
  base::InstallInterrupt();
  nlohmann::ordered_json json{{"schema", "osteon.bench.surface/1"},
                              {"subcommand", "bench surface"},
                              {"machine", session::MachineName()},
                              {"frames", options.frames},
                              {"rows", nlohmann::ordered_json::array()}};
  fmt::print("Osteon bench surface: steps of {} frames, medians, on {}\n\n", surface::ToolSweep::kBatchFrames,
             session::MachineName());
  fmt::print("{:<12} {:>6} {:>8} {:>8} {:>10} {:>7} {:>8} {:>8} {:>7} {:>7} {:>8}\n", "cell", "voxel",
             "build s", "mesh s", "triangles", "MB", "carve ms", "extr. ms", "pack ms", "bricks", "chunk kB");
  for (const std::string& cell : options.cells) {
    const auto setup = session::PrepareCell(options.config_root / "cells" / (cell + ".yaml"), {});
    if (!setup) return session::Fail("bench surface", setup.error());
    if (!setup->solid)
      return session::Fail("bench surface", cell + ": found a packing, accepted a cell with a solid");
    const auto own_mm = static_cast<double>(surface::VoxelFor(setup->config.tool.tool));
    for (const double voxel_mm :
         options.voxels_mm.empty() ? std::vector{2.0 * own_mm, own_mm, 0.5 * own_mm} : options.voxels_mm) {
      SurfaceTimes times = Measure(*setup, voxel_mm, options.frames);
      if (base::Interrupted()) return base::kExitInterrupted;
      Print(times);
      json["rows"].push_back(Json(times));
    }
  }
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return session::Fail("bench surface", written.error(), session::kFailed);
  return 0;
}

}  // namespace

int RunBenchSurface(const BenchSurfaceOptions& options) {
  try {
    return Run(options);
  } catch (const config::ConfigError& error) {
    return session::Fail("bench surface", error.what());
  } catch (const std::invalid_argument& error) {
    return session::Fail("bench surface", error.what());
  }
}

}  // namespace osteon::studies
