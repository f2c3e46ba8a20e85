// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace segue::link {

/// A range of address space with memory behind it as far as it was touched. Unmapped when destroyed.
class Mapping {
 public:
  Mapping() = default;
  Mapping(Mapping&& other) noexcept
      : base_(std::exchange(other.base_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  Mapping& operator=(Mapping&& other) noexcept {
    std::swap(base_, other.base_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~Mapping();

  enum class Access : std::uint8_t { Read, ReadWrite };
  /// A whole file, shared with everybody who maps it.
  static Result<Mapping> of_file(int descriptor, std::size_t size, Access access);
  /// Zeros of this process alone.
  static Result<Mapping> anonymous(std::size_t size);

  [[nodiscard]] std::byte* data() const noexcept { return base_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Makes the first `bytes` present, so that touching them costs nothing.
  void populate(std::size_t bytes) const noexcept;

 private:
  Mapping(std::byte* base, std::size_t size) : base_(base), size_(size) {}
  std::byte* base_ = nullptr;
  std::size_t size_ = 0;
};

/// Memory as a file without a name, of a size that nobody can change any more.
struct SealedFile {
  Descriptor descriptor;
  Mapping mapping;  ///< the maker's, for reading and writing
};

enum class Writers : std::uint8_t { Everybody, MakerOnly };

/// `size` is rounded up to whole pages. MakerOnly: nobody can map it for writing again. ResourceExhausted.
Result<SealedFile> make_sealed_file(const std::string& name, std::size_t size, Writers writers);

/// Its size, if `descriptor` is a file of memory that cannot shrink under whoever maps it; InvalidArgument.
Result<std::size_t> check_sealed_file(int descriptor, Writers writers);

}  // namespace segue::link
