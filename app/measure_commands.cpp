#include "app/measure_commands.h"

#include "app/usage.h"

namespace osteon::app {
namespace {

constexpr double kMaxSpheres = 20e6;

CLI::App* AddBenchFrame(CLI::App& bench, BenchFrameOptions& options) {
  CLI::App* sub = bench.add_subcommand("frame", "times one cutting frame");
  sub->add_option(
         "--scene", options.scene,
         "acetabulum: reamed at 100 N and 250 rpm once the head is seated; molar: its recorded motion")
      ->check(OneOf({"acetabulum", "molar"}))
      ->capture_default_str();
  sub->add_option(
         "--spheres", options.spheres,
         "of the bone; more than the scene's own fill the bone below the cut zone, which stays as it is")
      ->check(NumberWithin(1, kMaxSpheres));
  sub->add_flag("--uniform", options.uniform, "all of the bone alike instead");
  sub->add_option("--tool-spheres", options.tool_spheres, "of the tool's head; 1: one analytic ball")
      ->check(NumberWithin(1, 10'000))
      ->capture_default_str();
  sub->add_option("--method", options.method, "what cuts")
      ->check(OneOf(MethodNames()))
      ->capture_default_str();
  sub->add_option("--compare", options.compare, "a further method, in turn with it, frame by frame")
      ->check(OneOf(MethodNames()));
  sub->add_option("--device", options.device, "part of a Vulkan device's name (osteon doctor lists them)");
  sub->add_option("--frames", options.frames, "timed")->check(NumberWithin(20, 10e6))->capture_default_str();
  sub->add_option("--most-seconds", options.max_seconds, "of timing; 20 frames at least")
      ->check(NumberWithin(0.1, 36e3))
      ->capture_default_str();
  sub->add_option("--voxel-mm", options.voxel_mm, "edge of a voxel, for the methods that have them")
      ->check(NumberWithin(0.01, 5.0))
      ->capture_default_str();
  sub->add_option("--json", options.json, "write the figures there");
  sub->footer(
      "Times are wall time around a frame, submit to result; the rate is one over the median.\n\n"
      "Examples:\n  osteon bench frame\n  osteon bench frame --spheres 1000000 --json frame.json\n"
      "  osteon bench frame --spheres 300000 --tool-spheres 1000 --compare brute --frames 50\n"
      "  osteon bench frame --scene molar --spheres 36000 --tool-spheres 200");
  return sub;
}

CLI::App* AddBenchKinematics(CLI::App& bench, BenchKinematicsOptions& options) {
  CLI::App* sub = bench.add_subcommand("kinematics", "times the arm's mathematics beside KDL's");
  sub->add_option("--robot", options.robot, "its file, joint by joint (default: the LBR iiwa 14 R820)");
  sub->add_option("--calls", options.calls, "of each function")
      ->check(NumberWithin(1000, 1e9))
      ->capture_default_str();
  sub->add_option("--json", options.json, "write the figures there");
  sub->footer(
      "Medians of 51 batches, ours and KDL's in turn. Inverse kinematics: all solutions and what the limits "
      "say of "
      "each, against one that KDL's LMA finds or not. Without masses there are no dynamics.\n\n"
      "Examples:\n  osteon bench kinematics\n"
      "  osteon bench kinematics --robot config/robots/kr_6_r900_2.yaml --json kr.json");
  return sub;
}

CLI::App* AddBenchTick(CLI::App& bench, BenchTickOptions& options) {
  CLI::App* sub = bench.add_subcommand("tick", "times the servo tick, whole and in its parts");
  sub->add_option("--ticks", options.ticks, "timed, a millisecond each; the tool presses on eight planes")
      ->check(NumberWithin(100, 3'600'000))
      ->capture_default_str();
  sub->add_option("--json", options.json, "write the figures there");
  sub->footer(
      "From the arm's message that waits to the record in the ring; the wake-up is not in it. FRI over the "
      "loopback,\nthe cell's CAN devices in memory, the cell is cells/demo.yaml. As in a run, the tick "
      "before is "
      "computed again\nshortly before the message.\n\n"
      "Examples:\n  osteon bench tick\n  osteon bench tick --ticks 60000 --json tick.json");
  return sub;
}

CLI::App* AddChartScaling(CLI::App& chart, ScalingOptions& options) {
  CLI::App* sub =
      chart.add_subcommand("scaling", "frame rate against number of spheres: the paper's figure 4");
  sub->add_option("--out", options.out, "folder for scaling.svg, .png, .csv, .json, .html")
      ->capture_default_str();
  sub->add_option("--max-spheres", options.max_spheres, "no more than these")
      ->check(NumberWithin(1000, kMaxSpheres))
      ->capture_default_str();
  sub->add_option("--device", options.device, "part of a Vulkan device's name (osteon doctor lists them)");
  sub->add_option("--frames", options.frames, "timed at each point")
      ->check(NumberWithin(20, 1e6))
      ->capture_default_str();
  sub->add_option("--most-seconds", options.max_seconds, "of a point; what would take longer is left out")
      ->check(NumberWithin(0.1, 36e3))
      ->capture_default_str();
  sub->add_option("--json", options.json, "a further copy of scaling.json");
  sub->footer(
      "From 1000 to 10 million spheres: the cut zone as it is and the bone below it finer; all of the bone "
      "alike; "
      "and without culling.\n\nExamples:\n  osteon chart scaling\n"
      "  osteon chart scaling --max-spheres 300000 --out my_scaling");
  return sub;
}

CLI::App* AddChartSpeedAccuracy(CLI::App& chart, SpeedAccuracyOptions& options) {
  CLI::App* sub = chart.add_subcommand(
      "speed-accuracy",
      "methods x resolutions on one workload: frame time against depth, volume, force and ripple");
  sub->add_option("--out", options.out, "folder for speed_accuracy.svg, .png, .csv, .json, .html")
      ->capture_default_str();
  sub->add_flag("--quick", options.quick, "fewer resolutions, 2 seeds, a faster feed");
  sub->add_option("--device", options.device, "part of a Vulkan device's name (osteon doctor lists them)");
  sub->add_option("--seeds", options.seeds, "paths and packings that differ")
      ->check(NumberWithin(1, 100))
      ->capture_default_str();
  sub->add_option("--method", options.methods, "these alone; several times")->check(OneOf(LadderMethods()));
  sub->add_option("--most-seconds", options.max_seconds,
                  "of a method's frames in one task; what would take longer is left out")
      ->check(NumberWithin(0.1, 36e3))
      ->capture_default_str();
  sub->add_option("--json", options.json, "a further copy of speed_accuracy.json");
  sub->footer(
      "Examples:\n  osteon chart speed-accuracy --quick\n  osteon chart speed-accuracy --out my_chart\n"
      "  osteon chart speed-accuracy --method ours --method voxel --seeds 2");
  return sub;
}

}  // namespace

MeasureCommands::MeasureCommands(CLI::App& app)
    : bench_(app.add_subcommand("bench", "measures what the parts take")),
      frame_(AddBenchFrame(*bench_, frame_options_)),
      kinematics_(AddBenchKinematics(*bench_, kinematics_options_)),
      tick_(AddBenchTick(*bench_, tick_options_)),
      chart_(app.add_subcommand("chart", "measures and draws")),
      scaling_(AddChartScaling(*chart_, scaling_options_)),
      accuracy_(AddChartSpeedAccuracy(*chart_, accuracy_options_)) {
  bench_->require_subcommand(1);
  bench_->footer(
      "Examples:\n  osteon bench frame\n  osteon bench kinematics\n  osteon bench tick\n  osteon bench frame "
      "--help");
  chart_->require_subcommand(1);
  chart_->footer("Examples:\n  osteon chart scaling\n  osteon chart speed-accuracy --quick");
}

bool MeasureCommands::asked() const { return bench_->parsed() || chart_->parsed(); }

int MeasureCommands::Run(const std::filesystem::path& config_root) {
  if (scaling_->parsed()) return RunChartScaling(scaling_options_);
  if (accuracy_->parsed()) return RunChartSpeedAccuracy(accuracy_options_);
  if (kinematics_->parsed()) {
    kinematics_options_.config_root = config_root;
    return RunBenchKinematics(kinematics_options_);
  }
  if (tick_->parsed()) {
    tick_options_.config_root = config_root;
    return RunBenchTick(tick_options_);
  }
  frame_options_.config_root = config_root;
  return RunBenchFrame(frame_options_);
}

}  // namespace osteon::app
