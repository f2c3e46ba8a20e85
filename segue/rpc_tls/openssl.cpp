// SPDX-License-Identifier: Apache-2.0
#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/rpc_tls/openssl.hpp>

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <utility>

namespace segue::control::tls {

namespace {

using Bio = Owned<BIO, BIO_free_all>;

constexpr std::size_t kLargestFile = std::size_t{1} << 20;

/// There is nobody to ask for a password.
int no_password(char*, int, int, void*) {
  return -1;
}

template <class T, class Read>
Result<T> from_pem(std::string_view pem, const std::filesystem::path& file, const char* what, Read read) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(std::min(pem.size(), kLargestFile))));
  T object(bio ? read(bio.get(), nullptr, no_password, nullptr) : nullptr);
  if (object) return object;
  return openssl_error(ErrorCode::ParseError, quote(file.string()) + " is not a valid " + what + " in PEM");
}

template <class Write>
std::string pem_of(Write write) {
  const Bio bio(BIO_new(BIO_s_mem()));
  if (!bio || write(bio.get()) != 1) return {};
  char* text = nullptr;
  const auto size = BIO_get_mem_data(bio.get(), &text);
  return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : std::string();
}

std::string hexadecimal(const ASN1_INTEGER* number) {
  const Owned<BIGNUM, BN_free> value(ASN1_INTEGER_to_BN(number, nullptr));
  if (!value) return {};
  char* digits = BN_bn2hex(value.get());
  if (digits == nullptr) return {};
  std::string text = digits;
  OPENSSL_free(digits);
  std::ranges::transform(text, text.begin(), [](char c) { return c >= 'A' && c <= 'F' ? c - 'A' + 'a' : c; });
  return text;
}

/// The text of the only entry of that kind in the certificate's subject.
std::optional<std::string> only_entry(X509* certificate, int kind) {
  const X509_NAME* subject = X509_get_subject_name(certificate);
  const int place = X509_NAME_get_index_by_NID(subject, kind, -1);
  if (place < 0 || X509_NAME_get_index_by_NID(subject, kind, place) >= 0) return std::nullopt;
  unsigned char* text = nullptr;
  const int size = ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, place)));
  if (size < 0) return std::nullopt;
  std::string result(reinterpret_cast<const char*>(text), static_cast<std::size_t>(size));
  OPENSSL_free(text);
  return result;
}

std::string ip_address(const ASN1_OCTET_STRING* bytes) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const int size = ASN1_STRING_length(bytes);
  if (size != sizeof(in_addr) && size != sizeof(in6_addr)) return {};
  const int family = size == sizeof(in_addr) ? AF_INET : AF_INET6;
  ::inet_ntop(family, ASN1_STRING_get0_data(bytes), text.data(), text.size());
  return text.data();
}

/// The DNS names and IP addresses among the certificate's subject alternative names.
std::vector<std::string> alternative_names_of(X509* certificate) {
  const Owned<GENERAL_NAMES, GENERAL_NAMES_free> names(
      static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)));
  std::vector<std::string> all;
  for (int i = 0; i < sk_GENERAL_NAME_num(names.get()); ++i) {
    int kind = 0;
    const void* value = GENERAL_NAME_get0_value(sk_GENERAL_NAME_value(names.get(), i), &kind);
    std::string name;
    if (kind == GEN_IPADD) name = ip_address(static_cast<const ASN1_OCTET_STRING*>(value));
    if (kind == GEN_DNS) {
      const auto* text = static_cast<const ASN1_IA5STRING*>(value);
      name.assign(reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
                  static_cast<std::size_t>(ASN1_STRING_length(text)));
    }
    if (!name.empty()) all.push_back(std::move(name));
  }
  return all;
}

/// Whether only its owner, we or root, may read the file.
Result<void> check_secret(int descriptor, const std::filesystem::path& file) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return system_error("cannot read " + quote(file.string()), errno);
  if (status.st_uid != ::geteuid() && status.st_uid != 0) {
    return fail(ErrorCode::PermissionDenied,
                "the key " + quote(file.string()) + " belongs to another user; make it yours");
  }
  if ((status.st_mode & 077U) == 0) return {};
  return fail(ErrorCode::PermissionDenied, "others may read the key " + quote(file.string()) +
                                               "; do chmod 600, or replace it if somebody has");
}

Result<std::string> read_secret(const std::filesystem::path& file) {
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  if (!descriptor.valid()) return system_error("cannot read the key " + quote(file.string()), errno);
  if (auto safe = check_secret(descriptor.get(), file); !safe) return safe.error();
  std::string content;
  std::array<char, 4096> chunk{};
  for (;;) {
    const auto got = ::read(descriptor.get(), chunk.data(), chunk.size());
    if (got == 0) return content;
    if (got < 0) return system_error("cannot read the key " + quote(file.string()), errno);
    content.append(chunk.data(), static_cast<std::size_t>(got));
    if (content.size() > kLargestFile) {
      return fail(ErrorCode::ParseError, quote(file.string()) + " is too large to be a key");
    }
  }
}

}  // namespace

