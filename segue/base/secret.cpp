// SPDX-License-Identifier: Apache-2.0
#include <segue/base/secret.hpp>

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace segue {

namespace {

void fill_with_random(void* bytes, std::size_t size) {
  if (::getrandom(bytes, size, 0) != static_cast<ssize_t>(size))
    throw std::system_error(errno, std::generic_category(), "getrandom");
}

}  // namespace

std::string random_secret() {
  constexpr std::string_view kHexadecimal = "0123456789abcdef";
  std::array<unsigned char, 32> bytes{};
  fill_with_random(bytes.data(), bytes.size());
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kHexadecimal[byte >> 4U];
    text += kHexadecimal[byte & 15U];
  }
  return text;
}

std::uint64_t random_number() {
  std::uint64_t number = 0;
  while (number == 0)
    fill_with_random(&number, sizeof(number));
  return number;
}

bool equal_secrets(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t at = 0; at < a.size(); ++at)
    difference |= static_cast<unsigned char>(a[at]) ^ static_cast<unsigned char>(b[at]);
  return difference == 0;
}

}  // namespace segue
