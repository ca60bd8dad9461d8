// The command `osteon`: reads the command line and hands over to a subcommand. Exit codes: 0 done, 1 the
// thing asked for failed, 2 wrong usage or bad input, 130 ended by Ctrl-C.

#include <cstdlib>
#include <exception>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "app/demo.h"
#include "app/doctor.h"
#include "app/tool_choice.h"
#include "app/usage.h"
#include "config/reader.h"

namespace {

std::string CommandLine(int argc, char** argv) {
  std::string line = "./osteon";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain = word.find_first_of(" \"'$\\") == std::string::npos;
    line += plain ? " " + word : " '" + word + "'";
  }
  return line;
}

// The cells of a configuration folder, in alphabetical order.
std::string CellNames(const std::filesystem::path& config_root) {
  std::set<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(config_root / "cells", error))
    if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  return names.empty() ? "there is none" : fmt::format("{}", fmt::join(names, ", "));
}

int Run(int argc, char** argv) {
  const char* root = std::getenv("OSTEON_ROOT");
  std::filesystem::path config_root = std::filesystem::path(root ? root : ".") / "config";

  CLI::App app{"Osteon: haptic controller and cutting simulation for a hip-reaming robot cell", "osteon"};
  app.set_version_flag("--version", "osteon " OSTEON_VERSION);
  app.require_subcommand(0, 1);
  app.add_option("--config-root", config_root, "folder with cells/, robots/, tools/ …")
      ->capture_default_str();
  app.footer(
      "The launcher ./osteon adds:\n  test [ctest arguments]      builds and runs every test\n"
      "  clean                       removes what was built\n\n"
      "Examples:\n  osteon demo\n  osteon demo --help\n  osteon doctor");

  osteon::app::DemoOptions demo;
  std::string mesh, cup, tool, cell = "demo";
  double scale = 1.0;
  CLI::App* demo_app = app.add_subcommand("demo", "cuts bone on the simulated cell and leaves a report");
  demo_app->add_option("--seconds", demo.seconds, "time in COMMANDING_ACTIVE, 0.1 … 3600")
      ->check(osteon::app::NumberWithin(osteon::app::kLeastSeconds, osteon::app::kMostSeconds))
      ->capture_default_str();
  demo_app->add_option("--out", demo.out, "folder for summary.json, report.html, recording.mcap")
      ->capture_default_str();
  auto* mesh_option =
      demo_app->add_option("--mesh", mesh, "closed triangle mesh instead of the scene: STL, OBJ, PLY, in mm");
  auto* cup_option = demo_app->add_option("--cup", cup,
                                          "X,Y,Z,NX,NY,NZ,R: its cup, or the circle where a drill enters: "
                                          "centre, axis out of the bone, radius; mm");
  demo_app->add_option("--scale", scale, "millimetres to a unit of the mesh")
      ->check(osteon::app::NumberWithin(1e-4, 1e4))
      ->needs(mesh_option)
      ->capture_default_str();
  mesh_option->needs(cup_option);
  cup_option->needs(mesh_option);
  demo_app->add_flag("--virtual-time", demo.virtual_time,
                     "lockstep, as fast as it goes; two runs give equal bits");
  demo_app->add_option("--device", demo.device, "part of a Vulkan device's name (osteon doctor lists them)");
  demo_app
      ->add_option("--engine", demo.engine, "vulkan, or reference: double precision, slow, virtual time only")
      ->check(osteon::app::OneOf({"vulkan", "reference"}))
      ->capture_default_str();
  demo_app->add_option("--cell", cell, "a name under cells/, or a YAML file")->capture_default_str();
  auto* tool_option = demo_app->add_option(
      "--tool", tool, "NAME[:DIAMETER]: instead of the cell's; a name under tools/, or a YAML file; mm");
  demo_app->add_option("--port", demo.port, "FRI port on loopback instead of the cell's; 0: any free one")
      ->check(osteon::app::PortNumber());
  demo_app->add_option("--json", demo.json, "a further copy of summary.json");
  demo_app->footer(
      "Examples:\n  osteon demo\n  osteon demo --seconds 5 --out my_run\n  osteon demo --virtual-time\n"
      "  osteon demo --mesh hip.obj --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21\n"
      "  osteon demo --cell molar --mesh tooth.obj --scale 0.041 --cup 0,0.5,8,0,0,1,1.75");

  std::uint16_t port = 30200;
  std::filesystem::path doctor_json;
  CLI::App* doctor_app = app.add_subcommand("doctor", "what this machine can do, with a verdict each");
  doctor_app->add_option("--port", port, "FRI port to try")
      ->check(osteon::app::PortNumber())
      ->capture_default_str();
  doctor_app->add_option("--json", doctor_json, "write the checks there");
  doctor_app->footer("Examples:\n  osteon doctor\n  osteon doctor --json doctor.json");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    fmt::print(stderr, "{}", osteon::app::UsageError(app, error));
    return 2;
  }
  if (*demo_app) {
    demo.command_line = CommandLine(argc, argv);
    demo.cell =
        cell.ends_with(".yaml") ? std::filesystem::path(cell) : config_root / "cells" / (cell + ".yaml");
    if (!std::filesystem::is_regular_file(demo.cell)) {
      fmt::print(stderr, "osteon demo: --cell {}: no file {}; accepted: a YAML file, or one of {}: {}\n",
                 cell, demo.cell.string(), (config_root / "cells").string(), CellNames(config_root));
      return 2;
    }
    if (demo.engine == "reference" && !demo.virtual_time) {
      fmt::print(stderr,
                 "osteon demo: --engine reference: found wall time, accepted with --virtual-time only\n");
      return 2;
    }
    if (*tool_option) {
      const auto parsed = osteon::app::ParseTool(tool, config_root);
      if (!parsed) {
        fmt::print(stderr, "osteon demo: {}\n", parsed.error());
        return 2;
      }
      demo.tool = *parsed;
    }
    if (*mesh_option) {
      if (mesh.empty()) {
        fmt::print(stderr, "osteon demo: --mesh: found no name, accepted a file\n");
        return 2;
      }
      const auto parsed = osteon::app::ParseCup(cup);
      if (!parsed) {
        fmt::print(stderr, "osteon demo: {}\n", parsed.error());
        return 2;
      }
      demo.mesh = osteon::app::MeshChoice{.file = mesh, .cup = *parsed, .scale = scale};
    }
    try {
      return osteon::app::RunDemo(demo);
    } catch (const osteon::config::ToolSizeError& error) {
      fmt::print(stderr, "osteon demo: --tool {}: {}\n", tool, error.what());
      return 2;
    }
  }
  if (*doctor_app) return osteon::app::RunDoctor(port, doctor_json);
  fmt::print("{}", app.help());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Run(argc, argv);
  } catch (const osteon::config::ConfigError& error) {
    fmt::print(stderr, "osteon: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "osteon: {}\n", error.what());
    return 2;
  }
}
