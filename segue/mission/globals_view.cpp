// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/globals_store.hpp>

#include <algorithm>

namespace segue::mission {

namespace {

/// Users of a variable are dropped in batches of so many.
constexpr std::size_t kManyUsers = 64;

bool in_parallel_with(const Place& place, const std::shared_ptr<const ParallelBranch>& branch) {
  return in_parallel(place.branch.get(), branch.get());
}

bool within(const ParallelBranch* branch, std::uint64_t barrier) {
  while (branch != nullptr && branch->barrier != barrier)
    branch = branch->around.get();
  return branch != nullptr;
}

}  // namespace

template <class Counts>
const Globals::Version* Globals::Entry::last_before(std::uint64_t position, const Counts& counts) const {
  const Version* last = nullptr;
  for (const Version& version : versions) {
    const bool later = last == nullptr || last->position < version.position ||
                       (last->position == version.position && last->number < version.number);
    if (version.position < position && later && counts(version)) last = &version;
  }
  return last;
}

const Globals::Version* Globals::Entry::before(const Place& place) const {
  return last_before(place.position,
                     [&](const Version& version) { return !in_parallel_with(place, version.branch); });
}

Globals::Variable Globals::Entry::seen_from(const Place& place) const {
  const Version* seen = before(place);
  if (seen == nullptr) return now;
  for (const Version& version : versions) {
    if (version.number > seen->number && in_parallel_with(place, version.branch)) seen = &version;
  }
  return seen->variable;
}

/// Keeps the last version, and for each branch around it the last version that actions in branches beside it
/// see, since the last version of all does not come before those.
void Globals::Entry::settle_before(std::uint64_t position) {
  if (const Version* last = last_before(position, [](const Version&) { return true; })) {
    std::vector<std::uint64_t> kept{last->number};
    for (const ParallelBranch* branch = last->branch.get(); branch != nullptr;
         branch = branch->around.get()) {
      const auto counts = [&](const Version& each) {
        return !within(each.branch.get(), branch->barrier) &&
               !in_parallel(each.branch.get(), branch->around.get());
      };
      if (const Version* beside = last_before(position, counts)) kept.push_back(beside->number);
    }
    std::erase_if(versions, [&](const Version& each) {
      return each.position < position && std::ranges::find(kept, each.number) == kept.end();
    });
  }
  if (users.size() >= kManyUsers)
    std::erase_if(users, [&](const Place& user) { return user.position < position; });
}

void Globals::Variables::write(Entry& entry, const Place* place, Variable variable) {
  if (place != nullptr) {
    entry.settle_before(settled);
    if (entry.versions.empty()) entry.versions.push_back({0, nullptr, 0, entry.now});
    entry.versions.push_back({place->position, place->branch, ++last_number, variable});
  }
  entry.now = std::move(variable);
  unlocked.notify_all();
}

/// The variable as the execution sees it now, unless it has changed the variable itself.
Globals::View::Use& Globals::View::use(const Variables& variables, std::string_view name) {
  const auto entry = variables.by_name.find(name);
  const bool known = entry != variables.by_name.end();
  auto found = uses.find(name);
  if (found == uses.end()) {
    found = uses.emplace(std::string(name), Use()).first;
    const Version* last = known ? entry->second.before(place) : nullptr;
    found->second.version = last == nullptr ? 0 : last->number;
  }
  Use& use = found->second;
  if (!use.changed) {
    use.own = known ? entry->second.seen_from(place) : Variable();
    use.holder = use.own.holder;
  }
  return use;
}

Globals::Variable Globals::find(std::string_view name) const SEGUE_REQUIRES(variables_->mutex) {
  if (view_ && view_->kept_aside) return view_->closed ? Variable() : view_->use(*variables_, name).own;
  const auto found = variables_->by_name.find(name);
  if (!view_) return found == variables_->by_name.end() ? Variable() : found->second.now;
  Entry& entry = found != variables_->by_name.end() ? found->second : variables_->by_name[std::string(name)];
  const auto mine = [&](const Place& user) { return user.position == view_->place.position; };
  if (std::ranges::any_of(entry.users, mine)) return entry.now;
  entry.settle_before(variables_->settled);
  entry.users.push_back(view_->place);
  return entry.now;
}

Result<void> Globals::put(const std::string& name, Variable variable) SEGUE_REQUIRES(variables_->mutex) {
  if (!view_) {
    variables_->write(variables_->by_name[name], nullptr, std::move(variable));
    return {};
  }
  if (!view_->kept_aside) {
    View::Use& use = view_->uses[name];
    use.own = variable;
    use.changed = true;
    variables_->write(variables_->by_name[name], &view_->place, std::move(variable));
    return {};
  }
  if (view_->closed) {
    return fail(ErrorCode::InvalidState,
                "the global variable " + quote(name) + " cannot be used after the end of the action");
  }
  View::Use& use = view_->use(*variables_, name);
  use.own = std::move(variable);
  use.changed = true;
  return {};
}

/// The changes through one handle that are kept aside.
class Globals::Pending final : public PendingChanges {
 public:
  Pending(std::shared_ptr<Variables> variables, std::shared_ptr<View> view)
      : variables_(std::move(variables)), view_(std::move(view)) {}

