// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

/// For tests only: tf2's BufferCore as the judge of TransformTree. Its own headers need C++17, and name their
/// messages as ours are named.
namespace tf2_judge {

struct Pose {
  std::int64_t time = 0;                          ///< ns
  std::array<double, 3> position{};               ///< m
  std::array<double, 4> orientation{0, 0, 0, 1};  ///< x, y, z, w
};

class Buffer {
 public:
  Buffer();
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  /// Whether it is taken in.
  bool insert(const std::string& frame, const std::string& child, const Pose& pose, bool is_static);
  /// The pose of `child` in `frame` at a time (ns); 0: the newest one. Nothing where tf2 throws.
  [[nodiscard]] std::optional<Pose> look_up(const std::string& frame, const std::string& child,
                                            std::int64_t time) const;

 private:
  struct Core;
  std::unique_ptr<Core> core_;
};

}  // namespace tf2_judge
