// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/fleet/peer_mapping.hpp>

#include <segue/base/text.hpp>

#include <map>

namespace segue::fleet::detail {

namespace {

class PeerMapping {
 public:
  PeerMapping(concurrent::ThreadPool& pool, TimePoint deadline) : pool_(pool), deadline_(deadline) {}

  std::vector<FailedPair> run(const std::vector<ProcessPair>& pairs) {
    for (const auto& [one, other] : pairs) {
      add(one, other);
      add(other, one);
    }
    collect_offers();
    std::vector<concurrent::ThreadPool::Job> jobs;
    for (const auto& [one, others] : missing_) {
      jobs.emplace_back([this, one = one, &others = others] { admit_peers(one, others); });
    }
    pool_.run_all(std::move(jobs));
    const Lock lock(mutex_);
    return std::move(failed_);
  }

 private:
  void add(const RecordPtr& one, const RecordPtr& other) {
    if (!one->has_mapped(other->incarnation())) {
      missing_[one].insert(other);
    }
  }

  void collect_offers() {
    for (const auto& [one, others] : missing_) {
      for (const auto& other : others) {
        offers_.try_emplace(other, other->unreachable());
      }
    }
    std::vector<concurrent::ThreadPool::Job> jobs;
    for (auto& item : offers_) {
      jobs.emplace_back([this, &item] {
        const ConnectionTurn turn(*item.first, deadline_);
        if (const auto service = item.first->service()) {
          item.second = turn ? service->memory(deadline_) : Result<sample_link::MemoryOffer>(turn.error());
        }
      });
    }
    pool_.run_all(std::move(jobs));
  }

  void admit_peers(const RecordPtr& one, const std::set<RecordPtr>& others) {
    const auto service = one->service();
    for (const auto& other : others) {
      const auto& offer = offers_.at(other);
      const ConnectionTurn turn(*one, deadline_);
      const auto admitted = !offer     ? Result<void>(offer.error())
                            : !service ? Result<void>(one->unreachable())
                            : !turn    ? Result<void>(turn.error())
                                       : service->admit(*offer, deadline_);
      if (admitted) {
        one->mark_mapped(offer->incarnation);
      } else {
        const Lock lock(mutex_);
        failed_.push_back({{one, other}, admitted.error()});
      }
    }
  }

  concurrent::ThreadPool& pool_;
  const TimePoint deadline_;
  std::map<RecordPtr, std::set<RecordPtr>> missing_;  ///< peers to be mapped, by process
  std::map<RecordPtr, Result<sample_link::MemoryOffer>> offers_;
  Mutex mutex_;  ///< protects failed_
  std::vector<FailedPair> failed_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace

std::vector<FailedPair> map_peers(concurrent::ThreadPool& pool, const std::vector<ProcessPair>& pairs,
                                  TimePoint deadline) {
  return PeerMapping(pool, deadline).run(pairs);
}

}  // namespace segue::fleet::detail
