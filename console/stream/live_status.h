#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "console/stream/live_window.h"

namespace osteon::console {

/// One part of the cell's latency, as a mean over the run so far.
struct LatencyPartStatus {
  std::string name;  ///< "sensor", "link", "tick", "arm", "model"
  double mean_ms{0.0};
  bool measured{false};  ///< false: assumed
};

/// The cell's latency: from the hand's force to the arm's motion, and from the bone's contact to the hand.
struct LatencyStatus {
  bool known{false};           ///< false: the arm was not commanded yet
  bool measured{false};        ///< every part is measured
  bool hand_moves_arm{false};  ///< impedance law: the hand moves the arm without the loop; no hand_to_arm_ms
  double hand_to_arm_ms{0.0}, bone_to_hand_ms{0.0};
  std::vector<LatencyPartStatus> parts{};
};

/// A run's note on a latched fault: all that the run knows besides the name.
struct FaultNote {
  std::string seen;  ///< the measured and the accepted value: "the reading is 101 ms old, accepted 100 ms"
  std::string page;  ///< path of the stop's page, which is written once the arm has come to rest; empty: none
};

/// The facts of a cell that a live view needs besides the stream.
struct LiveContext {
  double force_limit_N{0.0};       ///< the cell's, on the coupling
  std::string force_limit_from{};  ///< where this limit comes from: "cell", "ceiling", "stored energy"
  double torque_limit_Nm{0.0};     ///< the cell's, on the coupling; 0: not known
  /// Unit vector in W that points out of the site's opening; a positive feed is against it. Empty: not known.
  std::optional<PlainVector3> axis_W{};
  bool has_plc{false};  ///< motion needs a PLC's permission
  /// Depth of the tool's apex at a proxy pose in W, below the cup's first floor [m]; empty: not known.
  std::function<double(const Pose& X_WP)> depth_m{};
  /// Distance left to the depth limit in a tick [m]; empty: the cell has none.
  std::function<double(const control::TickRecord&)> depth_left_m{};
  /// The run's note on a fault (a bit of safety::Fault), callable from any thread; empty: nothing.
  std::function<FaultNote(std::uint32_t fault)> fault{};
  /// Free space on the disk to which the recording is written [bytes], callable from any thread; empty: not
  /// known.
  std::function<std::optional<std::uintmax_t>()> disk_left_B{};
  /// Latency of the run so far, callable from any thread; empty: not known.
  std::function<LatencyStatus()> latency{};
  /// Time by which the carved bone on the pages is behind the engine [s], callable from any thread; empty, or
  /// nothing returned: no bone is shown that follows the cut.
  std::function<std::optional<double>()> bone_age_s{};
};

/// A condition of motion.
struct PermitStatus {
  std::string text;  ///< the condition in words
  bool holds{false};
};

/// A latched fault, in the catalogue's words.
struct FaultStatus {
  std::string name, cause, reaction, clearing;
  bool allows_recovery{false};  ///< a recovery may clear the fault within the run
  FaultNote note{};
};

/// The cell's status in words and figures. The status line, `osteon status` and the console all show it.
struct LiveStatus {
  bool known{false};               ///< false: nothing was recorded yet
  int state_number{-1};            ///< safety::CellState; -1: unknown
  std::string state, does, leave;  ///< name, action and ways out of the state (safety::Describe)
  bool can_pause{false}, can_resume{false};
  /// the arm is at rest, all latched faults allow a recovery, and no stop is requested
  bool can_recover{false};
  /// The conditions of motion: as they are now, or, while the arm moves, as they were when motion began; from
  /// then on a condition that ends is a fault.
  std::vector<PermitStatus> permits;
  bool moves{false};                 ///< the cell is in a state in which the arm moves
  bool permits_known{false};         ///< false: they are not evaluated in this state (a stop, a fault)
  std::vector<std::string> limits;   ///< names of the limits that acted in the window
  std::vector<int> limit_numbers;    ///< their numbers (safety::Limit)
  std::vector<double> limits_for_s;  ///< how long each has acted so far
  std::vector<FaultStatus> faults;
  double force_N{0.0}, force_limit_N{0.0}, hand_N{0.0};
  std::string force_limit_from;  ///< as in LiveContext
  /// Bound of the force in the last tick. If a limit reduced the force in this tick, the bound is the force
  /// itself, at most force_limit_N; otherwise it is force_limit_N.
  double force_limit_now_N{0.0};
  int force_limit_number{-1};  ///< safety::Limit that reduced the force; -1: none did
  double torque_Nm{0.0}, torque_limit_Nm{0.0};
  double depth_mm{0.0}, deepest_mm{0.0};
  double depth_left_mm{std::numeric_limits<double>::infinity()};  ///< distance left to the depth limit;
                                                                  ///< infinite: the cell has no depth limit
  /// commanded speed of the tool along the site's axis, positive into the bone
  std::optional<double> feed_mm_per_s{};
  double speed_mm_per_s{0.0}, spindle_rpm{0.0}, spindle_torque_Nm{0.0};
  double removed_mm3{0.0};
  bool gives_way{false};                                  ///< tool, tissue or mount is compliant in this cell
  double bend_mm{0.0}, layer_mm{0.0}, mount_mm{0.0};      ///< displacement of tool, surface layer, mount
  std::optional<double> model_age_ms{}, sensor_age_ms{};  ///< empty: none has come yet
  double frame_us{0.0};                                   ///< 0: no frame yet
  std::optional<double> arm_age_ms{}, plc_age_ms{};     ///< maximum in the window; empty: no message, no PLC
  double compute_p99_us{0.0}, wakeup_p99_us{0.0};       ///< as in LiveWindow
  std::uint32_t arm_messages_lost{0}, answers_lost{0};  ///< so far, between the arm and the loop
  std::optional<std::uintmax_t> disk_left_B{};          ///< as in LiveContext
  /// age of the carved bone that the pages show (LiveContext::bone_age_s)
  std::optional<double> bone_age_ms{};
  double rendered_s{0.0}, paused_s{0.0};
  LatencyStatus latency{};
};

/// The status as of a window's last tick and frame.
[[nodiscard]] LiveStatus StatusOf(const LiveWindow& window, const LiveContext& context);

/// The status as one line of at most `columns` columns: state, force, depth, limits, model's age, time.
/// @param wanted_s  seconds of rendering that the run was asked for; 0: no end
[[nodiscard]] std::string StatusLine(const LiveStatus& status, double wanted_s, std::size_t columns);

/// The status as a JSON object (osteon.status/1), in one line.
[[nodiscard]] std::string StatusJson(const LiveStatus& status);

/// Returns the name of a limit for people: "tool speed". @param number  of safety::Limit
[[nodiscard]] std::string LimitName(int number);

}  // namespace osteon::console
