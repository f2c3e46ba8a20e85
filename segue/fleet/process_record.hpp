// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/deploy/deployment_service.hpp>
#include <segue/fleet/merged_view.hpp>
#include <segue/model/transition.hpp>
#include <segue/process_server/process_service.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace segue::fleet::detail {

/// The last lines of the process's log, each on an indented line of its own; empty where there are none.
/// Reads a file.
std::string last_log_lines(const process_server::ProcessInfo& process);

class ProcessRecord;

/// A turn to ask a process about connections. A few are given at a time, since a process refuses more than 16
/// calls of one client at once; one that has connections with many others would be asked about all of them.
class ConnectionTurn {
 public:
  static constexpr std::size_t kMost = 8;
  /// Waits until the deadline at most; false where there was none.
  ConnectionTurn(ProcessRecord& process, TimePoint deadline);
  ~ConnectionTurn();
  ConnectionTurn(const ConnectionTurn&) = delete;
  ConnectionTurn& operator=(const ConnectionTurn&) = delete;
  explicit operator bool() const { return given_; }
  /// The reason why the turn was not given.
  [[nodiscard]] Error error() const;

 private:
  ProcessRecord& process_;
  const bool given_;
};

/// Called once a process stops answering; forgotten when the last copy goes.
using SilenceWatch = std::shared_ptr<const std::function<void()>>;

/// The runtime's knowledge of one deployment process: its connection, its latest snapshot, the polls that are
/// under way and whether it has ended. Thread safe: one mutex protects everything that changes, and nobody is
/// called with it held.
///
/// Polls are numbered by the requests for them. Invariants: answered_ <= finished_ <= requested_; while
/// polling_ is set, exactly one thread runs polls of this process, and it goes on until finished_ ==
/// requested_.
class ProcessRecord {
 public:
  ProcessRecord(model::Deployment deployment, process_server::ProcessInfo process);

  [[nodiscard]] const model::DeploymentKey& key() const { return key_; }
  [[nodiscard]] const process_server::ProcessInfo& process() const { return process_; }
  [[nodiscard]] ProcessView view() const;
  [[nodiscard]] sample_link::Incarnation incarnation() const;
  /// The error Unavailable with the name of the process.
  [[nodiscard]] Error unreachable() const;

  /// Its client; null while there is no connection.
  [[nodiscard]] std::shared_ptr<deploy::DeploymentService> service() const;
  /// Replaces the connection and returns the former one, which the caller destroys without a lock held.
  std::shared_ptr<deploy::DeploymentService> set_service(std::shared_ptr<deploy::DeploymentService> service,
                                                         std::optional<deploy::DeploymentInfo> info);

  /// The changes that a poll has found, to be reported.
  struct Change {
    bool silent = false;  ///< it stopped answering
    bool answers_again = false;
    std::vector<model::TaskId> hanging;          ///< from now on
    std::vector<model::TaskId> hanging_no_more;  ///< from now on
    std::vector<SilenceWatch> watches;           ///< to be told that it is silent
  };

  /// Requests a poll that begins from now on. `start`: nobody polls this process, so the caller has to see to
  /// it that someone does; otherwise whoever polls it at present does so once more.
  struct PollRequest {
    std::uint64_t number = 0;
    bool start = false;
  };
  PollRequest request_poll();
  /// The number of the latest request, which a poll that begins now fulfils.
  [[nodiscard]] std::uint64_t latest_request() const;
  /// Takes over the result of a poll; null where the process did not answer. `more`: there are newer
  /// requests.
  struct Finished {
    bool more = false;
    Change change;
  };
  Finished finish_poll(std::uint64_t number, std::shared_ptr<const deploy::Snapshot> snapshot);
  /// Waits until the poll of that number, or a later one, is finished or the process has ended; false at the
  /// deadline.
  bool wait_for_poll(std::uint64_t number, TimePoint deadline) const;
  /// The poll of that number took too long: the process counts as not answering, unless it just did.
  Change give_up_poll(std::uint64_t number);
  [[nodiscard]] bool answers() const;
  /// Adds `watch` to those that are told when the process stops answering; tells it at once, in the caller's
  /// thread, where the process does not answer now.
  void add(const SilenceWatch& watch);

  /// Marks a process that answers but that a transition has to replace. False where this was known before.
  bool blame(std::string why);

  /// Says whether the process is being ended by request: then its silence and its end are not reported.
  void expect_end(bool expected);
  [[nodiscard]] bool end_expected() const;
  /// The process has ended. True for the first call only.
  bool mark_ended();
  [[nodiscard]] bool ended() const;
  /// Waits until mark_ended(); false at the deadline.
  bool wait_for_end(TimePoint deadline) const;

  /// Tasks that were created or removed after the latest poll, for view() in case the process never answers
  /// again.
  void note_created(const model::ConfigAction& action);
  void note_removed(const model::TaskId& task);

  /// Incarnations of other processes whose memory this process has mapped.
  [[nodiscard]] bool has_mapped(sample_link::Incarnation peer) const;
  void mark_mapped(sample_link::Incarnation peer);
  void mark_unmapped(sample_link::Incarnation peer);

 private:
  friend class ConnectionTurn;
  Change silent_now() SEGUE_REQUIRES(mutex_);
  std::vector<SilenceWatch> take_watches() SEGUE_REQUIRES(mutex_);
  Change answering_now() SEGUE_REQUIRES(mutex_);
  [[nodiscard]] std::shared_ptr<const deploy::Snapshot> last_known() const SEGUE_REQUIRES(mutex_);

  const model::DeploymentKey key_;
  const process_server::ProcessInfo process_;
  mutable Mutex mutex_;                             ///< protects everything below
  mutable ConditionVariable changed_;               ///< finished_, ended_ or turns_ has changed
  std::size_t turns_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< of ConnectionTurn, given at present
  model::Deployment deployment_ SEGUE_GUARDED_BY(mutex_);
  sample_link::Incarnation incarnation_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::shared_ptr<deploy::DeploymentService> service_ SEGUE_GUARDED_BY(mutex_);
  std::shared_ptr<const deploy::Snapshot> snapshot_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t requested_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< the latest poll requested
  /// The latest poll finished, with or without an answer.
  std::uint64_t finished_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::uint64_t answered_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< the latest poll that gave a snapshot
  bool polling_ SEGUE_GUARDED_BY(mutex_) = false;
  bool answers_ SEGUE_GUARDED_BY(mutex_) = true;
  std::string fault_ SEGUE_GUARDED_BY(mutex_);
  bool end_expected_ SEGUE_GUARDED_BY(mutex_) = false;
  bool ended_ SEGUE_GUARDED_BY(mutex_) = false;
  std::vector<model::TaskId> hanging_ SEGUE_GUARDED_BY(mutex_);
  std::vector<std::weak_ptr<const std::function<void()>>> watches_ SEGUE_GUARDED_BY(mutex_);
  /// Each with the value of requested_ at that time.
  std::vector<std::pair<std::uint64_t, model::ConfigAction>> created_ SEGUE_GUARDED_BY(mutex_);
  std::set<sample_link::Incarnation> peers_ SEGUE_GUARDED_BY(mutex_);
};

using RecordPtr = std::shared_ptr<ProcessRecord>;

}  // namespace segue::fleet::detail
