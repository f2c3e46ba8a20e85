// SPDX-License-Identifier: Apache-2.0
// Connections that begin and end with the commit of a transition.
#include <segue/sample_link/commit_page.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/shared_test_support.hpp>

#include <support/sanitizers.hpp>

#include <gmock/gmock.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace segue::sample_link {
namespace {

using namespace shared_test;
using task::CommitGate;
using task::CommitGatePtr;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Policy kBuffer{BufferKind::Buffer, 8};

enum class Kind { Local, Shared };

/// Writes again, once its connections have begun, what it wrote before.
struct Keeper : Component {
  OutputPort<int> out{*this, "out", {.on_commit = [this] {
                        if (kept) out.write(*std::exchange(kept, std::nullopt));
                      }}};
  std::optional<int> kept;
};

/// Connections of both kinds between ports of this process.
struct Ports {
  Pair pair;
  Keeper source;
  Sink<int> one{"one"};
  Sink<int> two{"two"};

  /// Its endpoints, the writer's first.
  using Endpoints = std::vector<std::shared_ptr<PortConnection>>;
  Endpoints connect(Kind kind, InputPort<int>& to, const Policy& policy,
                    const CommitGatePtr& gate = nullptr) {
    if (kind == Kind::Local) {
      auto made = sample_link::connect(source.out, to, policy, gate);
      EXPECT_TRUE(made) << to_string(made.error());
      return {*made};
    }
    auto input = open_input(*pair.reader, describe_output(*pair.writer, source.out), to, policy, gate);
    EXPECT_TRUE(input) << to_string(input.error());
    auto output = attach_output(*pair.writer, input->place, source.out, policy, gate);
    EXPECT_TRUE(output) << to_string(output.error());
    places_.emplace_back(input->endpoint, input->place);
    return {*output, input->endpoint};
  }

  void disconnect(const Endpoints& endpoints) {
    for (const auto& endpoint : endpoints) {
      endpoint->disconnect();
      const auto is_it = [&](const auto& known) { return known.first == endpoint; };
      const auto place = std::find_if(places_.begin(), places_.end(), is_it);
      if (place == places_.end()) continue;
      release_input(*pair.reader, place->second);
      places_.erase(place);
    }
  }

 private:
  std::vector<std::pair<std::shared_ptr<PortConnection>, InputPlace>> places_;
};

std::vector<int> all_of(InputPort<int>& port) {
  std::vector<int> found;
  while (const Sample<int> sample = port.take())
    found.push_back(*sample);
  return found;
}

class CommitTest : public ::testing::TestWithParam<Kind> {
 protected:
  /// The gate of the next transition.
  void begin() {
    gate_ = std::make_shared<CommitGate>();
    number_ = page_->begin();
  }
  void arm() { gate_->arm(page_->word(number_), number_); }
  void commit() { page_->commit(number_); }
  static void settle(const Ports::Endpoints& endpoints) {
    for (const auto& endpoint : endpoints)
      endpoint->settle();
  }
  void end(const Ports::Endpoints& endpoints) {
    for (const auto& endpoint : endpoints)
      endpoint->end_at(gate_);
  }

