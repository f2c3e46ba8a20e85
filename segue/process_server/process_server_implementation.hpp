// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/process_log.hpp>
#include <segue/process_server/process_place.hpp>
#include <segue/process_server/process_server.hpp>
#include <segue/process_server/process_table.hpp>
#include <segue/process_server/process_watch.hpp>
#include <segue/process_server/zygote.hpp>

#include <atomic>
#include <memory>

namespace segue::process_server {

/// Implementation of ProcessServer. Internal.
///
/// Locks: `mutex` protects the table and its entries; `listener_mutex` protects the listener and is held
/// while it is called. They are never held together. An entry with `starting` set may be changed by the
/// thread that starts it without `mutex`, except for its pid, which others read; one with `ending` set is
/// read by the watching thread without `mutex`, and nobody changes what it reads.
struct ProcessServer::Implementation {
  using Entry = detail::ProcessTable::Entry;
  static constexpr std::string_view kSoftware = SEGUE_VERSION;

  Implementation(ProcessServerOptions chosen, std::filesystem::path found);
  Result<void> begin();
  void begin_zygote();

  Result<ProcessInfo> start(const Launch& what, TimePoint deadline);
  /// Ends a process. `orderly`: by SIGTERM first, and killed only at `deadline`.
  Result<ExitReason> stop(const ProcessInfo& info, TimePoint deadline, bool orderly);
  /// The entry of that process, after it has been adopted if need be; null where it does not run.
  Entry adopt(const ProcessInfo& info) SEGUE_REQUIRES(mutex);
  /// Adopts every running process that has a socket in the folder.
  void adopt_all(const std::string& robot, const std::filesystem::path& folder) SEGUE_REQUIRES(mutex);

  /// Takes the name of a process that is about to start. AlreadyExists where it runs or just starts.
  Result<Entry> reserve(const ProcessInfo& info, TimePoint deadline);
  Result<void> launch(const Launch& what, detail::ProcessEntry& entry, detail::ProcessPlace& place);
  /// Starts it by the zygote; false where there is none or it cannot start this one.
  bool fork(const Launch& what, detail::ProcessEntry& entry, const detail::HandedOver& files);
  /// Begins to watch a process that was started. Where that fails, the process is killed.
  Result<ProcessInfo> settle(const Entry& entry, detail::ProcessPlace& place,
                             std::optional<std::uint64_t> memory);
  void set_pid(detail::ProcessEntry& entry, int pid);
  /// Moves it into a control group of its own; empty where none is wanted or possible.
  [[nodiscard]] std::filesystem::path enter_group(const detail::ProcessEntry& entry,
                                                  std::optional<std::uint64_t> memory) const;
  void retire(Descriptor output_changes);
  /// Deals with the end of a process; on the watching thread.
  void finish(std::uint64_t id);

  const ProcessServerOptions options;
  const std::filesystem::path program;

  Mutex mutex;
  ConditionVariable changed;  ///< an entry's `starting` or `exit` has changed, or an entry was removed
  detail::ProcessTable table SEGUE_GUARDED_BY(mutex);

  /// Null where none is wanted; set before there is another thread.
  std::unique_ptr<detail::Zygote> zygote;
  /// The zygote is gone. Only a hint that saves futile attempts and repeated log lines, so its order with
  /// respect to other memory does not matter: the zygote has a lock of its own.
  std::atomic<bool> zygote_failed{false};

  Mutex listener_mutex;
  Listener listener SEGUE_GUARDED_BY(listener_mutex);

  concurrent::ThreadPool closing{"segue-closing", {1, 0}};  ///< see retire()

  /// Destroyed first, since its thread uses all of the above. Set before there is another thread.
  std::unique_ptr<detail::ProcessWatch> watch;
};

}  // namespace segue::process_server
