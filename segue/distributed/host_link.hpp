// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/distributed/host_service.hpp>
#include <segue/distributed/robot_loss.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace segue::distributed {

/// Connects to the daemon of a host. `gone` is called once, from any thread, when the connection breaks.
using ConnectHost =
    std::function<Result<std::unique_ptr<HostService>>(TimePoint deadline, std::function<void()> gone)>;

/// A host of a robot, as its runtime reaches it.
struct HostPlace {
  model::HostName name;
  std::string address;    ///< for people
  bool optional = false;  ///< the robot can be switched without it
  ConnectHost connect;
};

namespace detail {

/// The runtime's connection to one host, which may be lost and made anew at any time. Thread safe.
class HostLink {
 public:
  /// Connections end on threads of `pool`, which must outlive this: their last user may be a thread of
  /// theirs.
  HostLink(HostPlace place, concurrent::ThreadPool& pool, RobotLoss& loss)
      : place_(std::move(place)), pool_(pool), loss_(loss) {}
  HostLink(const HostLink&) = delete;
  HostLink& operator=(const HostLink&) = delete;

  [[nodiscard]] const model::HostName& name() const { return place_.name; }
  [[nodiscard]] bool optional() const { return place_.optional; }

  /// Connects and gets the robot. Does nothing where it has it already. Superseded, without asking, once the
  /// robot is lost to another runtime. Blocks until `deadline` at most.
  Result<void> connect(const RobotRequest& request, TimePoint deadline);
  /// The highest term of all runtimes that have had the robot there; asks over a connection of its own.
  [[nodiscard]] Result<std::uint64_t> highest_term(const std::string& robot, TimePoint deadline);
  /// Extends the lease, and measures the round trip and the host's clock. An error: the connection is lost.
  Result<void> keep_alive();
  /// Makes all further calls to the host fail until connect() succeeds. Does nothing where the connection of
  /// that number has been replaced already: a call that fails late says nothing of the present one.
  void lose(std::optional<std::uint64_t> number, const std::string& why);
  /// Gives up the lease, so that another runtime may have the robot at once.
  void release(const std::string& why);
  /// Notes that a call over connection `number` failed: where nobody answered, or another runtime has got the
  /// robot, the connection is given up.
  void note(const Error& error, std::uint64_t number);

  /// A connection to the host; the number tells it from those before and after it.
  struct Reached {
    std::shared_ptr<HostedRobot> robot;  ///< never null; must not be kept
    std::uint64_t number = 0;
  };
  /// Unavailable, with the reason, where the host cannot be reached; Superseded once the robot is lost.
  [[nodiscard]] Result<Reached> reach() const;
  [[nodiscard]] bool reachable() const;
  /// The refusal of a host that can be reached, but where another runtime commands the robot.
  struct Refusal {
    Error why;
    TimePoint when;  ///< the host was asked last
  };
  [[nodiscard]] std::optional<Refusal> refusal() const;
  [[nodiscard]] HostInfo info() const;
  [[nodiscard]] task_host::ComputerReport report() const;
  /// Notes the view of the host, which last_seen() then returns.
  void note(const HostView& view);
  [[nodiscard]] HostView last_seen() const;

 private:
  struct Connection {
    std::unique_ptr<HostService> service;
    std::shared_ptr<HostedRobot> robot;
    bool broken = false;
  };
  /// Opens a connection to the daemon, without the robot, which acquire() requests.
  Result<std::shared_ptr<Connection>> open(TimePoint deadline);
  Result<HostInfo> acquire(Connection& connection, const RobotRequest& request, TimePoint deadline);
  /// Hands the connection over to the caller, who destroys it without the lock.
  std::shared_ptr<Connection> take(std::optional<std::uint64_t> number, const std::string& why);
  /// Uses this connection for all further calls to the host; Superseded where the robot was lost meanwhile.
  Result<void> use(std::shared_ptr<Connection> made, HostInfo info);
  Result<void> measure(HostService& service);
  [[nodiscard]] bool is_connected() const SEGUE_REQUIRES(mutex_) {
    return connection_ != nullptr && !connection_->broken && !loss_.why();
  }

  const HostPlace place_;
  concurrent::ThreadPool& pool_;
  RobotLoss& loss_;
  Mutex connecting_;     ///< one connect() at a time
  mutable Mutex mutex_;  ///< protects everything below; never held while the host is called
  std::shared_ptr<Connection> connection_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t number_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::string why_ SEGUE_GUARDED_BY(mutex_) = "not connected yet";
  std::optional<Refusal> refusal_ SEGUE_GUARDED_BY(mutex_);
  TimePoint since_ SEGUE_GUARDED_BY(mutex_) = RealClock::instance().now();
  HostInfo info_ SEGUE_GUARDED_BY(mutex_);
  HostView seen_ SEGUE_GUARDED_BY(mutex_);
  std::optional<Duration> round_trip_ SEGUE_GUARDED_BY(mutex_);
  std::optional<Duration> offset_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace detail
}  // namespace segue::distributed
