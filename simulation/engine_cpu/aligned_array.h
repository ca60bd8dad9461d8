#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace osteon::simulation::cpu {

/// An array of plain data that begins at a cache line and never moves. It is allocated at set-up only. It has
/// kPadding more elements, because kernels read beyond the end.
template <class T>
class AlignedArray {
 public:
  static constexpr std::size_t kAlignment = 64;  ///< start of the array is a multiple of this [bytes]
  static constexpr std::size_t kPadding = 16;    ///< additional elements behind the end

  AlignedArray() = default;
  /// Every element is zero.
  explicit AlignedArray(std::size_t size) { Allocate(size, size + kPadding); }
  /// Has room for `size` elements, of which only the first `touched` are zeroed. The others take address
  /// space at once, but memory only when they are written.
  AlignedArray(std::size_t size, std::size_t touched) { Allocate(size, touched); }

  [[nodiscard]] T* data() { return data_; }
  [[nodiscard]] const T* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T& operator[](std::size_t i) { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  // @param touched  number of elements that are zeroed
  void Allocate(std::size_t size, std::size_t touched) {
    size_ = size;
    const std::size_t allocated = size + kPadding;
    raw_ = std::make_unique_for_overwrite<std::byte[]>(allocated * sizeof(T) + kAlignment);
    const auto at = reinterpret_cast<std::uintptr_t>(raw_.get());
    data_ = reinterpret_cast<T*>((at + kAlignment - 1) / kAlignment * kAlignment);
    for (std::size_t i = 0; i < (touched < allocated ? touched : allocated); ++i) data_[i] = T{};
  }

  std::unique_ptr<std::byte[]> raw_;
  T* data_{nullptr};
  std::size_t size_{0};
};

}  // namespace osteon::simulation::cpu
