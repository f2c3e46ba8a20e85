// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/execution_threads.hpp>

#include <system_error>
#include <utility>

namespace segue::mission {

ExecutionThreads::~ExecutionThreads() {
  const Lock lock(mutex_);
  closes_ = true;
  for (std::stop_source& stop : running_)
    stop.request_stop();
}

void ExecutionThreads::start(ActionCall& call, Body body) {
  const std::stop_source stop;
  auto completed = call.defer([stop]() mutable { stop.request_stop(); });
  start(stop, [completed = std::move(completed), body = std::move(body),
               outputs = std::vector<type::Value>(call.outputs().begin(), call.outputs().end())](
                  const std::stop_token& stopped) mutable {
    Ending ending = body(stopped, outputs);
    completed(std::move(ending), std::move(outputs));
  });
}

void ExecutionThreads::start(std::stop_source stop, std::function<void(const std::stop_token& stop)> work) {
  const auto place = [&] {
    const Lock lock(mutex_);
    if (closes_) throw std::system_error(std::make_error_code(std::errc::operation_canceled));
    return running_.insert(running_.end(), stop);
  }();
  const auto ended = [this, place] {
    const Lock lock(mutex_);
    running_.erase(place);
  };
  const bool begun = threads_.try_submit([token = stop.get_token(), work = std::move(work), ended]() mutable {
    work(token);
    work = nullptr;  // what it holds goes before this counts as ended
    ended();
  });
  if (begun) return;
  ended();
  throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
}

}  // namespace segue::mission
