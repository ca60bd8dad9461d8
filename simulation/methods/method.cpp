#include "simulation/methods/method.h"

#include <stdexcept>

#include "simulation/methods/paper_engine.h"
#include "simulation/methods/pointshell_engine.h"
#include "simulation/methods/stamps_engine.h"
#include "simulation/methods/voxel_engine.h"

namespace osteon::simulation {

std::string_view MethodName(Method method) {
  switch (method) {
    case Method::kPaperPrinted:
      return "paper-printed";
    case Method::kPaperCorrected:
      return "paper";
    case Method::kPointshell:
      return "pointshell";
    case Method::kVoxelProxy:
      return "voxel";
    case Method::kStamps:
      return "stamps";
  }
  return "unknown";
}

std::unique_ptr<MethodEngine> MakeMethod(Method method, const Bone& bone, const Solid* solid,
                                         const Tool& tool, const Pose& X_WG, const CuttingParams& params,
                                         const MethodParams& method_params) {
  switch (method) {
    case Method::kPaperPrinted:
    case Method::kPaperCorrected:
      return std::make_unique<PaperEngine>(method == Method::kPaperPrinted, bone, solid, tool, X_WG, params);
    case Method::kPointshell:
      return std::make_unique<PointshellEngine>(bone, solid, tool, X_WG, params, method_params);
    case Method::kVoxelProxy:
      return std::make_unique<VoxelEngine>(bone, solid, tool, X_WG, params, method_params.voxel_m);
    case Method::kStamps:
      return std::make_unique<StampsEngine>(bone, solid, tool, X_WG, params);
  }
  throw std::invalid_argument("method: found a number that is no method");
}

}  // namespace osteon::simulation
