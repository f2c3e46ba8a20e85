// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace segue::deploy::detail {

/// Steps that may take long or never return, carried out on threads of their own: one after the other as long
/// as each returns within `patience`; where one does not, the next ones begin beside it. Of one thread.
class Staggered {
 public:
  Staggered(std::vector<std::function<void()>> steps, Duration patience);
  /// Steps that have not returned go on by themselves, so they must own what they use; those that have not
  /// begun never do.
  ~Staggered();
  Staggered(const Staggered&) = delete;
  Staggered& operator=(const Staggered&) = delete;

  /// Goes on until all have returned; false: some have not at `deadline`. May be called again.
  bool run(TimePoint deadline);

 private:
  struct Line;
  static void work(const std::shared_ptr<Line>& line);
  void add_worker();

  const std::shared_ptr<Line> line_;
  const std::size_t count_;
  const Duration patience_;
};

}  // namespace segue::deploy::detail
