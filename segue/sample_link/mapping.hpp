// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace segue::sample_link {

/// A mapped range of address space; pages get memory when they are first touched. Unmapped when destroyed.
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
  /// Maps a whole file, shared with everybody who maps it.
  static Result<Mapping> of_file(int descriptor, std::size_t size, Access access);
  /// Private zero-filled memory.
  static Result<Mapping> anonymous(std::size_t size);

  [[nodiscard]] std::byte* data() const noexcept { return base_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Makes the first `bytes` present and locks them where permitted, so that touching them causes no page
  /// fault.
  void populate(std::size_t bytes) const noexcept;

 private:
  Mapping(std::byte* base, std::size_t size) : base_(base), size_(size) {}
  std::byte* base_ = nullptr;
  std::size_t size_ = 0;
};

/// An unnamed memory file (memfd) whose size is sealed.
struct SealedFile {
  Descriptor descriptor;
  Mapping mapping;  ///< for its creator, readable and writable
};

/// Who may write: every process that has the file, or only its creator through the mapping that it has.
enum class Writers : std::uint8_t { Everybody, CreatorOnly };

/// `size` is rounded up to whole pages. CreatorOnly: nobody can map it for writing any more.
/// ResourceExhausted.
Result<SealedFile> make_sealed_file(const std::string& name, std::size_t size, Writers writers);

/// The size of the file if it is a memory file that cannot shrink under those who map it; else
/// InvalidArgument.
Result<std::size_t> check_sealed_file(int descriptor, Writers writers);

}  // namespace segue::sample_link
