#include <array>

#include "studies/failures/page/failure_scenes.h"

// Sketches of the scenarios of tool change and undo. Each function draws one half of the scenario of its
// name: our method if s.ours(), otherwise the baseline. Coordinates are in pixels of the sketch.

namespace osteon::studies {
namespace {

// Change to a reamer of 2 mm larger diameter, whose apex lies further ahead.
void ToolChange(SceneSketch& s) {
  s.Line({{140, 10}, {140, 60}}, {.color = "#c3cbd2", .width_px = 8.0});
  s.GhostBall(140, 84, 22);
  if (s.ours()) {
    s.ToolBall(140, 84, 30);
    s.Text(190, 60, "joints stay,", "start", s.color());
    s.Text(190, 76, "the apex is further", "start", s.color());
  } else {
    s.ToolBall(140, 76, 30);
    s.Arrow({96, 60}, {96, 30}, s.Strong());
    s.Text(190, 60, "the arm leaps back", "start", s.color());
  }
  s.Text(190, 120, "44 to 46 mm");
}

// A heavier tool, with nobody at the handle.
void ToolLoad(SceneSketch& s) {
  s.Line({{140, 10}, {140, 50}}, {.color = "#c3cbd2", .width_px = 8.0});
  s.ToolBall(140, 74, 26);
  s.Text(190, 40, "13 g more, nobody holds it");
  if (s.ours()) {
    s.Text(190, 90, "stays", "start", s.color());
  } else {
    s.Arrow({140, 108}, {140, 148}, s.Strong());
    s.Text(156, 140, "sinks", "start", s.color());
  }
}

// A larger tool is chosen while it would overlap bone.
void ToolInBone(SceneSketch& s) {
  std::vector<report::PlotPoint> bone{{20, 156}, {20, 70}};
  for (const report::PlotPoint& p : ArcPoints({140, 70}, 40, 180, 360)) bone.push_back(p);
  bone.insert(bone.end(), {{260, 70}, {260, 156}});
  s.Bone(bone);
  s.GhostBall(140, 70, 38);
  if (s.ours()) {
    s.ToolBall(140, 25, 46);
    s.Text(200, 24, "retract first", "start", s.color());
  } else {
    s.ToolBall(140, 70, 46);
    s.Arrow({140, 40}, {140, 4}, s.Strong());
    s.Text(200, 24, "pushed out at once", "start", s.color());
  }
}

// A pass is undone, and the run resumes.
void Undo(SceneSketch& s) {
  s.BoneBlock(20, 90, 260, 150);
  s.ToolBall(100, 74, 18);
  s.GhostBall(180, 74, 18);
  s.Text(60, 40, "a pass is undone");
  if (s.ours())
    s.Text(282, 110, "the bone is back", "start", s.color());
  else
    s.Text(282, 110, "its bone is gone", "start", s.color());
}

}  // namespace

std::span<const FailureScene> SequenceScenes() {
  static const std::array scenes{
      FailureScene{.id = 32,
                   .draw = ToolChange,
                   .baseline = "keeps the apex where it is: the flange moves at once",
                   .ours = "keeps the joints; the pose becomes the new tool's"},
      FailureScene{.id = 33,
                   .draw = ToolLoad,
                   .baseline = "weighs with the tool before: the rest looks like a hand",
                   .ours = "takes load and tool in one tick"},
      FailureScene{.id = 34,
                   .draw = ToolInBone,
                   .baseline = "begins in bone",
                   .ours = "refuses, and says how far to retract"},
      FailureScene{.id = 35,
                   .draw = Undo,
                   .baseline = "goes on with the bone as it is",
                   .ours = "continues from the saved state"}};
  return scenes;
}

}  // namespace osteon::studies
