// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task/component.hpp>

#include <chrono>
#include <functional>
#include <set>
#include <string>
#include <vector>

/// A component that blocks in one of its hooks until the test releases it, and records which hooks ran.
namespace hooks {

struct State {
  segue::Mutex mutex;
  segue::ConditionVariable changed;
  std::vector<std::string> log;
  std::set<std::string> inside;
  std::set<std::string> released;
  bool all_released = false;
};

/// Never destroyed, since threads that are given up may still use it.
inline State& state() {
  static State& state = *new State;
  return state;
}

inline bool wait_for(const std::function<bool(State&)>& wanted) {
  segue::Lock lock(state().mutex);
  return state().changed.wait_for(state().mutex, std::chrono::seconds(60), [&] { return wanted(state()); });
}
inline bool wait_until_inside(const std::string& task) {
  return wait_for([&](State& now) { return now.inside.contains(task); });
}
inline std::vector<std::string> log() {
  const segue::Lock lock(state().mutex);
  return state().log;
}
inline void forget_log() {
  const segue::Lock lock(state().mutex);
  state().log.clear();
}
inline void release(const std::string& task) {
  const segue::Lock lock(state().mutex);
  state().released.insert(task);
  state().changed.notify_all();
}
inline void release_all() {
  const segue::Lock lock(state().mutex);
  state().all_released = true;
  state().changed.notify_all();
}
/// Back to the initial state.
inline void reset() {
  const segue::Lock lock(state().mutex);
  state().log.clear();
  state().inside.clear();
  state().released.clear();
  state().all_released = false;
}

class Stuck : public segue::task::Component {
 public:
  segue::task::InputPort<double> in{*this, "in"};
  segue::task::OutputPort<double> out{*this, "out"};
  segue::task::Property<std::string> hook{*this, "hook", "", {}};

  Stuck() : Component({.activity = segue::periodic(std::chrono::milliseconds(1))}) {}

 protected:
  segue::Result<void> on_configure() override { return note("configure"); }
  segue::Result<void> on_start() override { return note("start"); }
  void on_update() override {
    if (hook.get() == "update") static_cast<void>(note("update"));
  }
  void on_stop() override { static_cast<void>(note("stop")); }
  void on_cleanup() override { static_cast<void>(note("cleanup")); }

 private:
  segue::Result<void> note(const std::string& name) {
    segue::Lock lock(state().mutex);
    state().log.push_back(name + " " + id());
    if (hook.get() == name) {
      state().inside.insert(id());
      state().changed.notify_all();
      state().changed.wait(state().mutex,
                           [&] { return state().all_released || state().released.contains(id()); });
    }
    state().changed.notify_all();
    return {};
  }
};

}  // namespace hooks
