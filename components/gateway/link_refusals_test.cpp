// SPDX-License-Identifier: Apache-2.0
#include "link_test_support.hpp"

namespace gateway::testing {
namespace {

/// Writes bytes to a topic, as any program may.
class Foreign {
 public:
  Foreign(const std::string& topic, const std::string& type)
      : participant_(participant(local_settings(kDomain)).value()),
        topic_(participant_, "rt/" + topic, dds_type_name(type)),
        writer_(make_writer()) {}
  ~Foreign() { ::dds_delete(writer_); }
  Foreign(const Foreign&) = delete;
  Foreign& operator=(const Foreign&) = delete;

  void write(const std::vector<std::byte>& bytes) {
    auto* message = new Message(topic_.type(), SDK_DATA, bytes.size());
    std::ranges::copy(bytes, message->bytes().begin());
    EXPECT_EQ(::dds_writecdr(writer_, message), DDS_RETCODE_OK);
  }

 private:
  dds_entity_t make_writer() const {
    dds_qos_t* quality = ::dds_create_qos();
    ::dds_qset_reliability(quality, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    ::dds_qset_history(quality, DDS_HISTORY_KEEP_ALL, 0);
    const dds_entity_t made = ::dds_create_writer(participant_, topic_.entity(), quality, nullptr);
    ::dds_delete_qos(quality);
    return made;
  }
  dds_entity_t participant_;
  Topic topic_;
  dds_entity_t writer_;
};

template <class T>
std::vector<std::byte> encoded(const T& sample) {
  std::vector<std::byte> bytes(segue::type::cdr_size(segue::type::type_info<T>(), &sample));
  segue::type::write_cdr(segue::type::type_info<T>(), &sample, bytes);
  return bytes;
}

TEST_F(GatewayLink, HostileBytesAreCountedAndDropped) {
  Running receiver("gateway::Receiver", properties(kDomain, topic, name_of<Text>(), "buffer", 100));
  Sink<Text> sink(receiver, kPlenty);
  Foreign foreign(topic, name_of<Text>());
  ASSERT_TRUE(receiver.has_matched(1));
  Text text;
  fill(text, 3, 5);
  const auto whole = encoded(text);
  std::uint64_t corrupt = 0;
  for (std::size_t cut = 4; cut < whole.size(); cut += 3, ++corrupt)
    foreign.write({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut)});
  auto huge = whole;
  std::fill(huge.begin() + 12, huge.begin() + 16, std::byte{0xff});
  foreign.write(huge);
  Pose pose;
  fill(pose, 4, 0);
  foreign.write(encoded(pose));
  foreign.write(std::vector<std::byte>(1000, std::byte{0x5a}));
  foreign.write(whole);
  EXPECT_EQ(sink.read(1), numbers(3, 3));
  EXPECT_EQ(receiver.count("corrupt"), corrupt + 3);
}

TEST_F(GatewayLink, AnotherTypeDoesNotMatchAndIsSeen) {
  Running receiver("gateway::Receiver", properties(kDomain, topic, name_of<Text>()));
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Pose>()));
  EXPECT_TRUE(
      eventually([&] { return sender.count("mismatched") == 1 && receiver.count("mismatched") == 1; }));
  EXPECT_EQ(sender.count("matched") + receiver.count("matched"), 0U);
}

/// Returns the error of a Receiver with these properties, in place of the usual ones.
std::string refusal(const std::string& topic, const ValueMap& changes, TaskState state) {
  Running receiver("gateway::Receiver");
  ValueMap all = properties(kDomain, topic, name_of<Pose>());
  for (const auto& [name, value] : changes)
    all[name] = value;
  const auto done = receiver.configure(all);
  EXPECT_EQ(receiver.task().state(), state);
  return done ? std::string() : segue::to_string(done.error());
}

TEST_F(GatewayLink, WrongPropertiesAreRefusedWithAReason) {
  const auto refuse = [&](const char* name, Value value) {
    ValueMap changes;
    changes.append(name, std::move(value));
    return refusal(topic, changes, TaskState::PreOperational);
  };
  EXPECT_THAT(refuse("type", "/no/Such"), HasSubstr("type '/no/Such' is not known to this process"));
  EXPECT_THAT(refuse("library", "no_such"), HasSubstr("needs library 'no_such', which cannot be loaded"));
  EXPECT_THAT(refuse("policy", "fifo"), HasSubstr("policy 'fifo' is none of"));
  EXPECT_THAT(refuse("size", 5), HasSubstr("policy data holds one sample"));
  EXPECT_THAT(refuse("topic", "a b"), HasSubstr("the topic 'a b' must be"));
  EXPECT_THAT(refuse("domain", 233), HasSubstr("domain 233 does not exist"));
  EXPECT_THAT(refuse("domain", kDomain + 1), HasSubstr("with other settings"));
  EXPECT_THAT(refuse("peers", Value::list({})), HasSubstr("with other settings"));
}

TEST_F(GatewayLink, ATaskWithoutPeersLooksForThoseOfItsProcess) {
  ValueMap changes;
  changes.append("peers", Value::list({}));
  ::setenv("SEGUE_PEERS", "127.0.0.1", 1);  // as the tests' participant has
  EXPECT_EQ(refusal(topic, changes, TaskState::Stopped), "");
  ::setenv("SEGUE_PEERS", "10.0.0.1,arm.local", 1);
  EXPECT_THAT(refusal(topic, changes, TaskState::PreOperational), HasSubstr("peers 10.0.0.1 and arm.local"));
  ::unsetenv("SEGUE_PEERS");
}

TEST_F(GatewayLink, ATypeComesFromItsLibrary) {
  Running receiver("gateway::Receiver");
  ValueMap values = properties(kDomain, topic, "/demo/Scan");
  values["library"] = "segue_components_demo";
  ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kComponentFolder, 1);
  const auto done = receiver.configure(values);
  EXPECT_TRUE(done) << (done ? "" : segue::to_string(done.error()));
  EXPECT_EQ(receiver.out().type_name(), "/demo/Scan");
}

TEST(GatewayStart, ANetworkThatIsNotThereLeadsToException) {
  for (const char* interface : {"no_such_device", "203.0.113.77"}) {
    Peer peer({"configure", std::to_string(kDomain), interface});
    EXPECT_EQ(peer.line(), "exception");
    EXPECT_THAT(peer.line(), HasSubstr("Cyclone DDS cannot start"));
    EXPECT_THAT(peer.line(), ::testing::StartsWith("alive"));
  }
}

}  // namespace
}  // namespace gateway::testing
