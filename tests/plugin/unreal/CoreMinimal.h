// The few types of Unreal that the plug-in uses, so that the plug-in compiles and runs without Unreal.
// Names, members and meanings are the engine's.
#pragma once

#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

using int32 = std::int32_t;
using uint32 = std::uint32_t;
using uint8 = std::uint8_t;
using TCHAR = char;

#define TEXT(text) text
#define UTF8_TO_TCHAR(text) (text)
#define UPROPERTY(...)
#define UFUNCTION(...)
#define UCLASS(...)
#define USTRUCT(...)
#define GENERATED_BODY()
#define OSTEONCUTTING_API

template <class T>
class TArray {
 public:
  void Reserve(int32 count) { values_.reserve(static_cast<std::size_t>(count)); }
  void Add(const T& value) { values_.push_back(value); }
  int32 Num() const { return static_cast<int32>(values_.size()); }
  void Empty() { values_.clear(); }
  const T& operator[](int32 index) const { return values_.at(static_cast<std::size_t>(index)); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }

 private:
  std::vector<T> values_;
};

template <class K, class V>
class TMap {
 public:
  const V* Find(const K& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? nullptr : &found->second;
  }
  void Add(const K& key, const V& value) { values_[key] = value; }
  int32 Num() const { return static_cast<int32>(values_.size()); }
  void Empty() { values_.clear(); }

 private:
  std::map<K, V> values_;
};

class FString {
 public:
  FString() = default;
  FString(const char* text) : text_(text) {}
  const char* operator*() const { return text_.c_str(); }
  bool IsEmpty() const { return text_.empty(); }
  void Empty() { text_.clear(); }
  friend bool operator!=(const FString& a, const FString& b) { return a.text_ != b.text_; }

 private:
  std::string text_;
};

class FTCHARToUTF8 {
 public:
  explicit FTCHARToUTF8(const char* text) : text_(text) {}
  const char* Get() const { return text_.c_str(); }

 private:
  std::string text_;
};

struct FVector {
  double X{0.0}, Y{0.0}, Z{0.0};
  FVector() = default;
  FVector(double x, double y, double z) : X(x), Y(y), Z(z) {}
  FVector operator+(const FVector& b) const { return {X + b.X, Y + b.Y, Z + b.Z}; }
  FVector operator-(const FVector& b) const { return {X - b.X, Y - b.Y, Z - b.Z}; }
  FVector operator*(double s) const { return {s * X, s * Y, s * Z}; }
};
struct FVector2D {
  double X{0.0}, Y{0.0};
};
struct FColor {
  uint8 R, G, B, A;
  FColor(uint8 r, uint8 g, uint8 b, uint8 a) : R(r), G(g), B(b), A(a) {}
};

/// Cross product by the usual formula of components, although Unreal's axes are left-handed.
inline FVector Cross(const FVector& a, const FVector& b) {
  return {a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z, a.X * b.Y - a.Y * b.X};
}
inline double Dot(const FVector& a, const FVector& b) { return a.X * b.X + a.Y * b.Y + a.Z * b.Z; }

struct FQuat {
  double X{0.0}, Y{0.0}, Z{0.0}, W{1.0};
  FQuat() = default;
  FQuat(double x, double y, double z, double w) : X(x), Y(y), Z(z), W(w) {}
  FQuat Inverse() const { return {-X, -Y, -Z, W}; }
  FVector RotateVector(const FVector& v) const {
    const FVector q(X, Y, Z), t = Cross(q, v) * 2.0;
    return v + t * W + Cross(q, t);
  }
  FQuat operator*(const FQuat& b) const {
    return {W * b.X + X * b.W + Y * b.Z - Z * b.Y, W * b.Y - X * b.Z + Y * b.W + Z * b.X,
            W * b.Z + X * b.Y - Y * b.X + Z * b.W, W * b.W - X * b.X - Y * b.Y - Z * b.Z};
  }
};

/// Rotation and translation, without scale.
class FTransform {
 public:
  FTransform() = default;
  FTransform(const FQuat& rotation, const FVector& location) : rotation_(rotation), location_(location) {}
  FVector GetLocation() const { return location_; }
  FQuat GetRotation() const { return rotation_; }
  FTransform GetRelativeTransform(const FTransform& other) const {
    const FQuat back = other.rotation_.Inverse();
    return {back * rotation_, back.RotateVector(location_ - other.location_)};
  }

 private:
  FQuat rotation_;
  FVector location_;
};

/// All texts that UE_LOG was given.
inline std::vector<std::string>& LoggedTexts() {
  static std::vector<std::string> texts;
  return texts;
}
inline void LogText(const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  char text[1024];
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  LoggedTexts().emplace_back(text);
}
#define UE_LOG(category, verbosity, ...) LogText(__VA_ARGS__)

class FObjectInitializer {};

#define DECLARE_DYNAMIC_MULTICAST_DELEGATE_OneParam(Name, Type, Parameter) \
  struct Name {                                                            \
    std::vector<std::function<void(Type)>> Bound;                          \
    void Broadcast(Type value) {                                           \
      for (const auto& call : Bound) call(value);                          \
    }                                                                      \
  }

#define DECLARE_DYNAMIC_MULTICAST_DELEGATE_ThreeParams(Name, A, a, B, b, C, c) \
  struct Name {                                                                \
    std::vector<std::function<void(A, B, C)>> Bound;                           \
    void Broadcast(A a, B b, C c) {                                            \
      for (const auto& call : Bound) call(a, b, c);                            \
    }                                                                          \
  }
