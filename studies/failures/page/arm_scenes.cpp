#include <array>

#include "studies/failures/page/failure_scenes.h"

// Sketches of the scenarios of arm, sensor, hand and connections. Each function draws one half of the
// scenario of its name: our method if s.ours(), otherwise the baseline. Coordinates are in pixels of the
// sketch.

namespace osteon::studies {
namespace {

void RestingBuzz(SceneSketch& s) {
  s.BoneBlock(20, 106, 260, 150);
  s.Line({{120, 64}, {120, 10}}, {.color = "#c3cbd2", .width_px = 8.0});
  s.ToolBall(120, 84, 22);
  s.Arrow({152, 10}, {152, 56});
  s.Text(160, 24, "firm hand, 5 to 200 N");
  s.Text(282, 72, "handle");
  if (s.ours()) {
    s.Line({{282, 100}, {390, 100}}, s.Strong());
    s.Text(336, 130, "still", "middle", s.color());
  } else {
    s.Line(WavePoints({282, 100}, 390, 7, {14, 14}), s.Strong());
    s.Text(336, 136, "250 Hz", "middle", s.color());
  }
}

void SimulationStall(SceneSketch& s) {
  std::vector<report::PlotPoint> bone{{20, 150}, {20, 40}};
  for (const report::PlotPoint& p : ArcPoints({140, 24}, 104, 171, 9)) bone.push_back(p);
  bone.insert(bone.end(), {{260, 40}, {260, 150}});
  s.Bone(bone);
  s.GhostBall(140, 110, 18);
  s.ToolBall(140, 62, 18);
  s.Arrow({184, 104}, {184, 62});
  s.Text(194, 26, "hand draws it out;");
  s.Text(278, 66, "no frame comes");
  s.Text(278, 82, "for 20 to 200 ms");
  if (s.ours()) {
    s.Line({{104, 128}, {176, 128}}, s.Strong());
    s.Text(278, 128, "the plane stays", "start", s.color());
    s.Text(278, 144, "where bone is", "start", s.color());
  } else {
    s.Arrow({140, 44}, {140, 4}, s.Strong());
    s.Text(130, 18, "held force", "end", s.color());
  }
}

void Singularity(SceneSketch& s) {
  s.Line({{30, 156}, {90, 156}});
  s.Line(ArcPoints({60, 118}, 196, 8, -34), kMeantLine);
  s.Text(262, 148, "reach", "start");
  s.Arm({{60, 152}, {60, 118}, {148, 80}, {236, 46}});
  s.Arrow({244, 42}, {300, 18});
  s.Text(306, 18, "hand leads on");
  if (s.ours()) {
    s.Text(306, 46, "tool waits at", "start", s.color());
    s.Text(306, 62, "the reach", "start", s.color());
  } else {
    s.Line(ArcPoints({148, 80}, 20, 30, 300), s.Strong());
    s.Arrow({156, 61.7}, {161, 64}, s.Strong());
    s.Text(112, 124, "joint speeds leap", "start", s.color());
  }
}

void JointLimit(SceneSketch& s) {
  s.Line({{20, 156}, {80, 156}});
  s.Arm({{50, 152}, {50, 100}, {120, 44}, {180, 96}});
  s.Line({{180, 96}, {384, 96}}, kMeantLine);
  s.Line({{270, 70}, {270, 124}}, {.color = "#b3261e", .width_px = 2.0});
  s.Text(270, 142, "a joint's limit", "middle");
  s.Arrow({176, 118}, {236, 118});
  s.Text(92, 140, "hand leads along", "start");
  if (s.ours()) {
    s.Arrow({188, 96}, {264, 96}, s.Strong());
    s.Text(282, 88, "waits on the line", "start", s.color());
  } else {
    s.Line({{188, 96}, {256, 96}, {276, 92}, {296, 80}}, s.Strong());
    s.Arrow({296, 80}, {332, 36}, s.Strong());
    s.Text(326, 24, "leaves it", "middle", s.color());
  }
}

void Packets(SceneSketch& s) {
  s.Box(6, 34, 88, 40);
  s.Text(50, 58, "simulation", "middle");
  s.Arrow({98, 54}, {192, 54}, {.color = s.color(), .width_px = 2.0, .dashed = true});
  s.Cross(136, 54, kHandColor);
  s.Text(145, 40, s.ours() ? "planes" : "forces", "middle", s.color());
  s.Text(145, 80, "late, lost", "middle");
  s.Box(196, 34, 60, 40);
  s.Text(226, 58, "loop", "middle");
  s.Arrow({260, 54}, {312, 54}, {.color = kHandColor, .dashed = true});
  std::vector<report::PlotPoint> bone{{316, 92}, {316, 44}};
  for (const report::PlotPoint& p : ArcPoints({355, 44}, 30, 180, 0)) bone.push_back(p);
  bone.insert(bone.end(), {{394, 44}, {394, 92}});
  s.Bone(bone);
  s.ToolBall(355, 56, 17);
  s.Line({{355, 39}, {355, 8}}, {.color = "#c3cbd2", .width_px = 7.0});
  s.Text(344, 18, "hand taps", "end");
  s.Text(110, 130, "tool's swing", "end");
  s.Line(WavePoints({122, 126}, 390, 8, s.ours() ? std::pair{20.0, 0.5} : std::pair{3.0, 26.0}), s.Strong());
}

void Sensor(SceneSketch& s) {
  s.Line({{90, 10}, {210, 10}}, {.color = "#c3cbd2", .width_px = 9.0});
  s.Line({{150, 14}, {150, 100}}, {.color = "#c3cbd2", .width_px = 8.0});
  s.Box(128, 30, 44, 16);
  s.Arrow({174, 38}, {212, 38});
  s.Text(218, 34, "sensor's zero is off by");
  s.Text(218, 50, "0.5 to 5 N, and drifts");
  if (s.ours()) {
    s.ToolBall(150, 112, 20);
    s.Text(180, 116, "rests", "start", s.color());
  } else {
    s.GhostBall(150, 112, 20);
    s.ToolBall(262, 112, 20);
    s.Arrow({174, 112}, {236, 112}, s.Strong());
    s.Text(290, 116, "goes by itself", "start", s.color());
  }
  s.Text(150, 152, "nobody holds the tool", "middle");
}

void Grip(SceneSketch& s) {
  s.Line({{80, 104}, {80, 8}}, {.color = "#c3cbd2", .width_px = 8.0});
  s.ToolBall(80, 112, 20);
  s.Box(56, 30, 18, 34);
  s.Box(86, 30, 18, 34);
  s.Arrow({22, 47}, {52, 47});
  s.Arrow({138, 47}, {108, 47});
  s.Text(146, 51, "grip stiffens, or a clamp closes");
  s.Line({{210, 70}, {210, 136}}, kMeantLine);
  s.Line(WavePoints({140, 104}, 210, 0.5, {8, 8}), {.color = "#59636e", .width_px = 2.0});
  s.Line(
      WavePoints({210, 104}, 390, s.ours() ? 6 : 9, s.ours() ? std::pair{24.0, 0.0} : std::pair{24.0, 24.0}),
      s.Strong());
  s.Text(300, 152, s.ours() ? "force dies out" : "force at 5 to 40 Hz goes on", "middle", s.color());
  s.Text(150, 152, "free swing", "middle");
}

void Saturation(SceneSketch& s) {
  s.Line({{10, 156}, {66, 156}});
  s.Arm({{38, 152}, {38, 104}, {90, 54}, {150, 48}, {150, 74}});
  s.Line({{150, 60}, {150, 122}}, {.color = "#59636e", .width_px = 7.0});
  s.Text(162, 44, "A6: 40 N m");
  s.BoneBlock(156, 84, 196, 150);
  s.Arrow({92, 118}, {142, 118});
  s.Text(140, 144, "200 N", "end");
  s.Arrow({386, 86}, {276, 86}, kMeantLine);
  s.Text(332, 76, "force that was to be", "middle");
  if (s.ours()) {
    s.Arrow({386, 108}, {330, 108}, s.Strong());
    s.Text(386, 134, "what the arm holds of it", "end", s.color());
  } else {
    s.Arrow({386, 94}, {316, 126}, s.Strong());
    s.Text(318, 150, "force that comes of it", "middle", s.color());
  }
}

// Number, drawing, and the captions below baseline and ours.
constexpr std::array kScenes{
    FailureScene{
        6, RestingBuzz,
        "The force is of a millisecond ago, on a stiffness that the loop does not stand: the handle buzzes.",
        "The tick itself evaluates the planes: the handle is still."},
    FailureScene{10, SimulationStall,
                 "The last frame's force is held while the tool leaves: the hand is given energy that it "
                 "never put in.",
                 "The planes of the last frame stay in place: out of the bone there is no force."},
    FailureScene{
        12, Singularity,
        "A straight elbow has no inverse: to follow the hand, the joints would need thousands of times "
        "their speed.",
        "The arm stretches up to its reach within its joint speeds, and the hand feels the end."},
    FailureScene{13, JointLimit,
                 "One joint stops at its limit, the others go on: the tool leaves the line it is led along.",
                 "All joints slow down together: the tool stays on the line."},
    FailureScene{14, Packets,
                 "Forces are computed beyond the wire: what comes late pushes late, and the swing grows.",
                 "Planes are sent and the loop evaluates them: the swing dies out."},
    FailureScene{15, Sensor, "Every newton of a wrong zero is a hand's push: the tool wanders off.",
                 "The bias is taken while the tool waits, and a dead zone covers what is left."},
    FailureScene{16, Grip,
                 "Light gains are unstable with the stiff grip: the force oscillates on, or grows until the "
                 "cell stops.",
                 "The vibration index raises the drag until the force is calm."},
    FailureScene{17, Saturation,
                 "Each joint's torque is clipped by itself: the force turns away from the push.",
                 "The whole force is scaled: less of it, in its own direction."},
};

}  // namespace

std::span<const FailureScene> ArmScenes() { return kScenes; }

}  // namespace osteon::studies
