// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <thread>

namespace segue::process::detail {

/// Waits for processes to end, on one thread of its own. Internal; functions may be called from any thread.
class ProcessWatch {
 public:
  /// Called on the thread, once for each that ended.
  using Ended = std::function<void(std::uint64_t id)>;

  static Result<std::unique_ptr<ProcessWatch>> create(Ended ended);
  /// No call is under way any more.
  ~ProcessWatch();
  ProcessWatch(const ProcessWatch&) = delete;
  ProcessWatch& operator=(const ProcessWatch&) = delete;

  /// `pidfd` must stay open until the end was told. `id` is not 0.
  Result<void> add(int pidfd, std::uint64_t id);
  /// Never tells of that one from now on, unless it is just telling.
  void remove(int pidfd);

 private:
  ProcessWatch(Descriptor epoll, Descriptor wake, Ended ended);
  void run();

  Descriptor epoll_;
  Descriptor wake_;
  Ended ended_;
  std::thread thread_;
};

}  // namespace segue::process::detail