std::string openssl_reason() {
  const unsigned long code = ERR_peek_last_error();
  ERR_clear_error();
  if (code == 0) return {};
  const char* reason = ERR_reason_error_string(code);
  return reason != nullptr ? std::string(reason) : "error " + std::to_string(code);
}

Error openssl_error(ErrorCode code, const std::string& what) {
  const std::string reason = openssl_reason();
  return fail(code, reason.empty() ? what : what + ": " + reason);
}

Result<Certificate> certificate_from(std::string_view pem, const std::filesystem::path& file) {
  return from_pem<Certificate>(pem, file, "certificate", PEM_read_bio_X509);
}

Result<RevokedList> revoked_list_from(std::string_view pem, const std::filesystem::path& file) {
  return from_pem<RevokedList>(pem, file, "list of revoked certificates", PEM_read_bio_X509_CRL);
}

Result<Key> key_from(std::string_view pem, const std::filesystem::path& file) {
  return from_pem<Key>(pem, file, "key without a password", PEM_read_bio_PrivateKey);
}

std::string to_pem(X509* certificate) {
  return pem_of([=](BIO* bio) { return PEM_write_bio_X509(bio, certificate); });
}

std::string to_pem(X509_CRL* list) {
  return pem_of([=](BIO* bio) { return PEM_write_bio_X509_CRL(bio, list); });
}

std::string to_pem(EVP_PKEY* key) {
  return pem_of([=](BIO* bio) {
    return PEM_write_bio_PKCS8PrivateKey(bio, key, nullptr, nullptr, 0, nullptr, nullptr);
  });
}

Result<Certificate> read_certificate(const std::filesystem::path& file) {
  const auto text = read_file(file, kLargestFile);
  if (!text) return text.error();
  return certificate_from(*text, file);
}

Result<Key> read_key(const std::filesystem::path& file) {
  const auto text = read_secret(file);
  if (!text) return text.error();
  return key_from(*text, file);
}

Result<RevokedList> read_revoked_list(const std::filesystem::path& file, X509* authority) {
  const auto text = read_file(file, kLargestFile);
  if (!text) return text.error();
  auto list = revoked_list_from(*text, file);
  if (list && X509_CRL_verify(list->get(), X509_get0_pubkey(authority)) != 1) {
    return openssl_error(ErrorCode::ParseError, quote(file.string()) + " is not signed by this authority");
  }
  return list;
}

Result<Identity> identity_of(X509* certificate) {
  const auto name = only_entry(certificate, NID_commonName);
  const auto unit = only_entry(certificate, NID_organizationalUnitName);
  const auto role = unit ? role_from(*unit) : fail(ErrorCode::ParseError, "");
  if (!name || !is_identifier(*name) || !role) {
    return fail(ErrorCode::ParseError, "the certificate of " + quote(common_name(certificate)) +
                                           " does not name one owner and one role, as those of Segue do");
  }
  Identity identity;
  identity.name = *name;
  identity.role = *role;
  const auto uses = X509_get_extended_key_usage(certificate);
  identity.host = uses != UINT32_MAX && (uses & XKU_SSL_SERVER) != 0;
  identity.serial = serial_of(certificate);
  identity.valid_from = time_from(X509_get0_notBefore(certificate));
  identity.valid_until = time_from(X509_get0_notAfter(certificate));
  if (identity.host) identity.addresses = alternative_names_of(certificate);
  return identity;
}

std::string common_name(X509* certificate) {
  return only_entry(certificate, NID_commonName).value_or("");
}

std::string serial_of(X509* certificate) {
  return hexadecimal(X509_get0_serialNumber(certificate));
}

std::vector<Revocation> revocations(X509_CRL* list) {
  std::vector<Revocation> all;
  STACK_OF(X509_REVOKED)* entries = X509_CRL_get_REVOKED(list);
  for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
    const X509_REVOKED* entry = sk_X509_REVOKED_value(entries, i);
    all.push_back({hexadecimal(X509_REVOKED_get0_serialNumber(entry)),
                   time_from(X509_REVOKED_get0_revocationDate(entry))});
  }
  return all;
}

Time time_from(const ASN1_TIME* time) {
  std::tm parts{};
  if (time == nullptr || ASN1_TIME_to_tm(time, &parts) != 1) return {};
  return std::chrono::system_clock::from_time_t(::timegm(&parts));
}

std::string text_of(Time time) {
  std::string text = iso_time(time);
  return text.substr(0, text.find('.')) + 'Z';
}

}  // namespace segue::control::tls
