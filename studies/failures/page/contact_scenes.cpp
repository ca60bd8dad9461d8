#include <array>

#include "studies/failures/page/failure_scenes.h"

// Sketches of the scenarios in which a tool touches bone that does not change. Each function draws one half
// of the scenario of its name: our method if s.ours(), otherwise the baseline. Coordinates are in pixels of
// the sketch.

namespace osteon::studies {
namespace {

void ThinSheet(SceneSketch& s) {
  s.BoneBlock(40, 78, 360, 90);
  s.Text(44, 108, "sheet of 1 mm");
  s.Arrow({176, 2}, {181, 28});
  s.Text(192, 14, "a shot, 10 to 1000 mm/s");
  if (s.ours()) {
    s.Line({{169, 60}, {193, 130}}, kMeantLine);
    s.Line({{211, 50}, {237, 118}}, kMeantLine);
    s.ToolBall(190, 56, 22);
    s.GhostBall(215, 124, 22);
    s.Text(160, 60, "proxy", "end", s.color());
    s.Text(246, 128, "hand's tool");
  } else {
    s.GhostBall(190, 54, 22, s.color());
    s.ToolBall(215, 124, 22);
    s.Arrow({196, 66}, {210, 108}, s.Strong());
    s.Text(160, 60, "frame n", "end");
    s.Text(246, 128, "frame n + 1", "start", s.color());
  }
}

void ContactSwitch(SceneSketch& s) {
  s.BoneBlock(40, 104, 360, 150);
  s.Line({{120, 76}, {280, 82}}, {.color = "#c3cbd2", .width_px = 9.0});
  s.ToolBall(120, 78, 25);
  s.ToolBall(280, 80, 25);
  s.Arrow({200, 8}, {200, 62});
  s.Text(210, 24, "200 N");
  s.Arrow({240, 58}, {250, 70});
  s.Arrow({160, 68}, {150, 56});
  s.Text(212, 46, "rocks by 0.1 mm");
  s.Arrow({84, 134}, {84, s.ours() ? 92.0 : 50.0}, s.Strong());
  if (s.ours()) {
    s.Arrow({316, 134}, {316, 84}, s.Strong());
    s.Text(200, 136, "each ball has its share", "middle", s.color());
  } else {
    s.Arrow({316, 134}, {316, 60}, {.color = s.color(), .dashed = true});
    s.Text(200, 126, "all of the force here,", "middle", s.color());
    s.Text(200, 142, "a millisecond later there", "middle", s.color());
  }
}

void ConcaveCup(SceneSketch& s) {
  std::vector<report::PlotPoint> bone{{20, 146}, {20, 16}};
  for (const report::PlotPoint& p : ArcPoints({150, 16}, 92, 180, 0)) bone.push_back(p);
  bone.insert(bone.end(), {{280, 16}, {280, 146}});
  s.Bone(bone);
  // The head touches the wall on the line through both centres, 35 deg from the axis.
  s.Tool(ArcPoints({156, 24}, 82, 180, 0));
  s.Line({{156, 24}, {156, 2}}, {.color = "#59636e", .width_px = 6.0});
  s.Arrow({202.8, 91.4}, {171, 46}, kMeantLine);
  s.Arrow({202.8, 91.4}, s.ours() ? report::PlotPoint{174, 50.2} : report::PlotPoint{154, 66}, s.Strong());
  s.Line({{290, 56}, {312, 56}}, kMeantLine);
  s.Text(317, 60, "cup's normal");
  s.Line({{290, 80}, {312, 80}}, s.Strong());
  s.Text(317, 84, s.ours() ? "ours" : "one pair's", "start", s.color());
}

void Corner(SceneSketch& s) {
  s.Bone({{40, 8}, {90, 8}, {90, 112}, {280, 112}, {280, 148}, {40, 148}});
  s.GhostBall(106, 96, 30);
  s.ToolBall(120, 82, 30);
  s.Arrow({192, 12}, {164, 60});
  s.Text(198, 18, "hand pushes into it");
  s.Arrow({120, 82}, {154, 24}, kMeantLine);
  if (s.ours())
    s.Arrow({120, 82}, {152, 27.5}, s.Strong());
  else
    s.Arrow({120, 82}, {120, 26}, s.Strong());
  s.Line({{212, 60}, {234, 60}}, kMeantLine);
  s.Text(240, 64, "the spring's force");
  s.Line({{212, 82}, {234, 82}}, s.Strong());
  s.Text(240, 86, s.ours() ? "force of both planes" : "force of one plane", "start", s.color());
}

void OwnSlot(SceneSketch& s) {
  s.Bone({{40, 44}, {140, 44}, {140, 122}, {204, 122}, {204, 44}, {300, 44}, {300, 148}, {40, 148}});
  const double x = s.ours() ? 0.0 : 11.0;
  // shaft and head, tilted by 12 deg
  s.Tool({{152 + x, 92}, {170 + x, 8}, {208 + x, 16}, {190 + x, 100}});
  s.ToolBall(169 + x, 96, 25);
  s.Arrow({222, 14}, {262, 14});
  s.Text(268, 18, "hand tilts it");
  if (!s.ours()) {
    s.Tool({{204, 47}, {211, 47}, {206, 68}, {204, 76}});
    s.Line({{204, 47}, {211, 47}, {206, 68}, {204, 76}, {204, 47}}, s.Strong());
    s.Text(216, 66, "overlap", "start", s.color());
  } else {
    s.Text(212, 66, "touches", "start", s.color());
  }
  s.Text(48, 140, "slot that the tool has cut");
}

void Cogging(SceneSketch& s) {
  s.BoneBlock(30, 112, 310, 152);
  for (int i = 0; i < 19; ++i) s.BoneBall(42.0 + 14.2 * i, 112, 10);
  for (double angle_deg = 0.0; angle_deg <= 180.0; angle_deg += 20.0) {
    const report::PlotPoint p = ArcPoints({165, 52}, 37, angle_deg, angle_deg).front();
    s.ToolBall(p.x, p.y, 10);
  }
  s.GhostBall(165, 52, 48);
  s.Arrow({226, 52}, {270, 52});
  s.Text(276, 56, "50 mm/s");
  s.Arrow({165, 96}, s.ours() ? report::PlotPoint{165, 24} : report::PlotPoint{128, 34}, s.Strong());
  if (!s.ours()) s.Line({{165, 96}, {165, 24}}, kMeantLine);
  s.Text(226, 92, s.ours() ? "force stays upright" : "force swings to and fro", "start", s.color());
}

void Leak(SceneSketch& s) {
  s.Line({{30, 60}, {300, 60}}, kMeantLine);
  s.Text(306, 64, "face");
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i < 7; ++i) s.BoneBall(52.0 + 36.0 * i, 77.0 + 32.0 * row, s.ours() ? 21 : 16);
  for (int row = 0; s.ours() && row < 3; ++row)
    for (int i = 0; i < 6; ++i) s.BoneBall(70.0 + 36.0 * i, 66.0 + 32.0 * row, 9);
  const double tip = s.ours() ? 57.0 : 148.0;
  s.Line({{178, 6}, {178, tip}}, {.color = "#59636e", .width_px = 2.6});
  s.Arrow({166, 8}, {166, 40});
  s.Text(188, 22, "probe, R = 0.1 mm");
  s.Text(306, s.ours() ? 88 : 148, s.ours() ? "it stays out" : "it slips in", "start", s.color());
}

void FastRotation(SceneSketch& s) {
  s.BoneBlock(241, 64, 300, 96);
  s.Text(306, 84, "post");
  const std::vector<report::PlotPoint> arc = ArcPoints({90, 80}, 150, 26, s.ours() ? 9 : -26);
  s.Line({{90, 80}, arc.front()}, {.color = "#c3cbd2", .width_px = 5.0});
  s.ToolBall(90, 80, 5);
  s.Text(80, 84, "pivot", "end");
  s.Line(ArcPoints({90, 80}, 150, 26, -26), kMeantLine);
  if (s.ours()) {
    s.Line(arc, s.Strong());
    s.GhostBall(224.8, 14.2, 10);
    s.ToolBall(arc.back().x - 3, arc.back().y + 4, 10);
    s.Text(262, 128, "stops at the first", "start", s.color());
    s.Text(262, 144, "contact on the arc", "start", s.color());
  } else {
    s.Line({arc.front(), arc.back()}, s.Strong());
    s.ToolBall(224.8, 14.2, 10);
    s.GhostBall(240, 80, 10, s.color());
    s.Text(262, 128, "tests the chord: free", "start", s.color());
  }
  s.ToolBall(224.8, 145.8, 10);
  s.Text(80, 20, "one turn, after", "middle");
  s.Text(80, 36, "a stall of 100 ms", "middle");
}

// Number, drawing, and the captions below baseline and ours.
constexpr std::array kScenes{
    FailureScene{
        1, ThinSheet,
        "It looks at discrete poses: one lies above the sheet, the next below, and the tool is through.",
        "The whole way between two frames is searched: the proxy stops on the sheet."},
    FailureScene{
        2, ContactSwitch,
        "Only the pair that was met makes force: as the tool rocks, the torque jumps from side to side.",
        "Every pair in reach has its plane, and the torque follows the rocking."},
    FailureScene{
        3, ConcaveCup,
        "The normal is that of one packing ball, and jumps from ball to ball as the head moves along.",
        "The normal is that of the overlap as a whole, close to the cup's own."},
    FailureScene{4, Corner, "Only the first contact makes force; the other wall is not felt.",
                 "Floor and wall both make their planes: the force is what a spring would have there."},
    FailureScene{5, OwnSlot,
                 "A start in contact is taken for free: the shaft goes into the wall of its own slot.",
                 "The proxy rests against the walls, and comes out as it went in."},
    FailureScene{7, Cogging,
                 "Each pair of balls tilts the normal: sliding along a flat plate feels like cogs.",
                 "The normal is a sum over the overlap: hardly any force along the plate."},
    FailureScene{8, Leak, "Disjoint balls leave gaps, and a thin probe slips between them.",
                 "Overlapping balls close the surface: the probe stays at the face."},
    FailureScene{11, FastRotation,
                 "The straight chord of a turn misses the post: the ball ends up inside it.",
                 "The turn is followed along its arc up to first contact."},
};

}  // namespace

std::span<const FailureScene> ContactScenes() { return kScenes; }

}  // namespace osteon::studies