  [[nodiscard]] bool empty() const override {
    const Lock guard(variables_->mutex);
    return view_->uses.empty() && !view_->all;
  }

  [[nodiscard]] bool valid() const override {
    const Lock guard(variables_->mutex);
    const auto changed = [&](const auto& use) SEGUE_REQUIRES(variables_->mutex) {
      return use.second.version != version(use.first) || locked_meanwhile(use);
    };
    if (std::ranges::any_of(view_->uses, changed)) return false;
    if (!view_->all) return true;
    return std::ranges::none_of(variables_->by_name, [&](const auto& each) SEGUE_REQUIRES(variables_->mutex) {
      return !view_->uses.contains(each.first) && version(each.first) != 0;
    });
  }

  Result<void> apply() override {
    const Lock guard(variables_->mutex);
    for (const auto& [name, use] : view_->uses) {
      if (use.changed) {
        if (const Place* user = later_user(name)) return conflict(name, *user);
      }
    }
    view_->closed = true;
    for (auto& [name, use] : view_->uses) {
      if (use.changed) variables_->write(variables_->by_name[name], &view_->place, use.own);
    }
    return {};
  }

 private:
  /// The number of the last version by an action before this one. Versions by actions in parallel branches
  /// may come before or after, so they make nothing wrong.
  [[nodiscard]] std::uint64_t version(const std::string& name) const SEGUE_REQUIRES(variables_->mutex) {
    const auto found = variables_->by_name.find(name);
    const Version* last = found == variables_->by_name.end() ? nullptr : found->second.before(view_->place);
    return last == nullptr ? 0 : last->number;
  }

  /// Whether an action in a parallel branch has locked the variable meanwhile.
  [[nodiscard]] bool locked_meanwhile(const std::pair<const std::string, View::Use>& use) const
      SEGUE_REQUIRES(variables_->mutex) {
    const auto found = variables_->by_name.find(use.first);
    if (!use.second.changed || found == variables_->by_name.end()) return false;
    const Key holder = found->second.now.holder;
    return holder != 0 && holder != use.second.holder;
  }

  [[nodiscard]] const Place* later_user(const std::string& name) const SEGUE_REQUIRES(variables_->mutex) {
    const auto found = variables_->by_name.find(name);
    if (found == variables_->by_name.end()) return nullptr;
    const auto& users = found->second.users;
    const auto later = std::ranges::find_if(users, [&](const Place& user) {
      return user.position > view_->place.position && !in_parallel_with(view_->place, user.branch);
    });
    return later == users.end() ? nullptr : &*later;
  }

  static Error conflict(const std::string& name, const Place& user) {
    return fail(ErrorCode::InvalidState,
                "it changed the global variable " + quote(name) + ", which " + quote(user.who) +
                    " had already used, although that comes later; let that one require a fact that this one "
                    "makes true");
  }

  const std::shared_ptr<Variables> variables_;
  const std::shared_ptr<View> view_;
};

Globals Globals::at(Place place) const {
  Globals handle(*this);
  handle.view_ = std::make_shared<View>(View{std::move(place)});
  return handle;
}

Globals Globals::kept_aside_at(Place place) const {
  Globals handle(*this);
  handle.view_ = std::make_shared<View>(View{std::move(place), true});
  return handle;
}

std::shared_ptr<PendingChanges> Globals::pending_changes() const {
  if (!view_ || !view_->kept_aside) return nullptr;
  return std::make_shared<Pending>(variables_, view_);
}

Globals::Changes Globals::changes() const {
  const Lock guard(variables_->mutex);
  Changes changes;
  if (!view_) return changes;
  for (const auto& [name, use] : view_->uses) {
    if (!use.changed) continue;
    if (use.own.content)
      changes.set.append(name, use.own.content->shown());
    else
      changes.erased.push_back(name);
  }
  return changes;
}

void Globals::close() {
  const Lock guard(variables_->mutex);
  if (view_) view_->closed = true;
}

void Globals::settle_before(std::uint64_t position) {
  const Lock guard(variables_->mutex);
  variables_->settled = position;
}

}  // namespace segue::mission
