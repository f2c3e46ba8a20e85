// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task_host/task_host.hpp>

#include <support/forwarding_host.hpp>

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace segue::testing {

/// A host that calls the test before every action, to let it fail or to block it.
class AskingHost final : public ForwardingHost {
 public:
  using Ask = std::function<Result<void>(const model::Action& action)>;

  using ForwardingHost::ForwardingHost;
  void ask(Ask ask) {
    const Lock lock(mutex_);
    ask_ = std::move(ask);
  }
  /// Called after every successful action, which has taken effect whatever the call returns.
  void ask_after(Ask ask) {
    const Lock lock(mutex_);
    ask_after_ = std::move(ask);
  }

  /// Called by get_ready().
  void when_getting_ready(std::function<void(const model::Network&)> notify) {
    const Lock lock(mutex_);
    getting_ready_ = std::move(notify);
  }

  void get_ready(const model::Network& target) override {
    std::function<void(const model::Network&)> notify;
    {
      const Lock lock(mutex_);
      notify = getting_ready_;
    }
    if (notify) {
      notify(target);
    }
    inner_.get_ready(target);
  }
  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override {
    Ask ask;
    Ask after;
    {
      const Lock lock(mutex_);
      ask = ask_;
      after = ask_after_;
    }
    std::vector<model::Action> allowed;
    std::vector<std::size_t> index_of;
    for (std::size_t i = 0; i < actions.size(); ++i) {
      if (auto answer = ask ? ask(actions[i]) : Result<void>(); !answer) {
        completed({{i, std::move(answer)}});
      } else {
        allowed.push_back(actions[i]);
        index_of.push_back(i);
      }
    }
    inner_.begin_all(allowed, deadline, [allowed, index_of, after, completed](auto ended) {
      for (auto& one : ended) {
        if (one.outcome && after) {
          one.outcome = after(allowed.at(one.index));
        }
        one.index = index_of.at(one.index);
      }
      completed(std::move(ended));
    });
  }
  [[nodiscard]] model::Network observe() const override {
    model::Network seen = inner_.observe();
    Listener notify;
    std::optional<task_host::TaskEvent> event;
    {
      const Lock lock(mutex_);
      notify = listener_;
      event.swap(after_look_);
    }
    if (event && notify) {
      notify(*event);
    }
    return seen;
  }
  /// Reports `event` after the next snapshot has been taken and before it is returned.
  void tell_after_look(task_host::TaskEvent event) {
    const Lock lock(mutex_);
    after_look_ = std::move(event);
  }
  void set_listener(Listener listener) override {
    {
      const Lock lock(mutex_);
      listener_ = listener;
    }
    inner_.set_listener(std::move(listener));
  }

 private:
  mutable Mutex mutex_;
  Ask ask_;
  Ask ask_after_;
  std::function<void(const model::Network&)> getting_ready_;
  Listener listener_;
  mutable std::optional<task_host::TaskEvent> after_look_;
};

}  // namespace segue::testing
