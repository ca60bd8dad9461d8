// Compares Osteon's packings with OpenVDB's fillWithSpheres: coverage and surface gap over the number of
// spheres and over time. Both pack the same meshes, alternate in one run, and are measured by the same
// function (MeasurePacking).
//
//     osteon_packing_chart MESH… --out DIR [--counts N,N…] [--full] [--samples N] [--threads N]
//
// Writes packing_chart.csv and, for each mesh, packing_chart_<mesh>.svg. Seconds are wall time from the
// checked mesh to the spheres: for Osteon the search tree and the packing, for OpenVDB the level set and the
// filling, which uses every core in spite of --threads. --full adds 100 000 spheres, at which OpenVDB takes
// minutes.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "simulation/packing/disjoint_packing.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/packing/packing_quality.h"
#include "simulation/solids/mesh_solid.h"
#include "tests/bench/vdb_spheres.h"

namespace {

using namespace osteon;

struct Options {
  std::vector<std::filesystem::path> meshes;
  std::filesystem::path out;
  std::vector<std::size_t> counts{1'000, 3'000, 10'000, 30'000};
  std::size_t samples{200'000};
  int threads{0};
};

constexpr const char* kUsage =
    "usage: osteon_packing_chart MESH… --out DIR [--counts N,N…] [--full] [--samples N] [--threads N]";

/// Reads the whole number in an option's text. @throws std::invalid_argument if the text is no whole number
/// or the number is out of bounds
std::size_t ToCount(const std::string& option, const std::string& text, std::size_t min_value,
                    std::size_t max_value) {
  std::size_t end = 0, value = 0;
  try {
    value = std::stoul(text, &end);
  } catch (const std::exception&) {
    end = 0;
  }
  if (end == 0 || end != text.size() || text[0] == '-' || value < min_value || value > max_value)
    throw std::invalid_argument(
        fmt::format("{}: found '{}', accepted a whole number, {} … {}", option, text, min_value, max_value));
  return value;
}

Options Parse(const std::vector<std::string>& words) {
  Options options;
  bool full = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const auto value = [&]() -> const std::string& {
      if (i + 1 == words.size()) throw std::invalid_argument(fmt::format("{}: found no value", word));
      return words[++i];
    };
    if (word == "--out") {
      options.out = value();
    } else if (word == "--full") {
      full = true;
    } else if (word == "--samples") {
      options.samples = ToCount(word, value(), 1000, 100'000'000);
    } else if (word == "--threads") {
      options.threads = static_cast<int>(ToCount(word, value(), 0, 1024));
    } else if (word == "--counts") {
      options.counts.clear();
      const std::string& list = value();
      for (std::size_t from = 0; from <= list.size();) {
        const std::size_t comma = std::min(list.find(',', from), list.size());
        options.counts.push_back(ToCount(word, list.substr(from, comma - from), 10, 10'000'000));
        from = comma + 1;
      }
    } else if (word.starts_with("--")) {
      throw std::invalid_argument(fmt::format("found '{}', which is no option", word));
    } else {
      options.meshes.emplace_back(word);
    }
  }
  if (full) options.counts.push_back(100'000);
  if (options.meshes.empty()) throw std::invalid_argument("found no mesh, accepted one or more");
  if (options.out.empty()) throw std::invalid_argument("found no --out, accepted a folder");
  return options;
}

/// One packing of one mesh.
struct Row {
  std::string method;
  std::size_t asked;  ///< number of spheres that was requested
  double seconds;
  simulation::PackingQuality quality;
};

/// One packing method: its balls and its wall time.
struct Method {
  std::string name;
  std::function<std::vector<simulation::Ball>(std::size_t count, double& seconds)> pack;
};

/// All of Osteon's methods, and OpenVDB's if this executable was built with OpenVDB.
std::vector<Method> Methods(const simulation::LoadedMesh& loaded, int threads) {
  using Clock = std::chrono::steady_clock;
  // a method of Osteon, whose time includes building the search tree
  const auto ours = [&loaded](const auto& pack) {
    return [&loaded, pack](std::size_t count, double& seconds) {
      const auto start = Clock::now();
      const simulation::MeshSolid solid(loaded.mesh);
      std::vector<simulation::Ball> balls = pack(solid, count);
      seconds = std::chrono::duration<double>(Clock::now() - start).count();
      return balls;
    };
  };
  const auto vdb = [&loaded](bool overlapping) {
    return [&loaded, overlapping](std::size_t count, double& seconds) {
      bench::VdbSpheres spheres = bench::FillWithVdb(loaded.mesh, count, overlapping);
      seconds = spheres.level_set_s + spheres.fill_s;
      return std::move(spheres.balls);
    };
  };
  std::vector<Method> methods{
      {"osteon disjoint", ours([threads](const simulation::Solid& solid, std::size_t count) {
         return simulation::BuildDisjointPacking(solid, simulation::EverywhereZone(),
                                                 {.count = count, .threads = threads});
       })},
      {"osteon overlapping", ours([threads](const simulation::Solid& solid, std::size_t count) {
         const simulation::EverywhereZone zone;
         return simulation::BuildPacking(
             solid, zone, simulation::OverlapParamsFor(solid, zone, {.count = count, .threads = threads}));
       })}};
  if (!bench::VdbVersion().empty()) {
    methods.insert(methods.begin() + 1, {"openvdb disjoint", vdb(false)});
    methods.push_back({"openvdb overlapping", vdb(true)});
  }
  return methods;
}

/// Packs a mesh with each method for each number of spheres, measures the packings and prints them.
std::vector<Row> Run(const std::filesystem::path& mesh, const Options& options) {
  const auto loaded = simulation::LoadMesh(mesh);
  if (!loaded) throw std::invalid_argument(loaded.error().message);
  const simulation::MeshSolid solid(loaded->mesh);
  std::printf("%s\n%-20s %8s %8s %9s %9s %9s %9s %9s %9s\n", mesh.filename().c_str(), "", "asked", "spheres",
              "seconds", "coverage", "gap mean", "gap p95", "protrude", "overlap");
  std::vector<Row> rows;
  for (const std::size_t count : options.counts)
    for (const Method& method : Methods(*loaded, options.threads)) {
      Row row{.method = method.name, .asked = count, .seconds = 0.0, .quality = {}};
      const std::vector<simulation::Ball> balls = method.pack(count, row.seconds);
      row.quality = MeasurePacking(solid, balls, {.samples = options.samples, .threads = options.threads});
      const simulation::PackingQuality& q = row.quality;
      std::printf("%-20s %8zu %8zu %9.2f %9.4f %9.4f %9.4f %9.4f %9.4f\n", row.method.c_str(), count,
                  q.spheres, row.seconds, q.coverage, q.surface_gap_mean_m * 1e3, q.surface_gap_p95_m * 1e3,
                  q.protrusion_max_m * 1e3, q.overlap_max_m * 1e3);
      std::fflush(stdout);
      rows.push_back(std::move(row));
    }
  return rows;
}

void AppendCsv(const std::string& mesh, const std::vector<Row>& rows, std::ostream& csv) {
  for (const Row& row : rows) {
    const simulation::PackingQuality& q = row.quality;
    csv << fmt::format("{},{},{},{},{:.3f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.4f},{:.4f}\n",
                       mesh, row.method, row.asked, q.spheres, row.seconds, q.coverage,
                       q.coverage_standard_error, q.surface_gap_mean_m * 1e3, q.surface_gap_p95_m * 1e3,
                       q.surface_gap_max_m * 1e3, q.protrusion_max_m * 1e3, q.overlap_max_m * 1e3,
                       q.r_min_m * 1e3, q.r_max_m * 1e3);
  }
}

/// Draws coverage and surface gap, each over the number of spheres and over the time. Only the axes of
/// coverage are linear.
std::string Chart(const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const Row& row : rows)
    if (std::find(names.begin(), names.end(), row.method) == names.end()) names.push_back(row.method);
  const auto panel = [&](const std::string& title, const std::string& x_label, const std::string& y_label,
                         const auto& x, const auto& y, bool log_y) {
    report::LineChart chart{.title = title,
                            .x_label = x_label,
                            .y_label = y_label,
                            .y_from_zero = false,
                            .log_x = true,
                            .log_y = log_y,
                            .legend = false};
    for (const std::string& name : names) {
      report::Series series{.name = name, .marker = report::Marker::kCircle};
      for (const Row& row : rows) {
        if (row.method != name) continue;
        series.x.push_back(x(row));
        series.y.push_back(y(row));
      }
      chart.series.push_back(std::move(series));
    }
    return chart;
  };
  const auto spheres = [](const Row& row) { return static_cast<double>(row.quality.spheres); };
  const auto seconds = [](const Row& row) { return row.seconds; };
  const auto coverage = [](const Row& row) { return row.quality.coverage; };
  const auto gap = [](const Row& row) { return row.quality.surface_gap_mean_m * 1e3; };
  const std::string by_count = "spheres", by_time = "time [s]";
  const std::vector<report::LineChart> panels{
      panel("Coverage over spheres", by_count, "share of the volume", spheres, coverage, false),
      panel("Coverage over time", by_time, "share of the volume", seconds, coverage, false),
      panel("Gap over spheres", by_count, "mean surface gap [mm]", spheres, gap, true),
      panel("Gap over time", by_time, "mean surface gap [mm]", seconds, gap, true)};
  std::vector<report::LegendEntry> legend;
  for (std::size_t i = 0; i < names.size(); ++i)
    legend.push_back({.text = names[i], .color = report::kPalette[i % report::kPalette.size()]});
  return report::SvgGrid(panels, 2, "", legend, 830.0);
}

void Write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

int main(int argc, char** argv) {
  std::optional<Options> options;
  try {
    options = Parse({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "osteon_packing_chart: %s\n%s\n", error.what(), kUsage);
    return 2;
  }
  try {
    std::filesystem::create_directories(options->out);
    if (bench::VdbVersion().empty())
      std::printf("built without OpenVDB (libopenvdb-dev): Osteon's packings alone\n");
    else
      std::printf("OpenVDB %s\n", bench::VdbVersion().c_str());
    std::ostringstream csv;
    csv << "mesh,method,asked,spheres,seconds,coverage,coverage_standard_error,gap_mean_mm,gap_p95_mm,"
           "gap_max_mm,protrusion_mm,overlap_mm,r_min_mm,r_max_mm\n";
    for (const std::filesystem::path& mesh : options->meshes) {
      const std::vector<Row> rows = Run(mesh, *options);
      AppendCsv(mesh.stem().string(), rows, csv);
      Write(options->out / "packing_chart.csv", csv.str());
      Write(options->out / fmt::format("packing_chart_{}.svg", mesh.stem().string()), Chart(rows));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "osteon_packing_chart: %s\n", error.what());
    return 1;
  }
  return 0;
}
