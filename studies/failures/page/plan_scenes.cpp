#include <array>

#include "studies/failures/page/failure_scenes.h"

// Sketches of the scenarios of a surgical plan and its assessment. Each function, but AxisArrow, draws one
// half of the scenario of its name: our method if s.ours(), otherwise the baseline. Coordinates are in pixels
// of the sketch.

namespace osteon::studies {
namespace {

// A cup's axis: an arrow from the cup's centre by (x, y).
void AxisArrow(SceneSketch& s, report::PlotPoint centre, double x, double y, const SketchLine& line) {
  s.Arrow(centre, {centre.x + x, centre.y + y}, line);
}

void CupDefinitions(SceneSketch& s) {
  s.Bone({{40, 20}, {190, 20}, {190, 60}, {130, 110}, {40, 130}});
  s.Line(ArcPoints({150, 90}, 44.0, 200.0, 380.0));
  AxisArrow(s, {150, 90}, 62, 46, kMeantLine);
  s.Text(226, 142, "planned: 40, 20");
  if (s.ours()) {
    AxisArrow(s, {150, 90}, 62, 46, s.Strong());
    s.Text(226, 70, "any definition,", "start", s.color());
    s.Text(226, 86, "the same axis", "start", s.color());
  } else {
    AxisArrow(s, {150, 90}, 74, 28, s.Strong());
    s.Text(236, 86, "another axis: 5 deg off", "start", s.color());
  }
}

void WrongSide(SceneSketch& s) {
  s.Bone({{120, 20}, {280, 20}, {300, 70}, {260, 130}, {140, 130}, {100, 70}});
  AxisArrow(s, {120, 84}, -62, 40, kMeantLine);
  s.Text(40, 150, "right hip");
  s.Text(360, 150, "left hip", "end");
  if (s.ours()) {
    s.Cross(306, 104, s.color());
    s.Text(320, 84, "refused", "start", s.color());
  } else {
    AxisArrow(s, {120, 84}, 62, 40, s.Strong());
    s.Text(200, 112, "mirrored axis", "start", s.color());
  }
}

void SmallCap(SceneSketch& s) {
  s.Line(ArcPoints({200, 20}, 110.0, 50.0, 130.0), kMeantLine);
  // errors of the points' distance from the centre
  const double errors_px[] = {4, -5, 3, -2, 5, -4, 2, -3, 4, -5, 3};
  for (int i = 0; i < 11; ++i) {
    const auto at = ArcPoints({200, 20}, 110.0 + errors_px[i], 52.0 + 7.6 * i, 52.5 + 7.6 * i);
    s.BoneBall(at.front().x, at.front().y, 3.0);
  }
  if (s.ours()) {
    s.Line(ArcPoints({200, 20}, 110.0, 45.0, 135.0), s.Strong());
    s.Text(200, 60, "the true radius", "middle", s.color());
  } else {
    s.Line(ArcPoints({200, 44}, 86.0, 30.0, 150.0), s.Strong());
    s.Text(200, 60, "too small, too deep", "middle", s.color());
  }
}

void CoarsePacking(SceneSketch& s) {
  for (int i = 0; i < 7; ++i) {
    const auto at = ArcPoints({200, -40}, 178.0, 60.0 + 10.0 * i, 60.5 + 10.0 * i);
    s.BoneBall(at.front().x, at.front().y, 19.0);
  }
  s.Line(ArcPoints({200, -40}, 158.5, 50.0, 130.0), kMeantLine);
  if (s.ours()) {
    for (int i = 0; i < 7; ++i) {
      const auto at = ArcPoints({200, -40}, 158.5, 60.0 + 10.0 * i, 60.5 + 10.0 * i);
      s.GhostBall(at.front().x, at.front().y, 3.0, s.color());
    }
    s.Text(200, 60, "where the reamer touched", "middle", s.color());
  } else {
    for (int i = 0; i < 6; ++i) {
      const auto at = ArcPoints({200, -40}, 166.0, 65.0 + 10.0 * i, 65.5 + 10.0 * i);
      s.Arrow({200, 20}, at.front(), s.Strong());
    }
    s.Text(20, 40, "rays end in valleys", "start", s.color());
  }
}

// Number, drawing, and the captions below baseline and ours.
constexpr std::array kScenes{
    FailureScene{23, CupDefinitions,
                 "Two numbers without their definition: read as operative angles, they are another cup.",
                 "Every conversion goes through the axis, which all definitions share."},
    FailureScene{24, WrongSide, "The left hip's plan at the right hip: its mirrored axis is reamed.",
                 "An axis more than 45 degrees off the native cup is refused."},
    FailureScene{25, SmallCap,
                 "The algebraic fit of a small, rough cap is biased: a radius too small, a centre too deep.",
                 "The geometric fit has no bias, and says how sure it is; below 45 degrees it refuses."},
    FailureScene{26, CoarsePacking,
                 "Rays meet the valleys between large balls as well: the sphere comes out too large.",
                 "Each cut ball touches the reamer's sphere at one point: those points are fitted."},
};

}  // namespace

std::span<const FailureScene> PlanScenes() { return kScenes; }

}  // namespace osteon::studies
