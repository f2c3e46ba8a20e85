// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/journaling.hpp>

#include <segue/model/files.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/solve/action_sites.hpp>
#include <segue/solve/estimate.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>
#include <unordered_map>

namespace segue::runtime {

namespace {

Duration end_of(const ActionRecord& record) {
  return record.started + record.duration;
}

/// The earliest possible begin of each phase: the end of those before it.
std::array<Duration, 3> phase_begins(const std::vector<ActionRecord>& records, std::size_t count) {
  std::array<Duration, 3> begins{};
  for (std::size_t i = 0; i < count; ++i) {
    const ActionRecord& record = records[i];
    if (!record.executed) continue;
    for (auto phase = static_cast<std::size_t>(record.action.phase) + 1; phase < begins.size(); ++phase)
      begins.at(phase) = std::max(begins.at(phase), end_of(record));
  }
  return begins;
}

/// The execution time of an action itself, if it was measured.
Duration work_of(const ActionRecord& record) {
  return record.took.value_or(record.duration);
}

/// Quick actions of one batch are executed by their process sequentially and reported together. Sums their
/// durations for each process and batch.
class Lanes {
 public:
  Lanes(const std::vector<ActionRecord>& records, const std::vector<journal::ActionEntry>& entries,
        std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      if (!records[i].executed || !records[i].took) continue;
      Duration& so_far = lanes_[{records[i].started, entries[i].host, entries[i].process}];
      before_.emplace(i, Part{so_far, &so_far});
      so_far += std::min(*records[i].took, model::kQuickAction);
    }
  }

  /// The time that the process was busy until it reported the action, that action included.
  [[nodiscard]] Duration busy(const ActionRecord& record, std::size_t index) const {
    const auto part = before_.find(index);
    if (part == before_.end()) return record.duration;
    const bool is_quick = *record.took < model::kQuickAction;
    return is_quick ? *part->second.all : part->second.before + *record.took;
  }

 private:
  struct Part {
    Duration before{0};
    const Duration* all = nullptr;
  };
  std::map<std::tuple<Duration, model::HostName, model::ProcessName>, Duration> lanes_;
  std::unordered_map<std::size_t, Part> before_;
};

/// Fills in the waiting time of each action: from the end of its predecessors to its reported end, less the
/// time that its process was busy with it.
void find_waits(const std::vector<ActionRecord>& records, std::size_t count,
                std::vector<journal::ActionEntry>& entries) {
  const auto begins = phase_begins(records, count);
  const Lanes lanes(records, entries, count);
  std::unordered_map<int, Duration> ends;
  for (std::size_t i = 0; i < count; ++i) {
    const ActionRecord& record = records[i];
    if (!record.executed) continue;
    Duration ready = begins.at(static_cast<std::size_t>(record.action.phase));
    for (const int id : record.action.after) {
      const auto before = ends.find(id);
      if (before != ends.end()) ready = std::max(ready, before->second);
    }
    ends[record.action.id] = end_of(record);
    const Duration busy = lanes.busy(record, i);
    entries[i].waited = std::max(end_of(record) - busy - ready, Duration(0));
  }
}

journal::ActionEntry action_entry(const ActionRecord& record, const solve::ActionSite& site) {
  journal::ActionEntry entry;
  entry.id = record.action.id;
  entry.kind = record.action.kind;
  entry.phase = record.action.phase;
  entry.label = record.action.label();
  entry.component = site.key.component;
  entry.host = site.key.host;
  entry.process = site.process;
  entry.started = record.started;
  entry.duration = work_of(record);
  if (record.executed) entry.ended = end_of(record);
  entry.outcome = outcome_of(record);
  if (record.error) entry.error = to_string(*record.error);
  return entry;
}

std::vector<journal::ActionEntry> action_entries(const std::vector<ActionRecord>& records,
                                                 const model::Network& current, std::size_t planned) {
  model::Transition executed;
  for (const ActionRecord& record : records)
    executed.actions.push_back(record.action);
  const auto sites = solve::action_sites(current, executed);
  std::vector<journal::ActionEntry> entries;
  for (std::size_t i = 0; i < records.size(); ++i)
    entries.push_back(action_entry(records[i], sites[i]));
  find_waits(records, std::min(planned, records.size()), entries);
  return entries;
}

Duration total_of(const std::vector<ActionRecord>& records) {
  Duration total{0};
  for (const ActionRecord& record : records) {
    if (record.executed) total = std::max(total, end_of(record));
  }
  return total;
}

std::string undone_as(const Undo& undo) {
  if (undo.restored) return "restored";
  if (undo.fell_back && undo.fallback) return "fell back to '" + undo.fallback->str() + "'";
  return "not undone";
}

}  // namespace

