// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rpc_tls/issue.hpp>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <ctime>
#include <string>
#include <utility>

namespace segue::control::tls {

namespace {

using std::chrono::hours;

constexpr hours kDay(24);
constexpr hours kAuthorityLife = 3653 * kDay;
constexpr hours kHostLife = 825 * kDay;
constexpr hours kPersonLife = 365 * kDay;
/// Clocks of computers differ.
constexpr hours kBackdated(1);

using Extension = Owned<X509_EXTENSION, X509_EXTENSION_free>;
using Number = Owned<ASN1_INTEGER, ASN1_INTEGER_free>;
using Moment = Owned<ASN1_TIME, ASN1_TIME_free>;

Error failed(const std::string& what) {
  return openssl_error(ErrorCode::Internal, "cannot make " + what);
}

Moment moment(Time time) {
  return Moment(ASN1_TIME_set(nullptr, std::chrono::system_clock::to_time_t(time)));
}

std::array<unsigned char, 16> random_bytes() {
  std::array<unsigned char, 16> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) bytes = {};
  bytes[0] = static_cast<unsigned char>((bytes[0] & 0x3FU) | 0x40U);  // positive and of full length
  return bytes;
}

Number number_from(const std::array<unsigned char, 16>& bytes) {
  const Owned<BIGNUM, BN_free> value(BN_bin2bn(bytes.data(), static_cast<int>(bytes.size()), nullptr));
  return Number(value ? BN_to_ASN1_INTEGER(value.get(), nullptr) : nullptr);
}

bool add_name(X509_NAME* name, const char* kind, const std::string& text) {
  return X509_NAME_add_entry_by_txt(name, kind, MBSTRING_UTF8,
                                    reinterpret_cast<const unsigned char*>(text.data()),
                                    static_cast<int>(text.size()), -1, 0) == 1;
}

bool add_extension(X509* certificate, X509* issuer, int kind, const char* text) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, text));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

/// The parts that all certificates have.
bool prepare(X509* certificate, EVP_PKEY* key, Time from, Time until) {
  const Number serial = number_from(random_bytes());
  const Moment begin = moment(from);
  const Moment end = moment(until);
  return serial && begin && end && X509_set_version(certificate, X509_VERSION_3) == 1 &&
         X509_set_serialNumber(certificate, serial.get()) == 1 &&
         X509_set1_notBefore(certificate, begin.get()) == 1 &&
         X509_set1_notAfter(certificate, end.get()) == 1 && X509_set_pubkey(certificate, key) == 1;
}

bool is_signed(X509* certificate, EVP_PKEY* key) {
  return X509_sign(certificate, key, EVP_sha256()) > 0;
}

/// Whether it can be a DNS name: letters, digits, '-' and '.', at most 253 of them.
bool is_dns_name(const std::string& text) {
  const auto fits = [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '-' || letter == '.';
  };
  return !text.empty() && text.size() <= 253 && std::ranges::all_of(text, fits) &&
         std::isalnum(static_cast<unsigned char>(text.front())) != 0;
}

bool is_ip_address(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return ::inet_pton(AF_INET, text.c_str(), address.data()) == 1 ||
         ::inet_pton(AF_INET6, text.c_str(), address.data()) == 1;
}

/// "DNS:arm,IP:10.0.0.3": what browsers compare with the address that they have opened.
Result<std::string> alternative_names(const Enrolment& enrolment) {
  std::string names = is_dns_name(enrolment.name) ? "DNS:" + enrolment.name : "";
  for (const std::string& address : enrolment.addresses) {
    const bool is_ip = is_ip_address(address);
    if (!is_ip && !is_dns_name(address)) {
      return fail(ErrorCode::InvalidArgument,
                  quote(address) + " is neither an IP address nor the name of a computer");
    }
    names += (names.empty() ? "" : ",") + std::string(is_ip ? "IP:" : "DNS:") + address;
  }
  return names;
}

}  // namespace

Result<Key> new_key() {
  Key key(EVP_EC_gen("P-256"));
  if (!key) return failed("a key");
  return key;
}

Result<Certificate> new_authority(EVP_PKEY* key) {
  Certificate certificate(X509_new());
  const Time now = std::chrono::system_clock::now();
  if (!certificate || !prepare(certificate.get(), key, now - kBackdated, now + kAuthorityLife)) {
    return failed("the certificate of an authority");
  }
  X509_NAME* name = X509_get_subject_name(certificate.get());
  X509* own = certificate.get();
  const bool done = add_name(name, "O", "segue") &&
                    add_name(name, "CN", "authority " + serial_of(own).substr(0, 12)) &&
                    X509_set_issuer_name(own, name) == 1 &&
                    add_extension(own, own, NID_basic_constraints, "critical,CA:TRUE,pathlen:0") &&
                    add_extension(own, own, NID_key_usage, "critical,keyCertSign,cRLSign") &&
                    add_extension(own, own, NID_subject_key_identifier, "hash") && is_signed(own, key);
  if (!done) return failed("the certificate of an authority");
  return certificate;
}

