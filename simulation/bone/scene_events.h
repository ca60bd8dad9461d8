#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "simulation/bone/bone.h"
#include "simulation/packing/surface_samples.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// A region of tissue that the tool should avoid, or should reach. That the cut reaches it is an event.
struct RegionWatch {
  std::string name;      ///< the event is "NAME reached"
  std::string material;  ///< one of the bone's materials; the region is all tissue of this material
};

/// The events of a scene that are watched for.
struct SceneEventParams {
  std::vector<RegionWatch> regions{};
  double min_wall_m{0.0};         ///< a wall thinner than this is an event; 0: walls are not watched
  double opening_widening{1.5};   ///< radius of the opening's zone, in radii of the site
  double wall_spacing_m{0.5e-3};  ///< spacing of the surface's samples
};

/// An event in a frame. Each event occurs at most once in a run.
struct SceneEvent {
  std::string name;          ///< "pulp reached", "wall too thin", "breakthrough"
  rt::Nanoseconds stamp{0};  ///< stamp of the frame
  double value{0.0};         ///< in `unit`: see SceneWatch
  std::string unit{"m"};
  PlainVector3 p_G_m;  ///< the event's place
};

/// Checks the proxy after each frame for the scene's events. Frames that removed no bone are skipped.
///
/// **A region is reached** once a cutting ball's surface meets it: signed distance of the ball's centre to
/// the region minus the ball's radius <= 0. This is exact if the solid knows that distance
/// (Solid::RegionDistance). If not, the region's mass points represent the region, and it is reached once the
/// first of these points is cut. Value: the depth of the place below the site's centre, along the site's
/// axis.
///
/// **A wall** is the bone left between the cut and a surface that is not the opening. Its thickness is the
/// distance from a cutting ball's centre to the nearest point of that surface, minus the ball's radius. Only
/// points whose surface faces away from the ball, with bone between the two, are considered. The first frame
/// in which no thickness is left is the event "breakthrough". The search begins at samples of the surface and
/// is refined with the solid's own nearest points. The point found is exact on a plane, and accurate to
/// second order in the samples' spacing elsewhere. Value: the wall's thickness, 0 once it is cut through; for
/// a breakthrough, the depth of the place as for a region.
///
/// **The opening** is the surface whose normal is within 60 degrees of the site's axis. Up to
/// `opening_widening` site radii from the axis, the opening is all surface except a floor, whose normal is
/// within 60 degrees of the opposite direction. Farther out, the opening also includes surface that faces
/// outward and towards the axis, such as a cusp's inner slope.
///
/// A frame takes one or two queries of the solid, so call it from the simulation's thread, not in a tick.
class SceneWatch {
 public:
  /// @param solid  the solid that the bone was packed from; must outlive the watch. Null if it is not known
  /// (a saved packing): mass points then represent every region, and walls are not watched
  /// @throws std::invalid_argument if the bone has no such material, or a figure is out of range.
  SceneWatch(const Solid* solid, const Bone& bone, const Tool& tool, const SceneEventParams& params);

  /// Checks one frame.
  /// @param removed_volume_m3  volume removed since the start (ContactModel::removed_volume_m3)
  /// @returns the events that began in this frame, mostly none.
  [[nodiscard]] std::vector<SceneEvent> Step(const Pose& X_GP, double removed_volume_m3,
                                             rt::Nanoseconds stamp);

  /// Thickness of the thinnest wall so far, 0 if it is cut through; nothing if no wall was seen.
  [[nodiscard]] std::optional<double> min_wall_m() const {
    return min_wall_m_ ? std::optional(std::max(0.0, *min_wall_m_)) : std::nullopt;
  }

 private:
  struct Region {
    std::string name;
    MaterialIndex material;
    std::optional<SampleIndex> points;  // the region's mass points, if the solid has no distance to it
    bool reached{false};
  };
  struct Wall {
    double thickness_m;
    Vector3 p_G_m;  // the point of the surface nearest to the cut
  };
  // Adds the event if a cutting ball reaches the region in this frame.
  void StepRegion(Region& region, const Pose& X_GP, rt::Nanoseconds stamp, std::vector<SceneEvent>& events);
  // Finds the thinnest wall beside the tool; returns nothing if it is not thinner than all walls so far.
  [[nodiscard]] std::optional<Wall> ThinnestWall(const Pose& X_GP) const;
  [[nodiscard]] OrientedPoint Refined(const Vector3& c_m, OrientedPoint at) const;
  [[nodiscard]] bool IsOpening(const OrientedPoint& sample) const;
  [[nodiscard]] double DepthOf(const Vector3& p_G) const;  // below the site's centre along its axis [m]

  const Solid* solid_;
  CutSite site_;
  SceneEventParams params_;
  std::vector<ToolBall> cutting_;  // the tool's cutting balls
  std::vector<Region> regions_;
  SampleIndex walls_;  // samples of the surface that is not the opening
  double removed_volume_m3_{0.0};
  std::optional<double> min_wall_m_;
  bool wall_too_thin_{false}, broke_through_{false};
};

}  // namespace osteon::simulation
