#include "io/fri/wire_check.h"

namespace osteon::io {
namespace {

// Largest deviation of an element of R R^T from that of the identity, and of a quaternion's length from 1.
constexpr double kRotationTolerance = 1e-3;

bool IsRotation(const Matrix3& R) OSTEON_RT {
  return (R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() < kRotationTolerance &&
         R.determinant() > 0.0;
}

// Converts the twelve elements of a 3x4 matrix (row by row, lengths in mm) to a pose. Returns false if its
// 3x3 part is no rotation.
bool FromMatrix(const double* element, PlainPose& X) OSTEON_RT {
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> M(element);
  if (!IsRotation(M.leftCols<3>())) return false;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(X.R.data()) = M.leftCols<3>();
  X.p = Vector3(M.col(3) / kMmPerM);
  return true;
}

// Converts tx ty tz [mm], qw qx qy qz to a pose. Returns false if the quaternion's length is not 1.
bool FromQuaternion(const double* element, PlainPose& X) OSTEON_RT {
  Eigen::Quaterniond q(element[3], element[4], element[5], element[6]);
  if (std::abs(q.norm() - 1.0) > kRotationTolerance) return false;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(X.R.data()) = q.normalized().toRotationMatrix();
  X.p = Vector3(Vector3(element[0], element[1], element[2]) / kMmPerM);
  return true;
}

}  // namespace

std::optional<FriTime> ReadTime(const std::optional<WireTime>& wire) OSTEON_RT {
  if (!wire) return std::nullopt;
  return FriTime{*wire->sec, *wire->nanosec};
}

void WireCheck::CheckFinite(double value) OSTEON_RT {
  if (!std::isfinite(value)) Fail(CodecError::kNotFinite);
}

void WireCheck::ReadPose(const std::optional<WireTransformation>& wire,
                         const std::optional<WireRedundancy>& redundancy,
                         std::optional<FriPose>& value) OSTEON_RT {
  if (!wire) return;
  FriPose& pose = value.emplace();
  if (wire->element.count != kQuaternionSize) return Fail(CodecError::kWrongCount);
  std::copy_n(wire->element.value.begin(), kQuaternionSize, pose.element.begin());
  if (!AllFinite(pose.element)) return Fail(CodecError::kNotFinite);
  PlainPose X;
  if (!FromQuaternion(pose.element.data(), X)) Fail(CodecError::kOutOfRange);
  pose.name = FriName(*wire->name);
  pose.time = ReadTime(wire->time);
  if (!redundancy) return;
  CheckFinite(*redundancy->value);
  pose.redundancy = FriRedundancy{*redundancy->strategy, *redundancy->value};
}

void WireCheck::ReadTransformation(FriFamily family, const WireTransformation& wire,
                                   FriTransformations& list) OSTEON_RT {
  FriTransformation transformation{.name = FriName(*wire.name), .time = ReadTime(wire.time)};
  const std::size_t count = wire.element.count;
  if (count != 0) {
    const bool matrix = family == FriFamily::k1;
    if (count != (matrix ? kMatrixSize : kQuaternionSize)) return Fail(CodecError::kWrongCount);
    const double* element = wire.element.value.data();
    if (!AllFinite({element, count})) return Fail(CodecError::kNotFinite);
    if (!(matrix ? FromMatrix : FromQuaternion)(element, transformation.X)) Fail(CodecError::kOutOfRange);
  }
  list.Add(transformation);
}

void WireCheck::ReadIo(const WireIo& wire, FriIos& list) OSTEON_RT {
  FriIo io{.name = FriName(*wire.name), .digital = wire.digital, .analog = wire.analog};
  ReadEnum(wire.type, FriIoType::kAnalog, io.type);
  ReadEnum(wire.direction, FriIoDirection::kOutput, io.direction);
  if (io.analog) CheckFinite(*io.analog);
  list.Add(io);
}

}  // namespace osteon::io
