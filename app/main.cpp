// The command `osteon`: reads the command line and calls a subcommand. Exit codes: 0 done, 1 the requested
// work failed, 2 wrong usage or bad input, 70 an internal error, 71 out of memory, 130 ended by Ctrl-C, 129
// by SIGHUP, 141 because nobody reads the output.

#include <cstdlib>
#include <exception>
#include <memory>
#include <sstream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/calibrate_command.h"
#include "app/capability_command.h"
#include "app/cell_commands.h"
#include "app/cell_file.h"
#include "app/demo.h"
#include "app/doctor.h"
#include "app/engine_choice.h"
#include "app/exit_code.h"
#include "app/export_command.h"
#include "app/failures.h"
#include "app/fault_table.h"
#include "app/faults_command.h"
#include "app/fidelity_options.h"
#include "app/guard_command.h"
#include "app/help_text.h"
#include "app/kill_table.h"
#include "app/manual_command.h"
#include "app/measure_commands.h"
#include "app/output.h"
#include "app/pack.h"
#include "app/plan_command.h"
#include "app/regress_command.h"
#include "app/replay_command.h"
#include "app/states_command.h"
#include "app/tool_choice.h"
#include "app/transparency_command.h"
#include "app/tune_command.h"
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

// Options of `pack` that are texts on the command line and other types in PackOptions.
struct PackTexts {
  std::string mode{"overlap"}, cup, region;
  std::vector<std::string> path;
};

