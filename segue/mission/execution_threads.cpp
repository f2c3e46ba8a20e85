// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/execution_threads.hpp>

#include <utility>

namespace segue::mission {

ExecutionThreads::~ExecutionThreads() {
  for (Job& job : jobs_)
    job.stop.request_stop();
}

void ExecutionThreads::start(ActionCall& call, Body body) {
  std::vector<type::Value> outputs(call.outputs().begin(), call.outputs().end());
  const std::lock_guard lock(mutex_);
  std::erase_if(jobs_, [](const Job& job) { return job.ended.load(); });
  Job& job = jobs_.emplace_back();
  const auto completed = call.defer([stop = job.stop]() mutable { stop.request_stop(); });
  job.thread =
      std::jthread([&job, completed, body = std::move(body), outputs = std::move(outputs)]() mutable {
        Ending ending = body(job.stop.get_token(), outputs);
        completed(std::move(ending), std::move(outputs));
        job.ended = true;
      });
}

}  // namespace segue::mission
