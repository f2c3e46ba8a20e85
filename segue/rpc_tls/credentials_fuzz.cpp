// SPDX-License-Identifier: Apache-2.0
// Fuzzes addresses, certificates and lists of revoked certificates that others may have written: the other
// side of a connection shows its certificate before anybody trusts it.
#include <segue/base/text.hpp>
#include <segue/rpc/tcp_address.hpp>
#include <segue/rpc_tls/openssl.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace segue::control {
namespace {

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

void read_address(std::string_view text) {
  const auto address = parse_tcp_address(text, 7);
  if (!address) return;
  const auto again = parse_tcp_address(to_string(*address));
  require(again.has_value() && *again == *address, "an address is read as it was written");
}

void read(X509* certificate) {
  static_cast<void>(tls::common_name(certificate));
  const auto identity = tls::identity_of(certificate);
  if (identity) require(is_identifier(identity->name), "a name is an identifier");
}

void read_certificate(const std::uint8_t* bytes, std::size_t size) {
  const tls::Certificate certificate(d2i_X509(nullptr, &bytes, static_cast<long>(size)));
  if (certificate) read(certificate.get());
}

void read_pem(std::string_view text) {
  if (const auto certificate = tls::certificate_from(text, "fuzzed.crt")) read(certificate->get());
}

void read_list(std::string_view text) {
  const auto list = tls::revoked_list_from(text, "fuzzed.crl");
  if (!list) return;
  for (const auto& one : tls::revocations(list->get()))
    static_cast<void>(tls::text_of(one.when));
}

void read_binary_list(const std::uint8_t* bytes, std::size_t size) {
  const tls::RevokedList list(d2i_X509_CRL(nullptr, &bytes, static_cast<long>(size)));
  if (list) static_cast<void>(tls::revocations(list.get()));
}

}  // namespace
}  // namespace segue::control

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace segue::control;
  if (size == 0) return 0;
  const unsigned kind =
      *bytes++;  // 'd' an address, 'e' a certificate, 'a' in PEM, 'b' a list in PEM, 'c' a list
  --size;
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  switch (kind % 5) {
    case 0:
      read_address(text);
      break;
    case 1:
      read_certificate(bytes, size);
      break;
    case 2:
      read_pem(text);
      break;
    case 3:
      read_list(text);
      break;
    default:
      read_binary_list(bytes, size);
  }
  static_cast<void>(tls::openssl_reason());
  return 0;
}
