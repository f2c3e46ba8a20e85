// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/thread.hpp>
#include <segue/mission/execution_threads.hpp>

#include <system_error>
#include <utility>

namespace segue::mission {

ExecutionThreads::~ExecutionThreads() {
  const Lock lock(mutex_);
  closes_ = true;
  for (Job& job : jobs_)
    job.stop.request_stop();
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
  const Lock lock(mutex_);
  if (closes_) throw std::system_error(std::make_error_code(std::errc::operation_canceled));
  std::erase_if(jobs_, [](const Job& job) { return job.ended.load(); });
  Job& job = jobs_.emplace_back();
  job.stop = std::move(stop);
  try {
    const auto run = [&job, work = std::move(work)](const std::stop_token& /*own*/) mutable {
      work(job.stop.get_token());
      work = nullptr;  // what it holds is not kept until the next one starts
      job.ended = true;
    };
    job.thread = concurrent::start_stoppable_thread("segue-action", run);
  } catch (const std::system_error&) {
    jobs_.pop_back();
    throw;
  }
}

}  // namespace segue::mission
