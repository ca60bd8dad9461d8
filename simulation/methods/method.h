#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

// The methods that the cutting engine is compared with. Each is built as its authors describe it, and states
// every parameter in its own header. Each has the data structures of a competent implementation, since speed
// is compared too.
//
//     kPaperPrinted    paper_engine.h       Kaluschke et al. 2019, equations 1 to 5 as they are printed
//     kPaperCorrected  paper_engine.h       the same structure, with corrected equations
//     kPointshell      pointshell_engine.h  voxmap and pointshell, penalty, quasi-static coupling (VPS)
//     kVoxelProxy      voxel_engine.h       finger-proxy in a voxel volume (CHAI3D)
//     kStamps          stamps_engine.h      this project's packing of balls, tested at one pose per frame

namespace osteon::simulation {

class CarvedShape;

enum class Method : std::uint8_t { kPaperPrinted, kPaperCorrected, kPointshell, kVoxelProxy, kStamps };
inline constexpr std::array kMethods{Method::kPaperPrinted, Method::kPaperCorrected, Method::kPointshell,
                                     Method::kVoxelProxy, Method::kStamps};

/// "paper-printed", "paper", "pointshell", "voxel", "stamps": names in commands, charts and tables.
[[nodiscard]] std::string_view MethodName(Method method);

/// Parameters of a method beyond CuttingParams. Balls and mass points come with the bone: the paper's
/// packings are disjoint (disjoint_packing.h), stamps take any packing.
struct MethodParams {
  double voxel_m{0.25e-3};          ///< edge of a voxel (kPointshell, kVoxelProxy), 0.01 … 5 mm
  double point_spacing_m{0.25e-3};  ///< between the tool's points (kPointshell), 0.01 … 5 mm; VPS: one voxel
};

/// A cutting engine whose remaining bone can be measured.
///
/// As with every engine, Step never throws, reports an input that is not IsUsable as kBadInput, and gives
/// equal bits for equal inputs. A method counts removed volume and mass by its mass points where it has
/// balls, otherwise by its voxels. A snapshot of a voxel method has no balls, and `cleared` refers to its
/// voxels.
class MethodEngine : public CuttingEngine {
 public:
  /// The remaining bone as this method represents it. A copy that does not change while the engine goes on.
  [[nodiscard]] virtual std::unique_ptr<CarvedShape> Shape() const = 0;
  /// Number of balls or voxels that the bone has at the start.
  [[nodiscard]] virtual std::size_t ElementCount() const = 0;
};

/// Makes a compared method.
/// @param bone   its balls and mass points; a voxel method without a solid fills the union of the balls
/// @param solid  the solid that a voxel method fills with voxels, or null; used only during the call
/// @throws std::invalid_argument naming what was found and what is accepted: a tool without a cutting ball,
///   more than kMaxMaterials materials, sizes outside their ranges, a volume of more than 2^31 voxels.
[[nodiscard]] std::unique_ptr<MethodEngine> MakeMethod(Method method, const Bone& bone, const Solid* solid,
                                                       const Tool& tool, const Pose& X_WG,
                                                       const CuttingParams& params,
                                                       const MethodParams& method_params);

}  // namespace osteon::simulation
