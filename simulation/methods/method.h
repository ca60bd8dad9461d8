#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

// Other cutting methods, with which the cutting engine is compared. Each method follows its authors'
// description; its header states every parameter. Speed is compared, too, so each method has the data
// structures of a competent implementation.
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

/// "paper-printed", "paper", "pointshell", "voxel", "stamps": the method's name in commands, charts and
/// tables.
[[nodiscard]] std::string_view MethodName(Method method);

/// Parameters of a method in addition to CuttingParams. The packing is given with the bone: the paper's
/// methods expect a disjoint one (disjoint_packing.h), kStamps accepts any.
struct MethodParams {
  double voxel_m{0.25e-3};          ///< edge of a voxel (kPointshell, kVoxelProxy), 0.01 … 5 mm
  double point_spacing_m{0.25e-3};  ///< spacing of the tool's points (kPointshell), 0.01 … 5 mm; in VPS equal
                                    ///< to the voxel's edge
};

/// A cutting engine whose remaining bone can be measured.
///
/// As with every engine, Step never throws, reports an input that is not IsUsable as kBadInput, and gives
/// equal bits for equal inputs. A method with balls sums up removed volume and mass over its mass points, a
/// voxel method over its voxels. The carved state of a voxel method has no balls, and its `cleared` refers to
/// the voxels.
class MethodEngine : public CuttingEngine {
 public:
  /// A copy of the remaining bone in this method's representation. It does not change when the engine
  /// continues.
  [[nodiscard]] virtual std::unique_ptr<CarvedShape> Shape() const = 0;
  /// Number of balls or voxels that the bone has at the start.
  [[nodiscard]] virtual std::size_t ElementCount() const = 0;
};

/// Makes a compared method.
/// @param bone  balls and mass points; without a solid, a voxel method fills the union of the balls with
///   voxels
/// @param solid  the solid that a voxel method fills with voxels, or null; used only during the call
/// @throws std::invalid_argument naming what was found and what is accepted: a tool without a cutting ball,
///   more than kMaxMaterials materials, sizes outside their ranges, a volume of more than 2^31 voxels.
[[nodiscard]] std::unique_ptr<MethodEngine> MakeMethod(Method method, const Bone& bone, const Solid* solid,
                                                       const Tool& tool, const Pose& X_WG,
                                                       const CuttingParams& params,
                                                       const MethodParams& method_params);

}  // namespace osteon::simulation
