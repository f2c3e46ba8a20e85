// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board.hpp"

#include <memory>
#include <string>

namespace bench {

/// How long a peer takes from the wish for samples of other processes until the first of them is there.
class Joining {
 public:
  Joining() = default;
  Joining(const Joining&) = delete;
  Joining& operator=(const Joining&) = delete;
  virtual ~Joining() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  /// In the process that has samples: offers the last sample of so many topics, then waits for the end of
  /// the other.
  virtual void offer(const End& end, std::size_t topics) = 0;
  /// In the process that wants them: makes as many readers and waits for a sample of each, then drops them.
  /// How long it took; adds it to the board.
  virtual bool join(const End& end, std::size_t topics, std::size_t repeat) = 0;
};

/// Null where they were not there when this was built.
std::unique_ptr<Joining> make_cyclone_joining();
/// Needs a RouDi that runs.
std::unique_ptr<Joining> make_iceoryx_joining();

/// Blocks until the other end of the socket is closed.
void wait_for_the_other(const End& end);

std::string topic_name(std::size_t number);

}  // namespace bench
