// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "participant.hpp"
#include "types.hpp"

#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>

#include <support/dds_domain.hpp>
#include <support/dds_suppressions.hpp>
#include <support/eventually.hpp>
#include <support/running_task.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#ifdef SEGUE_SANITIZER_THREAD
extern "C" [[gnu::used]] const char* __tsan_default_suppressions() {
  return segue::testing::kDdsSuppressions;
}
#endif

/// For tests of the gateway: one program starts another (peer.cpp), and both use what is here.
namespace gateway::testing {

struct Text {
  std::uint64_t number = 0;
  std::string name;
  std::vector<std::string> words;
};

struct Image {
  std::uint64_t number = 0;
  std::uint32_t width = 0;
  std::vector<std::uint8_t> data;
};

struct Pose {
  std::uint64_t number = 0;
  double x = 0;
  bool valid = false;
};

/// Everything that shared memory and CDR lay out in another way.
struct Cloud {
  std::uint64_t number = 0;
  std::uint64_t bytes = 0;
  std::vector<std::vector<double>> rings;
  std::vector<Pose> poses;
  std::vector<Text> texts;
  std::vector<bool> bits;
  std::optional<std::string> remark;
  std::array<std::vector<std::uint16_t>, 2> two;
};

inline void fill(Text& text, std::uint64_t number, std::size_t bytes) {
  text.number = number;
  text.name = std::string(bytes, static_cast<char>('a' + number % 26));
  text.words = {std::to_string(number), "", text.name};
}
inline void fill(Image& image, std::uint64_t number, std::size_t bytes) {
  image.number = number;
  image.width = static_cast<std::uint32_t>(bytes);
  image.data.assign(bytes, static_cast<std::uint8_t>(number));
}
inline void fill(Pose& pose, std::uint64_t number, std::size_t) {
  pose = {number, static_cast<double>(number) / 2, true};
}

inline void fill(Cloud& cloud, std::uint64_t number, std::size_t bytes) {
  cloud.number = number;
  cloud.bytes = bytes;
  cloud.rings.assign(number % 4, std::vector<double>(bytes / 8, static_cast<double>(number)));
  cloud.poses.resize(number % 7);
  for (Pose& pose : cloud.poses)
    fill(pose, number, 0);
  cloud.texts.resize(number % 3);
  for (Text& text : cloud.texts)
    fill(text, number, bytes % 50);
  cloud.bits.assign(number % 11, number % 2 == 0);
  cloud.remark.reset();
  if (number % 2 == 0) cloud.remark = std::string(number % 5, 'r');
  cloud.two = {std::vector<std::uint16_t>(number % 3, 7), std::vector<std::uint16_t>(bytes % 100, 8)};
}

inline bool is_whole(const Text& text) {
  Text expected;
  fill(expected, text.number, text.name.size());
  return text.name == expected.name && text.words == expected.words;
}
inline bool is_whole(const Image& image) {
  return image.data.size() == image.width && std::ranges::all_of(image.data, [&](std::uint8_t byte) {
           return byte == static_cast<std::uint8_t>(image.number);
         });
}
inline bool is_whole(const Pose& pose) {
  return pose.valid && pose.x == static_cast<double>(pose.number) / 2;
}
inline bool is_whole(const Cloud& cloud) {
  Cloud expected;
  fill(expected, cloud.number, cloud.bytes);
  const auto same_pose = [](const Pose& a, const Pose& b) { return a.number == b.number && a.x == b.x; };
  const auto same_text = [](const Text& a, const Text& b) { return a.name == b.name && a.words == b.words; };
  return cloud.rings == expected.rings && std::ranges::equal(cloud.poses, expected.poses, same_pose) &&
         std::ranges::equal(cloud.texts, expected.texts, same_text) && cloud.bits == expected.bits &&
         cloud.remark == expected.remark && cloud.two == expected.two;
}

SEGUE_TYPE(Text, number, name, words)
SEGUE_TYPE(Image, number, width, data)
SEGUE_TYPE(Pose, number, x, valid)
SEGUE_TYPE(Cloud, number, bytes, rings, poses, texts, bits, remark, two)

using segue::testing::eventually;  // for what happens in threads of Cyclone and in other processes
using segue::testing::soon;
using segue::type::Value;
using segue::type::ValueMap;

/// Programs that run at the same time rarely share a domain, and never a topic.
inline std::int32_t own_domain() {
  return static_cast<std::int32_t>(segue::testing::dds_domain_of_process());
}

inline Settings local_settings(std::int32_t domain) {
  return {domain, "lo", {"127.0.0.1"}};
}

inline ValueMap properties(std::int32_t domain, const std::string& topic, const std::string& type,
                           const std::string& policy = "data", std::uint32_t size = 1, bool init = false) {
  ValueMap map;
  map.append("topic", topic);
  map.append("type", type);
  map.append("policy", policy);
  map.append("size", std::int64_t{size});
  map.append("init", init);
  map.append("domain", domain);
  map.append("interface", "lo");
  map.append("peers", Value::list({Value("127.0.0.1")}));
  return map;
}

template <class T>
std::string name_of() {
  return std::string(segue::type::type_info<T>().name());
}

/// A link task.
class Running final : public segue::testing::RunningTask {
 public:
  using RunningTask::RunningTask;
  Running(const std::string& component, const ValueMap& values) : RunningTask(component) { run(values); }

  bool has_matched(std::uint32_t wanted) {
    const auto found =
        task().call("wait_matched", Value::list({Value(std::int64_t{wanted}), Value(30'000)}), soon());
    return found && found->as_int() >= wanted;
  }
};

/// Writes to a Sender.
template <class T>
class Source final : public segue::task::Component {
 public:
  Source() = default;
  Source(Running& sender, const segue::Policy& policy) {
    if (!segue::sample_link::connect(port, sender.in(), policy)) std::abort();
  }
  segue::task::WriteResult write(std::uint64_t number, std::size_t bytes = 10) {
    fill(sample_, number, bytes);
    return port.write(sample_);
  }
  segue::task::OutputPort<T> port{*this, "samples"};

 private:
  T sample_;
};

/// Reads from a Receiver.
template <class T>
class Sink final : public segue::task::Component {
 public:
  Sink() = default;
  Sink(Running& receiver, const segue::Policy& policy) {
    if (!segue::sample_link::connect(receiver.out(), port, policy)) std::abort();
  }
  /// Numbers of the samples that have arrived since the last call; 0 for one that is not whole.
  std::vector<std::uint64_t> read() {
    std::vector<std::uint64_t> numbers;
    while (auto sample = port.take())
      numbers.push_back(is_whole(*sample) ? sample->number : 0);
    return numbers;
  }
  /// Waits for so many samples.
  std::vector<std::uint64_t> read(std::size_t count) {
    std::vector<std::uint64_t> numbers;
    static_cast<void>(eventually([&] {
      for (const std::uint64_t number : read())
        numbers.push_back(number);
      return numbers.size() >= count;
    }));
    return numbers;
  }
  segue::task::InputPort<T> port{*this, "samples"};
};

inline segue::Policy policy(segue::BufferKind kind, std::size_t size = 1) {
  return {kind, size, segue::Transport::Automatic, false};
}
inline const segue::Policy kPlenty = policy(segue::BufferKind::Buffer, 10'000);

}  // namespace gateway::testing
