#pragma once

#include <gdnative_api_struct.gen.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <variant>

#include "plugin/include/osteon_host.h"

namespace osteon::godot {

/// Godot's functions; set while the library is loaded.
extern const godot_gdnative_core_api_struct* api;

/// A godot_variant, destroyed with this object unless it was handed to Godot.
class Value {
 public:
  Value() { api->godot_variant_new_nil(&value_); }
  explicit Value(std::int64_t value) { api->godot_variant_new_int(&value_, value); }
  explicit Value(double value) { api->godot_variant_new_real(&value_, value); }
  explicit Value(const std::string& text);
  explicit Value(const godot_array& array) { api->godot_variant_new_array(&value_, &array); }
  explicit Value(const godot_dictionary& values) { api->godot_variant_new_dictionary(&value_, &values); }
  explicit Value(const host::Vector& v);
  explicit Value(const host::Pose& pose);
  Value(Value&& other) noexcept : value_(other.Release()) {}
  Value(const Value&) = delete;
  Value& operator=(const Value&) = delete;
  Value& operator=(Value&&) = delete;
  ~Value() { api->godot_variant_destroy(&value_); }

  [[nodiscard]] const godot_variant* get() const { return &value_; }
  /// Hands the value to Godot, which destroys it.
  [[nodiscard]] godot_variant Release() noexcept {
    const godot_variant given = value_;
    api->godot_variant_new_nil(&value_);
    return given;
  }

  static Value Bool(bool value) {
    Value result;
    api->godot_variant_new_bool(&result.value_, value);
    return result;
  }
  /// A brick's mesh in the form that ArrayMesh.add_surface_from_arrays accepts; empty if the brick was
  /// removed.
  static Value MeshArrays(const host::Brick& brick);

 private:
  godot_variant value_{};
};

/// An array that is being filled.
class ArrayBuilder {
 public:
  ArrayBuilder() { api->godot_array_new(&array_); }
  ArrayBuilder(const ArrayBuilder&) = delete;
  ArrayBuilder& operator=(const ArrayBuilder&) = delete;
  ~ArrayBuilder() { api->godot_array_destroy(&array_); }
  void Add(const Value& value) { api->godot_array_push_back(&array_, value.get()); }
  [[nodiscard]] Value ToValue() const { return Value(array_); }

 private:
  godot_array array_{};
};

/// A dictionary that is being filled.
class DictionaryBuilder {
 public:
  DictionaryBuilder() { api->godot_dictionary_new(&values_); }
  DictionaryBuilder(const DictionaryBuilder&) = delete;
  DictionaryBuilder& operator=(const DictionaryBuilder&) = delete;
  ~DictionaryBuilder() { api->godot_dictionary_destroy(&values_); }
  void Set(const char* key, const Value& value) {
    api->godot_dictionary_set(&values_, Value(std::string(key)).get(), value.get());
  }
  [[nodiscard]] Value ToValue() const { return Value(values_); }

 private:
  godot_dictionary values_{};
};

/// The arguments of a call. Mismatch checks their number and types; read them only after that.
class Arguments {
 public:
  Arguments(int count, godot_variant** values) : count_(count), values_(values) {}

  /// Checks number and types of the arguments. Returns an empty text, or what is wrong. An integer is
  /// accepted as a real number; no other type is converted.
  [[nodiscard]] std::string Mismatch(const char* method,
                                     std::initializer_list<godot_variant_type> accepted) const;

  [[nodiscard]] host::Pose PoseAt(int i) const;
  [[nodiscard]] host::Vector VectorAt(int i) const;
  [[nodiscard]] std::string TextAt(int i) const;
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool BoolAt(int i) const { return api->godot_variant_as_bool(values_[i]); }
  [[nodiscard]] double RealAt(int i) const { return api->godot_variant_as_real(values_[i]); }
  [[nodiscard]] const godot_variant* at(int i) const { return values_[i]; }

 private:
  int count_;
  godot_variant** values_;
};

/// A key of a Dictionary and where its value goes: a String, float, bool, int or Vector3.
struct Field {
  const char* key;
  std::variant<std::string*, double*, bool*, std::uint32_t*, host::Vector*> value;
};

/// Reads the values of a Dictionary's keys into the fields; an absent key leaves its field unchanged.
/// @returns empty, or what is wrong: a key that is not among the fields, a value of another type.
[[nodiscard]] std::string ReadDictionary(const char* method, const godot_variant* dictionary,
                                         std::initializer_list<Field> fields);

/// "Transform", "bool", …
[[nodiscard]] const char* TypeName(godot_variant_type type);
[[nodiscard]] std::string ToText(const godot_variant* value);

}  // namespace osteon::godot
