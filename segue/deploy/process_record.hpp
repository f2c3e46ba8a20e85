// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/deploy/deployment_service.hpp>
#include <segue/deploy/merged_view.hpp>
#include <segue/model/transition.hpp>
#include <segue/process/process_service.hpp>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace segue::deploy::detail {

/// What is known of one process with tasks. Thread safe; calls nothing.
class ProcessRecord {
 public:
  ProcessRecord(model::Deployment deployment, process::ProcessInfo process);

  [[nodiscard]] const model::DeploymentKey& key() const { return key_; }
  [[nodiscard]] const process::ProcessInfo& process() const { return process_; }
  [[nodiscard]] ProcessView view() const;
  [[nodiscard]] link::Incarnation incarnation() const;
  /// Unavailable, with its name.
  [[nodiscard]] Error unreachable() const;

  /// What answers for it; null while there is no connection.
  [[nodiscard]] std::shared_ptr<DeploymentService> service() const;
  /// A new connection; gives back the old one, to be destroyed outside.
  std::shared_ptr<DeploymentService> set_service(std::shared_ptr<DeploymentService> service,
                                                 std::optional<DeploymentInfo> info);

  /// What became different by being seen, or by not being seen.
  struct Change {
    bool silent = false;  ///< it stopped answering
    bool answers_again = false;
    std::vector<model::TaskId> hanging;          ///< from now on
    std::vector<model::TaskId> hanging_no_more;  ///< from now on
  };

  /// Asks for a look that begins from now on. `take`: the caller sees to it that someone takes it; else
  /// whoever is at it takes another one.
  struct PollRequest {
    std::uint64_t number = 0;
    bool start = false;
  };
  PollRequest request_poll();
  /// The number for which a look that begins now answers.
  [[nodiscard]] std::uint64_t latest_request() const;
  /// What a look gave; null where the process did not answer. `more`: take another one.
  struct Finished {
    bool more = false;
    Change change;
  };
  Finished finish_poll(std::uint64_t number, std::shared_ptr<const Snapshot> snapshot);
  /// Waits until the look of that number, or a later one, is done; false at the deadline.
  bool wait_for_poll(std::uint64_t number, TimePoint deadline) const;
  /// Nobody waits for that look any longer: the process does not answer, unless it just did.
  Change give_up_poll(std::uint64_t number);
  [[nodiscard]] bool answers() const;

  /// It is on its way out by request: its silence is no news.
  void expect_end(bool expected);
  [[nodiscard]] bool end_expected() const;
  /// True the first time.
  bool mark_ended();
  [[nodiscard]] bool ended() const;
  bool wait_for_end(TimePoint deadline) const;

  /// What became of its tasks since it was looked at last, for when it never is again.
  void note_created(const model::ConfigAction& made);
  void note_removed(const model::TaskId& task);

  /// Incarnations whose memory its process has mapped.
  [[nodiscard]] bool has_mapped(link::Incarnation peer) const;
  void mark_mapped(link::Incarnation peer);
  void mark_unmapped(link::Incarnation peer);

 private:
  Change silent_now();
  Change answering_now();
  [[nodiscard]] std::shared_ptr<const Snapshot> last_known() const;

  const model::DeploymentKey key_;
  const process::ProcessInfo process_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  model::Deployment deployment_;
  link::Incarnation incarnation_ = 0;
  std::shared_ptr<DeploymentService> service_;
  std::shared_ptr<const Snapshot> snapshot_;
  std::uint64_t requested_ = 0;
  std::uint64_t finished_ = 0;
  std::uint64_t answered_ = 0;  ///< the last look that gave a snapshot
  bool polling_ = false;
  bool answers_ = true;
  bool end_expected_ = false;
  bool ended_ = false;
  std::vector<model::TaskId> hanging_;
  std::vector<std::pair<std::uint64_t, model::ConfigAction>> created_;  ///< and the looks asked for by then
  std::set<link::Incarnation> peers_;
};

}  // namespace segue::deploy::detail
