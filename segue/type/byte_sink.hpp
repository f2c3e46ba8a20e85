// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/copy_bytes.hpp>

#include <cstddef>
#include <limits>
#include <span>

namespace segue::type::detail {

/// Limits the nesting of containers in types that contain themselves, so that no input exhausts the stack.
class Nesting {
 public:
  bool enter() { return ++level_ <= kMostLevels; }
  void leave() { --level_; }

 private:
  static constexpr int kMostLevels = 100;
  int level_ = 0;
};

/// Output of an encoder: counts bytes, and writes them where there is memory.
class ByteSink : public Nesting {
 public:
  ByteSink() : limit_(std::numeric_limits<std::size_t>::max()) {}
  explicit ByteSink(std::span<std::byte> bytes) : bytes_(bytes.data()), limit_(bytes.size()) {}

  [[nodiscard]] std::size_t used() const { return used_; }
  /// False: it only counts.
  [[nodiscard]] bool writes() const { return bytes_ != nullptr; }

  bool put(const void* from, std::size_t size) {
    if (size > limit_ - used_) return false;
    if (bytes_ != nullptr) copy_bytes(bytes_ + used_, from, size);
    used_ += size;
    return true;
  }
  bool count(std::size_t size) {
    if (size > limit_ - used_) return false;
    used_ += size;
    return true;
  }
  /// Memory for bytes that the caller writes; nullptr where there is not so much. Requires writes().
  std::byte* reserve(std::size_t size) {
    std::byte* const begin = bytes_ + used_;
    return count(size) ? begin : nullptr;
  }

 private:
  std::byte* bytes_ = nullptr;
  std::size_t limit_;
  std::size_t used_ = 0;
};

}  // namespace segue::type::detail
