#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace osteon::config {

/// What decides how the bone gives way in a scenario.
enum class ScenarioEngine : std::uint8_t {
  kPlane,      ///< a rigid plane at the site (hil/plane_engine.h): what is looked at is control alone
  kReference,  ///< the cutting model in double precision
  kVulkan,     ///< the same on a device
};

/// By how much a scenario's run may differ from its golden trace, by kind of quantity, in SI. As they stand
/// here they are far above what another compiler or processor makes of the same program, and far below what a
/// change of it does.
struct TraceTolerances {
  double position_m{1e-6};
  double angle_rad{1e-5};
  double force_N{0.01};
  double torque_Nm{1e-3};
  double speed_rad_per_s{0.01};  ///< of the spindle
  double volume_m3{1e-10};       ///< of bone that was removed
  double energy_J{1e-4};
  double share{1e-3};   ///< of what lies between 0 and 1
  double event_s{0.0};  ///< by which a state, a fault or an event of the scene may come earlier or later
};

/// A scenario of `osteon regress`: a cell, what it says otherwise there, and how long it is run in virtual
/// time.
struct ScenarioConfig {
  std::filesystem::path file;
  std::string name;   ///< of the file, without its ending
  std::string shows;  ///< in a line
  std::filesystem::path cell;
  ScenarioEngine engine{ScenarioEngine::kReference};
  double seconds{1.0};    ///< in COMMANDING_ACTIVE
  double frame_s{0.002};  ///< from one frame of the simulation to the next, and from its pose to its model
  bool planned{false};    ///< the bone is packed as `osteon demo` plans it, not as the scene's `packing` says
  double sample_s{0.02};  ///< from one sample of the golden trace to the next
  int recoveries{0};      ///< so often the loop begins again after a stop by the connection to the arm
  std::optional<double> pause_s, resume_s;  ///< an operator's pause and its end, after rendering began
  TraceTolerances tolerances;

  /// Where its golden trace is: beside it, in a folder of its own.
  [[nodiscard]] std::filesystem::path golden() const {
    return file.parent_path() / "golden" / (name + ".txt");
  }
};

/// The key whose mapping says what the cell says otherwise: config::Overlay.
inline constexpr const char* kOverridesKey = "overrides";

}  // namespace osteon::config
