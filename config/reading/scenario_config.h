#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace osteon::config {

/// The engine of a scenario, which decides how the bone yields.
enum class ScenarioEngine : std::uint8_t {
  kPlane,      ///< a rigid plane at the site (studies/regress/plane_engine.h): tests control alone
  kReference,  ///< the cutting model in double precision
  kVulkan,     ///< the cutting model on a graphics device (Vulkan)
};

/// Largest differences of a scenario's run from its golden trace, by kind of quantity, in SI. The defaults
/// are far above the differences between compilers or processors, and far below those that a change of the
/// program's behaviour makes.
struct TraceTolerances {
  double position_m{1e-6};
  double angle_rad{1e-5};
  double force_N{0.01};
  double torque_Nm{1e-3};
  double speed_rad_per_s{0.01};  ///< speed of the spindle
  double volume_m3{1e-10};       ///< volume of removed bone
  double energy_J{1e-4};
  double share{1e-3};   ///< any quantity between 0 and 1
  double event_s{0.0};  ///< difference in time of a state, a fault or an event of the scene
};

/// A scenario of `osteon regress`: a cell, the values that it overrides, and the duration in virtual time.
struct ScenarioConfig {
  std::filesystem::path file;
  std::string name;   ///< of the file, without its extension
  std::string shows;  ///< what the scenario shows, in one line
  std::filesystem::path cell;
  ScenarioEngine engine{ScenarioEngine::kReference};
  double seconds{1.0};    ///< duration of COMMANDING_ACTIVE
  double frame_s{0.002};  ///< time between two frames; also the time from a frame's tool pose until the loop
                          ///< gets the frame's model
  bool planned{false};    ///< the bone is packed as `osteon demo` plans it, not as the scene's `packing` says
  double sample_s{0.02};  ///< time between two samples of the golden trace
  /// number of times that the loop recovers after a stop caused by the connection to the arm
  int recoveries{0};
  /// times of an operator's pause and of its end, counted from the begin of rendering
  std::optional<double> pause_s, resume_s;
  std::filesystem::path plan;      ///< surgical plan whose guidance the loop uses; empty: none
  std::optional<double> guidance;  ///< gain of the guidance, 0 … 1; absent: the gain of the plan
  TraceTolerances tolerances;

  /// Path of its golden trace: in a folder beside the file.
  [[nodiscard]] std::filesystem::path golden() const {
    return file.parent_path() / "golden" / (name + ".txt");
  }
};

/// Key of a scenario file's mapping of values that override the cell's (config::Overlay).
inline constexpr const char* kOverridesKey = "overrides";

}  // namespace osteon::config
