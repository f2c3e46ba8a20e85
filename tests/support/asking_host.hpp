// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>

#include <support/forwarding_host.hpp>

#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace segue::testing {

/// A host that asks before every action: to fail it, or to hold it up.
class AskingHost final : public ForwardingHost {
 public:
  using Ask = std::function<Result<void>(const model::Action& action)>;

  using ForwardingHost::ForwardingHost;
  void ask(Ask ask) {
    const std::lock_guard lock(mutex_);
    ask_ = std::move(ask);
  }
  /// Asked after every action that succeeded: it took effect, whatever is answered.
  void ask_after(Ask ask) {
    const std::lock_guard lock(mutex_);
    ask_after_ = std::move(ask);
  }

  /// Called when the host is to get ready for a target.
  void when_getting_ready(std::function<void(const model::Network&)> tell) {
    const std::lock_guard lock(mutex_);
    getting_ready_ = std::move(tell);
  }

  void get_ready(const model::Network& target) override {
    std::function<void(const model::Network&)> tell;
    {
      const std::lock_guard lock(mutex_);
      tell = getting_ready_;
    }
    if (tell) {
      tell(target);
    }
    inner_.get_ready(target);
  }
  void perform_all(std::span<const model::Action> actions, TimePoint deadline,
                   const host::Completion& completed) override {
    Ask ask;
    Ask after;
    {
      const std::lock_guard lock(mutex_);
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
    inner_.perform_all(allowed, deadline, [&](std::vector<host::Completed> ended) {
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
    Listener tell;
    std::optional<host::TaskEvent> event;
    {
      const std::lock_guard lock(mutex_);
      tell = listener_;
      event.swap(after_look_);
    }
    if (event && tell) {
      tell(*event);
    }
    return seen;
  }
  /// Tells of `event` when the next look at the tasks has been taken and before it is answered.
  void tell_after_look(host::TaskEvent event) {
    const std::lock_guard lock(mutex_);
    after_look_ = std::move(event);
  }
  void set_listener(Listener listener) override {
    {
      const std::lock_guard lock(mutex_);
      listener_ = listener;
    }
    inner_.set_listener(std::move(listener));
  }

 private:
  mutable std::mutex mutex_;
  Ask ask_;
  Ask ask_after_;
  std::function<void(const model::Network&)> getting_ready_;
  Listener listener_;
  mutable std::optional<host::TaskEvent> after_look_;
};

}  // namespace segue::testing
