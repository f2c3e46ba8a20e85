// SPDX-License-Identifier: Apache-2.0
//
// Reading the flat layout, as if a hostile process had written it. The first byte chooses the type.
#include "allocated.hpp"
#include "require.hpp"

#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/describe.hpp>
#include <segue/type/flat.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace fuzzed {
enum class Mode : std::int16_t { Back = -1, Idle, Drive = 5 };
struct Sample {
  double value = 0;
  bool valid = false;
  Mode mode = Mode::Idle;
};
struct Empty {};
struct Tree {
  std::int32_t value = 0;
  std::vector<Tree> branches;
};
struct All {
  std::string name;
  std::vector<Sample> samples;
  std::optional<std::string> remark;
  std::vector<bool> bits;
  std::array<std::vector<std::uint16_t>, 2> two;
  std::vector<Empty> empty;
  std::optional<Sample> last;
  std::vector<std::vector<std::string>> texts;
};

SEGUE_TYPE(Mode, Back, Idle, Drive)
SEGUE_TYPE(Sample, value, valid, mode)
SEGUE_TYPE(Empty)
SEGUE_TYPE(Tree, value, branches)
SEGUE_TYPE(All, name, samples, remark, bits, two, empty, last, texts)

}  // namespace fuzzed

namespace segue::type {
namespace {

using fuzz::require;
using testing::allocated;

/// A sequence in memory has at the most so many times the bytes it has in the layout: of optionals, which
/// take one byte there when they hold nothing.
constexpr std::size_t kMostGrowth = sizeof(std::optional<fuzzed::Sample>);
/// A vector that grows at least doubles, and what it holds moves.
constexpr std::size_t kReallocation = 2;

/// To CDR, as by way of the object, if there is one.
void convert(const TypeInfo& info, std::span<const std::byte> bytes, const void* object) {
  require(is_flat(info, bytes) == (object != nullptr), "the check accepts what objects accept");
  std::vector<std::byte> cdr(cdr_size_of_flat(info, bytes));
  const bool done = !cdr.empty() && flat_to_cdr(info, bytes, cdr);
  require(done == !cdr.empty(), "what has a size can be written");
  if (object == nullptr) return;
  std::vector<std::byte> expected(cdr_size(info, object));
  require(write_cdr(info, object, expected) && cdr == expected, "CDR is that of the object");
}

template <class T>
void read(std::span<const std::byte> bytes) {
  static const TypeInfo& info = type_info<T>();
  static T used{};  // what inputs before this one left there
  T object{};
  allocated = 0;
  const bool done = read_flat(info, &object, bytes);
  require(allocated <= kMostGrowth * kReallocation * bytes.size(), "no more memory than the input justifies");
  require(read_flat(info, &used, bytes) == done, "what was there before does not matter");
  std::vector<std::byte> again(flat_size(info, &object));
  require(write_flat(info, &object, again) == again.size(), "whatever was read can be written");
  T copy{};
  require(read_flat(info, &copy, again), "and read again");
  require(info.to_value(&copy) == info.to_value(&object), "and is the same");
  convert(info, bytes, done ? &object : nullptr);
  if (!done) return;
  require(again.size() == bytes.size(), "what was accepted has one length");
  require(info.to_value(&used) == info.to_value(&object), "an object that was used reads the same");
}

}  // namespace
}  // namespace segue::type

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span bytes = std::as_bytes(std::span(data + 1, size - 1));
  using segue::type::read;
  switch (data[0] % 5) {
    case 0:
      read<fuzzed::Tree>(bytes);
      break;
    case 1:
      read<std::vector<std::optional<fuzzed::Sample>>>(bytes);
      break;
    case 2:
      read<std::vector<std::string>>(bytes);
      break;
    case 3:
      read<std::vector<bool>>(bytes);
      break;
    default:
      read<fuzzed::All>(bytes);
  }
  return 0;
}