std::string network_text(const model::Network& network) {
  using type::Value;
  const auto processes = model::task_processes(network);
  std::map<std::string, Value> tasks;
  for (const model::Task& task : network.tasks) {
    const auto found = processes.find(task.id);
    const model::DeploymentKey where = found == processes.end() ? model::DeploymentKey{} : found->second;
    tasks.insert_or_assign(task.id.str(), Value::map({{"id", task.id.str()},
                                                      {"component", task.component.str()},
                                                      {"state", to_string(task.state)},
                                                      {"host", where.host.str()},
                                                      {"process", where.process.str()}}));
  }
  std::map<std::pair<std::string, std::string>, Value> connections;
  for (const model::Connection& one : network.connections) {
    const std::string from = to_string(one.from);
    const std::string to = to_string(one.to);
    connections.insert_or_assign(std::pair(from, to), Value::map({{"from", from}, {"to", to}}));
  }
  Value::List task_list;
  for (auto& [id, task] : tasks)
    task_list.push_back(std::move(task));
  Value::List connection_list;
  for (auto& [ends, connection] : connections)
    connection_list.push_back(std::move(connection));
  return type::to_json(
      Value::map({{"tasks", std::move(task_list)}, {"connections", std::move(connection_list)}}), -1);
}

journal::TransitionEntry journal_entry(const SwitchResult& result) {
  journal::TransitionEntry entry;
  entry.request = result.request;
  entry.time = std::chrono::system_clock::now();
  entry.cause = to_string(result.cause);
  entry.who = result.who;
  entry.from = result.from.str();
  entry.to = result.to.str();
  entry.runs = result.runs.str();
  entry.from_version = result.from_version;
  entry.to_version = result.to_version;
  entry.runs_version = result.runs_version;
  entry.order = to_string(result.order);
  entry.outcome = to_string(result.outcome);
  if (result.undo) entry.undone = undone_as(*result.undo);
  if (result.error) entry.error = to_string(*result.error);
  entry.cancelled_by = result.cancelled_by;
  entry.solve = result.solve_time;
  entry.prepare = result.prepare;
  entry.ahead = result.ahead;
  entry.commit = result.commit;
  entry.retire = result.retire;
  return entry;
}

journal::TransitionEntry journal_entry(const SwitchResult& result, const model::Network& current,
                                       const model::Transition& transition, const model::ActionTimes& known) {
  journal::TransitionEntry entry = journal_entry(result);
  entry.total = total_of(result.actions);
  entry.actions = action_entries(result.actions, current, transition.actions.size());
  if (result.undo) entry.undo_actions = action_entries(result.undo->actions, current, 0);
  entry.lasted = result.duration;
  if (transition.actions.empty() || known.actions.empty()) return entry;
  const solve::Estimate expected = solve::estimate(current, transition, known);
  entry.predicted = journal::Prediction{expected.total, expected.of(model::Phase::Commit)};
  return entry;
}

namespace detail {

JournalKeeper::JournalKeeper(const std::filesystem::path& path, const std::filesystem::path& robot_folder,
                             EventLog& log) {
  if (path.empty()) return;
  journal::JournalOptions options;
  options.robot_folder = robot_folder;
  journal_ = std::make_unique<journal::Journal>(
      path, options, [&log, file = path.native()](const journal::Trouble& trouble) {
        const std::string lost =
            trouble.lost == 0 ? "" : "; " + std::to_string(trouble.lost) + " entries were lost";
        log.add(EventKind::Journal, file, trouble.message + lost);
      });
}

void JournalKeeper::accepted(std::uint64_t request, const std::string& who,
                             const model::NetworkName& wanted) {
  if (!journal_) return;
  journal_->add(journal::RequestEntry{request, std::chrono::system_clock::now(), who, wanted.str()});
}

void JournalKeeper::loaded(const model::Network& network) {
  if (!journal_ || network.version.empty()) return;
  journal_->add(journal::VersionEntry{std::chrono::system_clock::now(), network.name.str(), network.version,
                                      network.file, model::write_network(network)});
}

void JournalKeeper::drifted(const std::string& subject, const std::string& sentence,
                            const std::string& done) {
  if (!journal_) return;
  journal_->add(journal::DifferenceEntry{std::chrono::system_clock::now(), subject, sentence, done});
}

void JournalKeeper::did(journal::MissionEntry entry) {
  if (journal_) journal_->add(std::move(entry));
}

void JournalKeeper::lost(std::uint64_t entries, const std::string& reason) {
  if (journal_) journal_->add(journal::GapEntry{std::chrono::system_clock::now(), entries, reason});
}

void JournalKeeper::began(const model::Network& observed, const model::NetworkName& controller) {
  if (!journal_) return;
  journal_->add(journal::RunningEntry{std::chrono::system_clock::now(), journal::RunningEntry::Kind::Began,
                                      controller.str(), network_text(observed)});
}

void JournalKeeper::stopped() {
  if (!journal_) return;
  journal_->add(journal::RunningEntry{std::chrono::system_clock::now(), journal::RunningEntry::Kind::Ended});
}

void JournalKeeper::ended(const SwitchResult& result) {
  if (journal_) journal_->add(journal_entry(result));
}

Result<void> JournalKeeper::flush(TimePoint deadline) const {
  return journal_ ? journal_->flush(deadline) : Result<void>();
}

JournalKeeper::Known JournalKeeper::known() const {
  return journal_ ? journal_->times() : nullptr;
}

void JournalKeeper::ended(SwitchResult& result, const model::Network& current,
                          const model::Transition& transition, const Known& known, const Ends& ends) {
  if (!journal_ || !known) return;
  auto entry = journal_entry(result, current, transition, *known);
  result.predicted = entry.predicted;
  entry.before = network_text(ends.before);
  entry.after = network_text(ends.after);
  journal_->add(std::move(entry));
}

}  // namespace detail

}  // namespace segue::runtime