  Ports ports_;
  std::shared_ptr<CommitPage> page_ = *CommitPage::create();
  std::shared_ptr<CommitGate> gate_;
  std::uint64_t number_ = 0;
};

INSTANTIATE_TEST_SUITE_P(Kinds, CommitTest, ::testing::Values(Kind::Local, Kind::Shared),
                         [](const auto& which) { return which.param == Kind::Local ? "local" : "shared"; });

TEST_P(CommitTest, MovesAWriterFromOneReaderToAnotherBetweenTwoSamples) {
  const auto old = ports_.connect(GetParam(), ports_.one.in, kBuffer);
  begin();
  const auto fresh = ports_.connect(GetParam(), ports_.two.in, kBuffer, gate_);
  end(old);
  ports_.source.out.write(1);
  arm();
  ports_.source.out.write(2);
  EXPECT_TRUE(fresh.back()->dormant());
  EXPECT_THAT(all_of(ports_.two.in), IsEmpty()) << "not before the commit";
  commit();
  ports_.source.out.write(3);
  EXPECT_FALSE(fresh.back()->dormant());
  EXPECT_THAT(all_of(ports_.one.in), ElementsAre(1, 2)) << "what was written before is still there";
  EXPECT_THAT(all_of(ports_.two.in), ElementsAre(3));
  settle(old);
  settle(fresh);
  ports_.source.out.write(4);
  EXPECT_THAT(all_of(ports_.one.in), IsEmpty());
  EXPECT_THAT(all_of(ports_.two.in), ElementsAre(4));
}

TEST_P(CommitTest, ReadsWhatCameBeforeTheCommitFirst) {
  const auto old = ports_.connect(GetParam(), ports_.one.in, kBuffer);
  begin();
  const auto fresh = ports_.connect(GetParam(), ports_.one.in, {BufferKind::Buffer, 3}, gate_);
  end(old);
  arm();
  for (int i = 1; i <= 6; ++i) {
    if (i == 4) commit();
    ports_.source.out.write(i);
  }
  EXPECT_TRUE(old.back()->owes_samples());
  EXPECT_THAT(all_of(ports_.one.in), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_FALSE(old.back()->owes_samples());
}

TEST_P(CommitTest, ShowsANewReaderTheLastSampleWhenTheConnectionHasBegun) {
  ports_.source.out.write(5);
  begin();
  const auto fresh = ports_.connect(GetParam(), ports_.one.in, {BufferKind::Data, 1, {}, true}, gate_);
  arm();
  settle(fresh);
  EXPECT_THAT(all_of(ports_.one.in), IsEmpty());
  commit();
  settle(fresh);
  EXPECT_THAT(all_of(ports_.one.in), ElementsAre(5));
}

TEST_P(CommitTest, TellsTheWriterWhenAConnectionHasBegun) {
  task::OutputPortBase& out = ports_.source.out;
  EXPECT_FALSE(out.dormant()) << "it has no connection that could begin";
  begin();
  const auto one = ports_.connect(GetParam(), ports_.one.in, kBuffer, gate_);
  const auto two = ports_.connect(GetParam(), ports_.two.in, {BufferKind::Data, 1, {}, true}, gate_);
  arm();
  EXPECT_TRUE(out.dormant());
  ports_.source.out.write(5);
  ports_.source.kept = 5;
  commit();
  EXPECT_FALSE(out.dormant());
  settle(two);
  settle(one);
  EXPECT_FALSE(ports_.source.kept);
  EXPECT_THAT(all_of(ports_.one.in), ElementsAre(5));
  EXPECT_THAT(all_of(ports_.two.in), ElementsAre(5)) << "once, although the connection has init";
}

TEST_P(CommitTest, PortWithAConnectionThatStaysIsNotDormant) {
  const auto old = ports_.connect(GetParam(), ports_.one.in, kBuffer);
  begin();
  const auto fresh = ports_.connect(GetParam(), ports_.two.in, kBuffer, gate_);
  arm();
  EXPECT_FALSE(ports_.source.out.dormant());
  ports_.source.kept = 1;
  settle(fresh);  // the transition was given up
  EXPECT_TRUE(ports_.source.kept);
}

TEST_P(CommitTest, ChangesNothingWhereATransitionIsGivenUp) {
  const auto old = ports_.connect(GetParam(), ports_.one.in, kBuffer);
  begin();
  const auto fresh = ports_.connect(GetParam(), ports_.two.in, kBuffer, gate_);
  end(old);
  arm();
  settle(old);
  settle(fresh);
  EXPECT_TRUE(fresh.back()->dormant());
  ports_.disconnect(fresh);

  begin();  // the next one commits, which means nothing to the one before
  arm();
  commit();
  ports_.source.out.write(1);
  EXPECT_THAT(all_of(ports_.one.in), ElementsAre(1));
  EXPECT_THAT(all_of(ports_.two.in), IsEmpty());
}

TEST_P(CommitTest, RemembersTransitionsThatNobodyWasToldOf) {
  std::vector<Ports::Endpoints> all = {ports_.connect(GetParam(), ports_.one.in, kBuffer)};
  for (int i = 1; i <= 3; ++i) {  // two connections wait for, or end with, different transitions at a time
    begin();
    all.push_back(ports_.connect(GetParam(), i % 2 == 0 ? ports_.one.in : ports_.two.in,
                                 {BufferKind::Buffer, static_cast<std::size_t>(8 + i)}, gate_));
    end(all[static_cast<std::size_t>(i) - 1]);
    arm();
    commit();
    ports_.source.out.write(i);
  }
  EXPECT_THAT(all_of(ports_.one.in), ElementsAre(2));
  EXPECT_THAT(all_of(ports_.two.in), ElementsAre(1, 3));
}

TEST(CommitPage, IsTheSameInAnotherProcessWhichCannotWriteToIt) {
  const auto page = *CommitPage::create();
  const auto mapped = CommitPage::map(page->descriptor());
  ASSERT_TRUE(mapped) << to_string(mapped.error());
  CommitGate gate;
  const std::uint64_t number = page->begin();
  gate.arm((*mapped)->word(number), number);
  EXPECT_FALSE(gate.open());
  page->commit(number);
  EXPECT_TRUE(gate.open());
  const void* writable = mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, page->descriptor(), 0);
  EXPECT_EQ(writable, MAP_FAILED);
}

TEST(CommitPage, RemembersATransitionForLongAndConfusesNone) {
  const auto page = *CommitPage::create();
  CommitGate committed;
  CommitGate given_up;
  const std::uint64_t first = page->begin();
  committed.arm(page->word(first), first);
  page->commit(first);
  const std::uint64_t second = page->begin();
  given_up.arm(page->word(second), second);
  for (std::size_t i = 2; i < CommitPage::kRemembered; ++i)
    page->commit(page->begin());
  EXPECT_TRUE(committed.open());
  for (std::size_t i = 0; i < CommitPage::kRemembered; ++i)
    page->commit(page->begin());
  EXPECT_FALSE(given_up.open());
}

TEST(CommitPage, TakesNoFileThatCouldChangeUnderIt) {
  const Descriptor plain(memfd_create("plain", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  ASSERT_EQ(ftruncate(plain.get(), 4096), 0);
  EXPECT_EQ(CommitPage::map(plain.get()).error().code, ErrorCode::InvalidArgument);
  EXPECT_FALSE(CommitPage::map(-1));
}

constexpr int kCommits = kSanitized ? 1000 : 10000;

/// Writes 1, 2, ... as fast as its readers take them. A refused sample was taken by none, and is written
/// again.
struct Counting {
  explicit Counting(Keeper& source)
      : thread([this, &source] {
          for (int next = 1; !stop;) {
            const bool written = source.out.write(next) == WriteResult::Written;
            written ? void(last = next++) : std::this_thread::yield();
          }
        }) {}
  ~Counting() { finish(); }
  void finish() {
    stop = true;
    if (thread.joinable()) thread.join();
  }
  std::atomic<bool> stop{false};
  std::atomic<int> last{0};
  std::thread thread;
};

/// Takes all samples, in their order.
struct Taking {
  explicit Taking(InputPort<int>& port)
      : thread([this, &port] {
          do {
            const std::vector<int> found = all_of(port);
            taken.insert(taken.end(), found.begin(), found.end());
            found.empty() ? std::this_thread::yield() : void();
          } while (!stop);
          const std::vector<int> rest = all_of(port);
          taken.insert(taken.end(), rest.begin(), rest.end());
        }) {}
  ~Taking() { finish(); }
  void finish() {
    stop = true;
    if (thread.joinable()) thread.join();
  }
  std::atomic<bool> stop{false};
  std::vector<int> taken;
  std::thread thread;
};

/// The connection of a writer moves thousands of times, between two readers, among local and shared memory
/// and among sizes, while all of them work at full speed; every tenth transition is given up.
TEST(CommitStorm, LosesAndDoublesNothingAndKeepsTheOrder) {
  const auto page = *CommitPage::create();
  Ports ports;
  std::minstd_rand random(20261123);
  const auto pick = [&](unsigned count) { return static_cast<unsigned>(random()) % count; };
  Ports::Endpoints now = ports.connect(Kind::Local, ports.one.in, kBuffer);
  Taking one(ports.one.in);
  Taking two(ports.two.in);
  Counting writer(ports.source);
  for (int i = 0; i < kCommits; ++i) {
    const auto gate = std::make_shared<CommitGate>();
    const std::uint64_t number = page->begin();
    const Policy policy{BufferKind::Buffer, 1 + static_cast<std::size_t>(i) % 30};
    const Kind kind = pick(2) == 0 ? Kind::Local : Kind::Shared;
    const Ports::Endpoints next =
        ports.connect(kind, pick(2) == 0 ? ports.one.in : ports.two.in, policy, gate);
    for (const auto& endpoint : now)
      endpoint->end_at(gate);
    gate->arm(page->word(number), number);
    const bool commits = i % 10 != 9;
    if (commits) page->commit(number);
    for (const Ports::Endpoints& endpoints : {now, next}) {
      for (const auto& endpoint : endpoints)
        endpoint->settle();
    }
    const auto& over = commits ? now : next;
    ASSERT_TRUE(eventually([&] { return !over.back()->owes_samples(); }));
    ports.disconnect(over);
    if (commits) now = next;
  }
  writer.finish();
  one.finish();
  two.finish();
  EXPECT_TRUE(std::is_sorted(one.taken.begin(), one.taken.end()));
  EXPECT_TRUE(std::is_sorted(two.taken.begin(), two.taken.end()));
  std::vector<int> all;
  std::merge(one.taken.begin(), one.taken.end(), two.taken.begin(), two.taken.end(), std::back_inserter(all));
  ASSERT_EQ(all.size(), static_cast<std::size_t>(writer.last));
  for (std::size_t i = 0; i < all.size(); ++i)
    ASSERT_EQ(all[i], static_cast<int>(i) + 1);
}

}  // namespace
}  // namespace segue::sample_link
