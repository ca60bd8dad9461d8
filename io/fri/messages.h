#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>

#include "control/ports.h"
#include "kinematics/spatial.h"

// FRI messages as plain data, for all versions. Fields that a version does not have stay empty. The enums
// have the numbers that FRI uses.

namespace osteon::io {

enum class FriQuality : std::uint8_t { kPoor = 0, kFair = 1, kGood = 2, kExcellent = 3 };
enum class FriSafetyState : std::uint8_t { kNormal = 0, kStopLevel0 = 1, kStopLevel1 = 2, kStopLevel2 = 3 };
enum class FriOperationMode : std::uint8_t { kT1 = 0, kT2 = 1, kAutomatic = 2 };
enum class FriDriveState : std::uint8_t { kOff = 0, kTransitioning = 1, kActive = 2 };
enum class FriOverlay : std::uint8_t { kNone = 0, kJoint = 1, kCartesian = 2 };
enum class FriIoType : std::uint8_t { kBoolean = 0, kDigital = 1, kAnalog = 2 };
enum class FriIoDirection : std::uint8_t { kInput = 0, kOutput = 1 };

/// Largest numbers of transformations and of inputs and outputs in a message.
inline constexpr std::size_t kFriMaxTransformations = 5, kFriMaxIos = 10;

/// The arm's clock.
struct FriTime {
  std::uint32_t sec{0}, nanosec{0};
  bool operator==(const FriTime&) const = default;
};

/// A name with FRI's limits: at most 63 characters, none of them NUL. A name from the arm may contain any
/// other bytes.
class FriName {
 public:
  static constexpr std::size_t kMaxLength = 63;
  constexpr FriName() = default;
  /// Truncates the name after 63 characters or at the first NUL; see Fits().
  explicit constexpr FriName(std::string_view name) noexcept
      : length_(std::min({name.size(), name.find('\0'), kMaxLength})) {
    for (std::size_t i = 0; i < length_; ++i) text_[i] = name[i];
  }
  /// Whether a name is not truncated by the constructor.
  [[nodiscard]] static constexpr bool Fits(std::string_view name) noexcept {
    return name.size() <= kMaxLength && name.find('\0') == std::string_view::npos;
  }
  [[nodiscard]] constexpr std::string_view view() const noexcept { return {text_.data(), length_}; }
  [[nodiscard]] constexpr const char* c_str() const noexcept { return text_.data(); }
  constexpr bool operator==(const FriName& other) const noexcept { return view() == other.view(); }

 private:
  std::array<char, kMaxLength + 1> text_{};
  std::size_t length_{0};
};

/// A frame that the robot program registered for the client to move, or a pose of the arm. Lengths are in m
/// here, and in mm on the wire.
struct FriTransformation {
  FriName name;
  PlainPose X{};
  std::optional<FriTime> time{};
};

/// An input or output of the robot's field buses. `digital` is used by kBoolean and kDigital, `analog` by
/// kAnalog.
struct FriIo {
  FriName name;
  FriIoType type{FriIoType::kBoolean};
  FriIoDirection direction{FriIoDirection::kInput};
  std::optional<std::uint64_t> digital{};
  std::optional<double> analog{};
};

/// Up to N items in fixed memory. Unused items cost nothing: they are neither set nor copied.
template <class T, std::size_t N>
class FriList {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  FriList() noexcept {}
  FriList(const FriList& other) noexcept { *this = other; }
  FriList& operator=(const FriList& other) noexcept {
    if (this == &other) return *this;
    Clear();
    for (const T& item : other) Add(item);
    return *this;
  }
  /// False if the list is full.
  bool Add(const T& item) noexcept {
    if (size_ == N) return false;
    std::construct_at(items_ + size_++, item);
    return true;
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return items_[i]; }
  [[nodiscard]] const T* begin() const noexcept { return items_; }
  [[nodiscard]] const T* end() const noexcept { return items_ + size_; }
  void Clear() noexcept { size_ = 0; }

 private:
  union {  // so that T's constructor does not run
    T items_[N];
  };
  std::size_t size_{0};
};
using FriTransformations = FriList<FriTransformation, kFriMaxTransformations>;
using FriIos = FriList<FriIo, kFriMaxIos>;

/// FRI 2.x: selects one of the elbow positions that are possible for a pose.
struct FriRedundancy {
  std::uint32_t strategy{0};  ///< 0: `value` is the angle E1; 4: none
  double value{0.0};
};

/// FRI 2.x: a pose of the arm with the numbers of the wire, so that it can be sent back unchanged: tx ty tz
/// [mm], qw qx qy qz.
struct FriPose {
  FriName name;
  std::array<double, 7> element{};
  std::optional<FriTime> time{};
  std::optional<FriRedundancy> redundancy{};
};

/// The arm's message, sent in each period.
struct MonitoringMessage {
  std::uint32_t sequence{0};
  std::uint32_t reflected_sequence{0};  ///< sequence number of the last command that the arm has received
  control::SessionState session{control::SessionState::kIdle};
  FriQuality quality{FriQuality::kPoor};
  std::uint32_t send_period_ms{1};      ///< 1 … 100
  std::uint32_t receive_multiplier{1};  ///< the client answers every receive_multiplier-th message; 1 … 100
  FriSafetyState safety{FriSafetyState::kNormal};
  FriOperationMode operation{FriOperationMode::kT1};
  control::ControlMode control{control::ControlMode::kPosition};
  std::array<FriDriveState, control::kJoints> drives{};
  std::optional<control::JointArray> q_meas;    ///< [rad]
  std::optional<control::JointArray> tau_meas;  ///< [N·m]
  std::optional<control::JointArray> q_cmd;  ///< [rad] commanded position as reported by the arm; only in 1.x
  std::optional<control::JointArray> tau_cmd;  ///< [N·m]
  std::optional<control::JointArray> tau_ext;  ///< [N·m] external torques, estimated by the arm
  /// External wrench, estimated by the arm: Fx Fy Fz [N], torques [N·m] in the wire's order; only in 2.7.
  std::optional<std::array<double, 6>> wire_force;
  std::optional<FriPose> X_meas;  ///< measured Cartesian pose; only in 2.x
  /// [rad] position of the arm's interpolator; only in COMMANDING states.
  std::optional<control::JointArray> q_ipo;
  std::optional<FriPose> X_ipo;  ///< Cartesian pose of the arm's interpolator; only in 2.x
  control::CommandMode command_mode{control::CommandMode::kNone};
  FriOverlay overlay{FriOverlay::kNone};
  double tracking_performance{0.0};  ///< 0 … 1; 0 outside COMMANDING_ACTIVE
  std::optional<FriTime> time;
  FriIos ios;                          ///< inputs and outputs that the robot program registered, with values
  FriTransformations transformations;  ///< frames that the robot program requests from the client
};

/// The client's answer. Without joint positions, torques and wrench it consists only of the header.
struct CommandMessage {
  std::uint32_t sequence{0};
  std::uint32_t reflected_sequence{0};     ///< sequence number of the monitoring message that it answers
  std::optional<control::JointArray> q{};  ///< [rad]
  /// Fx Fy Fz [N], torques about A, B, C [N·m], in the wire's order.
  std::optional<std::array<double, 6>> wire_wrench{};
  std::optional<control::JointArray> tau{};  ///< [N·m]
  std::optional<FriPose> X{};                ///< Cartesian pose; only in 2.x
};

}  // namespace osteon::io
