#include <array>

#include "studies/failures/page/failure_scenes.h"

// Sketches of the scenarios of compliant tool, tissue and mount. Each function draws one half of the scenario
// of its name: our method if s.ours(), otherwise the baseline. Coordinates are in pixels of the sketch.

namespace osteon::studies {
namespace {

// A zigzag spring from left to right at one height.
void Spring(SceneSketch& s, double left, double right, double y, std::string_view color) {
  std::vector<report::PlotPoint> points{{left, y}};
  constexpr int kTeeth = 6;
  for (int i = 0; i < kTeeth; ++i)
    points.push_back({left + (right - left) * (i + 0.5) / kTeeth, y + (i % 2 == 0 ? -6.0 : 6.0)});
  points.push_back({right, y});
  s.Line(points, {.color = color, .width_px = 2.0});
}

void TwoSprings(SceneSketch& s) {
  s.Bone({{20, 150}, {20, 96}, {110, 130}, {200, 60}, {200, 150}});
  s.Line({{20, 92}, {110, 126}}, {.color = "#59636e", .width_px = 5.0});
  s.ToolBall(112, 96, 16);
  s.Line(ArcPoints({112, 66}, 26, -200, 90), kMeantLine);
  s.Arrow({137, 72}, {134, 82});
  s.Text(16, 84, "soft layer");
  s.Text(214, 30, "the tool circles between");
  s.Text(214, 46, "a soft and a hard plane");
  if (s.ours())
    s.Text(214, 96, "every turn takes work", "start", s.color());
  else
    s.Text(214, 96, "29 mJ out of every turn", "start", s.color());
}

void StaleStiffness(SceneSketch& s) {
  s.BoneBlock(20, 110, 200, 150);
  s.BoneBlock(20, 84, 200, 110, "#e7eef2");
  s.ToolBall(110, 62, 34);
  s.Arrow({110, 12}, {110, 24});
  s.Arrow({126, 24}, {126, 12});
  s.Text(214, 30, "pressed in and out at 8 Hz");
  s.Line({{214, 140}, {390, 140}}, kMeantLine);
  s.Text(386, 130, "work given", "end");
  if (s.ours())
    s.Line({{214, 140}, {390, 147}}, s.Strong());
  else
    s.Line({{214, 138}, {270, 118}, {330, 100}, {390, 78}}, s.Strong());
}

void BentArm(SceneSketch& s) {
  s.Bone({{20, 150}, {20, 110}, {200, 150}});
  s.Line({{96, 8}, {96, 60}, {104, 92}, {122, 126}}, {.color = "#59636e", .width_px = 6.0});
  s.Line({{96, 60}, {96, 124}}, kMeantLine);
  s.Text(16, 40, "rigid tool");
  s.Text(214, 30, "the drill's head is bent aside");
  if (s.ours()) {
    s.Line({{96, 124}, {122, 126}}, s.Strong());
    s.Text(214, 96, "the torque has the bent arm", "start", s.color());
  } else {
    s.Cross(96, 124, s.color());
    s.Text(214, 96, "torque as if it were straight", "start", s.color());
  }
}

void LatePlanes(SceneSketch& s) {
  s.BoneBlock(70, 84, 170, 130);
  s.ToolBall(120, 62, 22);
  s.Arrow({120, 10}, {120, 34});
  Spring(s, 14, 70, 107, "#59636e");
  Spring(s, 170, 214, 107, "#59636e");
  s.Text(224, 30, "bone on a mount of 15 Hz");
  if (s.ours())
    s.Line(WavePoints({226, 100}, 392, 5.0, {22.0, 2.0}), s.Strong());
  else
    s.Line(WavePoints({226, 100}, 392, 5.0, {4.0, 34.0}), s.Strong());
}

void DrillWalks(SceneSketch& s) {
  s.Bone({{20, 150}, {20, 84}, {200, 140}, {200, 150}});
  s.Line({{86, 8}, {86, 100}}, kMeantLine);
  s.Arrow({86, 8}, {86, 26});
  s.Text(214, 30, "a thin drill, led straight,");
  s.Text(214, 46, "meets tilted bone");
  if (s.ours()) {
    s.Line({{86, 30}, {87, 60}, {94, 90}, {106, 118}}, {.color = "#59636e", .width_px = 6.0});
    s.Line({{106, 118}, {110, 136}}, s.Strong());
    s.Text(214, 96, "its hole begins aside", "start", s.color());
  } else {
    s.Line({{86, 30}, {86, 112}}, {.color = "#59636e", .width_px = 6.0});
    s.Line({{86, 112}, {86, 136}}, s.Strong());
    s.Cross(86, 112, s.color());
    s.Text(214, 96, "its hole is where aimed", "start", s.color());
  }
}

void DepthOnMount(SceneSketch& s) {
  const double down = s.ours() ? 26.0 : 8.0;
  s.BoneBlock(70, 74, 170, 130);
  s.ToolBall(120, 74 + down - 24, 24);
  s.Arrow({120, 10}, {120, 34});
  Spring(s, 14, 70, 107, "#59636e");
  Spring(s, 170, 214, 107, "#59636e");
  s.Line({{60, 100}, {180, 100}}, kMeantLine);
  s.Text(224, 30, "the spindle stops");
  s.Text(224, 46, "at the planned depth");
  s.Text(224, 106, s.ours() ? "which goes with the bone" : "in the world: too shallow", "start", s.color());
}

void SwingingMount(SceneSketch& s) {
  s.BoneBlock(70, 84, 170, 130);
  s.ToolBall(120, 62, 22);
  s.Arrow({120, 34}, {120, 8});
  Spring(s, 14, 70, 107, "#59636e");
  Spring(s, 170, 214, 107, "#59636e");
  s.Line({{76, 74}, {76, 50}}, kMeantLine);
  s.Line({{164, 74}, {164, 50}}, kMeantLine);
  s.Text(224, 30, "a push that turns, and bone");
  s.Text(224, 46, "that swings on its mount");
  if (s.ours()) {
    s.Line({{226, 130}, {392, 130}}, s.Strong());
    s.Text(226, 96, "the handle stays light", "start", s.color());
  } else {
    s.Line({{226, 130}, {262, 130}, {266, 76}, {300, 96}, {304, 74}, {340, 94}, {344, 74}, {392, 98}},
           s.Strong());
    s.Text(226, 66, "the drag rises", "start", s.color());
  }
}

// Number, drawing, and the captions below baseline and ours.
constexpr std::array kScenes{
    FailureScene{36, TwoSprings,
                 "Each plane has its own stiffness: the force has a curl, and a circle one way gives work.",
                 "Planes share one stiffness; the layer is an element in series, with its own state."},
    FailureScene{37, StaleStiffness,
                 "A frame's stiffness is held until the next: soft on the way in, stiff on the way out.",
                 "The layer's displacement is a state that follows the force, tick by tick."},
    FailureScene{38, BentArm,
                 "The force acts at the bent head, the torque is computed at the straight one: work appears.",
                 "The wrench is carried back from the bent head."},
    FailureScene{39, LatePlanes,
                 "The engine moves the bone, so its planes follow 20 ms late: the motion grows.",
                 "The mount moves in the tick, and the engine sees a bone at rest: the motion decays."},
    FailureScene{40, DrillWalks,
                 "A rigid drill starts its hole where it is aimed, whatever the bone's slope.",
                 "The drill bends as an element of its own, and walks until its hole holds it."},
    FailureScene{41, DepthOnMount, "The bone gives way under the push, and the limit counts that as depth.",
                 "The limit is fixed to the bone: the hole is as deep as on bone at rest."},
    FailureScene{42, SwingingMount,
                 "Where the push turns, the bone's swing is all the index sees: it makes the handle heavy.",
                 "The index remembers the push for 0.2 s: the swing is a small share, and the drag stays."},
};

}  // namespace

std::span<const FailureScene> ComplianceScenes() { return kScenes; }

}  // namespace osteon::studies
