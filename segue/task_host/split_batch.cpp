// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/split_batch.hpp>

#include <utility>

namespace segue::task_host {

Completion SplitBatch::part(Indices indices, Note note) {
  return [batch = shared_from_this(), indices = std::move(indices),
          note = std::move(note)](std::vector<Completed> ended) {
    for (auto& one : ended) {
      one.index = indices[one.index];
      note(batch->actions()[one.index], one.outcome);
    }
    batch->add(std::move(ended));
  };
}

void SplitBatch::fail(const Indices& indices, const Error& why) {
  std::vector<Completed> ended;
  for (const std::size_t index : indices) {
    ended.push_back({index, why});
  }
  add(std::move(ended));
}

void SplitBatch::run(concurrent::ThreadPool& pool, std::size_t index, std::function<Result<void>()> work) {
  const auto job = [batch = shared_from_this(), index, work = std::move(work)] {
    const TimePoint begin = RealClock::instance().now();
    auto outcome = work();
    batch->add({{index, std::move(outcome), RealClock::instance().now() - begin}});
  };
  if (!pool.submit(job)) {
    job();  // it holds up this thread
  }
}

}  // namespace segue::task_host
