// SPDX-License-Identifier: Apache-2.0
#include <segue/task/component.hpp>
#include <segue/task/typed_port.hpp>
#include <segue/task_host/write_meter.hpp>
#include <segue/type/describe_standard.hpp>

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

namespace segue::task_host::detail {
namespace {

using type::Value;

struct Writer : task::Component {
  task::OutputPort<double> number{*this, "number"};
  task::OutputPort<std::vector<double>> numbers{*this, "numbers"};
};

Value measured(PortReader& reader) {
  const auto values = reader.read(1);
  EXPECT_EQ(values.size(), 1U);
  return values.empty() ? Value() : values.front();
}
std::int64_t count(const Value& measured, const char* key) {
  return measured.find(key)->as_int();
}

TEST(WriteMeter, CountsSamplesAndBytesSinceTheLastRead) {
  Writer writer;
  const auto meter = measure_writes(writer.number).value();
  for (const std::int64_t samples : {3, 5}) {
    for (int i = 0; i < samples; ++i)
      writer.number.write(i);
    const Value found = measured(*meter);
    EXPECT_EQ(count(found, "samples"), samples);
    EXPECT_EQ(count(found, "bytes"), samples * 8);
    const double mean = found.find("mean_s")->as_double();
    EXPECT_LE(found.find("least_s")->as_double(), mean);
    EXPECT_GE(found.find("most_s")->as_double(), mean);
    EXPECT_GE(found.find("deviation_s")->as_double(), 0);
    EXPECT_GT(found.find("span_s")->as_double(), 0);
  }
  const Value nothing = measured(*meter);
  EXPECT_EQ(count(nothing, "samples"), 0);
  EXPECT_EQ(*nothing.find("mean_s"), Value());
}

TEST(WriteMeter, CountsWhatSamplesReferTo) {
  Writer writer;
  const auto meter = measure_writes(writer.numbers).value();
  writer.numbers.write(std::vector<double>(1000));
  EXPECT_GE(count(measured(*meter), "bytes"), 8000);
}

TEST(WriteMeter, OutlivesItsPort) {
  auto writer = std::make_unique<Writer>();
  const auto meter = measure_writes(writer->number).value();
  writer->number.write(1);
  writer.reset();
  EXPECT_EQ(count(measured(*meter), "samples"), 1);
}

TEST(WriteMeter, TwoMeasureTheSamePort) {
  Writer writer;
  const auto one = measure_writes(writer.number).value();
  writer.number.write(1);
  const auto other = measure_writes(writer.number).value();
  writer.number.write(2);
  EXPECT_EQ(count(measured(*one), "samples"), 2);
  EXPECT_EQ(count(measured(*other), "samples"), 1);
}

/// For thread sanitizer, and for sums that are of one moment.
TEST(WriteMeter, IsReadWhileItsPortIsWritten) {
  constexpr int kSamples = 20'000;
  Writer writer;
  const auto meter = measure_writes(writer.number).value();
  std::thread thread([&] {
    for (int i = 0; i < kSamples; ++i)
      writer.number.write(i);
  });
  std::int64_t samples = 0;
  while (samples < kSamples) {
    const Value found = measured(*meter);
    EXPECT_EQ(count(found, "bytes"), 8 * count(found, "samples"));
    samples += count(found, "samples");
  }
  thread.join();
  EXPECT_EQ(samples, kSamples);
}

}  // namespace
}  // namespace segue::task_host::detail
