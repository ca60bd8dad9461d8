#include "app/cli/studies/studies.h"

#include "app/cli/studies/shard_option.h"
#include "app/cli/usage/plan_file.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "session/run/demo.h"
#include "studies/bench/bench_console.h"
#include "studies/bench/bench_frame.h"
#include "studies/bench/bench_kinematics.h"
#include "studies/bench/bench_simulate.h"
#include "studies/bench/bench_surface.h"
#include "studies/bench/bench_tick.h"
#include "studies/bench/bench_view.h"
#include "studies/bench/bench_workloads.h"
#include "studies/bench/method_engine.h"
#include "studies/charts/chart_compliance.h"
#include "studies/charts/chart_scaling.h"
#include "studies/charts/chart_speed_accuracy.h"

namespace osteon::app {
namespace {

constexpr double kMaxSpheres = 20e6;  // accepted number of spheres in a bone

// Adds an option that reads "A,B" into words, each of which must be one of `accepted`.
CLI::Option* AddWords(CLI::App& sub, const std::string& name, std::vector<std::string>& words,
                      const std::vector<std::string>& accepted, const std::string& help) {
  return sub.add_option(name, words, help)->check(OneOf(accepted))->delimiter(',')->expected(1)->take_all();
}

// Each function below adds one subcommand of `bench` or `chart`; parsing then fills `options`.

CLI::App* AddBenchFrame(CLI::App& bench, studies::BenchFrameOptions& options) {
  CLI::App* sub = bench.add_subcommand("frame", "times a cutting frame");
  auto* scene = sub->add_option(
      "--scene", options.scene,
      "acetabulum: reamed at 100 N and 250 rpm once the head is seated; molar: its recorded motion");
  scene->check(OneOf({"acetabulum", "molar"}))->capture_default_str();
  sub->add_option(
         "--spheres", options.spheres,
         "spheres of the bone; more than the scene has are added below the cut zone, which stays as it is; "
         "with --workloads: of each")
      ->check(NumberWithin(1, kMaxSpheres));
  sub->add_flag("--uniform", options.uniform, "change all of the bone alike, the cut zone too");
  auto* tool_spheres = sub->add_option("--tool-spheres", options.tool_spheres,
                                       "spheres of the tool's head; 1: one analytic ball");
  tool_spheres->check(NumberWithin(1, 10'000))->capture_default_str();
  auto* method = sub->add_option("--method", options.method, "the cutting method; ours: on Vulkan");
  method->check(OneOf(studies::MethodNames()))->capture_default_str();
  AddWords(*sub, "--compare", options.compare, studies::MethodNames(),
           "further methods, timed in turn with the first, frame by frame; separated by commas; without a "
           "value: voxel-128, voxel-256 and voxel-512, voxels along the bone's longest side")
      ->expected(0, 1);
  AddWords(*sub, "--engines", options.engines, {"vulkan", "cpu", "reference"},
           "instead of --method: cutting engines, timed in turn, frame by frame; separated by commas; on all "
           "workloads where --scene, --spheres, --uniform and --tool-spheres name none")
      ->excludes(method);
  AddWords(*sub, "--workloads", options.workloads, studies::BenchWorkloadNames(),
           "named workloads instead of --scene and --tool-spheres: a tool and its number of spheres in the "
           "bone (reamer of one analytic ball) or in the head; separated by commas")
      ->excludes(scene)
      ->excludes(tool_spheres);
  AddDeviceOption(*sub, options.device);
  sub->add_option("--frames", options.frames, "frames to time in a round, on each workload")
      ->check(NumberWithin(20, 10e6))
      ->capture_default_str();
  sub->add_option(
         "--rounds", options.rounds,
         "rounds over all workloads, each from the same start; the figures are of all frames together")
      ->check(NumberWithin(1, 1000))
      ->capture_default_str();
  sub->add_option("--most-seconds", options.max_seconds,
                  "longest time to measure in a round, on each workload; at least 20 frames are timed")
      ->check(NumberWithin(0.1, 36e3))
      ->capture_default_str();
  sub->add_option("--voxel-mm", options.voxel_mm, "edge of a voxel, for methods with voxels")
      ->check(NumberWithin(0.01, 5.0))
      ->capture_default_str();
  sub->add_option("--json", options.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->footer(
      "A time is the wall time from submission to result; the rate is one over the median.\n\n"
      "Examples:\n  osteon bench frame\n  osteon bench frame --spheres 1000000 --json frame.json\n"
      "  osteon bench frame --spheres 300000 --tool-spheres 1000 --compare brute --frames 50\n"
      "  osteon bench frame --scene molar --spheres 36000 --tool-spheres 200\n"
      "  osteon bench frame --engines cpu,vulkan --rounds 5 --json engines.json\n"
      "  osteon bench frame --engines cpu,vulkan --spheres 300000 --compare");
  // Set the defaults that depend on several options. CLI11 runs this callback after it has read all options.
  sub->callback([sub, &options] {
    if (sub->count("--compare") > 0 && (options.compare.empty() || options.compare.front().empty()))
      options.compare = studies::PlainVoxelNames();
    const auto is_given = [&](const char* name) { return sub->count(name) > 0; };
    if (!options.engines.empty() && options.workloads.empty() && !is_given("--scene") &&
        !is_given("--spheres") && !is_given("--uniform") && !is_given("--tool-spheres"))
      options.workloads = {studies::BenchWorkloadNames().front()};
  });
  return sub;
}

CLI::App* AddBenchKinematics(CLI::App& bench, studies::BenchKinematicsOptions& options) {
  CLI::App* sub = bench.add_subcommand("kinematics", "times the arm's kinematics and dynamics beside KDL's");
  sub->add_option("--robot", options.robot, "a name under robots/, or the robot's YAML file, joint by joint")
      ->type_name("ROBOT")
      ->default_str("lbr_iiwa_14_r820");
  sub->add_option("--calls", options.calls, "calls of each function")
      ->check(NumberWithin(1000, 1e9))
      ->capture_default_str();
  sub->add_option("--json", options.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->footer(
      "Medians of 51 batches, Osteon's and KDL's in turn. Inverse kinematics: Osteon computes all solutions "
      "and checks the limits of each; KDL's LMA searches for one and may fail. Dynamics need the links' "
      "masses.\n\n"
      "Examples:\n  osteon bench kinematics\n"
      "  osteon bench kinematics --robot config/robots/kr_6_r900_2.yaml --json kr.json");
  return sub;
}

CLI::App* AddBenchSurface(CLI::App& bench, studies::BenchSurfaceOptions& options) {
  CLI::App* sub = bench.add_subcommand("surface", "times the carved surface: its start, and steps of a cut");
  sub->add_option("--cells", options.cells, "names under cells/; separated by commas")
      ->type_name("CELL")
      ->delimiter(',')
      ->expected(1)
      ->take_all()
      ->capture_default_str();
  sub->add_option("--voxels-mm", options.voxels_mm,
                  "edges of a voxel, separated by commas; without it twice, once and half of the tool's own")
      ->check(NumberWithin(0.05, 5.0))
      ->delimiter(',')
      ->expected(1)
      ->take_all();
  sub->add_option("--frames", options.frames, "frames of the cut; 16 of them are a step")
      ->check(NumberWithin(16, 1e6))
      ->capture_default_str();
  sub->add_option("--json", options.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->footer(
      "A step carves what the tool swept in 16 frames, makes the mesh of the bricks that changed, and packs "
      "it for a page. The tool circles 1 mm off the site's axis and is fed in by 5 um a frame.\n\n"
      "Examples:\n  osteon bench surface\n  osteon bench surface --cells molar --voxels-mm 0.25,0.1");
  return sub;
}

CLI::App* AddBenchTick(CLI::App& bench, studies::BenchTickOptions& options) {
  CLI::App* sub = bench.add_subcommand("tick", "times the servo tick as a whole and in parts");
  sub->add_option("--ticks", options.ticks,
                  "ticks to time, one each millisecond; the tool presses on eight planes")
      ->check(NumberWithin(100, 3'600'000))
      ->capture_default_str();
  CLI::Option* compliance =
      sub->add_flag("--compliance", options.compliance,
                    "instead, what tool, tissue and mount that give way add: each in turn, so many ticks");
  sub->add_option(
         "--plan", options.plan,
         "instead, what the guidance of a plan adds: none, at gain 0 and as planned in turn, so many "
         "ticks; a name under plans/, or a surgical plan's YAML file")
      ->excludes(compliance)
      ->type_name("PLAN");
  sub->add_option("--json", options.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->footer(
      "A tick is timed from the waiting message of the arm to the record in the ring, without the wake-up. "
      "FRI runs over the loopback, the CAN devices in memory; the cell is cells/demo.yaml. As in a run, the "
      "previous tick is computed a second time shortly before the message.\n\n"
      "Examples:\n  osteon bench tick\n  osteon bench tick --ticks 60000 --json tick.json\n"
      "  osteon bench tick --compliance --ticks 2000\n"
      "  osteon bench tick --plan acetabulum --ticks 2000");
  return sub;
}

CLI::App* AddBenchSimulate(CLI::App& bench, studies::BenchSimulateOptions& options) {
  CLI::App* sub = bench.add_subcommand(
      "simulate", "times the contact model's age with the engine in this process and in one of its own");
  sub->add_option("--ticks", options.ticks, "ticks of a round, one each millisecond")
      ->check(NumberWithin(100, 3'600'000))
      ->capture_default_str();
  sub->add_option("--rounds", options.rounds, "rounds over a thread, shared memory and UDP, in turns")
      ->check(NumberWithin(1, 1000))
      ->capture_default_str();
  AddEngineOption(*sub, options.engine, session::WallTimeEngineNames(), "the cutting engine",
                  "; cpu: one thread, no GPU");
  AddDeviceOption(*sub, options.device);
  sub->add_option("--json", options.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->footer(
      "The age is that of the tool pose that a model was made for, when a tick takes it; back is the time "
      "from a tick's command until its model is there, seen every 10 us. The tool presses on the floor of "
      "the demo's cup.\n\n"
      "Examples:\n  osteon bench simulate\n  osteon bench simulate --ticks 20000 --json simulate.json");
  return sub;
}

CLI::App* AddChartScaling(CLI::App& chart, studies::ScalingOptions& options) {
  CLI::App* sub =
      chart.add_subcommand("scaling", "draws frame rate against number of spheres, as the paper's figure 4");
  sub->add_option("--out", options.out, "folder for scaling.svg, .png, .csv, .json and .html")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub->add_option("--max-spheres", options.max_spheres, "largest number of spheres")
      ->check(NumberWithin(1000, kMaxSpheres))
      ->capture_default_str();
  AddDeviceOption(*sub, options.device);
  sub->add_option("--frames", options.frames, "frames to time at each point")
      ->check(NumberWithin(20, 1e6))
      ->capture_default_str();
  sub->add_option("--most-seconds", options.max_seconds,
                  "longest time for a point; points that would take longer are left out")
      ->check(NumberWithin(0.1, 36e3))
      ->capture_default_str();
  sub->add_option("--json", options.json, "write a further copy of scaling.json there")->type_name("FILE");
  AddShardOption(*sub, options.sharding);
  sub->footer(
      "From 1000 to 10 million spheres, in three series: only the bone below the cut zone is refined; all of "
      "the bone is; and without culling.\n\nExamples:\n  osteon chart scaling\n"
      "  osteon chart scaling --max-spheres 300000 --out my_scaling");
  return sub;
}

CLI::App* AddChartSpeedAccuracy(CLI::App& chart, studies::SpeedAccuracyOptions& options) {
  CLI::App* sub =
      chart.add_subcommand("speed-accuracy",
                           "draws frame time against depth, volume, force and normal error and ripple, "
                           "for several methods and resolutions");
  sub->add_option("--out", options.out,
                  "folder for speed_accuracy.svg, .png, .csv, .json and .html, and speed_accuracy_worst.svg, "
                  "speed_accuracy_worst.png with the 99.9th percentile of the frame times")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub->add_flag("--quick", options.quick, "fewer resolutions, 2 seeds, a faster feed");
  AddDeviceOption(*sub, options.device);
  sub->add_option("--seeds", options.seeds, "number of different paths and packings")
      ->check(NumberWithin(1, 100))
      ->capture_default_str();
  sub->add_option("--method", options.methods, "only this method; may be given several times")
      ->check(OneOf(studies::LadderMethods()));
  sub->add_option("--most-seconds", options.max_seconds,
                  "longest time for a method's frames in a task; tasks that would take longer are left out")
      ->check(NumberWithin(0.1, 36e3))
      ->capture_default_str();
  sub->add_option("--json", options.json, "write a further copy of speed_accuracy.json there")
      ->type_name("FILE");
  AddShardOption(*sub, options.sharding);
  sub->footer(
      "Two tables name, for each error, the other methods' points that are both faster and more exact than "
      "ours: by the median and by the 99.9th percentile of the frame times.\n\n"
      "Examples:\n  osteon chart speed-accuracy --quick\n  osteon chart speed-accuracy --out my_chart\n"
      "  osteon chart speed-accuracy --method ours --method voxel --seeds 2");
  return sub;
}

CLI::App* AddChartCompliance(CLI::App& chart, studies::ComplianceChartOptions& options) {
  CLI::App* sub =
      chart.add_subcommand("compliance", "draws what tool, tissue and mount that give way change and cost");
  sub->add_option("--out", options.out,
                  "folder for compliance.svg, .png, .csv, .json and .html, compliance_gives.svg and "
                  "compliance_cost.svg")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub->add_option("--ticks", options.ticks, "ticks to time with each level, one each millisecond, in turn")
      ->check(NumberWithin(100, 3'600'000))
      ->capture_default_str();
  sub->add_option("--json", options.json, "write a further copy of compliance.json there")->type_name("FILE");
  sub->footer(
      "The parts are those of the cells long_drill, cartilage_cup and pelvis_mount, stepped as the servo "
      "loop steps them; their cost is that of the demo's tick (osteon bench tick --compliance).\n\n"
      "Examples:\n  osteon chart compliance\n  osteon chart compliance --ticks 10000 --out my_chart");
  return sub;
}

CLI::App* AddBenchConsole(CLI::App& bench, studies::BenchConsoleOptions& options) {
  CLI::App* sub =
      bench.add_subcommand("console", "times tick and frame of the demo without the console and with pages");
  sub->add_option("--rounds", options.rounds, "rounds, each with every leg in turn")
      ->check(NumberWithin(1, 1000))
      ->capture_default_str();
  sub->add_option("--seconds", options.seconds, "seconds of rendering of each demo")
      ->check(NumberWithin(session::kMinSeconds, session::kMaxSeconds))
      ->capture_default_str();
  sub->add_option("--reloads", options.reloads,
                  "instead of the rounds: load and leave a page so many times during one demo, every third "
                  "one as by a kill")
      ->check(NumberWithin(1, 1'000'000));
  sub->add_option("--chromium", options.chromium, "a Chromium: one more leg, in which it shows the page")
      ->type_name("PROGRAM")
      ->check(CLI::ExistingFile);
  sub->add_option("--json", options.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->footer(
      "Also tells how often the carved bone reaches a page while the tool cuts, the longest gap, and how\n"
      "old the bone is then: alone, and while other work keeps every core busy; and the time from a tick to\n"
      "its figures, taken by a page without a browser and drawn by the browser (with the way back).\n\n"
      "--reloads tells what the demo holds before and after: memory, descriptors, threads.\n\n"
      "Exit code 1: a demo failed, or had a fault for the reloads, or they left something\n\n"
      "Examples:\n  osteon bench console\n  osteon bench console --reloads 1000\n  osteon bench console "
      "--chromium /usr/bin/chromium --json "
      "console.json");
  return sub;
}

CLI::App* AddBenchView(CLI::App& bench, studies::BenchViewOptions& options) {
  CLI::App* sub = bench.add_subcommand(
      "view", "times how fast a long recording opens, and how fast any time of it is shown");
  sub->add_option("recording", options.recording, "the .mcap file of a run, which is repeated")
      ->type_name("FILE")
      ->required()
      ->check(CLI::ExistingFile);
  sub->add_option("--hours", options.hours, "length of the recording that is made of it")
      ->check(NumberWithin(0.01, 24))
      ->capture_default_str();
  sub->add_option("--seeks", options.seeks, "number of times that are gone to")
      ->check(NumberWithin(1, 1000))
      ->capture_default_str();
  sub->add_option("--folder", options.folder,
                  "where the long recording lies meanwhile; an hour takes some 3 GB")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
  sub->add_option("--json", options.json, "also write the figures there, as JSON")->type_name("FILE");
  sub->footer(
      "Exit code 1: the recording did not open, or a time was not shown\n\n"
      "Examples:\n  osteon bench view demo_out/recording.mcap\n"
      "  osteon bench view demo_out/recording.mcap --hours 0.1 --json view.json");
  return sub;
}

// `osteon bench` (sub_) and `osteon chart` (chart_), with their subcommands.
class MeasureCommands final : public Subcommand {
 public:
  explicit MeasureCommands(CLI::App& app);
  [[nodiscard]] bool asked() const override { return sub_->parsed() || chart_->parsed(); }
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::BenchFrameOptions frame_options_;  // declared before the members that point into it
  studies::BenchKinematicsOptions kinematics_options_;
  studies::BenchSurfaceOptions surface_options_;
  studies::BenchTickOptions tick_options_;
  studies::BenchConsoleOptions console_options_;
  studies::BenchViewOptions view_options_;
  studies::BenchSimulateOptions simulate_options_;
  studies::ScalingOptions scaling_options_;
  studies::SpeedAccuracyOptions accuracy_options_;
  studies::ComplianceChartOptions compliance_options_;
  CLI::App *frame_, *kinematics_, *surface_, *tick_, *console_, *view_, *simulate_, *chart_, *scaling_,
      *accuracy_, *compliance_;
};

MeasureCommands::MeasureCommands(CLI::App& app)
    : Subcommand(AddStudy(app, "bench")),
      frame_(AddBenchFrame(*sub_, frame_options_)),
      kinematics_(AddBenchKinematics(*sub_, kinematics_options_)),
      surface_(AddBenchSurface(*sub_, surface_options_)),
      tick_(AddBenchTick(*sub_, tick_options_)),
      console_(AddBenchConsole(*sub_, console_options_)),
      view_(AddBenchView(*sub_, view_options_)),
      simulate_(AddBenchSimulate(*sub_, simulate_options_)),
      chart_(AddStudy(app, "chart")),
      scaling_(AddChartScaling(*chart_, scaling_options_)),
      accuracy_(AddChartSpeedAccuracy(*chart_, accuracy_options_)),
      compliance_(AddChartCompliance(*chart_, compliance_options_)) {
  sub_->require_subcommand(1);
  sub_->footer(
      "Examples:\n  osteon bench frame\n  osteon bench kinematics\n  osteon bench surface\n  osteon bench "
      "tick\n  osteon bench console\n  osteon bench view demo_out/recording.mcap\n  osteon bench frame "
      "--help");
  chart_->require_subcommand(1);
  chart_->footer(
      "Examples:\n  osteon chart scaling\n  osteon chart speed-accuracy --quick\n"
      "  osteon chart compliance");
}

int MeasureCommands::Run(const Invocation& invocation) {
  TakeInvocation(invocation, scaling_options_.sharding);
  TakeInvocation(invocation, accuracy_options_.sharding);
  if (scaling_->parsed()) return studies::RunChartScaling(scaling_options_);
  if (accuracy_->parsed()) return studies::RunChartSpeedAccuracy(accuracy_options_);
  if (compliance_->parsed()) {
    compliance_options_.config_root = invocation.config_root;
    return studies::RunChartCompliance(compliance_options_);
  }
  if (kinematics_->parsed()) {
    kinematics_options_.config_root = invocation.config_root;
    return studies::RunBenchKinematics(kinematics_options_);
  }
  if (surface_->parsed()) {
    surface_options_.config_root = invocation.config_root;
    return studies::RunBenchSurface(surface_options_);
  }
  if (tick_->parsed()) {
    tick_options_.config_root = invocation.config_root;
    if (!tick_options_.plan.empty()) {
      const auto plan = FindPlan(invocation.config_root, tick_options_.plan.string());
      if (!plan) return session::Fail("bench tick", "--plan " + plan.error());
      tick_options_.plan = *plan;
    }
    return studies::RunBenchTick(tick_options_);
  }
  if (console_->parsed()) return studies::RunBenchConsole(console_options_);
  if (view_->parsed()) return studies::RunBenchView(view_options_);
  if (simulate_->parsed()) {
    simulate_options_.config_root = invocation.config_root;
    return studies::RunBenchSimulate(simulate_options_);
  }
  frame_options_.config_root = invocation.config_root;
  return studies::RunBenchFrame(frame_options_);
}

}  // namespace

void AddMeasureCommands(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<MeasureCommands>(app));
}

}  // namespace osteon::app
