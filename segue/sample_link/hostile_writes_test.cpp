// SPDX-License-Identifier: Apache-2.0
// Random writes to what a connection shares, while samples flow: SEGUE_HOSTILE_WRITES cases (200), from seed
// SEGUE_HOSTILE_SEED (1) on.
#include <segue/sample_link/shared_pools.hpp>
#include <segue/sample_link/shared_ring.hpp>
#include <segue/sample_link/shared_state.hpp>
#include <segue/sample_link/shared_test_support.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace segue::sample_link {
namespace {

using namespace shared_test;
using Words = std::span<std::atomic<std::uint64_t>>;

unsigned number_from(const char* variable, unsigned otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::stoul(text));
}

Words words_at(void* memory, std::size_t bytes) {
  return {static_cast<std::atomic<std::uint64_t>*>(memory), bytes / 8};
}

/// The part of the memory that is overwritten.
enum class Region : std::uint8_t { Header, Queue, Returned, Entries, Pool, Payload };
constexpr unsigned kRegions = 6;

class HostileWriter {
 public:
  explicit HostileWriter(unsigned seed) : random_(seed) {}

  [[nodiscard]] unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  Policy policy() {
    switch (below(4)) {
      case 0:
        return {BufferKind::Data, 1};
      case 1:
        return {BufferKind::Data, 1, Transport::SharedMemory, true};
      case 2:
        return {BufferKind::Buffer, 1 + below(7)};
      default:
        return {BufferKind::CircularBuffer, 1 + below(7)};
    }
  }
  /// One to eight words, anything from a single bit to garbage.
  void spoil(Words words) {
    for (unsigned left = 1 + below(8); left > 0; --left) {
      auto& word = words[random_() % words.size()];
      switch (below(4)) {
        case 0:
          word = random_();
          break;
        case 1:
          word ^= std::uint64_t{1} << below(64);
          break;
        case 2:
          word = 0;
          break;
        default:
          word = below(100);
      }
    }
  }

 private:
  std::mt19937_64 random_;
};

template <class T>
T sample_of(int number);
template <>
Pose sample_of<Pose>(int number) {
  return Pose(number);
}
template <>
std::vector<std::string> sample_of<std::vector<std::string>>(int number) {
  return {std::to_string(number), "text"};
}

/// A connection that is disturbed and looked after, in this thread.
template <class T>
class Case {
 public:
  explicit Case(unsigned seed)
      : hostile_(seed), policy_(hostile_.policy()), region_(static_cast<Region>(hostile_.below(kRegions))) {}

  void run() {
    connect();
    flow(hostile_.below(12));
    const bool waits = hostile_.below(2) == 0;
    if (waits) source_.out.write(sample_of<T>(++written_));
    hostile_.spoil(words());
    if (hostile_.below(2) == 0) flow(1 + hostile_.below(12));
    EXPECT_TRUE(check() || flows() || check()) << "samples are lost for ever, and nobody knows";
    EXPECT_TRUE(region_ == Region::Payload || wrong_ == 0) << "samples that were never written";
    pair_.disconnect(link_);
    connect();
    EXPECT_TRUE(flows()) << "made again, it carries nothing";
    EXPECT_FALSE(check());
    const auto late = *SharedMemory::create(kSmall);
    for (const auto& memory : {pair_.reader, pair_.writer})
      EXPECT_TRUE(late->admit(*memory->offer())) << "no process can connect to it any more";
  }
  [[nodiscard]] std::string what() const {
    return std::string(to_string(policy_.kind)) + " " + std::to_string(policy_.size) + ", region " +
           std::to_string(static_cast<int>(region_));
  }

 private:
  void connect() {
    link_ = pair_.connect(source_.out, sink_.in, policy_);
    ASSERT_TRUE(link_.ok) << to_string(link_.error);
  }
  /// The words of the region that belong to the connection, as its peers see them.
  Words words() {
    const auto reader = PeerMemory::map(*pair_.reader->offer());
    peer_ = *reader;
    SharedRing ring(peer_->control(link_.place.offset, SharedRing::bytes(policy_)), policy_,
                    link_.place.generation);
    auto* const begin = reinterpret_cast<std::byte*>(&ring.header());
    const auto writer = SharedState::of(*pair_.writer)->payload();
    switch (region_) {
      case Region::Header:
        return words_at(begin, sizeof(RingHeader));
      case Region::Queue: {
        const std::size_t header = (sizeof(RingHeader) + 63) / 64 * 64;
        return words_at(begin + header, WordRing::places(policy_.kind, policy_.size) * 8);
      }
      case Region::Returned:
        return ring.returned();
      case Region::Entries:
        return words_at(ring.entries().data(), ring.entries().size_bytes());
      case Region::Pool:
        return words_at(peer_->control(0, 64), pair_.reader->usage().control_used);
      case Region::Payload:
        break;
    }
    return words_at(writer->at(0), writer->blocks().used());
  }
  /// Takes all that waits; true: the last of them is the newest one written.
  bool take() {
    bool newest = false;
    while (const auto sample = sink_.in.take()) {
      newest = *sample == sample_of<T>(written_);
      bool known = false;
      for (int number = std::max(1, written_ - 20); number <= written_; ++number)
        known = known || *sample == sample_of<T>(number);
      wrong_ += known ? 0 : 1;
    }
    return newest;
  }
  void flow(unsigned samples) {
    for (; samples > 0; --samples) {
      source_.out.write(sample_of<T>(++written_));
      if (hostile_.below(3) > 0) take();
    }
  }
  /// More samples than there are entries, so that none can be missing.
  bool flows() {
    take();
    for (int i = 0; i < 30; ++i) {
      source_.out.write(sample_of<T>(++written_));
      if (!take()) return false;
    }
    return true;
  }
  /// For some seconds, as deployments do; samples may flow meanwhile.
  bool check() {
    const bool goes_on = hostile_.below(2) == 0;
    for (int second = 0; second < 5; ++second) {
      const TimePoint now(std::chrono::hours(1) + std::chrono::seconds(second));
      if (link_.input->damage(now) != Damage::None || link_.output->damage(now) != Damage::None) return true;
      if (goes_on) flow(3);
      take();
    }
    return false;
  }

  HostileWriter hostile_;
  const Policy policy_;
  const Region region_;
  Pair pair_;
  std::shared_ptr<const PeerMemory> peer_;
  Source<T> source_;
  Sink<T> sink_;
  Link link_;
  int written_ = 0;
  int wrong_ = 0;
};

TEST(HostileWrites, ToAConnectionAreFoundOrDoNoHarm) {
  const unsigned count = number_from("SEGUE_HOSTILE_WRITES", 200);
  const unsigned first = number_from("SEGUE_HOSTILE_SEED", 1);
  for (unsigned seed = first; seed < first + count; ++seed) {
    const auto run = [&](auto one) {
      SCOPED_TRACE("SEGUE_HOSTILE_SEED=" + std::to_string(seed) + ", " + one->what());
      one->run();
    };
    if (seed % 3 == 0) {
      run(std::make_unique<Case<std::vector<std::string>>>(seed));
    } else {
      run(std::make_unique<Case<Pose>>(seed));
    }
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace segue::sample_link
