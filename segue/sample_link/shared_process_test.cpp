// SPDX-License-Identifier: Apache-2.0
// Two real processes: this program starts itself again for the other side, and kills it at any moment.
#include <segue/base/descriptor.hpp>
#include <segue/sample_link/shared_test_support.hpp>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <vector>

extern char** environ;

namespace segue::sample_link {
namespace {

using namespace shared_test;
using Text = std::vector<std::string>;

constexpr int kChannel = 10;  ///< the child's descriptors
constexpr int kPayload = 11;
constexpr int kControl = 12;

Text text_of(std::int64_t number) {
  return {std::to_string(number), std::string(static_cast<std::size_t>(number % 3000), 'x'),
          std::to_string(number)};
}

bool is_whole(const Text& text) {
  return text.size() == 3 && text == text_of(std::stoll(text.front()));
}

/// All that the two sides exchange besides samples.
struct Message {
  Incarnation incarnation = 0;
  int payload = -1;
  int control = -1;
  Policy policy;
  std::uint64_t offset[2] = {};  ///< of the rings for poses and texts
  std::uint64_t generation[2] = {};
};

bool send(int channel, const Message& message) {
  return ::send(channel, &message, sizeof(message), MSG_NOSIGNAL) == static_cast<ssize_t>(sizeof(message));
}

Message receive(int channel) {
  Message message;
  if (recv(channel, &message, sizeof(message), MSG_WAITALL) != static_cast<ssize_t>(sizeof(message)))
    message.incarnation = 0;
  return message;
}

InputPlace place_of(const Message& from, int which, const InputPlace& like) {
  InputPlace place = like;
  place.reader = from.incarnation;
  place.offset = from.offset[which];
  place.generation = from.generation[which];
  return place;
}

void put_place(Message& message, int which, const InputPlace& place) {
  message.offset[which] = place.offset;
  message.generation[which] = place.generation;
}

template <class T>
InputPlace likeness(const std::string& port) {
  InputPlace place;
  place.type = type::type_info<T>().name();
  place.hash = type::type_info<T>().hash;
  place.port = port;
  return place;
}

/// A copy whose number is none of the child's, so that no redirection overwrites the source of another.
Descriptor aside(const Descriptor& descriptor) {
  return Descriptor(fcntl(descriptor.get(), F_DUPFD_CLOEXEC, kControl + 1));
}

/// The other process.
class Child {
 public:
  Child(const SharedMemory& memory, const std::string& role) {
    int ends[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
    channel_ = Descriptor(ends[0]);
    const Descriptor theirs = aside(Descriptor(ends[1]));
    const auto offer = memory.offer();
    EXPECT_TRUE(offer);
    const Descriptor payload = aside(offer->payload);
    const Descriptor control = aside(offer->control);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, theirs.get(), kChannel);
    posix_spawn_file_actions_adddup2(&actions, payload.get(), kPayload);
    posix_spawn_file_actions_adddup2(&actions, control.get(), kControl);
    std::string filter = "--gtest_filter=SharedChild.DISABLED_" + role;
    std::string disabled = "--gtest_also_run_disabled_tests";
    std::string brief = "--gtest_brief=1";
    std::string self = "shared-child";
    char* arguments[] = {self.data(), filter.data(), disabled.data(), brief.data(), nullptr};
    EXPECT_EQ(posix_spawn(&pid_, "/proc/self/exe", &actions, nullptr, arguments, environ), 0);
    posix_spawn_file_actions_destroy(&actions);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { kill(); }

  [[nodiscard]] int channel() const { return channel_.get(); }
  [[nodiscard]] MemoryOffer memory(const Message& reply) const {
    return {reply.incarnation, open_theirs(reply.payload), open_theirs(reply.control)};
  }
  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

 private:
  [[nodiscard]] Descriptor open_theirs(int descriptor) const {
    const std::string path = "/proc/" + std::to_string(pid_) + "/fd/" + std::to_string(descriptor);
    return Descriptor(open(path.c_str(), O_RDWR | O_CLOEXEC));
  }
  pid_t pid_ = -1;
  Descriptor channel_;
};

/// The child's side of the handshake.
struct Parent {
  Parent() {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    memory = *SharedMemory::create(kSmall);
    const auto offer = memory->offer();
    kept_payload = offer->payload.duplicate();
    kept_control = offer->control.duplicate();
    mine.incarnation = memory->incarnation();
    mine.payload = kept_payload.get();
    mine.control = kept_control.get();
    reply = receive(kChannel);
    MemoryOffer theirs{reply.incarnation, Descriptor(kPayload), Descriptor(kControl)};
    if (!memory->admit(theirs)) std::exit(3);
  }
  std::shared_ptr<SharedMemory> memory;
  Descriptor kept_payload;
  Descriptor kept_control;
  Message mine;
  Message reply;
};

/// Reads both kinds, holds a few samples, and leaves with 4 when one is torn.
struct Taker : Component {
  InputPort<Pose> poses{*this, "poses"};
  InputPort<Text> texts{*this, "texts"};
  std::atomic<std::uint64_t> received{0};
  std::atomic<std::uint64_t> torn{0};

