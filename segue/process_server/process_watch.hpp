// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <thread>

namespace segue::process_server::detail {

/// Watches processes until they end, by epoll on one thread of its own. Needs no lock: the kernel's table of
/// watched descriptors is the only state that threads share. Internal; functions may be called from any
/// thread.
class ProcessWatch {
 public:
  /// Called on the watching thread for a process that has ended, again and again until it is removed.
  using Ended = std::function<void(std::uint64_t id)>;

  /// Fails where the system has no descriptors left.
  static Result<std::unique_ptr<ProcessWatch>> create(Ended ended);
  /// Waits for a call of `ended` that is under way.
  ~ProcessWatch();
  ProcessWatch(const ProcessWatch&) = delete;
  ProcessWatch& operator=(const ProcessWatch&) = delete;

  /// Watches a process; `pidfd` must stay open until remove(), `id` must not be 0.
  Result<void> add(int pidfd, std::uint64_t id);
  /// Stops watching it. A call of `ended` that is already under way goes on.
  void remove(int pidfd);

 private:
  ProcessWatch(Descriptor epoll, Descriptor wake, Ended ended);
  void run();

  Descriptor epoll_;
  Descriptor wake_;
  Ended ended_;
  std::thread thread_;
};

}  // namespace segue::process_server::detail
