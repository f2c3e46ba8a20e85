// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/network.hpp>
#include <segue/task_host/task_host.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace segue::runtime::detail {

/// The calls that the instances of pools carry out, and which of them are for nobody: whoever called waits no
/// longer, but an operation that has begun cannot be taken back. An instance carries calls out in the order
/// in which they come, so only the oldest one has begun. One that runs although this runtime has not started
/// it was left by an earlier one, whose calls are not known; its computer may be reached long after the
/// start. Thread safe.
class InstanceCalls {
 public:
  /// `host` and `pools` must outlive this. `notify` is called, from any thread, when an instance is to be
  /// ended; it must not block.
  InstanceCalls(task_host::TaskHost& host, const model::Network& pools, std::function<void()> notify)
      : host_(host), pools_(pools), notify_(std::move(notify)) {}

  /// As TaskHost::call(), of any task. Blocks until it has ended, also where the wait has been stopped.
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, const Wait& wait);

  /// Tells lives of an instance apart.
  struct Life {
    model::TaskId instance;
    int pid = 0;
    friend auto operator<=>(const Life&, const Life&) = default;
  };

  /// A call is about to be made; the result names it. 0: the instance is being stopped, and takes none.
  std::uint64_t begin(Life life);
  /// It takes no calls any more, because it is to be stopped. False, and nothing is done, while it carries
  /// one out, for whomever.
  bool retire(const Life& life);
  /// Nobody waits for its answer any more, while it is under way.
  void no_longer_wanted(std::uint64_t call);
  enum class End : std::uint8_t {
    Answered,
    Unknown  ///< no answer came: if it had begun, it is still carried out, unless its process has ended
  };
  /// It is not under way any more.
  void ended(std::uint64_t call, End end);
  /// This runtime starts it, so it carries out nothing for others.
  void starts(const model::TaskId& instance);

  [[nodiscard]] bool is_busy(const Life& life) const;
  /// Why an instance that runs must be ended; empty: it need not.
  [[nodiscard]] std::string why_abandoned(const Life& life) const;
  /// Those that are to be ended, and why. One that does not answer may have ended, which is for the policy of
  /// its pool; once it answers again, it is among them. Forgets those that have begun another life.
  [[nodiscard]] std::map<Life, std::string> abandoned();
  /// That life begins anew, or has ended.
  void forget(const Life& life);

 private:
  struct Call {
    std::uint64_t number = 0;
    bool is_wanted = true;
  };

  struct Seen {
    int pid = 0;
    bool answers = false;
    bool runs = false;
  };
  [[nodiscard]] std::map<model::TaskId, Seen> processes() const;
  void note_left(const Life& life) SEGUE_REQUIRES(mutex_);

  task_host::TaskHost& host_;
  const model::Network& pools_;
  const std::function<void()> notify_;
  mutable Mutex mutex_;  ///< protects all below; not held while the host is asked
  std::uint64_t last_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::map<Life, std::deque<Call>> calls_ SEGUE_GUARDED_BY(mutex_);  ///< under way, the oldest first
  std::map<Life, std::string> abandoned_ SEGUE_GUARDED_BY(mutex_);   ///< and why
  std::set<Life> retired_ SEGUE_GUARDED_BY(mutex_);
  std::set<model::TaskId> known_ SEGUE_GUARDED_BY(mutex_);  ///< started by this runtime, or seen before
};

}  // namespace segue::runtime::detail
