// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/sample_link/latency.hpp>
#include <segue/task/commit_gate.hpp>

#include <cstdint>

/// The links that carry samples between ports: within a process and between processes of a host.
namespace segue::sample_link {

/// Samples of one connection since it was established. written = read + dropped + overwritten + those that
/// wait.
struct Counters {
  std::uint64_t written = 0;
  std::uint64_t read = 0;
  std::uint64_t dropped = 0;      ///< refused by a full buffer, or pushed out of a circular one
  std::uint64_t overwritten = 0;  ///< data: replaced by a newer value before it was read
  /// The number of samples that wait. Exact from any thread once the writer has ended.
  [[nodiscard]] std::uint64_t waiting() const {
    const std::uint64_t gone = read + dropped + overwritten;
    return written > gone ? written - gone : 0;
  }
  friend bool operator==(const Counters&, const Counters&) = default;
};

/// A connection between two ports, whatever link carries it. It lasts until disconnect() or until one of its
/// ports is destroyed, whether or not anybody keeps this object. All functions may be called from any thread.
///
/// A connection that was made with a gate is dormant until that opens: it carries nothing. One that ends at a
/// gate carries what is written before that opens, and its reader gets all of it before anything newer.
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
  /// Only the reader's endpoint of a connection between processes knows it.
  [[nodiscard]] virtual Latency latency() const = 0;
  [[nodiscard]] virtual const Policy& policy() const = 0;

  /// Ends when the gate opens; remains to be disconnected.
  virtual void end_at(task::CommitGatePtr gate) = 0;
  /// Tells that the transition of the gates has committed or was given up. Where a connection with
  /// policy.init began, the reader gets the last sample now. Where it would have begun, it stays dormant.
  virtual void settle() = 0;
  [[nodiscard]] virtual bool dormant() const = 0;
  /// Whether it carries samples: it is not dormant, and has not ended with a commit.
  [[nodiscard]] virtual bool carries() const = 0;
  /// Whether it has ended with a commit and samples that its buffer promised still wait for the reader;
  /// policy data promises only the newest value, which others replace. Exact after settle(), for the writer's
  /// endpoint too.
  [[nodiscard]] virtual bool owes_samples() const = 0;
};

}  // namespace segue::sample_link
