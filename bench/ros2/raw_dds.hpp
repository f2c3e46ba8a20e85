// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

/// One topic of ROS 2 by Fast DDS alone, as rmw_fastrtps has it: the floor.
namespace bench {

using Payload = std::vector<std::byte>;

class RawWriter {
 public:
  explicit RawWriter(std::uint32_t domain);
  ~RawWriter();
  RawWriter(const RawWriter&) = delete;
  RawWriter& operator=(const RawWriter&) = delete;
  [[nodiscard]] std::size_t readers() const;
  void write(Payload& message);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

class RawReader {
 public:
  /// `arrived` is called for each message: in the thread in which Fast DDS receives it, or, `by_thread`, in
  /// one that this thread wakes, as executors of rclcpp do.
  RawReader(std::uint32_t domain, bool by_thread, std::function<void(const Payload&)> arrived);
  ~RawReader();
  RawReader(const RawReader&) = delete;
  RawReader& operator=(const RawReader&) = delete;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace bench
