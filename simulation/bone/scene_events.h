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

/// A region of tissue that the tool should avoid, or should reach.
struct RegionWatch {
  std::string name;      ///< the event is "NAME reached"
  std::string material;  ///< one of the bone's materials: the region is all its tissue
};

/// Which events of a scene to watch for.
struct SceneEventParams {
  std::vector<RegionWatch> regions{};
  double min_wall_m{0.0};         ///< a wall thinner than this is an event; 0: walls are not watched
  double opening_widening{1.5};   ///< the opening reaches this many radii of the site from its axis
  double wall_spacing_m{0.5e-3};  ///< spacing of the surface's samples
};

/// An event of a frame. Each occurs once in a run.
struct SceneEvent {
  std::string name;          ///< "pulp reached", "wall too thin", "breakthrough"
  rt::Nanoseconds stamp{0};  ///< stamp of the frame
  double value{0.0};         ///< in `unit`: see SceneWatch
  std::string unit{"m"};
  PlainVector3 p_G_m;  ///< the event's place
};

/// Checks the proxy after each frame for the scene's events. Only frames that removed bone count.
///
/// **A region is reached** once a cutting ball's surface meets it: signed distance of the ball's centre to
/// the region minus the radius <= 0. This is exact where the solid knows that distance
/// (Solid::RegionDistance). Elsewhere the region's mass points stand for it, and it is reached once the first
/// of them is cut. Value: the depth of the place below the site's centre, along the site's axis.
///
/// **A wall** is the bone left between the cut and a surface that is not the opening. Its thickness is the
/// distance from a cutting ball's centre to the nearest such point of the surface that faces away from the
/// ball, with bone between the two, minus the ball's radius. The first frame in which nothing is left is the
/// event "breakthrough". Samples of the surface give the start of the search, and the solid's own nearest
/// points refine it: the foot is exact on a plane, and to second order in the spacing elsewhere. Value: the
/// wall's thickness, 0 once it is through; for a breakthrough, the depth of the place as for a region.
///
/// **The opening** is the surface whose normal is within 60 degrees of the site's axis. Up to
/// `opening_widening` radii from the axis it is all surface but what faces the other way (within 60 degrees:
/// a floor). Beyond that it also includes what faces out and towards the axis, such as a cusp's inner slope.
///
/// One or two queries of the solid per frame: call it from the simulation's thread, not in the tick.
class SceneWatch {
 public:
  /// @param solid  the solid that the bone was packed from; must outlive the watch. Null where it is not
  ///   known (a saved packing): mass points stand for every region, and walls are not watched
  /// @throws std::invalid_argument where the bone has no such material, or a figure is out of range.
  SceneWatch(const Solid* solid, const Bone& bone, const Tool& tool, const SceneEventParams& params);

  /// Checks one frame.
  /// @param removed_volume_m3  since the start, as in ContactModel
  /// @returns the events that began in this frame, mostly none.
  [[nodiscard]] std::vector<SceneEvent> Step(const Pose& X_GP, double removed_volume_m3,
                                             rt::Nanoseconds stamp);

  /// Thickness of the thinnest wall so far, 0 where the cut is through; nothing where no wall was seen.
  [[nodiscard]] std::optional<double> min_wall_m() const {
    return min_wall_m_ ? std::optional(std::max(0.0, *min_wall_m_)) : std::nullopt;
  }

 private:
  struct Region {
    std::string name;
    MaterialIndex material;
    std::optional<SampleIndex> points;  // where the solid has no distance to the region
    bool reached{false};
  };
  struct Wall {
    double thickness_m;
    Vector3 p_G_m;  // the point of the surface nearest to the cut
  };
  // Adds the event if a cutting ball reaches the region in this frame.
  void StepRegion(Region& region, const Pose& X_GP, rt::Nanoseconds stamp, std::vector<SceneEvent>& events);
  // The thinnest wall beside the tool, if it is thinner than all walls so far.
  [[nodiscard]] std::optional<Wall> ThinnestWall(const Pose& X_GP) const;
  [[nodiscard]] OrientedPoint Refined(const Vector3& c_m, OrientedPoint at) const;
  [[nodiscard]] bool IsOpening(const OrientedPoint& sample) const;
  [[nodiscard]] double DepthOf(const Vector3& p_G) const;  // below the site's centre, along its axis [m]

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