Result<Certificate> issue(const Enrolment& enrolment, EVP_PKEY* subject_key, X509* authority, EVP_PKEY* key) {
  Certificate certificate(X509_new());
  const Time from = enrolment.from.value_or(std::chrono::system_clock::now() - kBackdated);
  const auto names = enrolment.host ? alternative_names(enrolment) : Result<std::string>("");
  if (!names) return names.error();
  const hours usual = enrolment.host ? kHostLife : kPersonLife;
  const Time until = from + (enrolment.valid.count() > 0 ? enrolment.valid : usual);
  if (!certificate || !prepare(certificate.get(), subject_key, from, until)) return failed("a certificate");
  X509* own = certificate.get();
  X509_NAME* name = X509_get_subject_name(own);
  const char* uses = enrolment.host ? "serverAuth,clientAuth" : "clientAuth";
  const bool done =
      add_name(name, "O", "segue") && add_name(name, "OU", std::string(to_string(enrolment.role))) &&
      add_name(name, "CN", enrolment.name) &&
      X509_set_issuer_name(own, X509_get_subject_name(authority)) == 1 &&
      add_extension(own, authority, NID_basic_constraints, "critical,CA:FALSE") &&
      add_extension(own, authority, NID_key_usage, "critical,digitalSignature") &&
      add_extension(own, authority, NID_ext_key_usage, uses) &&
      (names->empty() || add_extension(own, authority, NID_subject_alt_name, names->c_str())) &&
      add_extension(own, authority, NID_subject_key_identifier, "hash") &&
      add_extension(own, authority, NID_authority_key_identifier, "keyid:always") && is_signed(own, key);
  if (!done) return failed("a certificate");
  return certificate;
}

Result<RevokedList> new_list(const std::vector<Revocation>& revoked, X509* authority, EVP_PKEY* key,
                             long number) {
  RevokedList list(X509_CRL_new());
  const Time now = std::chrono::system_clock::now();
  const Moment begin = moment(now - kBackdated);
  // A list that was copied by hand must not lock everybody out because nobody has copied a newer one.
  const Moment next = moment(now + kAuthorityLife);
  const Number own_number(ASN1_INTEGER_new());
  bool done = list && begin && next && own_number && ASN1_INTEGER_set(own_number.get(), number) == 1 &&
              X509_CRL_set_version(list.get(), X509_CRL_VERSION_2) == 1 &&
              X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(authority)) == 1 &&
              X509_CRL_set1_lastUpdate(list.get(), begin.get()) == 1 &&
              X509_CRL_set1_nextUpdate(list.get(), next.get()) == 1 &&
              X509_CRL_add1_ext_i2d(list.get(), NID_crl_number, own_number.get(), 0, 0) == 1;
  for (const Revocation& one : revoked) {
    Owned<X509_REVOKED, X509_REVOKED_free> entry(X509_REVOKED_new());
    BIGNUM* raw = nullptr;
    done = done && BN_hex2bn(&raw, one.serial.c_str()) > 0;
    const Owned<BIGNUM, BN_free> value(raw);
    const Number serial(value ? BN_to_ASN1_INTEGER(value.get(), nullptr) : nullptr);
    const Moment when = moment(one.when);
    done = done && entry && serial && when && X509_REVOKED_set_serialNumber(entry.get(), serial.get()) == 1 &&
           X509_REVOKED_set_revocationDate(entry.get(), when.get()) == 1 &&
           X509_CRL_add0_revoked(list.get(), entry.get()) == 1;
    if (done) static_cast<void>(entry.release());
  }
  done = done && X509_CRL_sort(list.get()) == 1 && X509_CRL_sign(list.get(), key, EVP_sha256()) > 0;
  if (!done) return failed("the list of revoked certificates");
  return list;
}

long number_of(X509_CRL* list) {
  const Number number(
      static_cast<ASN1_INTEGER*>(X509_CRL_get_ext_d2i(list, NID_crl_number, nullptr, nullptr)));
  return number ? ASN1_INTEGER_get(number.get()) : 0;
}

}  // namespace segue::control::tls
