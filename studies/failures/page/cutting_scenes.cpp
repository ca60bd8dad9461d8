#include <array>
#include <cmath>

#include "studies/failures/page/failure_scenes.h"

// Sketches of the scenarios in which bone is cut. Each function draws one half of the scenario of its name:
// our method if s.ours(), otherwise the baseline. Coordinates are in pixels of the sketch.

namespace osteon::studies {
namespace {

void HighFeed(SceneSketch& s) {
  s.BoneBlock(40, 20, 300, 136);
  const auto at = [](double x) { return report::PlotPoint{x, 78.0 + 18.0 * std::sin((x - 40.0) / 40.0)}; };
  if (s.ours()) {
    std::vector<report::PlotPoint> way;
    for (double x = 40.0; x <= 301.0; x += 4.0) way.push_back(at(x));
    s.Line(way, {.color = "#b3995c", .width_px = 40.0});
    s.Line(way, {.color = "#ffffff", .width_px = 37.6});
    s.Line(way, kMeantLine);
  } else {
    for (double x = 58.0; x < 300.0; x += 46.0) {
      s.Tool(ArcPoints(at(x), 19, 0, 360));
      if (x > 60.0) s.Cross(x - 23.0, at(x - 23.0).y, s.color());
    }
    s.Line({{306, 116}, {262, 88}}, {.color = s.color(), .width_px = 1.2});
    s.Text(308, 122, "left standing", "start", s.color());
  }
  const report::PlotPoint end = at(318.0);
  s.ToolBall(318, end.y, 19);
  s.Arrow({340, end.y}, {388, end.y});
  s.Text(40, 154, "seen from above: the tool mills a slot, up to 1 m/s");
}

void MaterialStep(SceneSketch& s) {
  s.BoneBlock(30, 78, 165, 150);
  s.BoneBlock(165, 78, 300, 150, "#d8bd84");
  s.Text(40, 142, "cancellous");
  s.Text(290, 142, "cortical", "end");
  s.Line({{80, 102}, {80, 24}, {250, 24}, {250, 102}, {80, 102}}, kMeantLine);
  s.Arrow({80, 40}, {80, 64});
  s.Arrow({148, 102}, {180, 102});
  s.Arrow({250, 66}, {250, 42});
  s.Arrow({180, 24}, {150, 24});
  s.ToolBall(80, 82, 18);
  s.Text(262, 30, "way of the hand");
  s.Arrow({122, 100}, {122, s.ours() ? 52.0 : 84.0}, s.Strong());
  s.Arrow({214, 100}, {214, s.ours() ? 52.0 : 36.0}, s.Strong());
  s.Text(168, 62, "force", "middle", s.color());
}

void Breakthrough(SceneSketch& s) {
  s.BoneBlock(40, 58, 150, 80);
  s.BoneBlock(192, 58, 300, 80);
  s.Text(42, 50, "wall of 1 to 2 mm");
  const double y = s.ours() ? 88.0 : 138.0;
  s.Line({{171, 2}, {171, y}}, {.color = "#c3cbd2", .width_px = 8.0});
  s.ToolBall(171, y, 18);
  s.Arrow({204, 8}, {204, 46});
  s.Text(212, 24, "steady push of 100 N");
  if (s.ours()) {
    s.Line({{60, 112}, {300, 112}}, {.color = s.color(), .dashed = true});
    s.Text(306, 116, "depth limit", "start", s.color());
  } else {
    s.GhostBall(171, 84, 18);
    s.Arrow({206, 86}, {206, 148}, s.Strong());
    s.Text(216, 128, "nothing holds it", "start", s.color());
  }
}

void Energy(SceneSketch& s) {
  std::vector<report::PlotPoint> bone{{20, 96}};
  for (const report::PlotPoint& p : ArcPoints({130, 88}, 27, 163, 17)) bone.push_back(p);
  bone.insert(bone.end(), {{230, 96}, {230, 150}, {20, 150}});
  s.Bone(bone);
  s.ToolBall(130, 88, 24);
  s.Line({{130, 64}, {130, 30}}, {.color = "#c3cbd2", .width_px = 8.0});
  s.Arrow({130, 4}, {130, 28});
  s.Text(140, 16, "feed");
  s.Line(ArcPoints({130, 46}, 16, 200, 20), {});
  s.Arrow({143.5, 54}, {141, 58});
  s.Text(152, 50, "drive");
  s.Text(30, 140, "a dimple, 100 times");
  const double work_bar_px = s.ours() ? 84.0 : 3.0;
  s.Line({{286, 130}, {286, 130 - work_bar_px}}, {.color = "#59636e", .width_px = 26.0});
  s.Line({{350, 130}, {350, s.ours() ? 46.0 : 20.0}}, {.color = s.color(), .width_px = 26.0});
  s.Line({{262, 130}, {374, 130}});
  s.Text(286, 148, "work in", "middle");
  s.Text(350, 148, "cut", "middle", s.color());
}

void Determinism(SceneSketch& s) {
  const std::array<const char*, 2> orders{"1234", s.ours() ? "1234" : "3142"};
  for (std::size_t run = 0; run < 2; ++run) {
    const double y = 24.0 + 64.0 * static_cast<double>(run);
    s.Text(10, y + 21, run == 0 ? "run 1" : "run 2");
    for (std::size_t i = 0; i < 4; ++i) {
      const double x = 60.0 + 46.0 * static_cast<double>(i);
      s.Box(x, y, 30, 32);
      s.Text(x + 15, y + 21, std::string(1, orders[run][i]), "middle");
      if (i < 3) s.Text(x + 38, y + 21, "+", "middle");
    }
    s.Arrow({234, y + 16}, {258, y + 16});
    const bool first = run == 0 || s.ours();
    s.Text(266, y + 21, first ? "0.70710677" : "0.70710683", "start", s.color());
  }
  s.Text(60, 148, "sums of a normal, in groups of balls");
}

void FrameRate(SceneSketch& s) {
  s.BoneBlock(20, 70, 250, 150);
  s.Line({{60, 30}, {60, 100}, {220, 100}}, kMeantLine);
  for (const report::PlotPoint& p :
       {report::PlotPoint{60, 30}, {60, 65}, {60, 100}, {113, 100}, {166, 100}, {220, 100}})
    s.ToolBall(p.x, p.y, 5);
  s.ToolBall(60, 30, 14);
  s.Text(84, 34, "plunge, then across");
  s.Text(30, 142, "frames at 0.25 to 2 kHz");
  s.Arrow({292, 130}, {292, s.ours() ? 52.0 : 100.0}, {.color = s.color(), .width_px = 5.0});
  s.Arrow({352, 130}, {352, s.ours() ? 52.0 : 115.0}, {.color = s.color(), .width_px = 5.0});
  s.Line({{268, 130}, {376, 130}});
  s.Text(292, 148, "0.25 kHz", "middle");
  s.Text(356, 148, "2 kHz", "middle");
  s.Text(322, 40, "force", "middle", s.color());
}

// Number, drawing, and the captions below baseline and ours.
constexpr std::array kScenes{
    FailureScene{9, HighFeed, "Bone is taken where the frames' poses are, and stands between them.",
                 "Bone is taken along the whole way from frame to frame."},
    FailureScene{
        18, MaterialStep,
        "Stiffness goes with the density: what was pressed in soft is given back hard, and the hand gains "
        "work in every cycle.",
        "One stiffness for all bone: what the hand gets back is what it put in."},
    FailureScene{19, Breakthrough,
                 "The wall gives way, the force is gone at once, and the pushing hand plunges on.",
                 "The proxy never leads the tool, and the depth limit 1 mm below takes the push over."},
    FailureScene{20, Energy, "Bone goes, and neither drive nor feed does the work that its cutting takes.",
                 "What drive and feed put in is the cutting energy of the bone that went."},
    FailureScene{21, Determinism,
                 "Threads add in the order in which they come: the last bits differ from run to run.",
                 "The order of a sum is fixed: every bit is the same in both runs."},
    FailureScene{22, FrameRate,
                 "Bone goes up to the device's pose in each frame: little force is left, and it hangs on the "
                 "frame rate.",
                 "Bone goes at a rate: the force is the same at every frame rate."},
};

}  // namespace

std::span<const FailureScene> CuttingScenes() { return kScenes; }

}  // namespace osteon::studies
