// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board.hpp"

#include <memory>
#include <string>

namespace bench {

/// The time that other middleware takes from subscribing to another process to the first sample.
class Joining {
 public:
  Joining() = default;
  Joining(const Joining&) = delete;
  Joining& operator=(const Joining&) = delete;
  virtual ~Joining() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  /// In the publishing process: offers the last sample of a number of topics, then waits for the end of the
  /// other process.
  virtual void offer(const End& end, std::size_t topics) = 0;
  /// In the subscribing process: creates as many readers, waits for a sample of each, then removes them.
  /// Returns the time, and adds it to the board.
  virtual bool join(const End& end, std::size_t topics, std::size_t repeat) = 0;
};

/// Null if not available at build time.
std::unique_ptr<Joining> make_cyclone_joining();
/// Requires a running RouDi.
std::unique_ptr<Joining> make_iceoryx_joining();

/// Blocks until the other end of the socket is closed.
void wait_for_the_other(const End& end);

std::string topic_name(std::size_t number);

}  // namespace bench
