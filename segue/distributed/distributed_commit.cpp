// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/distributed_commit.hpp>

#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/fleet/action_ids.hpp>

#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace segue::distributed::detail {

namespace {

using fleet::detail::Which;

void note(const Site& site, const Error& error, std::uint64_t number) {
  site.note(error, number);
}
/// Errors of arm_commit() may be those of a single process on the host, which itself is well.
void leave(const Site& /*site*/, const Error& /*error*/, std::uint64_t /*number*/) {}

/// Whether an action makes or ends a connection with the commit, rather than at once.
const model::Connection* at_commit(const model::Action& action, const ActionRouter& router) {
  const auto* what = std::get_if<model::ConnectionAction>(&action.what);
  const bool begins = action.kind == model::ActionKind::Connect && action.phase == model::Phase::Prepare;
  const bool ends = action.kind == model::ActionKind::Disconnect && action.phase == model::Phase::Retire;
  if (what == nullptr || (!begins && !ends) || router.at_once(what->connection)) {
    return nullptr;
  }
  return &what->connection;
}

}  // namespace

Result<void> DistributedCommit::ask_all(const std::set<const Site*>& sites, const std::string& what,
                                        const Ask& ask, const Failed& failed) const {
  std::vector<std::optional<Error>> errors(sites.size());
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const Site* site : sites) {
    jobs.emplace_back([&, site, &error = errors[jobs.size()]] {
      const auto reached = router_.reach(*site);
      const auto done = reached ? ask(*site, *reached->robot) : Result<void>(reached.error());
      if (!done) error = done.error();
      if (!done && reached) failed(*site, done.error(), reached->number);
    });
  }
  sites_.pool().run_all(std::move(jobs));
  std::optional<Error> first;
  std::vector<std::string> hosts;
  auto error = errors.begin();
  for (const Site* site : sites) {
    if (*error) {
      hosts.push_back(quote(site->name().str()));
      first = first ? first : std::move(*error);
    }
    ++error;
  }
  if (!first) {
    return {};
  }
  const ErrorCode code = first->code;
  return fail(code, "host " + listed(hosts) + " " + what).because_of(std::move(*first));
}

Result<void> DistributedCommit::arm(const model::Transition& transition, TimePoint deadline) {
  std::map<const Site*, model::Transition> parts;
  for (const auto& action : transition.actions) {
    const auto* connection = at_commit(action, router_);
    if (connection == nullptr) {
      continue;
    }
    const Which which = action.kind == model::ActionKind::Connect ? Which::Next : Which::Current;
    if (const auto site = sites_.locate(connection->from.task, which)) {
      auto& part = parts[*site];
      part.order = transition.order;
      part.actions.push_back(action);
    }
  }
  std::uint64_t number = 0;
  std::set<const Site*> involved;
  for (const auto& [site, part] : parts) {
    involved.insert(site);
  }
  {
    const Lock lock(mutex_);
    number = ++number_;
    armed_ = involved;
  }
  return ask_all(
      involved, "cannot prepare to commit",
      [&](const Site& site, HostedRobot& robot) {
        return robot.arm_commit(parts.at(&site), number, deadline);
      },
      leave);
}

Result<void> DistributedCommit::commit() {
  std::uint64_t number = 0;
  std::set<const Site*> involved;
  {
    const Lock lock(mutex_);
    number = number_;
    involved = std::exchange(armed_, {});
  }
  if (auto promised = promise(involved, number); !promised) {
    return promised;
  }
  return ask_all(
      involved, "did not confirm the commit; what it did is seen once it answers again",
      [&](const Site&, HostedRobot& robot) { return robot.commit(number); }, note);
}

Result<void> DistributedCommit::promise(const std::set<const Site*>& sites, std::uint64_t number) const {
  const TimePoint begin = clock_.now();
  // The first promises must last until all have got the order, so an answer may take no more than half of
  // that time.
  const auto vote = [&](const Site&, HostedRobot& robot) -> Result<void> {
    auto voted = robot.vote(number, promise_);
    const Duration took = clock_.now() - begin;
    if (voted && took > promise_ / 2) {
      return fail(ErrorCode::InvalidState, "it took " + format_seconds(took) +
                                               " to promise, too long for a promise of " +
                                               format_seconds(promise_));
    }
    return voted;
  };
  return ask_all(sites, "did not promise to commit", vote, note);
}

void DistributedCommit::give_up() {
  const Lock lock(mutex_);
  armed_.clear();
}

}  // namespace segue::distributed::detail
