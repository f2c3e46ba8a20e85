// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>

#include <cstdint>

/// What carries samples between ports.
namespace segue::link {

/// Samples through one connection since it was made. written = read + dropped + overwritten + those that
/// still wait.
struct Counters {
  std::uint64_t written = 0;
  std::uint64_t read = 0;
  std::uint64_t dropped = 0;      ///< refused by a full buffer, or pushed out of a circular one
  std::uint64_t overwritten = 0;  ///< data: replaced by a newer value before it was read
};

/// A connection between two ports, whatever link carries it. Stays until disconnect() or until one of its
/// ports is gone, whether or not anybody keeps this object. All functions may be called from any thread.
class Connection {
 public:
  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual ~Connection() = default;

  /// When it returns, the reader gets nothing of this connection any more, neither as new nor as old data.
  /// Neither port's task is stopped, nor ever waits; this waits for a write or read in progress. Idempotent.
  virtual void disconnect() = 0;
  [[nodiscard]] virtual bool connected() const = 0;
  [[nodiscard]] virtual Counters counters() const = 0;
  [[nodiscard]] virtual const Policy& policy() const = 0;
};

}  // namespace segue::link
