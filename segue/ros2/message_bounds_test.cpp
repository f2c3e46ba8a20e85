// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/message_bounds.hpp>
#include <segue/ros2/message_type.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/made_type.hpp>

#include <gmock/gmock.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "support/temporary_files.hpp"

namespace segue::ros2 {
namespace {

using type::Value;

class MessageBoundsTest : public ::testing::Test {
 protected:
  MessageBoundsTest() {
    folder_.write("bounds_msgs/msg/Label.msg", "uint8 kind\nstring<=3 label\n");
    folder_.write("bounds_msgs/msg/Labels.msg", "float64[<=2] values\nLabel[] labels\n");
  }

  MessageBounds bounds_of(const std::string& message) {
    auto bounds = MessageBounds::of(library_, message);
    EXPECT_TRUE(bounds) << to_string(bounds.error());
    return *std::move(bounds);
  }

  std::vector<std::byte> cdr_of(const std::string& message, const Value& value) {
    const type::TypeInfo& info = info_of(message);
    const auto object = object_of(info);
    EXPECT_TRUE(info.from_value(object.get(), value, ""));
    std::vector<std::byte> bytes(type::cdr_size(info, object.get()));
    EXPECT_TRUE(type::write_cdr(info, object.get(), bytes));
    return bytes;
  }

  bool is_read(const std::string& message, const std::vector<std::byte>& bytes) {
    const type::TypeInfo& info = info_of(message);
    return type::read_cdr(info, object_of(info).get(), bytes);
  }

  /// A message Labels with so many values and those labels.
  std::vector<std::byte> labels_of(std::size_t values, const std::vector<std::string>& labels) {
    Value::List items;
    for (const std::string& label : labels)
      items.push_back(Value::map({{"kind", 1}, {"label", label}}));
    return cdr_of("bounds_msgs/msg/Labels",
                  Value::map({{"values", Value::List(values, Value(1.5))}, {"labels", std::move(items)}}));
  }

  std::string broken_by(const std::vector<std::byte>& message) {
    const MessageBounds bounds = bounds_of("bounds_msgs/msg/Labels");
    std::string why = bounds.broken_by(message);
    EXPECT_EQ(bounds.kept_by(message), why.empty());
    return why;
  }

 private:
  const type::TypeInfo& info_of(const std::string& message) {
    const auto type = message_type(library_, message, registry_);
    EXPECT_TRUE(type);
    return **type::make_type_info(**type);
  }

  static std::shared_ptr<std::byte[]> object_of(const type::TypeInfo& info) {
    const std::shared_ptr<std::byte[]> object(new std::byte[info.size], [&info](std::byte* memory) {
      info.destroy(memory);
      delete[] memory;
    });
    info.construct(object.get());
    return object;
  }

  testing::TemporaryFiles folder_;
  InterfaceLibrary library_{{folder_.folder()}};
  type::TypeRegistry registry_;
};

TEST_F(MessageBoundsTest, AreKeptByAsMuchAsTheyAllow) {
  EXPECT_EQ(broken_by(labels_of(0, {})), "");
  EXPECT_EQ(broken_by(labels_of(2, {"abc", "", "\xC3\xA4z"})), "");
}

TEST_F(MessageBoundsTest, CountTheBytesOfATextAndSayWhereItIs) {
  EXPECT_EQ(broken_by(labels_of(1, {"abc", "abc", "\xC3\xA4\xC3\xA4"})),
            "labels[2].label: 4 bytes, but it is a string<=3");
}

TEST_F(MessageBoundsTest, CountTheItemsOfASequence) {
  EXPECT_EQ(broken_by(labels_of(3, {"abcd"})), "values: 3 items, but it is a float64[<=2]");
}

TEST_F(MessageBoundsTest, AreReadInBigEndianToo) {
  std::vector<std::byte> message = labels_of(3, {});
  message[1] = std::byte{0};
  EXPECT_EQ(broken_by(message), "values: 50331648 items, but it is a float64[<=2]");
}

TEST_F(MessageBoundsTest, AreNotKeptByAMessageThatEndsTooEarly) {
  const std::vector<std::byte> message = labels_of(2, {"abc", "ab"});
  const MessageBounds bounds = bounds_of("bounds_msgs/msg/Labels");
  for (std::size_t size = 0; size < message.size(); ++size) {
    const std::span<const std::byte> beginning = std::span(message).first(size);
    EXPECT_FALSE(bounds.kept_by(beginning)) << size;
    EXPECT_THAT(bounds.broken_by(beginning), ::testing::EndsWith(": the message ends too early"));
  }
}

TEST_F(MessageBoundsTest, AreLookedForInAnyBytes) {
  const MessageBounds bounds = bounds_of("bounds_msgs/msg/Labels");
  const std::vector<std::byte> message = labels_of(2, {"abc", "ab"});
  for (std::size_t i = 1; i < message.size(); ++i) {
    for (const int value : {0, 1, 3, 127, 255}) {
      std::vector<std::byte> changed = message;
      changed[i] = static_cast<std::byte>(value);
      const std::string why = bounds.broken_by(changed);
      EXPECT_EQ(bounds.kept_by(changed), why.empty());
      const bool too_short = why.find("ends too early") != std::string::npos;
      EXPECT_FALSE(too_short && is_read("bounds_msgs/msg/Labels", changed)) << i << ": " << value;
    }
  }
}

TEST_F(MessageBoundsTest, AreFoundInPartsOfAMessage) {
  EXPECT_TRUE(bounds_of("bounds_msgs/msg/Labels").any());
  EXPECT_TRUE(bounds_of("rcl_interfaces/srv/DescribeParameters_Response").any());
  EXPECT_FALSE(bounds_of("geometry_msgs/msg/Pose").any());
}

}  // namespace
}  // namespace segue::ros2
