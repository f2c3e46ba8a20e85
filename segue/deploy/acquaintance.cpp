// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/acquaintance.hpp>

#include <segue/base/text.hpp>

#include <map>
#include <mutex>

namespace segue::deploy::detail {

namespace {

class Acquaintance {
 public:
  Acquaintance(WorkerPool& pool, TimePoint deadline) : pool_(pool), deadline_(deadline) {}

  std::vector<Strangers> make(const std::vector<Pair>& pairs) {
    for (const auto& [one, other] : pairs) {
      add(one, other);
      add(other, one);
    }
    collect_offers();
    std::vector<WorkerPool::Job> jobs;
    for (const auto& [one, others] : unknown_) {
      jobs.emplace_back([this, one = one, &others = others] { introduce(one, others); });
    }
    pool_.run_all(std::move(jobs));
    return std::move(strangers_);
  }

 private:
  void add(const RecordPtr& one, const RecordPtr& other) {
    if (!one->knows(other->incarnation())) {
      unknown_[one].insert(other);
    }
  }

  void collect_offers() {
    for (const auto& [one, others] : unknown_) {
      for (const auto& other : others) {
        offers_.try_emplace(other, other->unreachable());
      }
    }
    std::vector<WorkerPool::Job> jobs;
    for (auto& item : offers_) {
      jobs.emplace_back([this, &item] {
        if (const auto service = item.first->service()) {
          item.second = service->memory(deadline_);
        }
      });
    }
    pool_.run_all(std::move(jobs));
  }

  void introduce(const RecordPtr& one, const std::set<RecordPtr>& others) {
    const auto service = one->service();
    for (const auto& other : others) {
      const auto& offer = offers_.at(other);
      const auto admitted = !offer     ? Result<void>(offer.error())
                            : !service ? Result<void>(one->unreachable())
                                       : service->admit(*offer, deadline_);
      if (admitted) {
        one->learn(offer->incarnation);
      } else {
        const std::lock_guard lock(mutex_);
        strangers_.push_back({{one, other}, admitted.error()});
      }
    }
  }

  WorkerPool& pool_;
  const TimePoint deadline_;
  std::map<RecordPtr, std::set<RecordPtr>> unknown_;  ///< who has to be told of whom
  std::map<RecordPtr, Result<link::MemoryOffer>> offers_;
  std::mutex mutex_;
  std::vector<Strangers> strangers_;
};

}  // namespace

std::vector<Strangers> acquaint(WorkerPool& pool, const std::vector<Pair>& pairs, TimePoint deadline) {
  return Acquaintance(pool, deadline).make(pairs);
}

}  // namespace segue::deploy::detail
