#include <array>

#include "studies/failures/page/failure_scenes.h"

// Sketches of the scenarios of guidance along a surgical plan. Each function, but Funnel, draws one half of
// the scenario of its name: our method if s.ours(), otherwise the baseline. Coordinates are in pixels of the
// sketch.

namespace osteon::studies {
namespace {

constexpr SketchLine kCorridor{.color = "#59636e", .width_px = 2.0};

// Draws the part that all these sketches share: a cup in bone, its axis, and the funnel within which the
// guidance leaves the tool free.
void Funnel(SceneSketch& s) {
  std::vector<report::PlotPoint> bone{{20, 150}, {20, 110}};
  for (const report::PlotPoint& p : ArcPoints({110, 110}, 34, 180, 0)) bone.push_back(p);
  bone.insert(bone.end(), {{200, 110}, {200, 150}});
  s.Bone(bone);
  s.Line({{110, 146}, {110, 8}}, kMeantLine);
  s.Line({{92, 110}, {74, 12}}, kCorridor);
  s.Line({{128, 110}, {146, 12}}, kCorridor);
}

void GuidedCycles(SceneSketch& s) {
  Funnel(s);
  s.GhostBall(110, 72, 14);
  s.ToolBall(172, 72, 14);
  s.Arrow({126, 40}, {180, 40});
  s.Arrow({180, 50}, {126, 50});
  s.Text(206, 40, "hand leads out");
  s.Text(206, 56, "and back, 20 times");
  s.Line({{220, 140}, {390, 140}}, kMeantLine);
  s.Text(386, 130, "energy given", "end");
  if (s.ours())
    s.Line({{220, 140}, {390, 147}}, s.Strong());
  else
    s.Line({{220, 136}, {390, 84}}, s.Strong());
}

void SwitchedOnOutside(SceneSketch& s) {
  Funnel(s);
  s.ToolBall(186, 60, 14);
  s.Box(178, 16, 16, 28);
  s.Text(206, 24, "guidance is switched on");
  s.Text(206, 40, "while the tool is aside");
  if (s.ours()) {
    s.Text(214, 86, "waits until the tool", "start", s.color());
    s.Text(214, 102, "has been inside", "start", s.color());
    s.Line({{172, 60}, {132, 60}}, {.color = s.color(), .width_px = 2.0, .dashed = true});
  } else {
    s.Arrow({170, 60}, {124, 60}, {.color = s.color(), .width_px = 4.0});
    s.Text(214, 94, "40 N within a tick", "start", s.color());
  }
}

void Ceiling(SceneSketch& s) {
  Funnel(s);
  s.ToolBall(160, 84, 14);
  s.Arrow({160, 68}, {160, 20});
  s.Text(172, 30, "the bone takes all of the");
  s.Text(172, 46, "cell's 200 N, then nothing");
  if (s.ours()) {
    s.Arrow({144, 84}, {128, 84}, s.Strong());
    s.Text(214, 84, "what was not taken", "start", s.color());
    s.Text(214, 100, "is not given", "start", s.color());
  } else {
    s.Arrow({144, 84}, {90, 84}, {.color = s.color(), .width_px = 4.0});
    s.Text(214, 92, "all of it at once", "start", s.color());
  }
}

void FirmHand(SceneSketch& s) {
  Funnel(s);
  s.ToolBall(142, 64, 14);
  s.Box(134, 16, 16, 32);
  s.Arrow({100, 30}, {130, 30});
  s.Text(160, 34, "firm hand leans on the edge");
  s.Line(WavePoints({220, 100}, 390, s.ours() ? 1 : 9, s.ours() ? std::pair{3.0, 0.0} : std::pair{6.0, 26.0}),
         s.Strong());
  s.Text(305, 148, s.ours() ? "still" : "20 N/mm, late: it swings", "middle", s.color());
}

void LetGo(SceneSketch& s) {
  Funnel(s);
  s.ToolBall(190, 62, 14);
  s.Text(212, 34, "17 mm aside, the");
  s.Text(212, 50, "hand lets go");
  if (s.ours()) {
    s.Arrow({174, 62}, {156, 62}, s.Strong());
    s.Text(214, 96, "48 mm/s at most", "start", s.color());
  } else {
    s.Arrow({174, 62}, {84, 62}, {.color = s.color(), .width_px = 4.0});
    s.Text(214, 96, "250 mm/s: it leaps", "start", s.color());
  }
}

// Number, drawing, and the captions below baseline and ours.
constexpr std::array kScenes{
    FailureScene{27, GuidedCycles,
                 "The springs see the measured tool, which is late: every cycle gives more than it took.",
                 "The springs see the commanded tool, and a book of energy bounds what they give."},
    FailureScene{28, SwitchedOnOutside, "The whole force comes at once, with energy that nobody put in.",
                 "The share stays at 0 until the tool has been inside the corridor."},
    FailureScene{29, Ceiling,
                 "The guidance yields on the way out and is back on the way in: the hand is pushed.",
                 "Its share returns only as far as energy was taken before."},
    FailureScene{30, FirmHand, "Stiff springs behind the arm's lag and dead time: the hand is shaken.",
                 "Gains that no hand of the grid makes swing, at the commanded pose."},
    FailureScene{31, LetGo, "A spring accelerates the tool all the way back.",
                 "The force fades with the speed toward the corridor: the tool comes back slowly."},
};

}  // namespace

std::span<const FailureScene> GuidanceScenes() { return kScenes; }

}  // namespace osteon::studies
