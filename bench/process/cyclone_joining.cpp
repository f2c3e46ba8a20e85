// SPDX-License-Identifier: Apache-2.0
#include "cyclone_peer.hpp"
#include "joining.hpp"

#include <sched.h>

#include <vector>

namespace bench {
namespace {

/// A new reader receives a sample.
void greet(dds_entity_t writer, dds_publication_matched_status_t status, void* /*nothing*/) {
  bench_dds_Sample sample{};
  if (status.current_count_change > 0) ::dds_write(writer, &sample);
}

class CycloneJoining final : public Joining {
 public:
  [[nodiscard]] std::string name() const override { return "Cyclone DDS (UDP loopback, reliable)"; }

  void offer(const End& end, std::size_t topics) override {
    const CycloneDomain domain;
    dds_listener_t* listener = ::dds_create_listener(nullptr);
    ::dds_lset_publication_matched(listener, &greet);
    for (std::size_t i = 0; i < topics; ++i) {
      const dds_entity_t writer = make_cyclone_writer(domain, domain.topic(topic_name(i)));
      ::dds_set_listener(writer, listener);
    }
    end.board.word.store(1, std::memory_order_release);
    wait_for_the_other(end);
  }

  /// The first round is not counted, since it discovers the other process.
  bool join(const End& end, std::size_t topics, std::size_t repeat) override {
    while (end.board.word.load(std::memory_order_acquire) == 0)
      ::sched_yield();
    const CycloneDomain domain;
    std::vector<dds_entity_t> made;
    for (std::size_t i = 0; i < topics; ++i)
      made.push_back(domain.topic(topic_name(i)));
    for (std::size_t round = 0; round <= repeat; ++round) {
      std::vector<dds_entity_t> readers;
      const std::int64_t begin = clock_ns();
      for (const dds_entity_t topic : made)
        readers.push_back(make_cyclone_reader(domain, topic));
      for (const dds_entity_t reader : readers) {
        while (!take_cyclone(reader).stamp)
          ::sched_yield();
      }
      if (round > 0) end.board.add_result(Duration(clock_ns() - begin));
      for (const dds_entity_t reader : readers)
        ::dds_delete(reader);
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<Joining> make_cyclone_joining() {
  return std::make_unique<CycloneJoining>();
}

}  // namespace bench
