// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>

#include <cstdint>

/// The links that carry samples between ports: within a process and between processes of a host.
namespace segue::link {

/// Samples of one connection since it was established. written = read + dropped + overwritten + those that
/// wait.
struct Counters {
  std::uint64_t written = 0;
  std::uint64_t read = 0;
  std::uint64_t dropped = 0;      ///< refused by a full buffer, or pushed out of a circular one
  std::uint64_t overwritten = 0;  ///< data: replaced by a newer value before it was read
  friend bool operator==(const Counters&, const Counters&) = default;
};

/// A connection between two ports, whatever link carries it. It lasts until disconnect() or until one of its
/// ports is destroyed, whether or not anybody keeps this object. All functions may be called from any thread.
class PortConnection {
 public:
  PortConnection() = default;
  PortConnection(const PortConnection&) = delete;
  PortConnection& operator=(const PortConnection&) = delete;
  virtual ~PortConnection() = default;

  /// After this has returned, the reader gets nothing from this connection any more, neither as new nor as
  /// old data. The tasks go on and never wait; this waits for a write or read in progress. Idempotent.
  virtual void disconnect() = 0;
  [[nodiscard]] virtual bool connected() const = 0;
  [[nodiscard]] virtual Counters counters() const = 0;
  [[nodiscard]] virtual const Policy& policy() const = 0;
};

}  // namespace segue::link