CLI::App* AddPack(CLI::App& app, osteon::app::PackOptions& pack, PackTexts& texts) {
  using osteon::app::NumberWithin;
  CLI::App* sub = app.add_subcommand(
      "pack", "fills a mesh or a shape with spheres and mass points, and measures the result");
  sub->add_option("input", pack.source.input,
                  "a closed mesh (.stl, .obj, .ply, in mm); a scene, by name or YAML file; ball:R or "
                  "box:X,Y,Z (mm); or a packing (.osp) to convert")
      ->type_name("SCENE")
      ->required();
  sub->add_option(
         "-o,--out", pack.outputs,
         "FILE.osp: the packing; FILE.ply or FILE.csv: its spheres alone; may be given several times")
      ->type_name("FILE")
      ->required()
      ->expected(1)
      ->take_all();
  const auto packing = [&](CLI::Option* option) { return option->group("Packing"); };
  packing(sub->add_option("--mode", texts.mode,
                          "overlap: spheres may overlap, for cutting; disjoint: they may not")
              ->check(osteon::app::OneOf({"overlap", "disjoint"}))
              ->capture_default_str());
  packing(sub->add_option("--count", pack.count,
                          "number of spheres; without it as many as a surface gap of 0.08 mm needs, or 10 "
                          "000 disjoint ones")
              ->check(NumberWithin(1, 100e6)));
  packing(sub->add_option("--r-min-mm", pack.r_min_mm, "smallest radius")->check(NumberWithin(0.001, 100)));
  packing(sub->add_option("--r-max-mm", pack.r_max_mm, "largest radius in the cut zone")
              ->check(NumberWithin(0.001, 500)));
  packing(sub->add_option("--grade", pack.grade,
                          "growth of the largest radius for each mm of depth below the cut zone, in mm")
              ->check(NumberWithin(0, 100)));
  packing(
      sub->add_option("--seed", pack.seed,
                      "seed of the random numbers; another seed gives another packing of the same quality")
          ->capture_default_str());
  packing(sub->add_option("--threads", pack.threads,
                          "number of threads; 0: one for each core. The result does not depend on it")
              ->check(NumberWithin(0, 1024))
              ->capture_default_str());
  packing(sub->add_flag("--points,!--no-points", pack.points,
                        "add mass points to the spheres, or leave them out; by default they are added"));
  packing(sub->add_option("--point-spacing-mm", pack.point_spacing_mm,
                          "mean spacing of the mass points where they are finest")
              ->check(NumberWithin(0.02, 20)));
  const auto mesh = [](CLI::Option* option) { return option->group("Mesh and site"); };
  mesh(sub->add_option("--scale", pack.source.scale, "mm for each unit of the mesh file")
           ->check(NumberWithin(1e-6, 1e6)));
  mesh(sub->add_option("--scene", pack.source.scene,
                       "scene whose bone the mesh replaces: gives the tissue and, with --cup, the cut zone; "
                       "without it acetabulum")
           ->type_name("SCENE"));
  mesh(sub->add_option("--materials", pack.source.materials, "YAML file with the materials")
           ->type_name("FILE"));
  auto* cup =
      mesh(sub->add_option("--cup", texts.cup,
                           "the cup, or the entry of a drill: centre, axis out of the bone, radius; mm")
               ->type_name("X,Y,Z,NX,NY,NZ,R"));
  auto* region = mesh(
      sub->add_option("--region", texts.region, "ball within which the surface is cut: centre, radius; mm")
          ->type_name("X,Y,Z,R"));
  auto* path =
      mesh(sub->add_option("--path", texts.path,
                           "path of the cut, a CSV file with x_mm,y_mm,z_mm, and the tool's radius in mm")
               ->type_name("FILE R")
               ->expected(2));
  region->excludes(path);
  path->excludes(region);
  static_cast<void>(cup);
  sub->add_option("--report", pack.report, "folder for report.html")->type_name("FOLDER");
  sub->add_option("--json", pack.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->footer(
      "Exit code 1: the packing protrudes or overlaps more than accepted, or a file could not be written\n\n"
      "Examples:\n  osteon pack hip.obj -o hip.osp --report hip_report\n"
      "  osteon pack hip.obj -o hip.osp --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21 --count 25000 --grade "
      "0.3\n"
      "  osteon pack tooth.obj -o tooth.osp --scene molar --count 36000\n"
      "  osteon pack acetabulum -o acetabulum.osp\n"
      "  osteon pack ball:20 -o ball.ply --mode disjoint --count 5000\n"
      "  osteon pack hip.osp -o hip.ply -o hip.csv");
  return sub;
}

// Converts the texts. @returns what is wrong with them.
std::string ReadPack(const PackTexts& texts, const CLI::App& sub, osteon::app::PackOptions& pack) {
  pack.disjoint = texts.mode == "disjoint";
  if (sub.count("--cup") > 0) {
    const auto parsed = osteon::app::ParseCup(texts.cup);
    if (!parsed) return parsed.error();
    pack.source.cup = *parsed;
  }
  if (sub.count("--region") > 0) {
    const auto parsed = osteon::app::ParseRegion(texts.region);
    if (!parsed) return parsed.error();
    pack.source.region = *parsed;
  }
  if (sub.count("--path") > 0) {
    const auto radius = osteon::app::ParseNumbers(texts.path[1], 1, "--path: R");
    if (!radius) return radius.error();
    if (!(radius->front() >= 0.1 && radius->front() <= 100.0))
      return fmt::format("--path: R: found {} mm, accepted 0.1 … 100", radius->front());
    pack.source.path = {.file = texts.path[0], .radius_m = 1e-3 * radius->front()};
  }
  pack.source.graded = pack.grade.value_or(0.0) > 0.0;
  for (const CLI::Option* option : sub.get_options())
    if (option->count() > 0 && (option->get_group() == "Packing" || option->get_group() == "Mesh and site") &&
        option->get_name() != "--threads")
      pack.packing_options.push_back(option->get_name());
  return "";
}

// The tables that `failures` makes instead of running its scenarios.
struct FailureTables {
  bool faults{false}, kill{false};
  int times{20};
};

CLI::App* AddFailures(CLI::App& app, osteon::app::FailureOptions& failures, FailureTables& tables) {
  CLI::App* sub = app.add_subcommand(
      "failures", "runs the scenarios in which plain cutting methods fail and Osteon must not");
  auto* ids = sub->add_option("scenarios", failures.ids, "numbers of the scenarios; without any, all of them")
                  ->check(osteon::app::NumberWithin(1, 99));
  auto* out =
      sub->add_option("--out", failures.out, "folder for failures.html and a picture of each scenario")
          ->type_name("FOLDER");
  auto* faults = sub->add_flag("--faults", tables.faults,
                               "instead of the scenarios: every fault of the cell in every state, in virtual "
                               "time (docs/states.md)")
                     ->excludes(ids)
                     ->excludes(out);
  auto* kill =
      sub->add_flag("--kill", tables.kill,
                    "instead of the scenarios: processes and threads are killed in full contact at 150 N: "
                    "controller, servo loop, simulation, recorder, guard, cell (docs/guard.md)")
          ->excludes(ids)
          ->excludes(out)
          ->excludes(faults);
  sub->add_option("--times", tables.times, "number of trials of each kind")
      ->check(osteon::app::NumberWithin(1, 1000))
      ->needs(kill)
      ->capture_default_str();
  sub->add_option("--markdown", failures.markdown,
                  "write a page with the pictures of --out there, as docs/failures.md")
      ->type_name("FILE")
      ->needs(out);
  sub->add_option("--json", failures.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->add_option("--device", failures.device,
                  "the Vulkan device: part of its name, as `osteon doctor` lists it")
      ->type_name("NAME");
  sub->add_option("--engine", failures.engine,
                  "the engine that must keep the bounds; auto: Vulkan on a GPU, the CPU engine elsewhere; "
                  "reference is slow")
      ->check(osteon::app::OneOf(osteon::app::EngineNames()))
      ->capture_default_str();
  sub->add_flag("--quick", failures.quick, "small scenes, as in the tests: seconds instead of minutes");
  std::string list = "Scenarios:\n";
  for (const osteon::hil::FailureScenario& scenario : osteon::hil::FailureScenarios())
    list += fmt::format("  {:>2}  {}\n", scenario.id, scenario.name);
  sub->footer(
      list +
      "\nExit code 1: a baseline did not fail, Osteon exceeded a bound, a fault did not lead to the stated "
      "reaction, or the arm did not stop within its limits after a kill\n\nExamples:\n"
      "  osteon failures\n  osteon failures 1 9 --out failures\n  osteon failures --quick --json "
      "failures.json\n"
      "  osteon failures 21 --device llvmpipe\n  osteon failures --faults --json faults.json\n"
      "  osteon failures --kill --times 1");
  return sub;
}

int Run(int argc, char** argv) {
  const char* root = std::getenv("OSTEON_ROOT");
  std::filesystem::path config_root = std::filesystem::path(root ? root : ".") / "config";

  CLI::App app{"haptic controller and cutting simulation for a hip-reaming robot cell", "osteon"};
  app.formatter(std::make_shared<osteon::app::HelpFormatter>());
  app.set_help_flag("-h,--help", "print this text");
  app.set_version_flag("--version", "osteon " OSTEON_VERSION, "print the version");
  app.require_subcommand(0, 1);
  app.add_option("--config-root", config_root, "the folder with cells/, robots/, tools/ and so on")
      ->type_name("FOLDER")
      ->default_str("config/ of the project");
  app.footer(osteon::app::LauncherFooter() +
             "Examples:\n  osteon demo\n  osteon demo --help\n  osteon run demo --simulated --seconds 10\n"
             "  osteon bench frame\n  osteon doctor");

  osteon::app::DemoOptions demo;
  std::string mesh, cup, tool, cell = "demo";
  double scale = 1.0;
  CLI::App* demo_app = app.add_subcommand("demo", "cuts bone on the simulated cell and leaves a report");
  demo_app->add_option("--seconds", demo.seconds, "seconds of rendering (COMMANDING_ACTIVE)")
      ->check(osteon::app::NumberWithin(osteon::app::kMinSeconds, osteon::app::kMaxSeconds))
      ->capture_default_str();
  demo_app
      ->add_option("--out", demo.out,
                   "folder for summary.json, report.html and recording.mcap; files of an earlier demo move "
                   "to earlier_DATE_TIME in it")
      ->type_name("FOLDER")
      ->capture_default_str();
  demo_app->add_flag("--overwrite", demo.overwrite, "replace the files of an earlier demo in --out");
  auto* mesh_option =
      demo_app
          ->add_option(
              "--mesh", mesh,
              "a closed mesh instead of the scene's bone: STL, OBJ or PLY in mm, or a packing (.osp)")
          ->type_name("FILE");
  auto* cup_option =
      demo_app
          ->add_option(
              "--cup", cup,
              "cup of the mesh, or the circle where a drill enters: centre, axis out of the bone, radius; mm")
          ->type_name("X,Y,Z,NX,NY,NZ,R");
  auto* scale_option = demo_app->add_option("--scale", scale, "mm for each unit of the mesh file");
  scale_option->check(osteon::app::NumberWithin(1e-4, 1e4))->needs(mesh_option)->capture_default_str();
  cup_option->needs(mesh_option);
  demo_app->add_flag("--virtual-time", demo.virtual_time,
                     "lockstep, as fast as the machine can; two runs give the same bits");
  demo_app->add_option("--frame-ms", demo.frame_ms, "duration of a simulation frame in virtual time")
      ->default_str("2")
      ->check(osteon::app::NumberWithin(1, 100));
  osteon::app::AddFidelityOptions(*demo_app, demo.fidelity);
  demo_app
      ->add_option("--device", demo.device,
                   "the Vulkan device: part of its name, as `osteon doctor` lists it")
      ->type_name("NAME");
  demo_app
      ->add_option(
          "--engine", demo.engine,
          "the cutting engine; auto: Vulkan on a GPU, the CPU engine elsewhere; cpu: one thread, no GPU; "
          "reference: plain double precision, slow, virtual time only")
      ->check(osteon::app::OneOf(osteon::app::EngineNames()))
      ->capture_default_str();
  demo_app->add_option("--cell", cell, "a name under cells/, or a cell's YAML file")
      ->type_name("CELL")
      ->capture_default_str();
  auto* tool_option = demo_app
                          ->add_option("--tool", tool,
                                       "use this tool instead of the cell's: NAME or NAME:DIAMETER in mm; a "
                                       "name under tools/, or a YAML file")
                          ->type_name("TOOL");
  demo_app
      ->add_option("--port", demo.port,
                   "first of the cell's ports, instead of the one in its file: FRI, PLC, then two for each "
                   "CAN bus; 0: any free ports")
      ->check(osteon::app::PortNumber());
  demo_app
      ->add_option("--cpu", demo.cpu,
                   "CPU of the servo thread and the simulated arm; everything else stays off it")
      ->check(osteon::app::NumberWithin(0, osteon::rt::kMaxCpu));
  demo_app->add_option("--json", demo.json, "write a further copy of summary.json there")->type_name("FILE");
  demo_app
      ->add_option("--save-motion", demo.save_motion,
                   "write the tool's motion there (CSV), to be played again")
      ->type_name("FILE");
  demo_app->footer(
      "Exit code 1: a fault ended the run, or a file could not be written\n\n"
      "Examples:\n  osteon demo\n  osteon demo --seconds 5 --out my_run\n  osteon demo --virtual-time\n"
      "  osteon demo --error-mm 0.05 --rate-hz 500\n"
      "  osteon demo --mesh hip.obj --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21\n"
      "  osteon demo --cell molar --mesh tooth.obj --scale 0.041 --cup 0,0.5,8,0,0,1,1.75");

  osteon::app::PackOptions pack;
  PackTexts pack_texts;
  CLI::App* pack_app = AddPack(app, pack, pack_texts);

  osteon::app::FailureOptions failures;
  FailureTables tables;
  CLI::App* failures_app = AddFailures(app, failures, tables);

  osteon::app::DoctorOptions doctor;
  CLI::App* doctor_app =
      app.add_subcommand("doctor", "checks what this machine can do, with a verdict for each item");
  doctor_app->add_option("--port", doctor.fri_port, "FRI port to try")
      ->check(osteon::app::PortNumber())
      ->capture_default_str();
  doctor_app
      ->add_option(
          "--seconds", doctor.seconds,
          "duration of the timer test, once with SCHED_FIFO and once without; a measurement takes hours")
      ->check(osteon::app::NumberWithin(0.1, 86400))
      ->capture_default_str();
  doctor_app->add_option("--json", doctor.json, "also write the checks there, as JSON")->type_name("FILE");
  doctor_app->footer(
      "Exit code 1: the FRI port is taken\n\n"
      "Examples:\n  osteon doctor\n  osteon doctor --seconds 3600 --json doctor.json");

  osteon::app::FaultsOptions faults;
  CLI::App* faults_app =
      app.add_subcommand("faults", "lists the faults that stop the cell, and how to continue after each");
  faults_app->add_option("--markdown", faults.markdown, "write the page there, as docs/faults.md")
      ->type_name("FILE");
  faults_app->add_option("--json", faults.json, "also write the faults there, as JSON")->type_name("FILE");
  faults_app->footer("Examples:\n  osteon faults\n  osteon faults --json faults.json");

  osteon::app::StatesOptions states;
  CLI::App* states_app =
      app.add_subcommand("states", "lists the states of the cell and what leads from one to another");
  states_app->add_option("--markdown", states.markdown, "write the page there, as docs/states.md")
      ->type_name("FILE");
  states_app->add_option("--json", states.json, "also write the states there, as JSON")->type_name("FILE");
  states_app->footer("Examples:\n  osteon states\n  osteon states --json states.json");

  osteon::app::MeasureCommands measure(app);
  osteon::app::CellCommands cells(app);
  osteon::app::GuardCommand guard(app);
  osteon::app::CalibrateCommand calibrate(app);
  osteon::app::CapabilityCommand capability(app);
  osteon::app::TransparencyCommand transparency(app);
  osteon::app::PlanCommand plan(app);
  osteon::app::TuneCommand tune(app);
  osteon::app::ExportCommand export_recording(app);
  osteon::app::ReplayCommand replay(app);
  osteon::app::RegressCommand regress(app);
  osteon::app::ManualCommands manual(app);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      std::ostringstream text;
      const int code = app.exit(error, text, text);
      fmt::print("{}", text.str());
      return code;
    }
    fmt::print(stderr, "{}", osteon::app::UsageError(app, error));
    return 2;
  }
  if (const std::string wrong = osteon::app::ValidateEnvironment(app); !wrong.empty()) {
    fmt::print(stderr, "{}", wrong);
    return 2;
  }
  if (*demo_app) {
    demo.command_line = CommandLine(argc, argv);
    const auto found = osteon::app::FindCell(config_root, cell);
    if (!found) {
      fmt::print(stderr, "osteon demo: --cell {}\n", found.error());
      return 2;
    }
    demo.cell = *found;
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
      demo.mesh = osteon::app::MeshChoice{.file = mesh, .scale = scale};
      std::string wrong = mesh.empty() ? "--mesh: found no name, accepted a file" : "";
      if (*cup_option) {
        const auto parsed = osteon::app::ParseCup(cup);
        if (!parsed && wrong.empty()) wrong = parsed.error();
        if (parsed) demo.mesh->cup = *parsed;
      } else if (wrong.empty() && demo.mesh->file.extension() != ".osp") {
        wrong = fmt::format("--mesh {}: found no --cup, accepted with it (a packing file may have its own)",
                            mesh);
      }
      if (wrong.empty() && *scale_option && demo.mesh->file.extension() == ".osp")
        wrong = fmt::format("--scale: found with {}, accepted with a mesh: a packing is in mm", mesh);
      if (!wrong.empty()) {
        fmt::print(stderr, "osteon demo: {}\n", wrong);
        return 2;
      }
    }
    try {
      return osteon::app::RunDemo(demo);
    } catch (const osteon::config::ToolSizeError& error) {
      fmt::print(stderr, "osteon demo: --tool {}: {}\n", tool, error.what());
      return 2;
    }
  }
  if (*pack_app) {
    pack.command_line = CommandLine(argc, argv);
    pack.source.config_root = config_root;
    if (const std::string wrong = ReadPack(pack_texts, *pack_app, pack); !wrong.empty()) {
      fmt::print(stderr, "osteon pack: {}\n", wrong);
      return 2;
    }
    return osteon::app::RunPack(pack);
  }
  if (*failures_app && tables.faults) return osteon::app::RunFaultTable({.json = failures.json});
  if (*failures_app && tables.kill) {
    if (failures.engine == "reference") {
      fmt::print(
          stderr,
          "osteon failures: --engine reference: found --kill, accepted without it: too slow for wall time\n");
      return 2;
    }
    return osteon::app::RunKillTable({.config_root = config_root,
                                      .times = tables.times,
                                      .json = failures.json,
                                      .engine = failures.engine,
                                      .device = failures.device});
  }
  if (*failures_app) {
    failures.command_line = CommandLine(argc, argv);
    return osteon::app::RunFailures(failures);
  }
  if (cells.asked()) return cells.Run(config_root);
  if (guard.asked()) return guard.Run(config_root);
  if (transparency.asked()) return transparency.Run(config_root, CommandLine(argc, argv));
  if (calibrate.asked()) return calibrate.Run(config_root, CommandLine(argc, argv));
  if (capability.asked()) return capability.Run(config_root, CommandLine(argc, argv));
  if (plan.asked()) return plan.Run(config_root);
  if (tune.asked()) return tune.Run(config_root, CommandLine(argc, argv));
  if (export_recording.asked()) return export_recording.Run();
  if (replay.asked()) return replay.Run(config_root);
  if (regress.asked()) return regress.Run(config_root, CommandLine(argc, argv));
  if (manual.asked()) {
    const CLI::App* const apps[] = {&app};
    return manual.Run(apps);
  }
  if (measure.asked()) return measure.Run(config_root);
  if (*states_app) return osteon::app::RunStates(states);
  if (*faults_app) return osteon::app::RunFaults(faults);
  if (*doctor_app) return osteon::app::RunDoctor(doctor);
  fmt::print("{}", app.help());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  osteon::app::InstallOutput();
  try {
    return osteon::app::OutputExitCode(Run(argc, argv));
  } catch (const std::exception& error) {
    const osteon::app::Failure failure = osteon::app::Explain(error);
    fmt::print(stderr, "osteon: {}\n", failure.text);
    return failure.code;
  }
}
