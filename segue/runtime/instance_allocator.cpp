// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/instance_allocator.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <utility>

namespace segue::runtime::detail {

namespace {

std::string why_none(const std::string& pool, const std::vector<std::string>& reasons,
                     const std::string& held_back) {
  std::string text = "no instance of pool " + quote(pool) + " is ready";
  std::string_view before = ": ";
  for (const std::string& reason : reasons) {
    text.append(std::exchange(before, "; ")).append(reason);
  }
  return held_back.empty() ? text : text.append(before).append(held_back);
}

model::DeploymentKey process_of(const model::Pool& pool, const model::TaskId& instance) {
  return {pool.process.host, model::ProcessName(instance.str())};
}

}  // namespace

InstanceAllocator::InstanceAllocator(const std::vector<model::Pool>& pools, const model::PoolBudget& budget,
                                     InstanceCalls& calls)
    : budget_(budget), calls_(calls) {
  {
    const Lock lock(mutex_);
    for (const model::Pool& pool : pools)
      states_.push_back(State{pool});
  }
  reset();
}

InstanceAllocator::Instance InstanceAllocator::named(const model::Pool& pool, int number) {
  Instance one{.number = number, .seen = {}};
  one.seen.task = model::instance_of(pool, number);
  one.seen.reason = "has not been started yet";
  return one;
}

InstanceAllocator::State* InstanceAllocator::find(std::string_view pool) {
  const auto found = std::ranges::find_if(states_, [&](const State& one) { return one.pool.name == pool; });
  return found == states_.end() ? nullptr : &*found;
}

InstanceAllocator::Instance* InstanceAllocator::find_instance(const model::TaskId& task) {
  for (State& state : states_) {
    for (Instance& one : state.instances) {
      if (one.seen.task == task) return &one;
    }
  }
  return nullptr;
}

bool InstanceAllocator::works(const Instance& one, TimePoint now) const {
  const InstanceCalls::Life life{one.seen.task, one.seen.pid};
  return now < one.reserved_until || calls_.is_busy(life) ||
         (one.seen.ready && !calls_.why_abandoned(life).empty());
}

std::optional<Result<model::TakenInstance>> InstanceAllocator::take(const model::InstanceQuestion& what,
                                                                    TimePoint since, TimePoint now) {
  const Lock lock(mutex_);
  State* state = find(what.pool);
  if (state == nullptr) return fail(ErrorCode::NotFound, "the robot has no pool " + quote(what.pool));
  Instance* free = nullptr;
  std::vector<std::string> reasons;
  for (Instance& one : state->instances) {
    const bool was_lost = one.seen.task.str() == what.lost.task && one.seen.pid == what.lost.pid;
    if (was_lost && one.lost_at < since) lose(one, "its caller has lost it", since);
    if (!one.seen.ready) {
      reasons.push_back(one.seen.task.str() + ": " + one.seen.reason);
    } else if (!works(one, now) && (free == nullptr || free->seen.task.str() == what.lost.task)) {
      free = &one;
    }
  }
  if (free != nullptr) {
    free->reserved_until = now + kReserved;
    free->last_used = now;
    return model::TakenInstance{free->seen.task.str(), free->seen.pid};
  }
  const bool any_ready = reasons.size() < state->instances.size();
  if (any_ready) state->last_ready = now;
  const bool is_complete = state->instances.size() == static_cast<std::size_t>(state->pool.most);
  const bool hopeless = is_complete && std::ranges::all_of(state->instances, [](const Instance& one) {
                          return !one.seen.ready && one.seen.given_up;
                        });
  if (!hopeless && now <= std::max(since, state->last_ready) + kReadyDeadline) return std::nullopt;
  return fail(ErrorCode::Unavailable, why_none(what.pool, reasons, state->held_back));
}

bool InstanceAllocator::begin_waiting(std::string_view pool) {
  const Lock lock(mutex_);
  State* state = find(pool);
  if (state == nullptr) return false;
  ++state->waiting;
  return state->instances.size() < static_cast<std::size_t>(state->pool.most);
}

void InstanceAllocator::end_waiting(std::string_view pool) {
  const Lock lock(mutex_);
  State* state = find(pool);
  if (state != nullptr && --state->waiting == 0) state->held_back.clear();
}

void InstanceAllocator::used(const model::TaskId& task, TimePoint now) {
  const Lock lock(mutex_);
  if (Instance* one = find_instance(task)) {
    one->last_used = now;
    one->reserved_until = {};
  }
}

void InstanceAllocator::note(const std::vector<PoolReport>& seen, TimePoint when) {
  const Lock lock(mutex_);
  for (const PoolReport& pool : seen) {
    for (const PoolInstance& one : pool.instances) {
      Instance* known = find_instance(one.task);
      if (known == nullptr) continue;
      const bool is_outdated = one.pid == known->seen.pid && known->lost_at >= when;
      if (one.ready && is_outdated) continue;
      const bool begins = one.ready && (!known->seen.ready || known->seen.pid != one.pid);
      known->seen = one;
      if (begins || one.busy) known->last_used = when;
      if (begins) known->reserved_until = {};
    }
    State* state = find(pool.pool);
    if (state != nullptr && std::ranges::any_of(pool.instances, &PoolInstance::ready)) {
      state->last_ready = when;
    }
  }
}

void InstanceAllocator::lost(const model::TaskId& task, const std::string& why, TimePoint now) {
  const Lock lock(mutex_);
  if (Instance* one = find_instance(task)) lose(*one, why, now);
}

void InstanceAllocator::lose(Instance& one, const std::string& why, TimePoint now) {
  one.lost_at = now;
  if (!one.seen.ready) return;  // supervision knows more of it
  one.seen.ready = false;
  one.seen.reason = why;
}

int InstanceAllocator::shortage(const State& state, TimePoint now) const {
  const auto will_be_free =
      std::ranges::count_if(state.instances, [&](const Instance& one) SEGUE_REQUIRES(mutex_) {
        return one.seen.ready ? !works(one, now) : !one.seen.given_up;
      });
  return state.waiting - static_cast<int>(will_be_free);
}

std::string InstanceAllocator::refusal(const State& state, const MemoryOf& memory_of) const {
  int processes = 0;
  std::uint64_t memory = 0;
  std::uint64_t largest = 0;  // of this pool: what another instance will need, as far as is known
  for (const State& other : states_) {
    if (other.pool.process.host != state.pool.process.host) continue;
    for (std::size_t i = 0; i < other.instances.size(); ++i) {
      const std::uint64_t takes = memory_of(process_of(other.pool, other.instances[i].seen.task));
      if (&other == &state) largest = std::max(largest, takes);
      if (i < static_cast<std::size_t>(other.pool.least)) continue;
      ++processes;
      memory += takes;
    }
  }
  if (processes >= budget_.processes) {
    return "'pool_budget' permits " + std::to_string(budget_.processes) +
           " processes beyond the least numbers";
  }
  if (memory + largest > budget_.memory) {
    return "'pool_budget' permits " + std::to_string(budget_.memory / 1'000'000) + " MB, of which " +
           std::to_string(memory / 1'000'000) + " MB are used, and another instance needs " +
           std::to_string(largest / 1'000'000) + " MB";
  }
  return {};
}

std::optional<model::TaskId> InstanceAllocator::next_to_make(TimePoint now, const MemoryOf& memory_of) {
  const Lock lock(mutex_);
  for (State& state : states_) {
    state.held_back.clear();
    if (state.instances.size() >= static_cast<std::size_t>(state.pool.most)) continue;
    if (shortage(state, now) <= 0) continue;
    state.held_back = refusal(state, memory_of);
    if (!state.held_back.empty()) continue;
    int number = 1;
    for (const Instance& one : state.instances) {
      if (one.number == number) ++number;
    }
    return model::instance_of(state.pool, number);
  }
  return std::nullopt;
}

void InstanceAllocator::add(const model::TaskId& task, TimePoint now) {
  const Lock lock(mutex_);
  for (State& state : states_) {
    for (int number = 1; number <= state.pool.most; ++number) {
      if (model::instance_of(state.pool, number) != task) continue;
      Instance one = named(state.pool, number);
      one.last_used = now;
      const auto after =
          std::ranges::find_if(state.instances, [&](const Instance& other) { return other.number > number; });
      state.instances.insert(after, std::move(one));
      return;
    }
  }
}

std::optional<model::TaskId> InstanceAllocator::next_to_leave(TimePoint now) {
  const Lock lock(mutex_);
  for (State& state : states_) {
    if (state.waiting > 0 || state.instances.size() <= static_cast<std::size_t>(state.pool.least)) continue;
    const auto is_idle = [&](const Instance& one) SEGUE_REQUIRES(mutex_) {
      return !works(one, now) && now - one.last_used >= state.pool.idle_after;
    };
    auto leaves = state.instances.end();
    for (auto one = state.instances.begin(); one != state.instances.end(); ++one) {
      const bool is_better = leaves == state.instances.end() || leaves->seen.ready || !one->seen.ready;
      if (is_better && is_idle(*one)) leaves = one;
    }
    if (leaves == state.instances.end()) continue;
    const model::TaskId task = leaves->seen.task;
    if (!calls_.retire({task, leaves->seen.pid})) continue;  // somebody has just called it
    state.instances.erase(leaves);
    return task;
  }
  return std::nullopt;
}

void InstanceAllocator::reset() {
  const Lock lock(mutex_);
  for (State& state : states_) {
    state.instances.clear();
    for (int number = 1; number <= state.pool.least; ++number)
      state.instances.push_back(named(state.pool, number));
  }
}

bool InstanceAllocator::is_wanted(const model::TaskId& task) const {
  const Lock lock(mutex_);
  return std::ranges::any_of(states_, [&](const State& state) {
    return std::ranges::any_of(state.instances, [&](const Instance& one) { return one.seen.task == task; });
  });
}

std::vector<PoolReport> InstanceAllocator::pools() const {
  const Lock lock(mutex_);
  std::vector<PoolReport> all;
  for (const State& state : states_) {
    PoolReport& report = all.emplace_back(PoolReport{state.pool.name, {}});
    report.least = state.pool.least;
    report.most = state.pool.most;
    report.waiting = state.waiting;
    report.held_back = state.held_back;
    for (const Instance& one : state.instances) {
      PoolInstance& instance = report.instances.emplace_back();
      instance.task = one.seen.task;
    }
  }
  return all;
}

}  // namespace segue::runtime::detail
