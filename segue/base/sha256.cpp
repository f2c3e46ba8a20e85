// SPDX-License-Identifier: Apache-2.0
#include <segue/base/sha256.hpp>

#include <openssl/evp.h>

#include <array>
#include <new>

namespace segue {

std::string sha256(std::string_view content) {
  std::array<unsigned char, 32> digest{};
  // Fails only where there is no memory for its state.
  if (EVP_Digest(content.data(), content.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1)
    throw std::bad_alloc();
  std::string digits;
  for (const unsigned byte : digest) {
    digits += "0123456789abcdef"[byte >> 4U];
    digits += "0123456789abcdef"[byte & 0xFU];
  }
  return digits;
}

}  // namespace segue