 protected:
  void on_update() override {
    for (int i = 0; i < 4; ++i) {
      if (auto pose = poses.take()) {
        if (held_ && !held_->whole()) ++torn;
        held_ = pose;
        if (!pose->whole()) ++torn;
        ++received;
      }
      if (const auto text = texts.take()) {
        if (!is_whole(*text)) ++torn;
        ++received;
      }
    }
  }

 private:
  Sample<Pose> held_;
};

TEST(SharedChild, DISABLED_Reader) {
  Parent parent;
  auto [task, taker] = running<Taker>("taker", {});
  const OutputOrigin poses{parent.reply.incarnation, sizeof(Pose), false};
  const OutputOrigin texts{parent.reply.incarnation, sizeof(Text), true};
  auto pose_endpoint = open_input(*parent.memory, poses, taker->poses, parent.reply.policy);
  auto text_endpoint = open_input(*parent.memory, texts, taker->texts, parent.reply.policy);
  if (!pose_endpoint || !text_endpoint) std::exit(5);
  put_place(parent.mine, 0, pose_endpoint->place);
  put_place(parent.mine, 1, text_endpoint->place);
  send(kChannel, parent.mine);
  receive(kChannel);  // until the parent closes it
}

TEST(SharedChild, DISABLED_Writer) {
  Parent parent;
  Source<Pose> poses;
  Source<Text> texts;
  send(kChannel, parent.mine);
  const Message places = receive(kChannel);
  const auto first =
      attach_output(*parent.memory, place_of(places, 0, likeness<Pose>("poses")), poses.out, places.policy);
  const auto second =
      attach_output(*parent.memory, place_of(places, 1, likeness<Text>("texts")), texts.out, places.policy);
  if (!first || !second) std::exit(5);
  for (std::int64_t i = 1;; ++i) {
    poses.out.write(Pose(i));
    texts.out.write(text_of(i));
  }
}

Policy policy_of(unsigned number) {
  switch (number % 3) {
    case 0:
      return {BufferKind::Data, 1};
    case 1:
      return {BufferKind::Buffer, 4};
    default:
      return {BufferKind::CircularBuffer, 5};
  }
}

constexpr int kKills = 24;

TEST(SharedProcess, WriterMayDieAtAnyMoment) {
  std::minstd_rand random(11);
  const auto memory = *SharedMemory::create(kSmall);
  const MemoryUsage idle = memory->usage();
  for (int round = 0; round < kKills; ++round) {
    auto [task, taker] = running<Taker>("taker", {});
    Child child(*memory, "Writer");
    const Policy policy = policy_of(static_cast<unsigned>(round));
    Message message;
    message.incarnation = memory->incarnation();
    ASSERT_TRUE(send(child.channel(), message));
    const Message reply = receive(child.channel());
    ASSERT_NE(reply.incarnation, 0U);
    ASSERT_TRUE(memory->admit(child.memory(reply)));
    auto poses = open_input(*memory, {reply.incarnation, sizeof(Pose), false}, taker->poses, policy);
    auto texts = open_input(*memory, {reply.incarnation, sizeof(Text), true}, taker->texts, policy);
    ASSERT_TRUE(poses && texts);
    put_place(message, 0, poses->place);
    put_place(message, 1, texts->place);
    message.policy = policy;
    ASSERT_TRUE(send(child.channel(), message));
    const std::uint64_t enough = 50 + random() % 3000;
    ASSERT_TRUE(eventually([&, reader = taker] { return reader->received > enough; }));
    child.kill();
    // Samples that were sent completely are still read.
    EXPECT_EQ(poses->endpoint->corrupt() + texts->endpoint->corrupt(), 0U);
    memory->forget(reply.incarnation);
    EXPECT_TRUE(task->stop(soon()));
    EXPECT_EQ(taker->torn, 0U);
    EXPECT_EQ(memory->usage().connections, 0U);
    EXPECT_EQ(memory->usage().peers, 0U);
    task.reset();
    EXPECT_EQ(memory->usage().control_used, idle.control_used);
  }
}

TEST(SharedProcess, ReaderMayDieAtAnyMoment) {
  std::minstd_rand random(12);
  const auto memory = *SharedMemory::create(kSmall);
  Source<Pose> poses;
  Source<Text> texts;
  std::optional<std::size_t> used;
  for (int round = 0; round < kKills; ++round) {
    Child child(*memory, "Reader");
    Message message;
    message.incarnation = memory->incarnation();
    message.policy = policy_of(static_cast<unsigned>(round));
    ASSERT_TRUE(send(child.channel(), message));
    const Message reply = receive(child.channel());
    ASSERT_NE(reply.incarnation, 0U);
    ASSERT_TRUE(memory->admit(child.memory(reply)));
    auto first =
        attach_output(*memory, place_of(reply, 0, likeness<Pose>("poses")), poses.out, message.policy);
    auto second =
        attach_output(*memory, place_of(reply, 1, likeness<Text>("texts")), texts.out, message.policy);
    ASSERT_TRUE(first && second);
    // Until it has read enough; it sleeps in between and must be woken.
    const std::uint64_t enough = 50 + random() % 1000;
    std::int64_t number = 0;
    ASSERT_TRUE(eventually([&] {
      poses.out.write(Pose(++number));
      texts.out.write(text_of(number));
      return (*first)->counters().read > enough && (*second)->counters().read > enough;
    }));
    std::thread killer([&] { child.kill(); });
    for (unsigned i = 0; i < random() % 2000; ++i) {
      EXPECT_NE(poses.out.write(Pose(++number)), WriteResult::NoSlot);
      texts.out.write(text_of(number));
    }
    killer.join();
    EXPECT_EQ((*first)->corrupt() + (*second)->corrupt(), 0U);
    memory->forget(reply.incarnation);
    first->reset();
    second->reset();
    EXPECT_EQ(memory->usage().connections, 0U);
    EXPECT_EQ(memory->usage().peers, 0U);
    // The port's own slots have grown to what the largest policy needs after three rounds.
    if (round == 2) used = memory->usage().payload_used;
    if (used) {
      EXPECT_EQ(memory->usage().payload_used, *used);
    }
  }
}

TEST(SharedProcess, SleepingReaderIsWokenForEverySample) {
  const auto memory = *SharedMemory::create(kSmall);
  Source<Pose> poses;
  Source<Text> texts;
  Child child(*memory, "Reader");
  Message message;
  message.incarnation = memory->incarnation();
  ASSERT_TRUE(send(child.channel(), message));
  const Message reply = receive(child.channel());
  ASSERT_NE(reply.incarnation, 0U);
  ASSERT_TRUE(memory->admit(child.memory(reply)));
  auto endpoint = attach_output(*memory, place_of(reply, 0, likeness<Pose>("poses")), poses.out, {});
  ASSERT_TRUE(endpoint);
  for (std::uint64_t i = 1; i <= 2000; ++i) {
    poses.out.write(Pose(static_cast<std::int64_t>(i)));
    ASSERT_TRUE(eventually([&] { return (*endpoint)->counters().read == i; })) << i;
  }
}

}  // namespace
}  // namespace segue::sample_link
