// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc/credentials.hpp>

#include <openssl/evp.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// OpenSSL's objects with owners, and what is read from certificates. All functions may be called from any
/// thread.
namespace segue::control::tls {

template <auto kFree>
struct Freer {
  template <class T>
  void operator()(T* object) const {
    kFree(object);
  }
};
template <class T, auto kFree>
using Owned = std::unique_ptr<T, Freer<kFree>>;

using Certificate = Owned<X509, X509_free>;
using RevokedList = Owned<X509_CRL, X509_CRL_free>;
using Key = Owned<EVP_PKEY, EVP_PKEY_free>;
using Time = std::chrono::system_clock::time_point;

/// "WHAT: the reason that OpenSSL noted last"; empties what it has noted.
Error openssl_error(ErrorCode code, const std::string& what);
/// The reason that OpenSSL noted last, alone.
std::string openssl_reason();

/// Read PEM; ParseError names `file`. Keys must not be encrypted.
Result<Certificate> certificate_from(std::string_view pem, const std::filesystem::path& file);
Result<RevokedList> revoked_list_from(std::string_view pem, const std::filesystem::path& file);
Result<Key> key_from(std::string_view pem, const std::filesystem::path& file);
/// Write PEM.
std::string to_pem(X509* certificate);
std::string to_pem(X509_CRL* list);
std::string to_pem(EVP_PKEY* key);

/// Reads a file of at most 1 MiB.
Result<Certificate> read_certificate(const std::filesystem::path& file);
/// Reads a key from a file of at most 1 MiB; PermissionDenied where others may read it or it belongs to
/// somebody else.
Result<Key> read_key(const std::filesystem::path& file);
/// Reads a list from a file of at most 1 MiB; ParseError where the authority has not signed it.
Result<RevokedList> read_revoked_list(const std::filesystem::path& file, X509* authority);

/// The owner that a certificate names; ParseError where it does not follow the rules of Identity.
Result<Identity> identity_of(X509* certificate);
/// The common name, whatever else there is, for messages about certificates that are refused; may be empty.
std::string common_name(X509* certificate);
std::string serial_of(X509* certificate);

struct Revocation {
  std::string serial;
  Time when;
};
std::vector<Revocation> revocations(X509_CRL* list);

/// 1970 where it is none.
Time time_from(const ASN1_TIME* time);
/// "2026-11-22T01:02:03Z"
std::string text_of(Time time);

}  // namespace segue::control::tls
