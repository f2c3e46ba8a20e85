// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/process/assignment.hpp>
#include <segue/process/process_log.hpp>
#include <segue/process/process_place.hpp>
#include <segue/process/process_server.hpp>
#include <segue/process/process_table.hpp>
#include <segue/process/process_watch.hpp>
#include <segue/process/zygote.hpp>

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>

namespace segue::process {

/// What is inside a process server. Internal.
struct ProcessServer::Implementation {
  using Entry = detail::ProcessTable::Entry;
  static constexpr std::string_view kSoftware = SEGUE_VERSION;

  Implementation(ProcessServerOptions chosen, std::filesystem::path found);
  Result<void> begin();
  void begin_zygote();

  Result<ProcessInfo> start(const Launch& what, TimePoint deadline);
  /// `orderly`: it may end by itself until `deadline`.
  Result<ExitReason> stop(const ProcessInfo& info, TimePoint deadline, bool orderly);
  /// The entry of that name, a process that is found running included; null where there is none. With the
  /// mutex held, as adopt_all.
  Entry adopt(const ProcessInfo& info);
  void adopt_all(const std::string& robot, const std::filesystem::path& folder);

  Result<Entry> reserve(const ProcessInfo& info, TimePoint deadline);
  Result<void> launch(const Launch& what, detail::ProcessEntry& entry, detail::ProcessPlace& place);
  /// By the zygote; false where there is none that can.
  bool fork(const Launch& what, detail::ProcessEntry& entry, const detail::HandedOver& files);
  Result<ProcessInfo> settle(const Entry& entry, detail::ProcessPlace& place,
                             std::optional<std::uint64_t> memory);
  void told_pid(detail::ProcessEntry& entry, int pid);
  [[nodiscard]] std::filesystem::path group_of(const detail::ProcessEntry& entry,
                                               std::optional<std::uint64_t> memory) const;
  void finish(std::uint64_t id);

  const ProcessServerOptions options;
  const std::filesystem::path program;

  std::mutex mutex;  ///< of the table; the entry of a process that starts belongs to who starts it
  std::condition_variable changed;
  detail::ProcessTable table;

  std::unique_ptr<detail::Zygote> zygote;  ///< null where none is wanted
  std::atomic<bool> zygote_failed{false};  ///< and was told of

  std::mutex telling;  ///< held while the listener is called
  Listener listener;

  std::unique_ptr<detail::ProcessWatch> watch;  ///< goes first: its thread uses all of the above
};

}  // namespace segue::process
